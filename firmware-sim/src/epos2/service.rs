//! Carries out the commands of the serial interfaces on a node; framing is the servers' business.
//!
//! Words of an answer that a command does not use are garbage, as on a real unit, and an error is answered in two words or in four.

use protocol::epos2::message::{
    Answer, InitiateSegmentedRead, InitiateSegmentedWrite, Nmt, ReadObject, ReadSegment, Request,
    RequestCanFrame, SegmentedRead, SegmentedWrite, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError, Frame};

use super::Abort;
use super::junk::Junk;
use super::node::Node;
use super::value::Value;

/// A serial interface's state between commands.
#[derive(Clone, Debug)]
pub(super) struct Service {
    junk: Junk,
    upload: Option<Upload>,
    download: Option<Download>,
}

/// A segmented read under way. No value here is longer than a segment.
#[derive(Clone, Copy, Debug)]
struct Upload {
    value: Value,
}

/// A segmented write under way.
#[derive(Clone, Copy, Debug)]
struct Download {
    address: Address,
    len: u32,
    toggle: bool,
    /// Numbers have at most four bytes.
    bytes: Bounded<u8, 4>,
}

impl Service {
    pub const fn new(seed: u64) -> Self {
        Self {
            junk: Junk::new(seed),
            upload: None,
            download: None,
        }
    }

    /// Executes a request and returns its answer.
    pub fn execute(&mut self, node: &mut Node, frame: &Frame) -> Frame {
        let request = match Request::parse(frame) {
            Ok(Some(request)) => request,
            Ok(None) => return self.refuse(CommError::ILLEGAL_COMMAND),
            // The guide names no code for a known command of a wrong length.
            Err(_) => return self.refuse(CommError::LENGTH),
        };
        match request {
            Request::ReadObject(it) => self.read(node, it),
            Request::WriteObject(it) => {
                let outcome = local(node, it.node).and_then(|()| node.write(it.address, it.value));
                WriteObject::answer(outcome)
            }
            Request::InitiateSegmentedRead(it) => self.begin_read(node, it),
            Request::SegmentedRead(it) => self.read_segment(it),
            Request::InitiateSegmentedWrite(it) => self.begin_write(node, it),
            Request::SegmentedWrite(SegmentedWrite(segment)) => self.write_segment(node, &segment),
            Request::Nmt(it) => nmt(node, it),
            // Nothing is on the bus: what is sent is lost, what is asked for never comes.
            Request::SendCanFrame(_) => Answer::bare(CommError::NONE).to_frame(),
            Request::RequestCanFrame(_) => RequestCanFrame::answer(Err(CommError::TIMEOUT)),
        }
    }

    /// The answer to a request that is not carried out, two words or four.
    pub fn refuse(&mut self, error: CommError) -> Frame {
        let mut answer = Answer::bare(error);
        let junk = self.junk.next();
        if junk & 1 != 0 {
            answer
                .data
                .extend([(junk >> 16) as u16, (junk >> 32) as u16]);
        }
        answer.to_frame()
    }

    fn read(&mut self, node: &Node, request: ReadObject) -> Frame {
        let outcome = local(node, request.node).and_then(|()| node.read(request.address));
        // A value longer than the answer has room for: the length of the parameter is the reason.
        match outcome.and_then(|value| Ok((value.raw().ok_or(Abort::TOO_LONG)?, value))) {
            Ok((raw, value)) => {
                let used = 8 * value.bytes().len() as u32;
                let unused = u32::MAX.checked_shl(used).unwrap_or(0);
                ReadObject::answer(Ok(raw | self.junk.next() as u32 & unused))
            }
            Err(error) => self.refuse(error),
        }
    }

    fn begin_read(&mut self, node: &Node, request: InitiateSegmentedRead) -> Frame {
        self.upload = None;
        match local(node, request.node).and_then(|()| node.read(request.address)) {
            Ok(value) => {
                self.upload = Some(Upload { value });
                Answer::bare(CommError::NONE).to_frame()
            }
            Err(error) => self.refuse(error),
        }
    }

    fn read_segment(&mut self, request: SegmentedRead) -> Frame {
        let Some(upload) = self.upload.take() else {
            return self.refuse(CommError::COMMAND);
        };
        if request.toggle {
            // The first segment, which is also the last, has the toggle bit clear.
            return self.refuse(CommError::TOGGLE);
        }
        let mut bytes = Bounded::new();
        bytes.extend(upload.value.bytes().iter().copied());
        SegmentedRead::answer(&Ok(ReadSegment {
            toggle: false,
            more: false,
            bytes,
        }))
    }

    fn begin_write(&mut self, node: &Node, request: InitiateSegmentedWrite) -> Frame {
        self.download = None;
        let outcome = local(node, request.node)
            .and_then(|()| node.read(request.address))
            .and_then(|value| match (request.len as usize, value.bytes().len()) {
                (given, wanted) if given > wanted => Err(Abort::TOO_LONG),
                (given, wanted) if given < wanted => Err(Abort::TOO_SHORT),
                _ => Ok(()),
            });
        match outcome {
            Ok(()) => {
                self.download = Some(Download {
                    address: request.address,
                    len: request.len,
                    toggle: false,
                    bytes: Bounded::new(),
                });
                Answer::bare(CommError::NONE).to_frame()
            }
            Err(error) => self.refuse(error),
        }
    }

    fn write_segment(&mut self, node: &mut Node, segment: &WriteSegment) -> Frame {
        let Some(mut download) = self.download.take() else {
            return self.refuse(CommError::COMMAND);
        };
        if segment.toggle != download.toggle {
            return self.refuse(CommError::TOGGLE);
        }
        let len = download.bytes.len() + segment.bytes.len();
        if len > download.len as usize {
            return self.refuse(CommError::TOO_LONG);
        }
        download.bytes.extend(segment.bytes.iter().copied());
        download.toggle = !download.toggle;
        if len < download.len as usize {
            self.download = Some(download);
            return SegmentedWrite::answer(Ok(segment.toggle));
        }
        let mut raw = [0; 4];
        for (to, from) in raw.iter_mut().zip(download.bytes.iter()) {
            *to = *from;
        }
        match node.write(download.address, u32::from_le_bytes(raw)) {
            Ok(()) => SegmentedWrite::answer(Ok(segment.toggle)),
            Err(error) => self.refuse(error),
        }
    }
}

/// Node 0 and the unit's own id are the unit; any other is looked for on the CAN bus, where there is none.
fn local(node: &Node, id: u8) -> Result<(), Abort> {
    if id == 0 || id == node.node_id() {
        Ok(())
    } else {
        Err(Abort::TIMEOUT)
    }
}

/// Network management is broadcast on the bus and has no errors.
fn nmt(node: &mut Node, request: Nmt) -> Frame {
    if request.node == 0 || request.node == u16::from(node.node_id()) {
        node.nmt(request.command);
    }
    Answer::bare(CommError::NONE).to_frame()
}
