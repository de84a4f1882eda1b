//! Executes the commands of the serial interfaces on the node. Those for other nodes go to the
//! gateway.
//!
//! Unused words of an answer are garbage, as on a real unit, and errors come in two words or in
//! four.

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, ReadSegment,
    SegmentedRead, SegmentedWrite, SerialAnswer, SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{BoundedVec, CommError, SerialFrame};

use super::Abort;
use super::garbage::GarbageGenerator;
use super::gateway;
use super::node::Node;
use super::value::{LONGEST, ObjectValue};

/// State of a serial interface between commands.
#[derive(Clone, Debug)]
pub(super) struct CommandService {
    garbage: GarbageGenerator,
    /// The value of a segmented read under way. None is longer than one segment.
    upload: Option<ObjectValue>,
    download: Option<Download>,
}

/// A segmented write under way.
#[derive(Clone, Copy, Debug)]
struct Download {
    node: u8,
    address: Address,
    len: u32,
    toggle: bool,
    bytes: BoundedVec<u8, LONGEST>,
}

impl CommandService {
    pub const fn new(seed: u64) -> Self {
        Self {
            garbage: GarbageGenerator::new(seed),
            upload: None,
            download: None,
        }
    }

    /// Executes a request and returns its answer.
    pub fn execute(&mut self, node: &mut Node, frame: &SerialFrame) -> SerialFrame {
        let outcome = match SerialRequest::parse(frame) {
            Ok(Some(request)) => self.answer(node, request),
            Ok(None) => Err(CommError::ILLEGAL_COMMAND),
            // The guide names no code for a known command of a wrong length.
            Err(_) => Err(CommError::LENGTH),
        };
        outcome.unwrap_or_else(|error| self.refuse(error))
    }

    fn answer(
        &mut self,
        node: &mut Node,
        request: SerialRequest,
    ) -> Result<SerialFrame, CommError> {
        match request {
            SerialRequest::ReadObject(it) => return self.read(node, it),
            SerialRequest::WriteObject(it) => {
                check_local(node, it.node)?;
                node.write(it.address, it.value)?;
                return Ok(WriteObject::answer(Ok(())));
            }
            SerialRequest::InitiateSegmentedRead(it) => self.begin_read(node, it)?,
            SerialRequest::SegmentedRead(it) => return self.read_segment(it),
            SerialRequest::InitiateSegmentedWrite(it) => self.begin_write(node, it)?,
            SerialRequest::SegmentedWrite(SegmentedWrite(segment)) => {
                self.write_segment(node, &segment)?;
                return Ok(SegmentedWrite::answer(Ok(segment.toggle)));
            }
            SerialRequest::GatewayNmt(it) => nmt(node, it),
            SerialRequest::SendCanFrame(it) => gateway::send(&it)?,
            SerialRequest::RequestCanFrame(it) => return Err(gateway::request(&it)),
        }
        Ok(SerialAnswer::bare(CommError::NONE).to_frame())
    }

    /// The answer to a request that is not executed, two words or four.
    pub fn refuse(&mut self, error: CommError) -> SerialFrame {
        let mut answer = SerialAnswer::bare(error);
        let garbage = self.garbage.next();
        if garbage & 1 != 0 {
            answer
                .data
                .extend([(garbage >> 16) as u16, (garbage >> 32) as u16]);
        }
        answer.to_frame()
    }

    fn read(&mut self, node: &Node, request: ReadObject) -> Result<SerialFrame, CommError> {
        check_local(node, request.node)?;
        let value = node.read(request.address)?;
        // A longer value does not fit the answer.
        let raw = value.raw().ok_or(Abort::TOO_LONG)?;
        let used = 8 * value.bytes().len() as u32;
        let unused = u32::MAX.checked_shl(used).unwrap_or(0);
        let garbage = self.garbage.next() as u32 & unused;
        Ok(ReadObject::answer(Ok(raw | garbage)))
    }

    fn begin_read(&mut self, node: &Node, request: InitiateSegmentedRead) -> Result<(), CommError> {
        self.upload = None;
        check_local(node, request.node)?;
        self.upload = Some(node.read(request.address)?);
        Ok(())
    }

    fn read_segment(&mut self, request: SegmentedRead) -> Result<SerialFrame, CommError> {
        let value = self.upload.take().ok_or(CommError::COMMAND)?;
        if request.toggle {
            // The first segment is also the last and has the toggle bit clear.
            return Err(CommError::TOGGLE);
        }
        let mut bytes = BoundedVec::new();
        bytes.extend(value.bytes().iter().copied());
        Ok(SegmentedRead::answer(&Ok(ReadSegment {
            toggle: false,
            more: false,
            bytes,
        })))
    }

    fn begin_write(
        &mut self,
        node: &Node,
        request: InitiateSegmentedWrite,
    ) -> Result<(), CommError> {
        self.download = None;
        // The request to another node follows when the value is complete.
        if is_local(node, request.node) {
            node.check_download(request.address, request.len as usize)?;
        } else if request.len as usize > LONGEST {
            return Err(Abort::MEMORY);
        }
        self.download = Some(Download {
            node: request.node,
            address: request.address,
            len: request.len,
            toggle: false,
            bytes: BoundedVec::new(),
        });
        Ok(())
    }

    fn write_segment(&mut self, node: &mut Node, segment: &WriteSegment) -> Result<(), CommError> {
        let mut download = self.download.take().ok_or(CommError::COMMAND)?;
        if segment.toggle != download.toggle {
            return Err(CommError::TOGGLE);
        }
        let len = download.bytes.len() + segment.bytes.len();
        if len > download.len as usize {
            return Err(CommError::TOO_LONG);
        }
        download.bytes.extend(segment.bytes.iter().copied());
        download.toggle = !download.toggle;
        if len < download.len as usize {
            self.download = Some(download);
            return Ok(());
        }
        check_local(node, download.node)?;
        node.write_bytes(download.address, &download.bytes)
    }
}

/// Node 0 and the id of the unit are the unit itself; others are on the CAN bus.
const fn is_local(node: &Node, id: u8) -> bool {
    id == 0 || id == node.node_id()
}

fn check_local(node: &Node, id: u8) -> Result<(), Abort> {
    match is_local(node, id) {
        true => Ok(()),
        false => Err(gateway::transfer(id)),
    }
}

/// Network management is broadcast on the bus and has no errors; the unit receives it too.
fn nmt(node: &mut Node, request: GatewayNmt) {
    if let Ok(specifier) = u8::try_from(request.specifier)
        && (request.node == 0 || request.node == u16::from(node.node_id()))
    {
        node.nmt(NmtCommand::from_u8(specifier));
    }
}
