//! Encoding of data in SDO messages: up to four bytes in the first message, or segments of up to
//! seven.

use crate::BoundedVec;
use crate::canopen::Scalar;

/// Bit of the first message: the number of bytes is indicated.
const SIZE_INDICATED: u8 = 1 << 0;
/// Bit of the first message: expedited transfer, the message contains the data.
const EXPEDITED: u8 = 1 << 1;
/// Toggle bit of segments, of their requests and of their confirmations.
pub(super) const TOGGLE: u8 = 1 << 4;
/// Bit of a segment: no more segments follow.
const LAST: u8 = 1 << 0;
/// Capacity of a segment on CAN.
pub const SEGMENT_LEN: usize = 7;

/// Data of one to four bytes with its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expedited {
    /// Zero above `len`.
    bytes: [u8; 4],
    len: u8,
}

impl Expedited {
    /// Wraps `data`; `None` unless it has one to four bytes.
    #[must_use]
    pub fn new(data: &[u8]) -> Option<Self> {
        if !(1..=4).contains(&data.len()) {
            return None;
        }
        let mut bytes = [0; 4];
        for (to, from) in bytes.iter_mut().zip(data) {
            *to = *from;
        }
        Some(Self {
            bytes,
            len: data.len() as u8,
        })
    }

    /// `value` in little-endian order, in the width of its type.
    #[must_use]
    pub fn of<T: Scalar>(value: T) -> Self {
        const { assert!(T::BYTES >= 1 && T::BYTES <= 4) };
        let mut bytes = value.to_raw().to_le_bytes();
        for byte in bytes.iter_mut().skip(usize::from(T::BYTES)) {
            *byte = 0;
        }
        Self {
            bytes,
            len: T::BYTES,
        }
    }

    /// The bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.len)).unwrap_or_default()
    }

    /// The bytes as a little-endian number.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        u32::from_le_bytes(self.bytes)
    }
}

/// The data field of an initiate message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initiate {
    /// The complete data.
    Expedited(Expedited),
    /// The complete data without its size: only the object's type says how many of the four bytes
    /// count. The EPOS2 always indicates the size; other nodes may not.
    Unsized([u8; 4]),
    /// The data follows in segments.
    Segmented {
        /// Total bytes, if indicated.
        size: Option<u32>,
    },
}

impl Initiate {
    /// Low bits of the command byte, and the four bytes after the multiplexer.
    pub(super) const fn encode(&self) -> (u8, [u8; 4]) {
        match self {
            Self::Expedited(data) => ((4 - data.len) << 2 | EXPEDITED | SIZE_INDICATED, data.bytes),
            Self::Unsized(bytes) => (EXPEDITED, *bytes),
            Self::Segmented { size: Some(size) } => (SIZE_INDICATED, size.to_le_bytes()),
            Self::Segmented { size: None } => (0, [0; 4]),
        }
    }

    pub(super) fn parse(command: u8, data: [u8; 4]) -> Self {
        match (command & EXPEDITED != 0, command & SIZE_INDICATED != 0) {
            (true, true) => {
                let [first, ..] = data;
                let len = 4 - usize::from(command >> 2 & 3);
                // `len` is 1 to 4, which `new` always accepts.
                let bytes = data.get(..len).and_then(Expedited::new);
                Self::Expedited(bytes.unwrap_or_else(|| Expedited::of(first)))
            }
            (true, false) => Self::Unsized(data),
            (false, true) => Self::Segmented {
                size: Some(u32::from_le_bytes(data)),
            },
            (false, false) => Self::Segmented { size: None },
        }
    }
}

/// One segment of an object on CAN.
pub type SdoSegment = GenericSdoSegment<SEGMENT_LEN>;

/// One segment of an object, of up to `L` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GenericSdoSegment<const L: usize> {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
    /// No more segments follow.
    pub last: bool,
    /// The data.
    pub bytes: BoundedVec<u8, L>,
}

impl<const L: usize> GenericSdoSegment<L> {
    /// The segment of up to `max_len` bytes at `offset` in `data`.
    #[must_use]
    pub fn cut(data: &[u8], offset: usize, toggle: bool, max_len: usize) -> Self {
        let rest = data.get(offset..).unwrap_or_default();
        let len = max_len.min(L);
        let mut bytes = BoundedVec::new();
        bytes.extend(rest.iter().copied().take(len));
        Self {
            toggle,
            last: rest.len() <= len,
            bytes,
        }
    }

    /// The message; both directions use command specifier 0.
    pub(super) fn to_bytes(self) -> [u8; super::LEN] {
        let unused = SEGMENT_LEN.saturating_sub(self.bytes.len()) as u8;
        let mut message = [0; super::LEN];
        for (to, from) in message.iter_mut().skip(1).zip(self.bytes.iter()) {
            *to = *from;
        }
        let [command, ..] = &mut message;
        *command = toggle_bit(self.toggle) | unused << 1 | if self.last { LAST } else { 0 };
        message
    }

    pub(super) fn parse(command: u8, data: [u8; SEGMENT_LEN]) -> Self {
        const { assert!(L >= SEGMENT_LEN) };
        let unused = usize::from(command >> 1 & 7);
        let mut bytes = BoundedVec::new();
        bytes.extend(data.into_iter().take(SEGMENT_LEN - unused));
        Self {
            toggle: command & TOGGLE != 0,
            last: command & LAST != 0,
            bytes,
        }
    }
}

/// The toggle bit at its position.
pub(super) const fn toggle_bit(toggle: bool) -> u8 {
    if toggle { TOGGLE } else { 0 }
}
