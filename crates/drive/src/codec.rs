//! The one place that knows which bytes a transport uses: a request to a frame, bytes to replies.
//!
//! EPOS2 frames on USB, the same messages in the handshake of RS232 ([`rs232`]), and SDO on CAN ([`sdo`]). Timing, pairing and
//! retries are the link's business; what else passes on a CAN bus is [`crate::bus`]'s.

mod rs232;
mod sdo;

use protocol::canopen::{CanFrame, NodeId, SOCKETCAN_LEN};
use protocol::epos2::message::{
    Answer, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, SegmentedRead,
    SegmentedWrite, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{Bounded, CommError, Frame, FrameError};
use protocol::record::DriveLink;
use units::{Host, Stamp};

use crate::pairing::{Access, Asked};
use rs232::Dialogue;

pub(crate) use sdo::{asked as sdo_asked, decode as sdo_decode};

/// An answer, not yet paired.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reply {
    pub error: CommError,
    /// Data words after the error code, on a serial link.
    pub words: usize,
    /// The first two of them as a number; above the object's width it is garbage.
    pub value: Option<u32>,
    /// The data as a segment, where it can be one.
    pub segment: Option<Segment>,
    /// What the answer says it is an answer to, on CAN.
    pub about: Option<About>,
}

/// Part of an object that is read or written in segments; empty where it only confirms one that was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Segment {
    pub toggle: bool,
    pub last: bool,
    pub bytes: Bounded<u8, SEGMENT_BYTES>,
}

/// The longest segment, that of the serial links.
const SEGMENT_BYTES: usize = 63;
/// The longest of a CAN bus.
const SDO_SEGMENT_BYTES: usize = 7;

/// What an SDO answer says of the request it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct About {
    /// Segments name no object.
    pub address: Option<Address>,
    pub kind: Kind,
}

/// Which request an SDO answer is the answer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Upload,
    UploadSegment,
    Download,
    DownloadSegment,
    Abort,
}

impl About {
    /// Whether this can be the answer to a request.
    pub fn fits(&self, asked: &Asked) -> bool {
        let same = self.address.is_none_or(|address| address == asked.address);
        let kind = match asked.access {
            _ if self.kind == Kind::Abort => true,
            Access::Read | Access::Open => self.kind == Kind::Upload,
            Access::Write(_) | Access::OpenWrite { .. } => self.kind == Kind::Download,
            Access::Segment { .. } => self.kind == Kind::UploadSegment,
            Access::WriteSegment(_) => self.kind == Kind::DownloadSegment,
            Access::Other => self.kind == Kind::Download,
        };
        same && kind
    }
}

impl Reply {
    /// Whether this is a value or an error, no announcement of segments.
    pub fn is_value(&self) -> bool {
        self.value.is_some() || !self.error.is_none()
    }
}

/// What a run of bytes turned out to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decoded {
    Reply(Reply),
    /// RS232: a handshake in its place; it says nothing of the answer.
    Step,
    /// RS232: the unit refused the request (`F`); it was not carried out.
    Refused,
    /// A frame of the bus that is no SDO answer of this node.
    Bus(CanFrame),
    /// A good frame that answers nothing, such as an echo.
    Foreign,
    /// No frame, yet nothing that could have been an answer.
    Noise,
    /// Began like an answer and was none.
    Damaged,
}

/// A transport's frames.
#[derive(Clone, Debug)]
pub(crate) struct Codec {
    node: u8,
    transport: Transport,
}

#[derive(Clone, Debug)]
enum Transport {
    Usb(UsbDecoder),
    Rs232(Dialogue),
    Can(NodeId),
}

/// Bytes to write now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outgoing {
    pub bytes: Vec<u8>,
    /// The request is executed no earlier than now.
    pub is_body: bool,
}

impl Codec {
    pub fn new(link: DriveLink, node: u8) -> Self {
        let transport = match link {
            DriveLink::Usb => Transport::Usb(UsbDecoder::new()),
            DriveLink::Rs232 => Transport::Rs232(Dialogue::new()),
            // A configuration with another node is refused before anything is sent.
            DriveLink::Can => Transport::Can(NodeId::new(node).unwrap_or(NodeId::MAX)),
        };
        Self { node, transport }
    }

    #[cfg(test)]
    pub fn usb(node: u8) -> Self {
        Self::new(DriveLink::Usb, node)
    }

    /// The bytes that ask for `access` to an object of so many bytes; on RS232 the first of them.
    pub fn encode(
        &mut self,
        address: Address,
        access: Access,
        width: u8,
        deadline: Stamp<Host>,
    ) -> Vec<u8> {
        let frame = message(self.node, address, access);
        match &mut self.transport {
            Transport::Usb(_) => usb::to_bytes(&frame).as_slice().to_vec(),
            Transport::Rs232(dialogue) => dialogue.begin(&frame, deadline),
            Transport::Can(node) => {
                let request = sdo::request(address, access, width);
                request.to_frame(*node).to_socketcan().to_vec()
            }
        }
    }

