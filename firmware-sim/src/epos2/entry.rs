//! The fixed properties of a dictionary entry: type, access, limits, factory value, PDO mapping.

use protocol::epos2::objects::Address;

use super::AbortCode;

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
    Domain,
}

impl Type {
    /// Bytes of a number of this type; 0 for texts and domains, whose length varies.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
            Self::U64 => 8,
            Self::Text | Self::Domain => 0,
        }
    }

    /// The number in the low bytes of `raw`.
    pub const fn number(self, raw: u32) -> i64 {
        match self {
            Self::U8 => raw as u8 as i64,
            Self::U16 => raw as u16 as i64,
            Self::U32 | Self::U64 | Self::Text | Self::Domain => raw as i64,
            Self::I8 => raw as i8 as i64,
            Self::I16 => raw as i16 as i64,
            Self::I32 => raw as i32 as i64,
        }
    }
}

/// Access rights of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EntryAccess {
    /// Read.
    Ro,
    /// Read and write.
    Rw,
    /// Read and write, by PDO too.
    Rww,
    /// Write.
    Wo,
}

/// One entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct DictionaryEntry {
    pub address: Address,
    /// The last subindex of a run of equal entries.
    pub last_sub: u8,
    pub ty: Type,
    pub access: EntryAccess,
    /// Factory value.
    pub default: i64,
    /// Adds the node id to the factory value.
    pub plus_node_id: bool,
    pub low: i64,
    pub high: i64,
    /// Permits mapping to a PDO.
    pub mappable: bool,
}

/// An entry without limits.
pub(super) const fn entry(
    index: u16,
    sub: u8,
    ty: Type,
    access: EntryAccess,
    default: i64,
) -> DictionaryEntry {
    DictionaryEntry {
        address: Address { index, sub },
        last_sub: sub,
        ty,
        access,
        default,
        plus_node_id: false,
        low: i64::MIN,
        high: i64::MAX,
        mappable: false,
    }
}

impl DictionaryEntry {
    /// Subindex 0 of an object: its last subindex.
    pub const fn count(index: u16, last_sub: u8) -> Self {
        entry(index, 0, Type::U8, EntryAccess::Ro, last_sub as i64)
    }

    /// The same entry at all subindices up to `last_sub`.
    pub const fn to_sub(self, last_sub: u8) -> Self {
        Self { last_sub, ..self }
    }

    pub const fn within(self, low: i64, high: i64) -> Self {
        Self { low, high, ..self }
    }

    pub const fn plus_node_id(self) -> Self {
        Self {
            plus_node_id: true,
            ..self
        }
    }

    pub const fn mappable(self) -> Self {
        Self {
            mappable: true,
            ..self
        }
    }

    pub const fn factory(&self, node_id: u8) -> u32 {
        let plus = if self.plus_node_id { node_id as i64 } else { 0 };
        (self.default + plus) as u32
    }

    pub fn check_read(&self) -> Result<(), AbortCode> {
        match self.access {
            EntryAccess::Wo => Err(AbortCode::WRITE_ONLY),
            EntryAccess::Ro | EntryAccess::Rw | EntryAccess::Rww => Ok(()),
        }
    }

    pub fn check_access(&self) -> Result<(), AbortCode> {
        match self.access {
            EntryAccess::Ro => Err(AbortCode::READ_ONLY),
            EntryAccess::Rw | EntryAccess::Rww | EntryAccess::Wo => Ok(()),
        }
    }

    /// Checks the length of a value.
    pub fn check_length(&self, bytes: usize) -> Result<(), AbortCode> {
        match self.ty.bytes() {
            // Texts and domains are rejected elsewhere.
            0 => Ok(()),
            wanted if bytes > wanted => Err(AbortCode::TOO_LONG),
            wanted if bytes < wanted => Err(AbortCode::TOO_SHORT),
            _ => Ok(()),
        }
    }

    /// Checks the limits of a write; bits above the type are ignored.
    pub fn check_limits(&self, raw: u32) -> Result<(), AbortCode> {
        let value = self.ty.number(raw);
        if value > self.high {
            Err(AbortCode::TOO_HIGH)
        } else if value < self.low {
            Err(AbortCode::TOO_LOW)
        } else {
            Ok(())
        }
    }

    /// Whether a transmit PDO may carry it.
    pub const fn is_sendable(&self) -> bool {
        self.mappable && !matches!(self.access, EntryAccess::Wo)
    }

    /// Whether a receive PDO may carry it.
    pub const fn is_receivable(&self) -> bool {
        self.mappable && matches!(self.access, EntryAccess::Rww | EntryAccess::Wo)
    }
}
