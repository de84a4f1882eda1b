//! The scripted drive's side of each link: bytes to requests, answers and their fates to bytes, and
//! the CAN services other than SDO.

use protocol::canopen::emcy::Emergency;
use protocol::canopen::heartbeat::Heartbeat;
use protocol::canopen::nmt::{NmtCommand, NmtState};
use protocol::canopen::pdo::{MappedObject, Pdo};
use protocol::canopen::sdo::{self, Expedited, Initiate};
use protocol::canopen::{BusMessage, CanFrame, NodeId, PdoNumber};
use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, SegmentedRead, SegmentedWrite,
    SerialAnswer, SerialRequest, WriteObject, WriteSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::rs232::{BodyDecoder, FAILED, OKAY, encode_body};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{Bounded, CommError, SerialFrame};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::fake::{Fake, Fate, device_us, width};

pub enum Wire {
    Usb(UsbDecoder),
    Rs232(UnitState),
    Can,
    /// Placeholder while the wire is in use.
    Gone,
}

/// State of the RS232 dialogue in the unit.
pub enum UnitState {
    Opcode,
    Body(BodyDecoder),
    Ready(SerialFrame, Fate),
    Receipt,
}

/// CAN services of the drive other than SDO.
pub struct FakeBus {
    pub state: NmtState,
    next_heartbeat: Option<Stamp<Host>>,
    /// The heartbeat is off.
    pub silent: bool,
    host_heartbeat: Option<Stamp<Host>>,
    /// Delay from SYNC to the sample, and from there to the frame's arrival.
    pub forth: Span,
    pub back: Span,
    /// Decides whether the n-th frame of the stream is sent, and how often.
    pub copies: Box<dyn FnMut(usize) -> usize + Send>,
    streamed: usize,
    pub syncs: Vec<Stamp<Host>>,
}

impl Default for FakeBus {
    fn default() -> Self {
        Self {
            state: NmtState::PreOperational,
            next_heartbeat: None,
            silent: false,
            host_heartbeat: None,
            forth: Span::from_micros(120),
            back: Span::from_micros(180),
            copies: Box::new(|_| 1),
            streamed: 0,
            syncs: Vec::new(),
        }
    }
}

const NODE: u8 = 1;

fn node() -> NodeId {
    NodeId::new(NODE).unwrap()
}

impl Wire {
    pub fn new(link: DriveLink) -> Self {
        match link {
            DriveLink::Usb => Self::Usb(UsbDecoder::new()),
            DriveLink::Rs232 => Self::Rs232(UnitState::Opcode),
            DriveLink::Can => Self::Can,
        }
    }

    pub fn link(&self) -> DriveLink {
        match self {
            Self::Usb(_) => DriveLink::Usb,
            Self::Rs232(_) => DriveLink::Rs232,
            Self::Can | Self::Gone => DriveLink::Can,
        }
    }

    pub fn input(&mut self, fake: &mut Fake, bytes: &[u8], now: Stamp<Host>) {
        match self {
            Self::Usb(decoder) => {
                for &byte in bytes {
                    if let Some(Ok(frame)) = decoder.push(byte) {
                        let request = SerialRequest::parse(&frame).unwrap().unwrap();
                        let (answer, fate) = fake.execute(request, now);
                        usb_answer(fake, &answer, fate, now);
                    }
                }
            }
            Self::Rs232(state) => {
                for &byte in bytes {
                    let was = std::mem::replace(state, UnitState::Opcode);
                    *state = rs232(was, fake, byte, now);
                }
            }
            Self::Can => {
                for bytes in bytes.chunks(16) {
                    can(fake, &CanFrame::from_socketcan(bytes).unwrap(), now);
                }
            }
            Self::Gone => {}
        }
    }
}

/// The reply to a request of another kind: a read instead of a write, and vice versa.
fn another(answer: &SerialFrame) -> SerialFrame {
    if SerialAnswer::parse(answer).unwrap().data.is_empty() {
        ReadObject::answer(Ok(0x1234))
    } else {
        WriteObject::answer(Ok(()))
    }
}

fn usb_answer(fake: &mut Fake, answer: &SerialFrame, fate: Fate, now: Stamp<Host>) {
    let other = another(answer);
    let answer = if fate == Fate::Another {
        &other
    } else {
        answer
    };
    let mut bytes = usb::to_bytes(answer).to_vec();
    let by = match fate {
        Fate::Lost => return,
        Fate::Late(by) => by,
        _ => Span::ZERO,
    };
    if fate == Fate::Damaged {
        *bytes.last_mut().unwrap() ^= 0x55;
    }
    if fate == Fate::Twice {
        fake.send(bytes.clone(), by, now);
    }
    fake.send(bytes, by, now);
}

