//! The object dictionary: the static table of entries ([`super::table`]) and their stored values.
//! Effects of writes and computed values are in the node.

use protocol::epos2::objects::{Address, Scalar, TypedObject};

use super::AbortCode;
use super::entry::DictionaryEntry;
use super::table::{COUNT, TABLE};

/// Stored values, one per entry; those of computed entries are unused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Dictionary {
    values: [u32; COUNT],
}

impl Dictionary {
    /// The factory values.
    pub fn factory(node_id: u8) -> Self {
        let mut dictionary = Self { values: [0; COUNT] };
        for (value, entry) in dictionary.values.iter_mut().zip(&TABLE) {
            *value = entry.factory(node_id);
        }
        dictionary
    }

    /// Copies the entries of indices `first` to `last` from `other`.
    pub fn copy_range(&mut self, other: &Self, first: u16, last: u16) {
        for ((value, entry), from) in self.values.iter_mut().zip(&TABLE).zip(&other.values) {
            if (first..=last).contains(&entry.address.index) {
                *value = *from;
            }
        }
    }

    /// Restores the factory value of an entry.
    pub fn reset(&mut self, address: Address, node_id: u8) {
        if let Ok((i, entry)) = Self::place(address)
            && let Some(value) = self.values.get_mut(i)
        {
            *value = entry.factory(node_id);
        }
    }

    /// The entry at `address`.
    pub fn entry(address: Address) -> Result<&'static DictionaryEntry, AbortCode> {
        Self::place(address).map(|(_, entry)| entry)
    }

    fn place(address: Address) -> Result<(usize, &'static DictionaryEntry), AbortCode> {
        let found = TABLE.binary_search_by_key(&address, |entry| entry.address);
        // An address that is missing sorts after the other subindices of its index; each index has
        // subindex 0.
        let before = found.unwrap_or_else(|at| at.saturating_sub(1));
        match (found, TABLE.get(before)) {
            (Ok(i), Some(entry)) => Ok((i, entry)),
            (_, Some(entry)) if entry.address.index == address.index => Err(AbortCode::NO_SUB),
            _ => Err(AbortCode::NO_OBJECT),
        }
    }

    /// The stored value of an entry; 0 if it does not exist.
    pub fn raw(&self, address: Address) -> u32 {
        Self::place(address)
            .ok()
            .and_then(|(i, _)| self.values.get(i).copied())
            .unwrap_or_default()
    }

    /// The stored value of a typed object.
    pub fn get<T: Scalar>(&self, object: TypedObject<T>) -> T {
        object.decode(self.raw(object.address))
    }

    /// Stores a value; an address that does not exist is ignored.
    pub fn set(&mut self, address: Address, raw: u32) {
        if let Some(value) = Self::place(address)
            .ok()
            .and_then(|(i, _)| self.values.get_mut(i))
        {
            *value = raw;
        }
    }
}

#[cfg(test)]
mod tests {
    use protocol::epos2::objects;

    use super::*;

    #[test]
    fn defaults_fit_their_types_and_limits() {
        for entry in &TABLE {
            if entry.ty.bytes() == 0 {
                continue;
            }
            let value = entry.ty.number(entry.factory(1));
            assert_eq!(
                value,
                entry.default + i64::from(entry.plus_node_id),
                "{}",
                entry.address
            );
            assert!(
                (entry.low..=entry.high).contains(&value),
                "{}",
                entry.address
            );
        }
    }

    #[test]
    fn the_count_at_sub_0_reaches_the_last_sub() {
        for entry in TABLE.iter().filter(|entry| entry.address.sub > 0) {
            let index = entry.address.index;
            let count = TABLE
                .iter()
                .find(|e| e.address == Address { index, sub: 0 })
                .unwrap();
            // The history and the mappings count the entries in use.
            let holds = matches!(index, 0x1003 | 0x1600..=0x1603 | 0x1A00..=0x1A03)
                || count.default >= i64::from(entry.address.sub);
            assert!(holds, "{}", entry.address);
        }
    }

    #[test]
    fn missing_index_and_missing_sub_have_different_codes() {
        assert_eq!(
            Dictionary::entry(Address::new(0x6041, 1)).unwrap_err(),
            AbortCode::NO_SUB
        );
        assert_eq!(
            Dictionary::entry(Address::new(0x60F9, 3)).unwrap_err(),
            AbortCode::NO_SUB
        );
        assert_eq!(
            Dictionary::entry(Address::new(0x6042, 0)).unwrap_err(),
            AbortCode::NO_OBJECT
        );
    }

    #[test]
    fn defaults_are_those_a_scan_relies_on() {
        let dictionary = Dictionary::factory(5);
        assert_eq!(dictionary.get(objects::NODE_ID), 5);
        assert_eq!(dictionary.get(objects::INPUT_EXECUTION_MASK), 0x0008);
        assert_eq!(dictionary.get(objects::MIN_POSITION), i32::MIN);
        assert_eq!(dictionary.get(objects::MAX_ACCELERATION), u32::MAX);
        assert_eq!(dictionary.get(objects::HOMING_METHOD), 7);
    }
}
