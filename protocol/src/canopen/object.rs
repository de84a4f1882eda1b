//! Entries of an object dictionary (CiA 301, "Object dictionary"): addresses, value types, typed
//! entries.

use core::fmt;
use core::marker::PhantomData;

/// Index and subindex of an entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Address {
    /// Index.
    pub index: u16,
    /// Subindex.
    pub sub: u8,
}

impl Address {
    /// The entry `index`:`sub`.
    #[must_use]
    pub const fn new(index: u16, sub: u8) -> Self {
        Self { index, sub }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04X}:{:02X}", self.index, self.sub)
    }
}

/// A value type of up to 32 bits in a serial command or an expedited SDO.
pub trait Scalar: Copy {
    /// Bytes of the object.
    const BYTES: u8;
    /// The value in the low bytes of `raw`; the others are ignored (a real drive leaves garbage
    /// there).
    fn from_raw(raw: u32) -> Self;
    /// The value in the low bytes, sign-extended to 32 bits.
    fn to_raw(self) -> u32;
}

macro_rules! scalar {
    ($($t:ty),*) => {$(
        impl Scalar for $t {
            const BYTES: u8 = size_of::<$t>() as u8;
            fn from_raw(raw: u32) -> Self {
                raw as $t
            }
            fn to_raw(self) -> u32 {
                // Signed types are sign-extended through i64, unsigned types zero-extended.
                i64::from(self) as u32
            }
        }
    )*};
}
scalar!(u8, u16, u32, i8, i16, i32);

/// An entry with its type.
pub struct TypedObject<T> {
    /// Its address.
    pub address: Address,
    /// Its name in the specification.
    pub name: &'static str,
    value: PhantomData<fn() -> T>,
}

impl<T> TypedObject<T> {
    /// The entry `index`:`sub`.
    #[must_use]
    pub const fn new(index: u16, sub: u8, name: &'static str) -> Self {
        Self {
            address: Address::new(index, sub),
            name,
            value: PhantomData,
        }
    }
}

impl<T: Scalar> TypedObject<T> {
    /// The value in an answer's data.
    #[must_use]
    pub fn decode(&self, raw: u32) -> T {
        T::from_raw(raw)
    }

    /// The data of a write.
    #[must_use]
    pub fn encode(&self, value: T) -> u32 {
        value.to_raw()
    }
}

// Derives would require `T: Clone`; `T` is only a marker.
impl<T> Clone for TypedObject<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for TypedObject<T> {}
impl<T> fmt::Debug for TypedObject<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.address, self.name)
    }
}
