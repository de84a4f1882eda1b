//! The content of a PDO: its mapping entries (160x, 1A0x), and the packing of values by them.
//!
//! Values are adjacent, low byte first, and low bit first where their length is not in whole bytes.

use core::fmt;

use thiserror::Error;

use crate::BoundedVec;
use crate::canopen::object::{Address, Scalar, TypedObject};

/// Largest number of entries of an EPOS2 mapping.
pub const MAX_ENTRIES: usize = 8;
/// Bits in a frame.
const MAX_BITS: usize = 64;

/// A mapped object.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct MappedObject {
    /// The object.
    pub address: Address,
    /// Its length in bits.
    pub bits: u8,
}

impl MappedObject {
    /// The entry of a whole object.
    #[must_use]
    pub const fn of<T: Scalar>(object: TypedObject<T>) -> Self {
        Self {
            address: object.address,
            bits: 8 * T::BYTES,
        }
    }

    /// The value of the entry: index, subindex, length, from the highest byte to the lowest.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        (self.address.index as u32) << 16 | (self.address.sub as u32) << 8 | self.bits as u32
    }

    /// The entry of a value.
    #[must_use]
    pub const fn from_u32(value: u32) -> Self {
        let [high, low, sub, bits] = value.to_be_bytes();
        Self {
            address: Address::new(u16::from_be_bytes([high, low]), sub),
            bits,
        }
    }
}

/// Writes the entry as in the object: `60640020`.
impl fmt::Debug for MappedObject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08X}", self.to_u32())
    }
}

/// Reason why entries do not form a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum LayoutError {
    /// More entries than a mapping holds.
    #[error("PDO mapping: {got} entries, expected at most {max}")]
    TooMany {
        /// [`MAX_ENTRIES`].
        max: usize,
        /// Entries given.
        got: usize,
    },
    /// More bits than a frame holds.
    #[error("PDO mapping: {got} bits, expected at most {max}")]
    TooLong {
        /// 64.
        max: usize,
        /// Bits of all entries.
        got: usize,
    },
    /// An entry without a bit.
    #[error("PDO mapping: entry {entry} has no bits, expected 1 to 64")]
    Empty {
        /// Number of the entry, from 1 like its subindex.
        entry: usize,
    },
}

/// Reason why data does not match a mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum PdoError {
    /// Fewer bytes than mapped; a node reports error 8210.
    #[error("PDO: {got} data bytes, expected {expected}")]
    Short {
        /// Bytes mapped.
        expected: usize,
        /// Bytes given.
        got: usize,
    },
    /// The number of values differs from the number of entries.
    #[error("PDO: {got} values, expected {expected}")]
    Values {
        /// Entries.
        expected: usize,
        /// Values given.
        got: usize,
    },
}

/// Mapping entries that fit a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PdoLayout {
    entries: BoundedVec<MappedObject, MAX_ENTRIES>,
}

impl PdoLayout {
    /// The layout of `entries`.
    ///
    /// # Errors
    /// [`LayoutError`].
    pub fn new(entries: &[MappedObject]) -> Result<Self, LayoutError> {
        let layout = Self {
            entries: BoundedVec::from_slice(entries).map_err(|full| LayoutError::TooMany {
                max: full.capacity,
                got: entries.len(),
            })?,
        };
        if let Some(empty) = entries.iter().position(|entry| entry.bits == 0) {
            return Err(LayoutError::Empty { entry: empty + 1 });
        }
        match layout.bits() {
            got if got > MAX_BITS => Err(LayoutError::TooLong { max: MAX_BITS, got }),
            _ => Ok(layout),
        }
    }

    /// The entries in their order.
    #[must_use]
    pub fn entries(&self) -> &[MappedObject] {
        &self.entries
    }

    /// Bits of all entries, at most 64.
    #[must_use]
    pub fn bits(&self) -> usize {
        self.entries
            .iter()
            .map(|entry| usize::from(entry.bits))
            .sum()
    }