    /// The bytes of a request that goes out whatever state the link is in, where that takes more than sending it: on RS232, with its
    /// dialogue. Its answer does not count.
    pub fn shout(&mut self, address: Address, access: Access, now: Stamp<Host>) -> Option<Vec<u8>> {
        let Transport::Rs232(dialogue) = &mut self.transport else {
            return None;
        };
        Some(dialogue.shout(&message(self.node, address, access), now))
    }

    /// Bytes of the longest segment.
    pub fn segment_len(&self) -> usize {
        match self.transport {
            Transport::Usb(_) | Transport::Rs232(_) => SEGMENT_BYTES,
            Transport::Can(_) => SDO_SEGMENT_BYTES,
        }
    }

    /// How many bytes from the device [`Codec::push`] takes at a time.
    pub fn piece(&self) -> usize {
        match self.transport {
            Transport::Usb(_) | Transport::Rs232(_) => 1,
            Transport::Can(_) => SOCKETCAN_LEN,
        }
    }

    /// Takes a byte, or on CAN a frame, from the device; `None` for part of what may become an answer.
    pub fn push(&mut self, piece: &[u8], now: Stamp<Host>) -> Option<Decoded> {
        match &mut self.transport {
            Transport::Can(node) => Some(sdo::received(*node, piece)),
            Transport::Usb(decoder) => decoder.push(*piece.first()?).map(|frame| decoded(&frame)),
            Transport::Rs232(dialogue) => dialogue.push(*piece.first()?, now),
        }
    }

    /// What a dialogue under way has to say next.
    pub fn outgoing(&mut self, now: Stamp<Host>) -> Option<Outgoing> {
        match &mut self.transport {
            Transport::Rs232(dialogue) => dialogue.outgoing(now),
            Transport::Usb(_) | Transport::Can(_) => None,
        }
    }

    /// Whether a request may be sent.
    pub fn is_ready(&self) -> bool {
        match &self.transport {
            Transport::Rs232(dialogue) => dialogue.is_idle(),
            Transport::Usb(_) | Transport::Can(_) => true,
        }
    }

    /// The request under way is given up.
    pub fn give_up(&mut self, now: Stamp<Host>) {
        if let Transport::Rs232(dialogue) = &mut self.transport {
            dialogue.give_up(now);
        }
    }

    /// When [`Codec::expire`] is due.
    pub fn deadline(&self) -> Option<Stamp<Host>> {
        match &self.transport {
            Transport::Rs232(dialogue) => dialogue.deadline(),
            Transport::Usb(_) | Transport::Can(_) => None,
        }
    }

    /// Lets time pass.
    pub fn expire(&mut self, now: Stamp<Host>) {
        if let Transport::Rs232(dialogue) = &mut self.transport {
            dialogue.expire(now);
        }
    }
}

/// The message of the serial links.
fn message(node: u8, address: Address, access: Access) -> Frame {
    match access {
        Access::Write(value) => WriteObject {
            node,
            address,
            value,
        }
        .to_frame(),
        Access::Open => InitiateSegmentedRead { node, address }.to_frame(),
        Access::OpenWrite { len } => InitiateSegmentedWrite { node, address, len }.to_frame(),
        Access::WriteSegment(Segment { toggle, bytes, .. }) => {
            SegmentedWrite(WriteSegment { toggle, bytes }).to_frame()
        }
        Access::Segment { toggle } => SegmentedRead { toggle }.to_frame(),
        Access::Read | Access::Other => ReadObject { node, address }.to_frame(),
    }
}

fn decoded(frame: &Result<Frame, FrameError>) -> Decoded {
    let Ok(frame) = frame else {
        return Decoded::Damaged;
    };
    match Reply::parse(frame) {
        Ok(reply) => Decoded::Reply(reply),
        Err(FrameError::Opcode { .. }) => Decoded::Foreign,
        Err(_) => Decoded::Damaged,
    }
}

impl Reply {
    /// The answer in a frame of a serial link.
    pub fn parse(frame: &Frame) -> Result<Self, FrameError> {
        let answer = Answer::parse(frame)?;
        let words = answer.data.as_slice().len();
        let segment = SegmentedRead::parse_answer(frame).ok().and_then(Result::ok);
        Ok(Self {
            error: answer.error,
            words,
            value: answer.value().ok().filter(|_| words == VALUE_WORDS),
            segment: segment.map(|segment| Segment {
                toggle: segment.toggle,
                last: !segment.more,
                bytes: segment.bytes,
            }),
            about: None,
        })
    }
}

/// Data words in the answer to ReadObject.
const VALUE_WORDS: usize = 2;

#[cfg(test)]
mod tests;
