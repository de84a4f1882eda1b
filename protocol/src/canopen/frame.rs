//! A classic CAN frame, and its form in a log: the 16 bytes of SocketCAN's `struct can_frame` with
//! a big-endian identifier (LINKTYPE_CAN_SOCKETCAN). CAN FD and error reports of the controller are
//! rejected.
//!
//! The traits of `embedded-can` are not implemented: they add conversions that nothing here uses.

use core::fmt;

use super::cob_id::CobId;
use super::error::CanFrameError;

/// Bytes of a `struct can_frame`: identifier and flags, length, three reserved, eight of data.
pub const SOCKETCAN_LEN: usize = 16;
/// Offset of the data in it.
const DATA_OFFSET: usize = 8;
/// The most data bytes in a classic frame.
const MAX_DATA: usize = 8;
/// Flags of the identifier word.
const EXTENDED: u32 = 1 << 31;
const REMOTE: u32 = 1 << 30;
const REPORT: u32 = 1 << 29;
/// Flag of byte 5: the frame is CAN FD.
const FD: u8 = 0x04;

/// A 29-bit identifier, which CANopen does not use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExtendedId(u32);

impl ExtendedId {
    /// The highest identifier.
    pub const MAX: Self = Self(0x1FFF_FFFF);

    /// The identifier `id`; `None` above 29 bits.
    #[must_use]
    pub const fn new(id: u32) -> Option<Self> {
        if id <= Self::MAX.0 {
            Some(Self(id))
        } else {
            None
        }
    }

    /// The low 29 bits of `word`.
    pub(super) const fn masked(word: u32) -> Self {
        Self(word & Self::MAX.0)
    }

    /// The number.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }
}

/// The identifier of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CanId {
    /// 11 bits.
    Standard(CobId),
    /// 29 bits.
    Extended(ExtendedId),
}

impl CanId {
    /// The number, without its width.
    #[must_use]
    pub const fn raw(self) -> u32 {
        match self {
            Self::Standard(id) => id.get() as u32,
            Self::Extended(id) => id.get(),
        }
    }
}

impl From<CobId> for CanId {
    fn from(id: CobId) -> Self {
        Self::Standard(id)
    }
}

impl From<ExtendedId> for CanId {
    fn from(id: ExtendedId) -> Self {
        Self::Extended(id)
    }
}

impl fmt::Display for CanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard(id) => id.fmt(f),
            Self::Extended(id) => write!(f, "{:08X}", id.get()),
        }
    }
}

/// A classic CAN frame: up to eight bytes, or a request for them (remote frame).
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct CanFrame {
    id: CanId,
    remote: bool,
    len: u8,
    /// Zero after `len`, and in a remote frame.
    data: [u8; MAX_DATA],
}

impl CanFrame {
    /// A data frame.
    ///
    /// # Errors
    /// [`CanFrameError::TooLong`] above eight bytes.
    pub fn new(id: impl Into<CanId>, data: &[u8]) -> Result<Self, CanFrameError> {
        let mut frame = Self::empty(id.into(), false, data.len())?;
        copy(data, &mut frame.data);
        Ok(frame)
    }

    /// A data frame of a fixed number of bytes.
    pub fn of<const N: usize>(id: impl Into<CanId>, data: [u8; N]) -> Self {
        const { assert!(N <= MAX_DATA) };
        let mut frame = Self {
            id: id.into(),
            remote: false,
            len: N as u8,
            data: [0; MAX_DATA],
        };
        copy(&data, &mut frame.data);
        frame
    }

    /// A remote frame that requests `len` bytes.
    ///
    /// # Errors
    /// [`CanFrameError::TooLong`] above eight.
    pub fn remote(id: impl Into<CanId>, len: u8) -> Result<Self, CanFrameError> {
        Self::empty(id.into(), true, usize::from(len))
    }

