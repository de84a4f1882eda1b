//! The object dictionary: one static table of entries ([`super::table`]) and the stored values beside it.
//!
//! Here are existence, access, width and limits. What a write does, and which values are computed on read, is the node's.

use protocol::epos2::objects::{Address, Object, Scalar};

use super::Abort;
use super::table::TABLE;

/// Data types of entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    U8,
    U16,
    U32,
    U64,
    I8,
    I16,
    I32,
    Text,
}

impl Type {
    /// Bytes of a number of this type; 0 for strings, which have no fixed length.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
            Self::U64 => 8,
            Self::Text => 0,
        }
    }

    /// The number in the low bytes of `raw`.
    pub const fn number(self, raw: u32) -> i64 {
        match self {
            Self::U8 => raw as u8 as i64,
            Self::U16 => raw as u16 as i64,
            Self::U32 | Self::U64 | Self::Text => raw as i64,
            Self::I8 => raw as i8 as i64,
            Self::I16 => raw as i16 as i64,
            Self::I32 => raw as i32 as i64,
        }
    }
}

/// Who may do what with an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    Ro,
    Rw,
}

/// One entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub address: Address,
    pub ty: Type,
    pub access: Access,
    /// As from the factory.
    pub default: i64,
    /// The factory value has the node id added.
    pub plus_node_id: bool,
    pub low: i64,
    pub high: i64,
}

/// An entry without limits of its own.
pub(super) const fn entry(index: u16, sub: u8, ty: Type, access: Access, default: i64) -> Entry {
    Entry {
        address: Address { index, sub },
        ty,
        access,
        default,
        plus_node_id: false,
        low: i64::MIN,
        high: i64::MAX,
    }
}

impl Entry {
    pub const fn within(self, low: i64, high: i64) -> Self {
        Self { low, high, ..self }
    }

    pub const fn plus_node_id(self) -> Self {
        Self {
            plus_node_id: true,
            ..self
        }
    }

    fn factory(&self, node_id: u8) -> u32 {
        let plus = if self.plus_node_id {
            i64::from(node_id)
        } else {
            0
        };
        (self.default + plus) as u32
    }

    /// Whether the low bytes of `raw` may be written.
    pub fn check_write(&self, raw: u32) -> Result<(), Abort> {
        let value = self.ty.number(raw);
        if self.access == Access::Ro {
            Err(Abort::READ_ONLY)
        } else if value > self.high {
            Err(Abort::TOO_HIGH)
        } else if value < self.low {
            Err(Abort::TOO_LOW)
        } else {
            Ok(())
        }
    }
}

/// Stored values, one an entry; the entries that are computed have one too, unused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Dictionary {
    values: [u32; TABLE.len()],
}

impl Dictionary {
    /// Everything as from the factory.
    pub fn factory(node_id: u8) -> Self {
        let mut dictionary = Self {
            values: [0; TABLE.len()],
        };
        for (value, entry) in dictionary.values.iter_mut().zip(&TABLE) {
            *value = entry.factory(node_id);
        }
        dictionary
    }

    /// The entry at `address`.
    pub fn entry(address: Address) -> Result<&'static Entry, Abort> {
        Self::place(address).map(|(_, entry)| entry)
    }

    fn place(address: Address) -> Result<(usize, &'static Entry), Abort> {
        let found = TABLE.binary_search_by_key(&address, |entry| entry.address);
        match found.ok().and_then(|i| Some((i, TABLE.get(i)?))) {
            Some(found) => Ok(found),
            None if TABLE
                .iter()
                .any(|entry| entry.address.index == address.index) =>
            {
                Err(Abort::NO_SUB)
            }
            None => Err(Abort::NO_OBJECT),
        }
    }

    /// The stored value of an entry; 0 where there is none.
    pub fn raw(&self, address: Address) -> u32 {
        Self::place(address)
            .ok()
            .and_then(|(i, _)| self.values.get(i).copied())
            .unwrap_or_default()
    }

    /// The stored value of a typed object.
    pub fn get<T: Scalar>(&self, object: Object<T>) -> T {
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

/// Lookups are binary searches.
const _: () = {
    let mut i = 1;
    while i < TABLE.len() {
        let (a, b) = (TABLE[i - 1].address, TABLE[i].address);
        assert!(
            a.index < b.index || a.index == b.index && a.sub < b.sub,
            "the table is not in order"
        );
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use protocol::epos2::objects;

    use super::*;

    #[test]
    fn defaults_fit_their_types_and_limits() {
        for entry in &TABLE {
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
            let holds = index == 0x1003 || count.default >= i64::from(entry.address.sub);
            assert!(holds, "{}", entry.address);
        }
    }

    #[test]
    fn missing_index_and_missing_sub_differ() {
        assert_eq!(
            Dictionary::entry(Address::new(0x6041, 1)).unwrap_err(),
            Abort::NO_SUB
        );
        assert_eq!(
            Dictionary::entry(Address::new(0x60F9, 3)).unwrap_err(),
            Abort::NO_SUB
        );
        assert_eq!(
            Dictionary::entry(Address::new(0x6042, 0)).unwrap_err(),
            Abort::NO_OBJECT
        );
    }

    #[test]
    fn the_defaults_a_scan_relies_on() {
        let dictionary = Dictionary::factory(5);
        assert_eq!(dictionary.get(objects::NODE_ID), 5);
        assert_eq!(dictionary.get(objects::INPUT_EXECUTION_MASK), 0x0008);
        assert_eq!(dictionary.get(objects::MIN_POSITION), i32::MIN);
        assert_eq!(dictionary.get(objects::MAX_ACCELERATION), u32::MAX);
        assert_eq!(dictionary.get(objects::HOMING_METHOD), 7);
    }
}