    /// Data bytes of the frame.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bits().div_ceil(8)
    }

    /// Whether nothing is mapped.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The data of a frame, from the low bits of each value.
    ///
    /// # Errors
    /// [`PdoError::Values`] unless there is one value per entry.
    pub fn pack(&self, values: &[u64]) -> Result<BoundedVec<u8, 8>, PdoError> {
        if values.len() != self.entries.len() {
            return Err(PdoError::Values {
                expected: self.entries.len(),
                got: values.len(),
            });
        }
        let packed = self
            .places()
            .zip(values)
            .fold(0, |all, ((_, shift, mask), value)| {
                all | (value & mask) << shift
            });
        let mut data = BoundedVec::new();
        data.extend(packed.to_le_bytes().into_iter().take(self.len()));
        Ok(data)
    }

    /// The values in the data of a frame, in the order of the entries, zero-extended; surplus bytes
    /// are ignored (CiA 301).
    ///
    /// # Errors
    /// [`PdoError::Short`].
    pub fn unpack(&self, data: &[u8]) -> Result<BoundedVec<u64, MAX_ENTRIES>, PdoError> {
        let packed = self.word(data)?;
        let mut values = BoundedVec::new();
        values.extend(self.places().map(|(_, shift, mask)| packed >> shift & mask));
        Ok(values)
    }

    /// The value of `object` in the data of a frame; `None` where it is not mapped in its whole
    /// length.
    ///
    /// # Errors
    /// [`PdoError::Short`].
    pub fn get<T: Scalar>(
        &self,
        object: TypedObject<T>,
        data: &[u8],
    ) -> Result<Option<T>, PdoError> {
        let packed = self.word(data)?;
        let wanted = MappedObject::of(object);
        let place = self.places().find(|(entry, ..)| *entry == wanted);
        Ok(place.map(|(_, shift, mask)| object.decode((packed >> shift & mask) as u32)))
    }

    /// The mapped bytes as one number.
    fn word(&self, data: &[u8]) -> Result<u64, PdoError> {
        let mapped = data.get(..self.len()).ok_or(PdoError::Short {
            expected: self.len(),
            got: data.len(),
        })?;
        let bytes = mapped.iter().rev();
        Ok(bytes.fold(0, |all, byte| all << 8 | u64::from(*byte)))
    }

    /// Each entry with its first bit (0 to 63) and the mask of its length.
    fn places(&self) -> impl Iterator<Item = (MappedObject, u32, u64)> + '_ {
        self.entries.iter().scan(0, |next, entry| {
            let shift = *next;
            *next += u32::from(entry.bits);
            let unused = u64::BITS.saturating_sub(u32::from(entry.bits));
            Some((*entry, shift, u64::MAX >> unused))
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::canopen::tests::{MODE_DISPLAY, POSITION_ACTUAL, STATUSWORD, TIMESTAMP};
    use proptest::prelude::*;

    fn entry(bits: u8) -> MappedObject {
        MappedObject {
            address: Address::new(0x2000, bits),
            bits,
        }
    }

    /// Position and time stamp of the tilt axis in one frame.
    #[test]
    fn the_angle_stream_layout_matches_its_bytes() {
        let entries = [
            MappedObject::of(POSITION_ACTUAL),
            MappedObject::of(TIMESTAMP),
        ];
        assert_eq!(
            entries.map(MappedObject::to_u32),
            [0x6064_0020, 0x1013_0020]
        );
        let layout = PdoLayout::new(&entries).unwrap();
        let data = [0xD0, 0x8A, 0xFF, 0xFF, 0x78, 0x56, 0x34, 0x12];
        assert_eq!(layout.get(POSITION_ACTUAL, &data), Ok(Some(-30_000)));
        assert_eq!(layout.get(TIMESTAMP, &data), Ok(Some(0x1234_5678)));
        assert_eq!(layout.get(STATUSWORD, &data), Ok(None));
        let packed = layout.pack(&[-30_000_i32 as u32 as u64, 0x1234_5678]);
        assert_eq!(packed.unwrap().as_slice(), data);
        let short = PdoError::Short {
            expected: 8,
            got: 7,
        };
        assert_eq!(layout.unpack(&data[..7]), Err(short));
        assert_eq!(layout.get(TIMESTAMP, &data[..7]), Err(short));
    }

    /// TPDO1 of a real drive (1A00): an analogue value, statusword, mode.
    #[test]
    fn values_are_packed_without_gaps() {
        let entries = [0x20C4_0110, 0x6041_0010, 0x6061_0008].map(MappedObject::from_u32);
        let layout = PdoLayout::new(&entries).unwrap();
        assert_eq!((layout.bits(), layout.len()), (40, 5));
        // Surplus bytes are ignored.
        let data = [0x11, 0x22, 0x37, 0x03, 0xFF, 0xEE];
        assert_eq!(
            layout.unpack(&data).unwrap().as_slice(),
            [0x2211, 0x0337, 0xFF]
        );
        assert_eq!(layout.get(MODE_DISPLAY, &data), Ok(Some(-1)));
        assert_eq!(
            layout.pack(&[1]),
            Err(PdoError::Values {
                expected: 3,
                got: 1
            })
        );
    }

    #[test]
    fn lengths_need_not_be_whole_bytes() {
        let layout = PdoLayout::new(&[entry(1), entry(12), entry(3)]).unwrap();
        let packed = layout.pack(&[1, 0xABC, 0b101]).unwrap();
        assert_eq!(
            u16::from_le_bytes([packed[0], packed[1]]),
            0b101 << 13 | 0xABC << 1 | 1
        );
        assert_eq!(
            layout.unpack(&packed).unwrap().as_slice(),
            [1, 0xABC, 0b101]
        );
    }

    #[test]
    fn layouts_that_exceed_a_frame_are_refused() {
        assert_eq!(
            PdoLayout::new(&[entry(32), entry(33)]),
            Err(LayoutError::TooLong { max: 64, got: 65 })
        );
        assert_eq!(
            PdoLayout::new(&[entry(1); 9]),
            Err(LayoutError::TooMany { max: 8, got: 9 })
        );
        assert_eq!(
            PdoLayout::new(&[entry(1), entry(0)]),
            Err(LayoutError::Empty { entry: 2 })
        );
        assert_eq!(
            PdoLayout::new(&[entry(255); 8]),
            Err(LayoutError::TooLong { max: 64, got: 2040 })
        );
        assert!(PdoLayout::new(&[entry(64)]).is_ok());
        assert_eq!(PdoLayout::default().pack(&[]).unwrap().as_slice(), []);
    }

    proptest! {
        #[test]
        fn values_round_trip(parts in prop::collection::vec((1_u8..=64, any::<u64>()), 0..8)) {
            let mut bits = 0;
            let parts: std::vec::Vec<_> = parts
                .into_iter()
                .take_while(|(more, _)| { bits += usize::from(*more); bits <= 64 })
                .collect();
            let entries: std::vec::Vec<_> = parts.iter().map(|(bits, _)| entry(*bits)).collect();
            let values: std::vec::Vec<_> = parts.iter().map(|(bits, value)| value & (u64::MAX >> (64 - bits))).collect();
            let layout = PdoLayout::new(&entries).unwrap();
            let data = layout.pack(&values).unwrap();
            prop_assert_eq!(data.len(), layout.len());
            let unpacked = layout.unpack(&data).unwrap();
            prop_assert_eq!(unpacked.as_slice(), values);
        }

        #[test]
        fn entries_round_trip(value in any::<u32>()) {
            prop_assert_eq!(MappedObject::from_u32(value).to_u32(), value);
        }
    }
}