    fn empty(id: CanId, remote: bool, len: usize) -> Result<Self, CanFrameError> {
        if len > MAX_DATA {
            return Err(CanFrameError::TooLong {
                offset: 4,
                max: MAX_DATA,
                got: len,
            });
        }
        Ok(Self {
            id,
            remote,
            len: len as u8,
            data: [0; MAX_DATA],
        })
    }

    /// The identifier.
    #[must_use]
    pub const fn id(&self) -> CanId {
        self.id
    }

    /// The identifier, if it has 11 bits.
    #[must_use]
    pub const fn cob_id(&self) -> Option<CobId> {
        match self.id {
            CanId::Standard(id) => Some(id),
            CanId::Extended(_) => None,
        }
    }

    /// The data; empty for a remote frame.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        let len = if self.remote { 0 } else { self.len };
        self.data.get(..usize::from(len)).unwrap_or_default()
    }

    /// Number of data bytes, or of bytes that a remote frame requests: 0 to 8.
    #[must_use]
    pub const fn dlc(&self) -> u8 {
        self.len
    }

    /// Whether it is a remote frame.
    #[must_use]
    pub const fn is_remote(&self) -> bool {
        self.remote
    }

    /// The frame as in a log.
    #[must_use]
    pub fn to_socketcan(&self) -> [u8; SOCKETCAN_LEN] {
        let extended = match self.id {
            CanId::Standard(_) => 0,
            CanId::Extended(_) => EXTENDED,
        };
        let remote = if self.remote { REMOTE } else { 0 };
        let [a, b, c, d] = (self.id.raw() | extended | remote).to_be_bytes();
        let [e, f, g, h, i, j, k, l] = self.data;
        [a, b, c, d, self.len, 0, 0, 0, e, f, g, h, i, j, k, l]
    }

    /// The frame in a log's record. Bytes after its data are optional and ignored.
    ///
    /// # Errors
    /// [`CanFrameError`]: incomplete, longer than a classic frame, an invalid identifier, CAN FD,
    /// an error report.
    pub fn from_socketcan(bytes: &[u8]) -> Result<Self, CanFrameError> {
        let Some((&[a, b, c, d, len, flags, _, _], rest)) =
            bytes.split_first_chunk::<DATA_OFFSET>()
        else {
            return Err(CanFrameError::Short {
                expected: DATA_OFFSET,
                got: bytes.len(),
            });
        };
        let word = u32::from_be_bytes([a, b, c, d]);
        if word & REPORT != 0 {
            return Err(CanFrameError::Report { got: word });
        }
        if flags & FD != 0 {
            return Err(CanFrameError::Fd {
                offset: 5,
                got: flags,
            });
        }
        let mut frame = Self::empty(parse_id(word)?, word & REMOTE != 0, usize::from(len))?;
        if !frame.remote {
            let data = rest.get(..usize::from(len)).ok_or(CanFrameError::Short {
                expected: DATA_OFFSET + usize::from(len),
                got: bytes.len(),
            })?;
            copy(data, &mut frame.data);
        }
        Ok(frame)
    }
}

fn parse_id(word: u32) -> Result<CanId, CanFrameError> {
    if word & EXTENDED != 0 {
        return Ok(CanId::Extended(ExtendedId::masked(word)));
    }
    let id = word & !REMOTE;
    u16::try_from(id)
        .ok()
        .and_then(CobId::new)
        .map(CanId::Standard)
        .ok_or(CanFrameError::Id { got: word })
}

fn copy(from: &[u8], to: &mut [u8; MAX_DATA]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// In the notation of candump: `601#4041600000000000`, `701#R1`.
impl fmt::Display for CanFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}#", self.id)?;
        if self.remote {
            return write!(f, "R{}", self.len);
        }
        self.data()
            .iter()
            .try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}

