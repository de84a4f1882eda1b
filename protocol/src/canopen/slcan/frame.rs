//! A CAN frame as a line: `tiiilDD..` with an 11-bit identifier, `TiiiiiiiilDD..` with a 29-bit
//! identifier; remote frames have `r` or `R` and no data.

use super::error::SlcanError;
use super::line::{length, number, write_number};
use crate::canopen::cob_id::CobId;
use crate::canopen::frame::{CanFrame, CanId, ExtendedId};

/// Digits of a time stamp after a frame.
const STAMP_DIGITS: usize = 4;

/// Writes the line of `frame`, without its CR.
pub(super) fn write_frame(frame: &CanFrame, out: &mut impl Extend<u8>) {
    let (letter, digits) = match (frame.id(), frame.is_remote()) {
        (CanId::Standard(_), false) => (b't', 3),
        (CanId::Extended(_), false) => (b'T', 8),
        (CanId::Standard(_), true) => (b'r', 3),
        (CanId::Extended(_), true) => (b'R', 8),
    };
    out.extend([letter]);
    write_number(frame.id().raw(), digits, out);
    write_number(u32::from(frame.dlc()), 1, out);
    for byte in frame.data() {
        write_number(u32::from(*byte), 2, out);
    }
}

/// The frame of a line that begins with `t`, `T`, `r` or `R`, and its time stamp: milliseconds
/// within a minute.
pub(super) fn parse_frame(line: &[u8]) -> Result<(CanFrame, Option<u16>), SlcanError> {
    let extended = matches!(line.first(), Some(b'T' | b'R'));
    let remote = matches!(line.first(), Some(b'r' | b'R'));
    let digits = if extended { 8 } else { 3 };
    let id = parse_id(number(line, 1, digits)?, extended)?;
    let at_len = 1 + digits;
    let too_long = |_| SlcanError::Character {
        offset: at_len,
        expected: "0 to 8",
        got: line.get(at_len).copied().unwrap_or_default(),
    };
    let len = number(line, at_len, 1)? as usize;
    let at_data = at_len + 1;
    let mut data = [0; 16];
    let data = data.get_mut(..len).unwrap_or_default();
    let frame = if remote {
        CanFrame::remote(id, len as u8).map_err(too_long)?
    } else {
        for (at, byte) in (at_data..).step_by(2).zip(data.iter_mut()) {
            *byte = number(line, at, 2)? as u8;
        }
        CanFrame::new(id, data).map_err(too_long)?
    };
    let end = at_data + 2 * frame.data().len();
    if line.len() == end {
        return Ok((frame, None));
    }
    length(line, end + STAMP_DIGITS)?;
    Ok((frame, Some(number(line, end, STAMP_DIGITS)? as u16)))
}

fn parse_id(got: u32, extended: bool) -> Result<CanId, SlcanError> {
    let (id, max) = if extended {
        let id = ExtendedId::new(got).map(CanId::Extended);
        (id, ExtendedId::MAX.get())
    } else {
        let id = u16::try_from(got).ok().and_then(CobId::new);
        (id.map(CanId::Standard), u32::from(CobId::MAX.get()))
    };
    id.ok_or(SlcanError::Id { max, got })
}
