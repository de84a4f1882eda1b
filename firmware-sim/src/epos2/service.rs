//! Executes the commands of the serial interfaces on the node. Those for other nodes go to the
//! gateway.
//!
//! Unused words of an answer are garbage, as on a real drive, and errors come in two words or in
//! four.

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, ReadSegment,
    SegmentedRead, SegmentedWrite, SerialAnswer, SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, BoundedVec, SerialFrame};
use units::random::split_mix_64;

use super::gateway;
use super::node::SimulatedDrive;
use super::value::{LONGEST, ObjectValue};

/// State of a serial interface between commands.
#[derive(Clone, Debug)]
pub(super) struct CommandService {
    /// State of the arbitrary numbers in unused words.
    garbage: u64,
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
            garbage: seed,
            upload: None,
            download: None,
        }
    }

    /// Executes a request and returns its answer.
    pub fn execute(&mut self, node: &mut SimulatedDrive, frame: &SerialFrame) -> SerialFrame {
        let outcome = match SerialRequest::parse(frame) {
            Ok(Some(request)) => self.answer(node, request),
            Ok(None) => Err(AbortCode::ILLEGAL_COMMAND),
            // The guide names no code for a known command of a wrong length.
            Err(_) => Err(AbortCode::LENGTH),
        };
        outcome.unwrap_or_else(|error| self.refuse(error))
    }

    fn answer(
        &mut self,
        node: &mut SimulatedDrive,
        request: SerialRequest,
    ) -> Result<SerialFrame, AbortCode> {
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
            SerialRequest::RequestCanFrame(it) => return Err(gateway::request_error(&it)),
        }
        Ok(SerialAnswer::bare(AbortCode::NONE).to_frame())
    }

    /// The answer to a request that is not executed, two words or four.
    pub fn refuse(&mut self, error: AbortCode) -> SerialFrame {
        let mut answer = SerialAnswer::bare(error);
        let garbage = split_mix_64(&mut self.garbage);
        if garbage & 1 != 0 {
            answer
                .data
                .extend([(garbage >> 16) as u16, (garbage >> 32) as u16]);
        }
        answer.to_frame()
    }

    fn read(
        &mut self,
        node: &SimulatedDrive,
        request: ReadObject,
    ) -> Result<SerialFrame, AbortCode> {
        check_local(node, request.node)?;
        let value = node.read(request.address)?;
        // A longer value does not fit the answer.
        let raw = value.raw().ok_or(AbortCode::TOO_LONG)?;
        let used = 8 * value.bytes().len() as u32;
        let unused = u32::MAX.checked_shl(used).unwrap_or(0);
        let garbage = split_mix_64(&mut self.garbage) as u32 & unused;
        Ok(ReadObject::answer(Ok(raw | garbage)))
    }

    fn begin_read(
        &mut self,
        node: &SimulatedDrive,
        request: InitiateSegmentedRead,
    ) -> Result<(), AbortCode> {
        self.upload = None;
        check_local(node, request.node)?;
        self.upload = Some(node.read(request.address)?);
        Ok(())
    }

    fn read_segment(&mut self, request: SegmentedRead) -> Result<SerialFrame, AbortCode> {
        let value = self.upload.take().ok_or(AbortCode::COMMAND)?;
        if request.toggle {
            // The first segment is also the last and has the toggle bit clear.
            return Err(AbortCode::TOGGLE);
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
        node: &SimulatedDrive,
        request: InitiateSegmentedWrite,
    ) -> Result<(), AbortCode> {
        self.download = None;
        // The request to another node follows when the value is complete.
        if is_local(node, request.node) {
            node.check_download(request.address, request.len as usize)?;
        } else if request.len as usize > LONGEST {
            return Err(AbortCode::MEMORY);
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

    fn write_segment(
        &mut self,
        node: &mut SimulatedDrive,
        segment: &WriteSegment,
    ) -> Result<(), AbortCode> {
        let mut download = self.download.take().ok_or(AbortCode::COMMAND)?;
        if segment.toggle != download.toggle {
            return Err(AbortCode::TOGGLE);
        }
        let len = download.bytes.len() + segment.bytes.len();
        if len > download.len as usize {
            return Err(AbortCode::TOO_LONG);
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

/// Node 0 and the id of the drive are the drive itself; others are on the CAN bus.
const fn is_local(node: &SimulatedDrive, id: u8) -> bool {
    id == 0 || id == node.node_id()
}

fn check_local(node: &SimulatedDrive, id: u8) -> Result<(), AbortCode> {
    match is_local(node, id) {
        true => Ok(()),
        false => Err(gateway::transfer_error(id)),
    }
}

/// Network management is broadcast on the bus and has no errors; the drive receives it too.
fn nmt(node: &mut SimulatedDrive, request: GatewayNmt) {
    if let Ok(specifier) = u8::try_from(request.specifier)
        && (request.node == 0 || request.node == u16::from(node.node_id()))
    {
        node.nmt(NmtCommand::from_u8(specifier));
    }
}
