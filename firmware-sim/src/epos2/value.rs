//! The value of a dictionary entry as bytes, for serial answers and SDOs.

use super::entry::Type;

/// Bytes of the longest value.
pub(super) const LONGEST: usize = 8;

/// A value, low byte first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectValue {
    bytes: [u8; LONGEST],
    len: usize,
}

impl ObjectValue {
    /// A number of type `ty`, from the low bytes of `raw`.
    pub(super) const fn number(ty: Type, raw: u64) -> Self {
        Self {
            bytes: raw.to_le_bytes(),
            len: ty.bytes(),
        }
    }

    /// A string, cut to 8 characters.
    pub(super) fn text(text: &str) -> Self {
        let mut value = Self {
            bytes: [0; LONGEST],
            len: 0,
        };
        for (to, from) in value.bytes.iter_mut().zip(text.bytes()) {
            *to = from;
            value.len += 1;
        }
        value
    }

    /// The bytes, low byte first.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }

    /// The value in 32 bits, zero above it; `None` for one that is longer.
    #[must_use]
    pub fn raw(&self) -> Option<u32> {
        let raw = u64::from_le_bytes(self.bytes) & mask(self.len);
        if self.len <= 4 {
            u32::try_from(raw).ok()
        } else {
            None
        }
    }
}

/// The bits of `bytes` bytes.
const fn mask(bytes: usize) -> u64 {
    if bytes >= 8 {
        u64::MAX
    } else {
        (1 << (8 * bytes)) - 1
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
