//! The value of a dictionary entry as bytes, for serial answers and SDOs.

use protocol::epos2::BoundedVec;

use super::entry::Type;

/// Bytes of the longest value.
pub(super) const LONGEST: usize = 8;

/// A value, low byte first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectValue(BoundedVec<u8, LONGEST>);

impl ObjectValue {
    /// A number of type `ty`, from the low bytes of `raw`.
    pub(super) fn number(ty: Type, raw: u64) -> Self {
        Self(raw.to_le_bytes().into_iter().take(ty.bytes()).collect())
    }

    /// A string, cut to 8 characters.
    pub(super) fn text(text: &str) -> Self {
        Self(text.bytes().collect())
    }

    /// The bytes, low byte first.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The value in 32 bits, zero above it; `None` for one that is longer.
    #[must_use]
    pub fn raw(&self) -> Option<u32> {
        let bytes = self.bytes().iter().rev();
        (self.0.len() <= 4).then(|| bytes.fold(0, |raw, byte| raw << 8 | u32::from(*byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_width_of_their_type() {
        let value = ObjectValue::number(Type::I16, 0xFFFF_FFFF_FFFF_FFFE);
        assert_eq!(value.bytes(), [0xFE, 0xFF]);
        assert_eq!(value.raw(), Some(0xFFFE));
        assert_eq!(ObjectValue::number(Type::U64, 1).raw(), None);
    }

    #[test]
    fn text_is_encoded_as_its_letters() {
        assert_eq!(ObjectValue::text("EPOS2").bytes(), b"EPOS2");
        assert_eq!(ObjectValue::text("EPOS2").raw(), None);
    }
}
