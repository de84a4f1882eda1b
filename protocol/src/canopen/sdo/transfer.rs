//! How data travels in SDO messages: up to four bytes in the first message, or in segments of up to seven.

use crate::epos2::Bounded;
use crate::epos2::objects::Scalar;

/// Bit of the first message: the data, or its size, is said to be so long.
const SIZE_INDICATED: u8 = 1 << 0;
/// Bit of the first message: the data is in it.
const EXPEDITED: u8 = 1 << 1;
/// Toggle bit of segments and of what asks for or confirms them.
pub(super) const TOGGLE: u8 = 1 << 4;
/// Bit of a segment: no more segments follow.
const LAST: u8 = 1 << 0;
/// The most bytes in a segment.
const SEGMENT_LEN: usize = 7;

/// One to four bytes, whose number the message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expedited {
    /// Zero beyond `len`.
    bytes: [u8; 4],
    len: u8,
}

impl Expedited {
    /// `data`; `None` unless it has one to four bytes.
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

    /// `value`, low byte first, as long as its type.
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

    /// The bytes as a number, low byte first.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        u32::from_le_bytes(self.bytes)
    }
}

/// How a transfer begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initiate {
    /// All data is here.
    Expedited(Expedited),
    /// All data is here; how many of the four bytes count is known only from the object's type. The EPOS2 always says
    /// it, other nodes may not.
    Unsized([u8; 4]),
    /// The data follows in segments.
    Segmented {
        /// Bytes to come, if said.
        size: Option<u32>,
    },
}

impl Initiate {
    /// Low bits of the command byte, and the four bytes behind the object.
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
                // One to four bytes: `new` takes them all.
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

/// A piece of longer data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Alternates from segment to segment, beginning with `false`.
    pub toggle: bool,
    /// No more segments follow.
    pub last: bool,
    /// Its bytes.
    pub bytes: Bounded<u8, SEGMENT_LEN>,
}

impl Segment {
    /// The segment that begins at byte `offset` of `data`: up to seven bytes, the last if no byte is left behind them.
    #[must_use]
    pub fn cut(data: &[u8], offset: usize, toggle: bool) -> Self {
        let rest = data.get(offset..).unwrap_or_default();
        let mut bytes = Bounded::new();
        bytes.extend(rest.iter().copied().take(SEGMENT_LEN));
        Self {
            toggle,
            last: rest.len() <= SEGMENT_LEN,
            bytes,
        }
    }

    /// The message; both directions have command specifier 0 for it.
    pub(super) fn to_bytes(self) -> [u8; super::LEN] {
        let unused = (SEGMENT_LEN - self.bytes.len()) as u8;
        let mut message = [0; super::LEN];
        for (to, from) in message.iter_mut().skip(1).zip(self.bytes.iter()) {
            *to = *from;
        }
        let [command, ..] = &mut message;
        *command = toggle_bit(self.toggle) | unused << 1 | if self.last { LAST } else { 0 };
        message
    }

    pub(super) fn parse(command: u8, data: [u8; SEGMENT_LEN]) -> Self {
        let unused = usize::from(command >> 1 & 7);
        let mut bytes = Bounded::new();
        bytes.extend(data.into_iter().take(SEGMENT_LEN - unused));
        Self {
            toggle: command & TOGGLE != 0,
            last: command & LAST != 0,
            bytes,
        }
    }
}

/// The toggle bit in its place.
pub(super) const fn toggle_bit(toggle: bool) -> u8 {
    if toggle { TOGGLE } else { 0 }
}
