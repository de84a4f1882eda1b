//! Executes the commands of the serial interfaces on the node, or on other nodes through the CAN
//! bus.
//!
//! Unused words of an answer are garbage, as on a real unit, and errors come in two words or in
//! four.

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, ReadSegment,
    RequestCanFrame, SegmentedRead, SegmentedWrite, SerialAnswer, SerialRequest, WriteObject,
    WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError, SerialFrame};

use super::Abort;
use super::bus::CanBus;
use super::dictionary::Dictionary;
use super::garbage::GarbageGenerator;
use super::gateway;
use super::node::Node;
use super::value::{LONGEST, ObjectValue};

/// State of a serial interface between commands.
#[derive(Clone, Debug)]
pub(super) struct CommandService {
    garbage: GarbageGenerator,
    upload: Option<Upload>,
    download: Option<Download>,
}

/// A segmented read under way. No value is longer than one segment.
#[derive(Clone, Copy, Debug)]
struct Upload {
    value: ObjectValue,
}

/// A segmented write under way.
#[derive(Clone, Copy, Debug)]
struct Download {
    node: u8,
    address: Address,
    len: u32,
    toggle: bool,
    bytes: Bounded<u8, LONGEST>,
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
    pub fn execute(
        &mut self,
        node: &mut Node,
        bus: &mut impl CanBus,
        frame: &SerialFrame,
    ) -> SerialFrame {
        let request = match SerialRequest::parse(frame) {
            Ok(Some(request)) => request,
            Ok(None) => return self.refuse(CommError::ILLEGAL_COMMAND),
            // The guide names no code for a known command of a wrong length.
            Err(_) => return self.refuse(CommError::LENGTH),
        };
        match request {
            SerialRequest::ReadObject(it) => self.read(node, bus, it),
            SerialRequest::WriteObject(it) => match write(node, bus, it) {
                Ok(()) => WriteObject::answer(Ok(())),
                Err(error) => self.refuse(error),
            },
            SerialRequest::InitiateSegmentedRead(it) => self.begin_read(node, bus, it),
            SerialRequest::SegmentedRead(it) => self.read_segment(it),
            SerialRequest::InitiateSegmentedWrite(it) => self.begin_write(node, it),
            SerialRequest::SegmentedWrite(SegmentedWrite(segment)) => {
                self.write_segment(node, bus, &segment)
            }
            SerialRequest::GatewayNmt(it) => nmt(node, bus, it),
            SerialRequest::SendCanFrame(it) => match gateway::send(bus, &it) {
                Ok(()) => SerialAnswer::bare(CommError::NONE).to_frame(),
                Err(error) => self.refuse(error),
            },
            SerialRequest::RequestCanFrame(it) => match gateway::request(bus, &it) {
                Ok(data) => RequestCanFrame::answer(Ok(data)),
                Err(error) => self.refuse(error),
            },
        }
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

    fn read(&mut self, node: &Node, bus: &mut impl CanBus, request: ReadObject) -> SerialFrame {
        let outcome = read(node, bus, request.node, request.address);
        // The value does not fit the answer.
        match outcome.and_then(|value| Ok((value.raw().ok_or(Abort::TOO_LONG)?, value))) {
            Ok((raw, value)) => {
                let used = 8 * value.bytes().len() as u32;
                let unused = u32::MAX.checked_shl(used).unwrap_or(0);
                ReadObject::answer(Ok(raw | self.garbage.next() as u32 & unused))
            }
            Err(error) => self.refuse(error),
        }
    }

    fn begin_read(
        &mut self,
        node: &Node,
        bus: &mut impl CanBus,
        request: InitiateSegmentedRead,
    ) -> SerialFrame {
        self.upload = None;
        match read(node, bus, request.node, request.address) {
            Ok(value) => {
                self.upload = Some(Upload { value });
                SerialAnswer::bare(CommError::NONE).to_frame()
            }
            Err(error) => self.refuse(error),
        }
    }

    fn read_segment(&mut self, request: SegmentedRead) -> SerialFrame {
        let Some(upload) = self.upload.take() else {
            return self.refuse(CommError::COMMAND);
        };
        if request.toggle {
            // The first segment is also the last and has the toggle bit clear.
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

    fn begin_write(&mut self, node: &Node, request: InitiateSegmentedWrite) -> SerialFrame {
        self.download = None;
        // The request to another node follows when the value is complete.
        let outcome = if is_local(node, request.node) {
            node.check_download(request.address, request.len as usize)
        } else if request.len as usize > LONGEST {
            Err(Abort::MEMORY)
        } else {
            Ok(())
        };
        match outcome {
            Ok(()) => {
                self.download = Some(Download {
                    node: request.node,
                    address: request.address,
                    len: request.len,
                    toggle: false,
                    bytes: Bounded::new(),
                });
                SerialAnswer::bare(CommError::NONE).to_frame()
            }
            Err(error) => self.refuse(error),
        }
    }

    fn write_segment(
        &mut self,
        node: &mut Node,
        bus: &mut impl CanBus,
        segment: &WriteSegment,
    ) -> SerialFrame {
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
        let outcome = if is_local(node, download.node) {
            node.write_bytes(download.address, &download.bytes)
        } else {
            gateway::write(bus, download.node, download.address, &download.bytes)
        };
        match outcome {
            Ok(()) => SegmentedWrite::answer(Ok(segment.toggle)),
            Err(error) => self.refuse(error),
        }
    }
}

/// Node 0 and the id of the unit are the unit itself; others are on the CAN bus.
const fn is_local(node: &Node, id: u8) -> bool {
    id == 0 || id == node.node_id()
}

fn read(
    node: &Node,
    bus: &mut impl CanBus,
    id: u8,
    address: Address,
) -> Result<ObjectValue, Abort> {
    if is_local(node, id) {
        node.read(address)
    } else {
        gateway::read(bus, id, address)
    }
}

/// Writes an object. The command has no length: the unit's own dictionary gives that of another
/// node's object, else four bytes.
fn write(node: &mut Node, bus: &mut impl CanBus, request: WriteObject) -> Result<(), Abort> {
    let WriteObject {
        node: id,
        address,
        value,
    } = request;
    if is_local(node, id) {
        return node.write(address, value);
    }
    let known = Dictionary::entry(address).map(|entry| entry.ty.bytes());
    let len = known.ok().filter(|len| (1..=4).contains(len)).unwrap_or(4);
    let bytes = value.to_le_bytes();
    gateway::write(bus, id, address, bytes.get(..len).unwrap_or(&bytes))
}

/// Network management is broadcast on the bus and has no errors; the unit receives it too.
fn nmt(node: &mut Node, bus: &mut impl CanBus, request: GatewayNmt) -> SerialFrame {
    if let Ok(specifier) = u8::try_from(request.specifier) {
        let command = NmtCommand::from_u8(specifier);
        gateway::nmt(bus, request.node, command);
        if request.node == 0 || request.node == u16::from(node.node_id()) {
            node.nmt(command);
        }
    }
    SerialAnswer::bare(CommError::NONE).to_frame()
}