impl fmt::Debug for CanFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use proptest::prelude::*;
    use std::string::ToString as _;

    fn id(id: u16) -> CobId {
        CobId::new(id).unwrap()
    }

    #[test]
    fn logged_frames_have_a_big_endian_identifier() {
        let frame = CanFrame::of(id(0x601), [0x40, 0x41, 0x60, 0, 0, 0, 0, 0]);
        let bytes = [0, 0, 6, 1, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0];
        assert_eq!(frame.to_socketcan(), bytes);
        assert_eq!(CanFrame::from_socketcan(&bytes), Ok(frame));
        assert_eq!(frame.to_string(), "601#4041600000000000");
    }

    #[test]
    fn extended_and_remote_frames_keep_their_flags() {
        let extended = CanFrame::of(ExtendedId::new(0x123).unwrap(), [1]);
        assert_eq!(extended.to_socketcan()[..5], [0x80, 0, 1, 0x23, 1]);
        assert_eq!(extended.cob_id(), None);
        assert_ne!(extended, CanFrame::of(id(0x123), [1]));
        assert_eq!(extended.to_string(), "00000123#01");
        let remote = CanFrame::remote(id(0x701), 1).unwrap();
        assert_eq!(remote.to_socketcan()[..5], [0x40, 0, 7, 1, 1]);
        assert_eq!(remote.to_string(), "701#R1");
        assert!(remote.data().is_empty());
        for frame in [extended, remote] {
            assert_eq!(CanFrame::from_socketcan(&frame.to_socketcan()), Ok(frame));
        }
        // A recorder may omit the requested bytes, or leave garbage in them.
        assert_eq!(
            CanFrame::from_socketcan(&[0x40, 0, 7, 1, 1, 0, 0, 0]),
            Ok(remote)
        );
        assert_eq!(
            CanFrame::from_socketcan(&[0x40, 0, 7, 1, 1, 0, 0, 0, 0xAA]),
            Ok(remote)
        );
    }

    #[test]
    fn frames_other_than_classic_can_are_refused() {
        let mut bytes = CanFrame::of(id(1), [1, 2, 3]).to_socketcan();
        bytes[4] = 9;
        let too_long = CanFrameError::TooLong {
            offset: 4,
            max: 8,
            got: 9,
        };
        assert_eq!(CanFrame::from_socketcan(&bytes), Err(too_long));
        assert_eq!(CanFrame::new(id(1), &[0; 9]), Err(too_long));
        assert_eq!(CanFrame::remote(id(1), 9), Err(too_long));
        bytes[4] = 3;
        for (len, expected) in [(7, 8), (8, 11), (10, 11)] {
            let short = CanFrameError::Short { expected, got: len };
            assert_eq!(CanFrame::from_socketcan(&bytes[..len]), Err(short));
        }
        bytes[0] = 0x20;
        assert_eq!(
            CanFrame::from_socketcan(&bytes),
            Err(CanFrameError::Report { got: 0x2000_0001 })
        );
        bytes[0] = 0x01;
        assert_eq!(
            CanFrame::from_socketcan(&bytes),
            Err(CanFrameError::Id { got: 0x0100_0001 })
        );
        bytes[0] = 0;
        bytes[5] = 0x04;
        assert_eq!(
            CanFrame::from_socketcan(&bytes),
            Err(CanFrameError::Fd { offset: 5, got: 4 })
        );
    }

    proptest! {
        #[test]
        fn logged_frames_round_trip(frame in crate::canopen::tests::any_frame()) {
            prop_assert_eq!(CanFrame::from_socketcan(&frame.to_socketcan()), Ok(frame));
            prop_assert!(frame.is_remote() || frame.data().len() == usize::from(frame.dlc()));
        }

        #[test]
        fn arbitrary_bytes_are_a_frame_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..24)) {
            if let Ok(frame) = CanFrame::from_socketcan(&bytes) {
                prop_assert_eq!(CanFrame::from_socketcan(&frame.to_socketcan()), Ok(frame));
            }
        }
    }
}
