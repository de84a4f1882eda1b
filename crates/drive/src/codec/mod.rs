//! Encoding of requests and decoding of replies on each link.
//!
//! USB carries EPOS2 frames, RS232 the same messages with a handshake ([`rs232`]), CAN carries SDO.
//! Timing, matching and retries belong to [`crate::link`], other CAN services to
//! [`crate::can_services`].

mod rs232;

use protocol::canopen::sdo::{Initiate, SEGMENT_LEN};
use protocol::canopen::{CanFrame, CommunicationObject, NodeId, SOCKETCAN_LEN};
use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, SegmentedRead, SegmentedWrite,
    SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{SerialFrame, SerialFrameError};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use crate::exchange::{
    MAX_SEGMENT, ObjectAccess, Reply, TransferRequest, TransferResponse, TransferSegment,
};
use rs232::Rs232Master;

/// Result of decoding bytes from the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DecodedFrame {
    Reply(Reply),
    /// RS232: an expected handshake byte.
    Handshake,
    /// RS232: the drive refused the request (`F`) and did not execute it.
    Refused,
    /// A frame of the bus other than an SDO response of this node.
    Bus(CanFrame),
    /// A valid frame that is not a reply, such as an echo.
    Foreign,
    /// Bytes that cannot have been a reply.
    Noise,
    /// A damaged reply.
    Damaged,
}

/// Encoder and decoder of one link.
#[derive(Clone, Debug)]
pub(crate) struct Codec {
    node: u8,
    link: LinkCodec,
}

#[derive(Clone, Debug)]
enum LinkCodec {
    Usb(UsbDecoder),
    Rs232(Rs232Master),
    Can(NodeId),
}

/// Bytes to write now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outgoing {
    pub bytes: Vec<u8>,
    /// The bytes contain the request's body: the drive executes it no earlier than now.
    pub is_body: bool,
}

impl Codec {
    pub fn new(link: DriveLink, node: u8) -> Self {
        let link = match link {
            DriveLink::Usb => LinkCodec::Usb(UsbDecoder::new()),
            DriveLink::Rs232 => LinkCodec::Rs232(Rs232Master::new()),
            // `AxisConfig::check` rejects any other node id before anything is sent.
            DriveLink::Can => LinkCodec::Can(NodeId::new(node).unwrap_or(NodeId::MAX)),
        };
        Self { node, link }
    }

    #[cfg(test)]
    pub fn usb(node: u8) -> Self {
        Self::new(DriveLink::Usb, node)
    }

    /// Encodes a request; on RS232 returns only its first byte.
    pub fn encode(
        &mut self,
        address: Address,
        access: ObjectAccess,
        deadline: Stamp<Host>,
    ) -> Vec<u8> {
        match &mut self.link {
            LinkCodec::Usb(_) => usb::to_bytes(&serial_frame(self.node, address, access))
                .as_slice()
                .to_vec(),
            LinkCodec::Rs232(master) => {
                master.begin(&serial_frame(self.node, address, access), deadline)
            }
            LinkCodec::Can(node) => {
                let request = access.to_sdo(address);
                request.to_frame(*node).to_socketcan().to_vec()
            }
        }
    }

    /// Encodes a complete request that ignores the state of the dialogue (RS232 only; the other
    /// links accept a request at any time). Its reply is discarded.
    pub fn encode_unsolicited(
        &mut self,
        address: Address,
        access: ObjectAccess,
        now: Stamp<Host>,
    ) -> Option<Vec<u8>> {
        let LinkCodec::Rs232(master) = &mut self.link else {
            return None;
        };
        Some(master.send_unsolicited(&serial_frame(self.node, address, access), now))
    }

    /// Bytes of the longest segment.
    pub fn segment_len(&self) -> usize {
        match self.link {
            LinkCodec::Usb(_) | LinkCodec::Rs232(_) => MAX_SEGMENT,
            LinkCodec::Can(_) => SEGMENT_LEN,
        }
    }

    /// Bytes that one call of [`Codec::push`] takes.
    pub fn chunk_len(&self) -> usize {
        match self.link {
            LinkCodec::Usb(_) | LinkCodec::Rs232(_) => 1,
            LinkCodec::Can(_) => SOCKETCAN_LEN,
        }
    }

    /// Processes a byte, or on CAN a frame, from the device; `None` inside an incomplete frame.
    pub fn push(&mut self, chunk: &[u8], now: Stamp<Host>) -> Option<DecodedFrame> {
        match &mut self.link {
            LinkCodec::Can(node) => Some(decode_can(*node, chunk)),
            LinkCodec::Usb(decoder) => decoder
                .push(*chunk.first()?)
                .map(|frame| decode_serial(&frame)),
            LinkCodec::Rs232(master) => master.push(*chunk.first()?, now),
        }
    }

    /// The next bytes of the dialogue in progress.
    pub fn outgoing(&mut self, now: Stamp<Host>) -> Option<Outgoing> {
        self.rs232_mut()?.outgoing(now)
    }

    /// Whether a request may be sent.
    pub fn is_ready(&self) -> bool {
        self.rs232().is_none_or(Rs232Master::is_idle)
    }

    /// Cancels the request in progress.
    pub fn cancel(&mut self, now: Stamp<Host>) {
        if let Some(master) = self.rs232_mut() {
            master.cancel(now);
        }
    }

