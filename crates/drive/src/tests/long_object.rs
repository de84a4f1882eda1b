//! An object that is longer than any of the simulated EPOS2, writable, and with faulty segments on
//! request: it replaces the name (1008) of a drive.

use protocol::epos2::message::{
    InitiateSegmentedWrite, ReadSegment, SegmentedRead, SegmentedWrite, SerialAnswer,
    SerialRequest, WriteSegment,
};
use protocol::epos2::{AbortCode, BoundedVec, SerialFrame};

/// The longest value that can be written.
const LONGEST: usize = 20;

pub struct LongObject {
    pub bytes: Vec<u8>,
    /// Bytes read so far.
    sent: usize,
    /// Bytes written so far, and the total length.
    writing: Option<(Vec<u8>, usize)>,
    /// Segments have the wrong toggle bit.
    pub wrong_toggle: bool,
    /// A complete value is refused.
    pub refuses: bool,
    /// Bytes of a segment to the host and of one from it.
    segment: (usize, usize),
}

impl LongObject {
    pub fn new(on_can: bool) -> Self {
        Self {
            bytes: b"EPOS2".to_vec(),
            sent: 0,
            writing: None,
            wrong_toggle: false,
            refuses: false,
            segment: if on_can { (7, 7) } else { (3, 63) },
        }
    }

    /// The answer to a request about this object.
    pub fn answer(&mut self, request: &SerialRequest) -> Option<SerialFrame> {
        match request {
            SerialRequest::InitiateSegmentedRead(open) if open.address.index == 0x1008 => {
                self.sent = 0;
                Some(SerialAnswer::bare(AbortCode::NONE).to_frame())
            }
            SerialRequest::SegmentedRead(SegmentedRead { toggle }) => {
                Some(SegmentedRead::answer(&Ok(self.next_segment(*toggle))))
            }
            SerialRequest::InitiateSegmentedWrite(open) if open.address.index == 0x1008 => {
                Some(SerialAnswer::bare(self.open(open)).to_frame())
            }
            SerialRequest::SegmentedWrite(SegmentedWrite(segment)) => {
                Some(SegmentedWrite::answer(self.write(segment)))
            }
            _ => None,
        }
    }

    fn next_segment(&mut self, toggle: bool) -> ReadSegment {
        let mut bytes = BoundedVec::new();
        bytes.extend(self.bytes[self.sent..].iter().copied().take(self.segment.0));
        self.sent += bytes.len();
        ReadSegment {
            toggle: toggle != self.wrong_toggle,
            more: self.sent < self.bytes.len(),
            bytes,
        }
    }

    fn open(&mut self, open: &InitiateSegmentedWrite) -> AbortCode {
        self.writing = None;
        let len = open.len as usize;
        if len > LONGEST {
            return AbortCode::TOO_LONG;
        }
        self.writing = Some((Vec::new(), len));
        AbortCode::NONE
    }

    fn write(&mut self, segment: &WriteSegment) -> Result<bool, AbortCode> {
        let (mut bytes, len) = self.writing.take().ok_or(AbortCode::COMMAND)?;
        // Earlier segments are complete, which determines the toggle bit.
        if segment.toggle != ((bytes.len() / self.segment.1) % 2 == 1) {
            return Err(AbortCode::TOGGLE);
        }
        bytes.extend_from_slice(&segment.bytes);
        if bytes.len() < len {
            self.writing = Some((bytes, len));
        } else if self.refuses {
            return Err(AbortCode::STATE);
        } else {
            self.bytes = bytes;
        }
        Ok(segment.toggle != self.wrong_toggle)
    }
}