fn rs232(state: UnitState, fake: &mut Fake, byte: u8, now: Stamp<Host>) -> UnitState {
    match state {
        UnitState::Opcode if [0x10, 0x11, 0x12, 0x13, 0x14, 0x15].contains(&byte) => {
            fake.send(vec![OKAY], Span::ZERO, now);
            UnitState::Body(BodyDecoder::new(byte))
        }
        UnitState::Opcode => {
            fake.send(vec![FAILED], Span::ZERO, now);
            UnitState::Opcode
        }
        UnitState::Body(mut decoder) => match decoder.push(byte) {
            None => UnitState::Body(decoder),
            Some(Err(_)) => {
                fake.send(vec![FAILED], Span::ZERO, now);
                UnitState::Opcode
            }
            Some(Ok(frame)) => {
                let request = SerialRequest::parse(&frame).unwrap().unwrap();
                let (answer, fate) = fake.execute(request, now);
                match fate {
                    Fate::Rejected => {
                        fake.send(vec![FAILED], Span::ZERO, now);
                        return UnitState::Opcode;
                    }
                    Fate::Lost => {}
                    Fate::Late(by) => fake.send(vec![OKAY, 0], by, now),
                    _ => fake.send(vec![OKAY, 0], Span::ZERO, now),
                }
                UnitState::Ready(answer, fate)
            }
        },
        UnitState::Ready(mut answer, fate) if byte == OKAY => {
            if fate == Fate::Another {
                answer = another(&answer);
            }
            let mut body = Vec::new();
            encode_body(&answer, &mut body).unwrap();
            if fate == Fate::Damaged {
                *body.last_mut().unwrap() ^= 0x55;
            }
            if fate == Fate::Twice {
                fake.send(body.clone(), Span::ZERO, now);
            }
            fake.send(body, Span::ZERO, now);
            UnitState::Receipt
        }
        UnitState::Ready(..) | UnitState::Receipt => UnitState::Opcode,
    }
}

fn can(fake: &mut Fake, frame: &CanFrame, now: Stamp<Host>) {
    match BusMessage::parse(frame).unwrap() {
        BusMessage::Nmt(nmt) => match nmt.command {
            NmtCommand::Start => fake.bus.state = NmtState::Operational,
            NmtCommand::EnterPreOperational => fake.bus.state = NmtState::PreOperational,
            other => panic!("{other:?}"),
        },
        BusMessage::Sync(_) => fake.sync(now),
        BusMessage::Heartbeat(heartbeat) => {
            assert_eq!(heartbeat.node.get(), 127);
            fake.bus.host_heartbeat = Some(now);
        }
        BusMessage::SdoRequest(to, request) => {
            assert_eq!(to, node());
            sdo_request(fake, &request, now);
        }
        other => panic!("{other:?}"),
    }
}

fn sdo_request(fake: &mut Fake, request: &sdo::SdoRequest, now: Stamp<Host>) {
    let (wire, address) = match *request {
        sdo::SdoRequest::InitiateUpload { address } if address.index == 0x1008 => {
            let open = InitiateSegmentedRead {
                node: NODE,
                address,
            };
            (SerialRequest::InitiateSegmentedRead(open), address)
        }
        sdo::SdoRequest::InitiateUpload { address } => {
            let node = NODE;
            (
                SerialRequest::ReadObject(ReadObject { node, address }),
                address,
            )
        }
        sdo::SdoRequest::InitiateDownload {
            address,
            transfer: Initiate::Expedited(data),
        } => {
            assert_eq!(
                data.as_slice().len(),
                usize::from(width(address)),
                "{address}"
            );
            let write = WriteObject {
                node: NODE,
                address,
                value: data.to_u32(),
            };
            (SerialRequest::WriteObject(write), address)
        }
        sdo::SdoRequest::UploadSegment { toggle } => (
            SerialRequest::SegmentedRead(SegmentedRead { toggle }),
            Address::new(0x1008, 0),
        ),
        sdo::SdoRequest::InitiateDownload {
            address,
            transfer: Initiate::Segmented { size: Some(len) },
        } => {
            let node = NODE;
            let open = InitiateSegmentedWrite { node, address, len };
            (SerialRequest::InitiateSegmentedWrite(open), address)
        }
        sdo::SdoRequest::DownloadSegment(segment) => {
            let mut bytes = Bounded::new();
            bytes.extend(segment.bytes.iter().copied());
            let toggle = segment.toggle;
            let write = SegmentedWrite(WriteSegment { toggle, bytes });
            (
                SerialRequest::SegmentedWrite(write),
                Address::new(0x1008, 0),
            )
        }
        sdo::SdoRequest::Abort { error, .. } => {
            fake.aborts.push(error);
            return;
        }
        other => panic!("{other:?}"),
    };
    let (answer, fate) = fake.execute(wire, now);
    let mut answer = sdo_answer(&wire, address, &answer);
    if fate == Fate::Another {
        // Even of the same kind.
        let address = Address::new(address.index + 1, address.sub);
        let transfer = Initiate::Expedited(Expedited::of(0x1234_u32));
        answer = sdo::SdoResponse::InitiateUpload { address, transfer };
    }
    let mut bytes = answer.to_frame(node()).to_socketcan().to_vec();
    let by = match fate {
        Fate::Lost => return,
        Fate::Late(by) => by,
        _ => Span::ZERO,
    };
    match fate {
        // A damaged CAN frame does not arrive; a wrong length comes closest.
        Fate::Damaged => bytes[4] = 7,
        Fate::Twice => fake.send(bytes.clone(), by, now),
        _ => {}
    }
    fake.send(bytes, by, now);
}