    /// Time at which [`Codec::expire`] is due.
    pub fn deadline(&self) -> Option<Stamp<Host>> {
        self.rs232()?.deadline()
    }

    /// Moves the deadline by a time in which the host read no input.
    pub fn postpone(&mut self, delay: Span) {
        if let Some(master) = self.rs232_mut() {
            master.postpone(delay);
        }
    }

    /// Acts on a deadline that has passed.
    pub fn expire(&mut self, now: Stamp<Host>) {
        if let Some(master) = self.rs232_mut() {
            master.expire(now);
        }
    }

    fn rs232(&self) -> Option<&Rs232Master> {
        match &self.link {
            LinkCodec::Rs232(master) => Some(master),
            LinkCodec::Usb(_) | LinkCodec::Can(_) => None,
        }
    }

    fn rs232_mut(&mut self) -> Option<&mut Rs232Master> {
        match &mut self.link {
            LinkCodec::Rs232(master) => Some(master),
            LinkCodec::Usb(_) | LinkCodec::Can(_) => None,
        }
    }
}

/// The command that makes an access on the serial links.
fn serial_frame(node: u8, address: Address, access: ObjectAccess) -> SerialFrame {
    let ObjectAccess::Transfer(request) = access else {
        return match access {
            ObjectAccess::Write { value, .. } => WriteObject {
                node,
                address,
                value,
            }
            .to_frame(),
            _ => ReadObject { node, address }.to_frame(),
        };
    };
    match request {
        TransferRequest::InitiateDownload { transfer, .. } => {
            let len = match transfer {
                Initiate::Segmented { size } => size.unwrap_or_default(),
                Initiate::Expedited(_) | Initiate::Unsized(_) => 0,
            };
            InitiateSegmentedWrite { node, address, len }.to_frame()
        }
        TransferRequest::DownloadSegment(TransferSegment { toggle, bytes, .. }) => {
            SegmentedWrite(WriteSegment { toggle, bytes }).to_frame()
        }
        TransferRequest::UploadSegment { toggle } => SegmentedRead { toggle }.to_frame(),
        _ => InitiateSegmentedRead { node, address }.to_frame(),
    }
}

/// Node, object and access of a command seen on a serial link. Segments name neither node nor
/// object; `own_node` and the default address then stand in.
pub(crate) fn parse_serial_request(
    frame: &SerialFrame,
    own_node: u8,
) -> Option<(u8, Address, ObjectAccess)> {
    let transfer = |request| {
        (
            own_node,
            Address::default(),
            ObjectAccess::Transfer(request),
        )
    };
    Some(match SerialRequest::parse(frame).ok()?? {
        SerialRequest::ReadObject(read) => (read.node, read.address, ObjectAccess::Read),
        SerialRequest::WriteObject(write) => {
            let value = write.value;
            let access = ObjectAccess::Write { value, width: 4 };
            (write.node, write.address, access)
        }
        SerialRequest::InitiateSegmentedRead(InitiateSegmentedRead { node, address }) => {
            let request = TransferRequest::InitiateUpload { address };
            (node, address, ObjectAccess::Transfer(request))
        }
        SerialRequest::InitiateSegmentedWrite(InitiateSegmentedWrite { node, address, len }) => {
            let transfer = Initiate::Segmented { size: Some(len) };
            let request = TransferRequest::InitiateDownload { address, transfer };
            (node, address, ObjectAccess::Transfer(request))
        }
        SerialRequest::SegmentedRead(SegmentedRead { toggle }) => {
            transfer(TransferRequest::UploadSegment { toggle })
        }
        SerialRequest::SegmentedWrite(SegmentedWrite(WriteSegment { toggle, bytes })) => {
            // A serial segment does not say whether it is the last.
            let last = false;
            transfer(TransferRequest::DownloadSegment(TransferSegment {
                toggle,
                last,
                bytes,
            }))
        }
        _ => (own_node, Address::default(), ObjectAccess::Other),
    })
}

fn decode_serial(frame: &Result<SerialFrame, SerialFrameError>) -> DecodedFrame {
    match frame.as_ref().map(Reply::parse) {
        Ok(Ok(reply)) => DecodedFrame::Reply(reply),
        Ok(Err(SerialFrameError::Opcode { .. })) => DecodedFrame::Foreign,
        Ok(Err(_)) | Err(_) => DecodedFrame::Damaged,
    }
}

/// Decodes a `struct can_frame` for the client of `node`.
fn decode_can(node: NodeId, bytes: &[u8]) -> DecodedFrame {
    let Ok(frame) = CanFrame::from_socketcan(bytes) else {
        return DecodedFrame::Noise;
    };
    if frame.cob_id() != Some(CommunicationObject::SdoResponse(node).cob_id()) {
        return DecodedFrame::Bus(frame);
    }
    match TransferResponse::parse(&frame) {
        // Block transfer, which this client never requests.
        Ok((_, TransferResponse::Unknown(_))) => DecodedFrame::Foreign,
        Ok((_, response)) => DecodedFrame::Reply(Reply::Sdo(response)),
        Err(_) => DecodedFrame::Damaged,
    }
}

#[cfg(test)]
mod tests;
