//! Faults of each link: requests on their way to the simulated EPOS2, its replies, and the CAN
//! services other than SDO.

use firmware_sim::epos2::SimulatedDrive;
use protocol::canopen::pdo::Pdo;
use protocol::canopen::sdo::{self, Expedited, Initiate};
use protocol::canopen::{BusMessage, CanFrame, CanId, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, SegmentedRead, SegmentedWrite,
    SerialAnswer, SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::rs232::{BodyDecoder, OKAY, encode_body};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{BoundedVec, SerialFrame};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::test_drive::{Fate, TestDrive};

/// Recognises the requests in the host's bytes.
pub enum RequestTap {
    Usb {
        decoder: UsbDecoder,
        bytes: Vec<u8>,
    },
    Rs232(Handshake),
    Can,
    /// Placeholder while the tap is in use.
    Gone,
}

/// Where the RS232 handshake is.
pub enum Handshake {
    Opcode,
    Body(BodyDecoder, Vec<u8>),
    Ready(Fate, Option<SerialFrame>),
    Receipt,
}

/// Faults of the CAN services other than SDO.
pub struct BusFaults {
    /// The heartbeat is off.
    pub silent: bool,
    /// Delay from the sample to the arrival of its frame.
    pub back: Span,
    /// Decides whether the n-th frame of the stream is sent, and how often.
    pub copies: Box<dyn FnMut(usize) -> usize + Send>,
    streamed: usize,
    /// When the host sent SYNCs.
    pub syncs: Vec<Stamp<Host>>,
}

impl Default for BusFaults {
    fn default() -> Self {
        Self {
            silent: false,
            back: Span::from_micros(180),
            copies: Box::new(|_| 1),
            streamed: 0,
            syncs: Vec::new(),
        }
    }
}

const NODE: u8 = 1;

fn node_id() -> NodeId {
    NodeId::new(NODE).unwrap()
}

impl RequestTap {
    pub fn new(link: DriveLink) -> Self {
        match link {
            DriveLink::Usb => Self::Usb {
                decoder: UsbDecoder::new(),
                bytes: Vec::new(),
            },
            DriveLink::Rs232 => Self::Rs232(Handshake::Opcode),
            DriveLink::Can => Self::Can,
        }
    }

    pub fn input(&mut self, drive: &mut TestDrive, input: &[u8], now: Stamp<Host>) {
        match self {
            Self::Usb { decoder, bytes } => {
                for &byte in input {
                    bytes.push(byte);
                    if let Some(Ok(frame)) = decoder.push(byte) {
                        usb(drive, &frame, std::mem::take(bytes), now);
                    }
                }
            }
            Self::Rs232(handshake) => {
                for &byte in input {
                    let was = std::mem::replace(handshake, Handshake::Opcode);
                    *handshake = rs232(was, drive, byte, now);
                }
            }
            Self::Can => {
                for bytes in input.chunks(16) {
                    can(drive, bytes, now);
                }
            }
            Self::Gone => {}
        }
    }
}

/// The answer of a script instead of the drive's.
fn scripted(drive: &mut TestDrive, request: &SerialRequest, fate: Fate) -> Option<SerialFrame> {
    if let Some(answer) = drive.long_object.as_mut().and_then(|it| it.answer(request)) {
        return Some(answer);
    }
    match (fate, request) {
        // A read instead of a write, and vice versa.
        (Fate::Another, SerialRequest::WriteObject(_)) => Some(ReadObject::answer(Ok(0x1234))),
        (Fate::Another | Fate::Ignored, _) => Some(WriteObject::answer(Ok(()))),
        (Fate::Refused(error), _) => Some(SerialAnswer::bare(error).to_frame()),
        (Fate::Value(value), _) => Some(ReadObject::answer(Ok(value))),
        _ => None,
    }
}

/// Whether a request with this fate changes the drive.
fn is_executed(fate: Fate) -> bool {
    !matches!(fate, Fate::Ignored | Fate::Refused(_))
}

fn reply(drive: &mut TestDrive, mut bytes: Vec<u8>, fate: Fate, now: Stamp<Host>) {
    let by = match fate {
        Fate::Lost => return,
        Fate::Late(by) => by,
        _ => Span::ZERO,
    };
    if fate == Fate::Damaged {
        match drive.link {
            // A damaged CAN frame does not arrive; a wrong length comes closest.
            DriveLink::Can => bytes[4] = 7,
            _ => *bytes.last_mut().unwrap() ^= 0x55,
        }
    }
    if fate == Fate::Twice {
        drive.send(bytes.clone(), by, now);
    }
    drive.send(bytes, by, now);
}

fn usb(drive: &mut TestDrive, frame: &SerialFrame, mut bytes: Vec<u8>, now: Stamp<Host>) {
    let request = SerialRequest::parse(frame).unwrap().unwrap();
    let fate = drive.meet(request, now);
    let script = scripted(drive, &request, fate);
    if fate == Fate::Rejected {
        *bytes.last_mut().unwrap() ^= 0x55;
    }
    let mut answers = Vec::new();
    if is_executed(fate) {
        answers = drive.server.input(&mut drive.node, &bytes);
    }
    if let Some(answer) = script {
        answers = vec![usb::to_bytes(&answer).to_vec()];
    }
    for answer in answers {
        reply(drive, answer, fate, now);
    }
}

/// The drive receives the byte of the handshake, or a request as a whole.
fn rs232(handshake: Handshake, drive: &mut TestDrive, byte: u8, now: Stamp<Host>) -> Handshake {
    let mut bytes = vec![byte];
    let (fate, next) = match handshake {
        Handshake::Opcode if SerialRequest::OPCODES.contains(&byte) => (
            Fate::Sent,
            Handshake::Body(BodyDecoder::new(byte), Vec::new()),
        ),
        Handshake::Opcode => (Fate::Sent, Handshake::Opcode),
        Handshake::Body(mut decoder, mut body) => {
            body.push(byte);
            match decoder.push(byte) {
                None => return Handshake::Body(decoder, body),
                Some(Err(_)) => {
                    bytes = body;
                    (Fate::Sent, Handshake::Opcode)
                }
                Some(Ok(frame)) => {
                    let request = SerialRequest::parse(&frame).unwrap().unwrap();
                    let fate = drive.meet(request, now);
                    let script = scripted(drive, &request, fate);
                    bytes = body;
                    if fate == Fate::Rejected {
                        *bytes.last_mut().unwrap() ^= 0x55;
                    } else if !is_executed(fate) {
                        bytes = harmless(&request, bytes);
                    }
                    let next = match fate {
                        Fate::Rejected => Handshake::Opcode,
                        _ => Handshake::Ready(fate, script),
                    };
                    // Damage and repetition are for the answer.
                    let fate = match fate {
                        Fate::Lost | Fate::Late(_) => fate,
                        _ => Fate::Sent,
                    };
                    (fate, next)
                }
            }
        }
        Handshake::Ready(fate, script) if byte == OKAY => {
            let mut answers = drive.server.input(&mut drive.node, &bytes);
            if let Some(frame) = script {
                let mut body = Vec::new();
                encode_body(&frame, &mut body).unwrap();
                answers = vec![body];
            }
            // A late reply was late with its handshake.
            let fate = match fate {
                Fate::Lost | Fate::Late(_) => Fate::Sent,
                _ => fate,
            };
            for answer in answers {
                reply(drive, answer, fate, now);
            }
            return Handshake::Receipt;
        }
        Handshake::Ready(..) | Handshake::Receipt => (Fate::Sent, Handshake::Opcode),
    };
    for answer in drive.server.input(&mut drive.node, &bytes) {
        reply(drive, answer, fate, now);
    }
    next
}

/// The body of a request that the drive refuses, with its handshake.
fn harmless(request: &SerialRequest, body: Vec<u8>) -> Vec<u8> {
    let SerialRequest::WriteObject(write) = *request else {
        return body;
    };
    let address = Address::new(0x5FFF, 0);
    let frame = WriteObject { address, ..write }.to_frame();
    let mut body = Vec::new();
    encode_body(&frame, &mut body).unwrap();
    body
}

fn can(drive: &mut TestDrive, bytes: &[u8], now: Stamp<Host>) {
    let frame = CanFrame::from_socketcan(bytes).unwrap();
    match BusMessage::parse(&frame).unwrap() {
        BusMessage::SdoRequest(to, request) => {
            assert_eq!(to, node_id());
            return sdo_request(drive, &request, bytes, now);
        }
        BusMessage::Sync(_) => drive.bus.syncs.push(now - drive.forth),
        _ => {}
    }
    let sent = drive.server.input(&mut drive.node, bytes);
    drive.on_bus(sent, now);
}

fn sdo_request(drive: &mut TestDrive, request: &sdo::SdoRequest, bytes: &[u8], now: Stamp<Host>) {
    if let sdo::SdoRequest::Abort { error, .. } = *request {
        drive.aborts.push(error);
        drive.server.input(&mut drive.node, bytes);
        return;
    }
    let (wire, address) = serial_request(request);
    let fate = drive.meet(wire, now);
    let script = scripted(drive, &wire, fate);
    if is_executed(fate) && script.is_none() {
        for bytes in drive.server.input(&mut drive.node, bytes) {
            let frame = CanFrame::from_socketcan(&bytes).unwrap();
            if channel(&frame) == Some(CommunicationObject::SdoResponse(node_id())) {
                reply(drive, bytes, fate, now);
            } else {
                drive.on_bus(vec![bytes], now);
            }
        }
    }
    let Some(script) = script else {
        return;
    };
    let answer = if fate == Fate::Another {
        // Even of the same kind.
        let address = Address::new(address.index + 1, address.sub);
        let transfer = Initiate::Expedited(Expedited::of(0x1234_u32));
        sdo::SdoResponse::InitiateUpload { address, transfer }
    } else {
        sdo_answer(&drive.node, &wire, address, &script)
    };
    let bytes = answer.to_frame(node_id()).to_socketcan().to_vec();
    reply(drive, bytes, fate, now);
}

/// The serial request of the same meaning, and the object.
fn serial_request(request: &sdo::SdoRequest) -> (SerialRequest, Address) {
    const NAME: Address = Address::new(0x1008, 0);
    let node = NODE;
    match *request {
        sdo::SdoRequest::InitiateUpload { address } if address == NAME => {
            let open = InitiateSegmentedRead { node, address };
            (SerialRequest::InitiateSegmentedRead(open), address)
        }
        sdo::SdoRequest::InitiateUpload { address } => {
            let read = ReadObject { node, address };
            (SerialRequest::ReadObject(read), address)
        }
        sdo::SdoRequest::InitiateDownload {
            address,
            transfer: Initiate::Expedited(data),
        } => {
            let write = WriteObject {
                node,
                address,
                value: data.to_u32(),
            };
            (SerialRequest::WriteObject(write), address)
        }
        sdo::SdoRequest::UploadSegment { toggle } => {
            (SerialRequest::SegmentedRead(SegmentedRead { toggle }), NAME)
        }
        sdo::SdoRequest::InitiateDownload {
            address,
            transfer: Initiate::Segmented { size: Some(len) },
        } => {
            let open = InitiateSegmentedWrite { node, address, len };
            (SerialRequest::InitiateSegmentedWrite(open), address)
        }
        sdo::SdoRequest::DownloadSegment(segment) => {
            let mut bytes = BoundedVec::new();
            bytes.extend(segment.bytes.iter().copied());
            let toggle = segment.toggle;
            let write = SegmentedWrite(WriteSegment { toggle, bytes });
            (SerialRequest::SegmentedWrite(write), NAME)
        }
        other => panic!("{other:?}"),
    }
}

/// A script's answer on CAN.
fn sdo_answer(
    node: &SimulatedDrive,
    request: &SerialRequest,
    address: Address,
    answer: &SerialFrame,
) -> sdo::SdoResponse {
    let parsed = SerialAnswer::parse(answer).unwrap();
    let error = parsed.error;
    if !error.is_none() {
        return sdo::SdoResponse::Abort { address, error };
    }
    match request {
        SerialRequest::WriteObject(_) | SerialRequest::InitiateSegmentedWrite(_) => {
            sdo::SdoResponse::InitiateDownload { address }
        }
        SerialRequest::SegmentedWrite(_) => {
            let toggle = SegmentedWrite::parse_answer(answer).unwrap().unwrap();
            sdo::SdoResponse::DownloadSegment { toggle }
        }
        SerialRequest::InitiateSegmentedRead(_) => sdo::SdoResponse::InitiateUpload {
            address,
            transfer: Initiate::Segmented { size: None },
        },
        SerialRequest::SegmentedRead(_) => {
            let read = SegmentedRead::parse_answer(answer).unwrap().unwrap();
            let mut segment = sdo::SdoSegment::cut(&read.bytes, 0, read.toggle, sdo::SEGMENT_LEN);
            segment.last = !read.more;
            sdo::SdoResponse::UploadSegment(segment)
        }
        _ => {
            let value = parsed.value().unwrap().to_le_bytes();
            let width = node.read(address).unwrap().bytes().len();
            let data = Expedited::new(&value[..width]).unwrap();
            sdo::SdoResponse::InitiateUpload {
                address,
                transfer: Initiate::Expedited(data),
            }
        }
    }
}

fn channel(frame: &CanFrame) -> Option<CommunicationObject> {
    frame.cob_id().map(CommunicationObject::of)
}

impl TestDrive {
    /// Frames that the drive sends on its own at `now`.
    pub(super) fn on_bus(&mut self, sent: Vec<Vec<u8>>, now: Stamp<Host>) {
        let stream = Pdo::Transmit(PdoNumber::One).channel(node_id());
        for bytes in sent {
            let frame = CanFrame::from_socketcan(&bytes).unwrap();
            if frame.id() == CanId::Standard(stream.cob_id()) {
                let n = self.bus.streamed;
                self.bus.streamed += 1;
                for copy in 0..(self.bus.copies)(n) {
                    let at = now + self.bus.back + Span::from_micros(100 * copy as i64);
                    self.send_at(bytes.clone(), at);
                }
                continue;
            }
            let is_heartbeat = channel(&frame) == Some(CommunicationObject::Heartbeat(node_id()));
            if !(is_heartbeat && self.bus.silent) {
                self.send_at(bytes, now + Span::from_micros(150));
            }
        }
    }
}