fn sdo_answer(request: &SerialRequest, address: Address, answer: &SerialFrame) -> sdo::SdoResponse {
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
            let data = Expedited::new(&value[..usize::from(width(address))]).unwrap();
            sdo::SdoResponse::InitiateUpload {
                address,
                transfer: Initiate::Expedited(data),
            }
        }
    }
}

impl Fake {
    /// Sends the boot-up message and starts the heartbeat.
    pub fn start_bus(&mut self, now: Stamp<Host>) {
        let state = self.bus.state;
        self.bus = FakeBus::default();
        if state != NmtState::PreOperational {
            self.send_frame(
                &Heartbeat {
                    node: node(),
                    state: NmtState::BootUp,
                }
                .to_frame(),
                now,
            );
        }
    }

    pub fn next_of_bus(&self) -> Option<Stamp<Host>> {
        self.bus.next_heartbeat.or(self.fault_at.map(|(at, _)| at))
    }

    pub fn live_on_bus(&mut self, now: Stamp<Host>) {
        let period = i64::from(self.objects[&(0x1017, 0)]);
        if period == 0 || self.bus.silent {
            self.bus.next_heartbeat = None;
        } else if self.bus.next_heartbeat.is_none_or(|at| at <= now) {
            self.bus.next_heartbeat = Some(now + Span::from_millis(period));
            let state = self.bus.state;
            self.send_frame(
                &Heartbeat {
                    node: node(),
                    state,
                }
                .to_frame(),
                now,
            );
        }
        let entry = self.objects[&(0x1016, 1)];
        let limit = Span::from_millis(i64::from(entry & 0xFFFF));
        let observed = self.bus.host_heartbeat;
        if entry == 0 {
            self.bus.host_heartbeat = None;
        } else if observed.is_some_and(|at| now - at > limit) {
            self.bus.host_heartbeat = None;
            self.fault(0x8130, now);
        }
    }

    pub fn emergency(&mut self, code: u16, now: Stamp<Host>) {
        if self.bus.state == NmtState::Operational {
            self.send_frame(&Emergency::new(node(), code, 1).to_frame(), now);
        }
    }

    pub fn send_frame(&mut self, frame: &CanFrame, now: Stamp<Host>) {
        let at = now + Span::from_micros(150);
        self.send_at(frame.to_socketcan().to_vec(), at);
    }

    fn sync(&mut self, now: Stamp<Host>) {
        self.bus.syncs.push(now);
        let object = |entry| self.objects[&entry];
        let in_use = object((0x1800, 1)) & 1 << 31 == 0 && object((0x1800, 2)) == 1;
        if !in_use || self.bus.state != NmtState::Operational {
            return;
        }
        let at = now + self.bus.forth;
        let mut data = Vec::new();
        for sub in 1..=object((0x1A00, 0)) as u8 {
            let entry = MappedObject::from_u32(self.objects[&(0x1A00, sub)]);
            let value = match (entry.address.index, entry.address.sub) {
                (0x1013, 0) => device_us(at),
                _ => self
                    .get(entry.address, at)
                    .unwrap_or_else(|e: CommError| panic!("{e}")),
            };
            data.extend_from_slice(&value.to_le_bytes()[..usize::from(entry.bits / 8)]);
        }
        let id = Pdo::Transmit(PdoNumber::One).channel(node()).cob_id();
        let frame = CanFrame::new(id, &data).unwrap();
        let n = self.bus.streamed;
        self.bus.streamed += 1;
        for copy in 0..(self.bus.copies)(n) {
            let at = at + self.bus.back + Span::from_micros(100 * copy as i64);
            self.send_at(frame.to_socketcan().to_vec(), at);
        }
    }
}
