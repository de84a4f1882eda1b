//! SDO on both ends: a transfer accepts only answers to its request, the simulated unit answers
//! every request, and both survive any frame of the bus at any time.

use firmware_sim::epos2::{CanServer, SimulatedDrive, SimulatedDriveConfig, UsbServer};
use protocol::BoundedVec;
use protocol::canopen::sdo::{
    Expedited, Initiate, SEGMENT_LEN, SdoRequest, SdoResponse, SdoSegment, SdoTransfer,
    TransferError, TransferStep,
};
use protocol::canopen::{BusMessage, CanFrame, CommunicationObject, NodeId};
use protocol::epos2::message::{ReadObject, SerialAnswer as UsbAnswer, WriteObject};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{AbortCode, SerialFrame};

use super::can_frames;
use super::input::Input;

/// Buffer of the transfer under test, small enough that objects exceed it.
const ROOM: usize = 24;

/// Mode 0: a transfer and scripted answers. 1: the unit and any frames. Else transfers with the
/// unit, compared with its USB interface.
pub fn holds(data: &[u8]) {
    let mut input = Input::new(data);
    match input.u8() % 3 {
        0 => transfer(&mut input),
        1 => server(&mut input),
        _ => dialogue(&mut input),
    }
}

fn node_1() -> NodeId {
    NodeId::new(1).expect("an id")
}

/// Objects of every kind, and invalid ones.
fn address(input: &mut Input<'_>) -> Address {
    const KNOWN: [(u16, u8); 13] = [
        (0x6064, 0),
        (0x6041, 0),
        (0x1008, 0),
        (0x1018, 1),
        (0x1003, 0),
        (0x2003, 1),
        (0x2004, 0),
        (0x2078, 1),
        (0x1A00, 1),
        (0x1800, 1),
        (0x1016, 1),
        (0x1013, 0),
        (0x607A, 0),
    ];
    let choice = input.u8();
    match KNOWN.get(usize::from(choice) % 16) {
        Some(&(index, sub)) => Address::new(index, sub),
        None => Address::new(input.u16(), input.u8()),
    }
}

/// A transfer with its requests and answers.
#[derive(Default)]
struct TransferUnderTest {
    transfer: Option<SdoTransfer<ROOM>>,
    /// The request to send next.
    request: Option<SdoRequest>,
    address: Address,
    data: Vec<u8>,
    is_read: bool,
    sent: Vec<SdoRequest>,
    taken: Vec<SdoResponse>,
}

fn transfer(input: &mut Input<'_>) {
    let mut transfer = TransferUnderTest::default();
    while !input.is_empty() {
        transfer.act(input);
    }
}

impl TransferUnderTest {
    fn act(&mut self, input: &mut Input<'_>) {
        match input.u8() % 4 {
            0 => {
                self.address = address(input);
                self.is_read = true;
                self.begin(SdoTransfer::upload(self.address), &[]);
            }
            1 => self.write(input),
            2 => self.sent.extend(self.request.take()),
            _ => {
                let frame = self.answer(input);
                self.receive(&frame);
            }
        }
    }

    fn write(&mut self, input: &mut Input<'_>) {
        let address = address(input);
        let len = usize::from(input.u8()) % (ROOM + 2);
        let data = input.take(len);
        match SdoTransfer::download(address, data, SEGMENT_LEN) {
            Ok(started) => {
                assert!(data.len() <= ROOM);
                self.address = address;
                self.is_read = false;
                self.begin(started, data);
            }
            Err(error) => {
                let (max, got) = (ROOM, data.len());
                assert_eq!(error, TransferError::TooLong { max, got });
                assert!(got > max);
            }
        }
    }

    fn begin(&mut self, (transfer, request): (SdoTransfer<ROOM>, SdoRequest), data: &[u8]) {
        self.transfer = Some(transfer);
        self.request = Some(request);
        self.data = data.to_vec();
        self.sent.clear();
        self.taken.clear();
    }

    /// An answer that fits, nearly fits, or does not fit.
    fn answer(&self, input: &mut Input<'_>) -> CanFrame {
        let choice = input.u8();
        let toggle = choice & 0x80 != 0;
        let address = if choice & 0x40 != 0 {
            address(input)
        } else {
            self.address
        };
        let answer = match choice % 8 {
            0 => return can_frames::frame(input),
            1 => {
                let mut bytes = [0; 8];
                bytes.iter_mut().for_each(|byte| *byte = input.u8());
                SdoResponse::from_bytes(bytes)
            }
            2 => SdoResponse::InitiateUpload {
                address,
                transfer: match input.u8() % 8 {
                    0 => Initiate::Unsized(input.u32().to_le_bytes()),
                    1 => Initiate::Segmented { size: None },
                    2 => Initiate::Segmented {
                        size: Some(input.u32()),
                    },
                    3 | 4 => Initiate::Segmented {
                        size: Some(input.u8().into()),
                    },
                    5 => Initiate::Expedited(Expedited::of(input.u8())),
                    _ => Initiate::Expedited(Expedited::of(input.u32())),
                },
            },
            3 | 4 => {
                let head = input.u8();
                let mut segment = SdoSegment::cut(input.take(usize::from(head & 7)), 0, toggle, 7);
                segment.last = head & 8 != 0;
                SdoResponse::UploadSegment(segment)
            }
            5 => SdoResponse::InitiateDownload { address },
            6 => SdoResponse::DownloadSegment { toggle },
            _ => SdoResponse::Abort {
                address,
                error: AbortCode(input.u32()),
            },
        };
        answer.to_frame(node_1())
    }

    fn receive(&mut self, frame: &CanFrame) {
        let Ok((node, answer)) = SdoResponse::parse(frame) else {
            return;
        };
        let is_sent = self.request.is_none();
        let Some(mut transfer) = self.transfer.take_if(|_| is_sent && node == node_1()) else {
            return;
        };
        self.taken.push(answer);
        match transfer.handle_response(&answer) {
            Ok(TransferStep::Send(request)) => {
                assert!(answer.address().is_none_or(|got| got == self.address));
                self.transfer = Some(transfer);
                self.request = Some(request);
            }
            Ok(TransferStep::Done(value)) if self.is_read => self.was_read(&value),
            Ok(TransferStep::Done(value)) => {
                assert!(value.is_empty());
                self.was_written();
            }
            Err(TransferError::Aborted(error)) => {
                let address = self.address;
                assert_eq!(answer, SdoResponse::Abort { address, error });
            }
            Err(error) => assert!(error.abort_code().is_some()),
        }
    }

    /// Checks a read value against a second implementation.
    fn was_read(&self, value: &[u8]) {
        let [
            SdoResponse::InitiateUpload { address, transfer },
            segments @ ..,
        ] = &self.taken[..]
        else {
            panic!("read by {:?}", self.taken);
        };
        assert_eq!(*address, self.address);
        let mut expected: Vec<u8> = Vec::new();
        match transfer {
            Initiate::Expedited(data) => expected.extend(data.as_slice()),
            Initiate::Unsized(bytes) => expected.extend(bytes),
            Initiate::Segmented { size } => {
                for (n, answer) in segments.iter().enumerate() {
                    let SdoResponse::UploadSegment(segment) = answer else {
                        panic!("no segment: {answer:?}");
                    };
                    assert_eq!(segment.toggle, n % 2 == 1, "segment {n}");
                    assert_eq!(segment.last, n + 1 == segments.len());
                    expected.extend(segment.bytes.iter());
                }
                assert!(!segments.is_empty());
                assert!(size.is_none_or(|size| size as usize == expected.len()));
            }
        }
        assert!(segments.is_empty() || matches!(transfer, Initiate::Segmented { .. }));
        assert_eq!(value, expected);
    }

    /// Checks that the written value was sent completely and confirmed segment by segment.
    fn was_written(&self) {
        let [SdoResponse::InitiateDownload { address }, confirmed @ ..] = &self.taken[..] else {
            panic!("written by {:?}", self.taken);
        };
        assert_eq!(*address, self.address);
        for (n, answer) in confirmed.iter().enumerate() {
            let toggle = n % 2 == 1;
            assert_eq!(
                *answer,
                SdoResponse::DownloadSegment { toggle },
                "segment {n}"
            );
        }
        let mut written: Vec<u8> = Vec::new();
        for request in &self.sent {
            match request {
                SdoRequest::InitiateDownload {
                    transfer: Initiate::Expedited(data),
                    ..
                } => {
                    written.extend(data.as_slice());
                }
                SdoRequest::InitiateDownload { .. } => {}
                SdoRequest::DownloadSegment(segment) => written.extend(segment.bytes.iter()),
                other => panic!("{other:?} in a write"),
            }
        }
        assert_eq!(written, self.data);
        assert_eq!(self.sent.len(), self.taken.len());
    }
}

/// The unit between any frames and any time spans.
fn server(input: &mut Input<'_>) {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    let mut server = CanServer::new();
    // Other services may use the identifier of the answers; from then on they cannot be
    // distinguished.
    let mut distinguishable = true;
    while !input.is_empty() {
        match input.u8() % 4 {
            0 => pass_time(&mut node, &mut server, input.u8()),
            1 => {
                let request = request(input);
                check_request(&mut node, &mut server, &request, &mut distinguishable);
            }
            _ => {
                let frame = can_frames::frame(input);
                match SdoRequest::parse(&frame) {
                    Ok((to, request)) if to.get() == node.node_id() => {
                        check_request(&mut node, &mut server, &request, &mut distinguishable);
                    }
                    _ => server.input(&mut node, &frame, &mut |frame| is_whole(frame)),
                }
            }
        }
    }
}

fn request(input: &mut Input<'_>) -> SdoRequest {
    let choice = input.u8();
    let address = address(input);
    let toggle = choice & 0x80 != 0;
    match choice % 8 {
        0 | 1 => SdoRequest::InitiateUpload { address },
        2 => SdoRequest::UploadSegment { toggle },
        3 => SdoRequest::InitiateDownload {
            address,
            transfer: Initiate::Segmented {
                size: (!toggle).then(|| input.u8().into()),
            },
        },
        4 => {
            let mut segment =
                SdoSegment::cut(input.take(usize::from(choice >> 3 & 7)), 0, toggle, 7);
            segment.last = choice & 0x40 != 0;
            SdoRequest::DownloadSegment(segment)
        }
        5 => SdoRequest::Abort {
            address,
            error: AbortCode::GENERAL,
        },
        _ => {
            let len = usize::from(choice >> 3 & 3) + 1;
            let data = Expedited::new(input.take(len)).unwrap_or_else(|| Expedited::of(0_u8));
            SdoRequest::InitiateDownload {
                address,
                transfer: Initiate::Expedited(data),
            }
        }
    }
}

fn pass_time(node: &mut SimulatedDrive, server: &mut CanServer, choice: u8) {
    let cycles = match choice {
        long @ 0xF0.. => 100 * u32::from(long & 0xF),
        few => u32::from(few),
    };
    for _ in 0..cycles {
        node.tick();
        server.poll(node, &mut |frame| is_whole(frame));
    }
    node.set_phase_us(3 * u32::from(choice));
}

fn is_whole(frame: &CanFrame) {
    assert_eq!(CanFrame::from_socketcan(&frame.to_socketcan()), Ok(*frame));
}

/// A request has at most one answer, about its object.
fn check_request(
    node: &mut SimulatedDrive,
    server: &mut CanServer,
    request: &SdoRequest,
    distinguishable: &mut bool,
) {
    if let SdoRequest::InitiateDownload { address, .. } = request {
        // 1014, 1400 to 1BFF: identifiers of emergencies and process data. 2000: the node's id.
        *distinguishable &= !matches!(address.index, 0x1014 | 0x1400..=0x1BFF | 0x2000);
    }
    let Some(id) = NodeId::new(node.node_id()) else {
        return;
    };
    let mut answers = Vec::new();
    server.input(node, &request.to_frame(id), &mut |frame| {
        is_whole(frame);
        if *distinguishable {
            BusMessage::parse(frame).expect("a message of the predefined set");
        }
        if frame.cob_id() == Some(CommunicationObject::SdoResponse(id).cob_id()) {
            answers.push(*frame);
        }
    });
    if !*distinguishable {
        return;
    }
    let answers: Vec<_> = answers
        .iter()
        .map(|frame| SdoResponse::parse(frame).expect("an answer").1)
        .collect();
    let [answer] = answers[..] else {
        assert!(answers.is_empty(), "{answers:?} to {request:?}");
        return;
    };
    match (request, answer) {
        (
            SdoRequest::InitiateUpload { address },
            SdoResponse::InitiateUpload { address: got, .. },
        )
        | (SdoRequest::InitiateUpload { address }, SdoResponse::Abort { address: got, .. })
        | (
            SdoRequest::InitiateDownload { address, .. },
            SdoResponse::InitiateDownload { address: got },
        )
        | (SdoRequest::InitiateDownload { address, .. }, SdoResponse::Abort { address: got, .. }) =>
        {
            assert_eq!(*address, got);
        }
        (SdoRequest::UploadSegment { toggle }, SdoResponse::UploadSegment(segment)) => {
            assert_eq!(*toggle, segment.toggle);
        }
        (SdoRequest::DownloadSegment(segment), SdoResponse::DownloadSegment { toggle }) => {
            assert_eq!(segment.toggle, toggle);
        }
        (
            SdoRequest::UploadSegment { .. }
            | SdoRequest::DownloadSegment(_)
            | SdoRequest::Unknown(_),
            SdoResponse::Abort { .. },
        ) => {}
        _ => panic!("{answer:?} to {request:?}"),
    }
}

/// Transfers with the unit: each object equals that of the unit's USB interface.
fn dialogue(input: &mut Input<'_>) {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    let mut server = CanServer::new();
    while !input.is_empty() {
        pass_time(&mut node, &mut server, input.u8() & 0x3F);
        let choice = input.u8();
        let address = address(input);
        if choice & 3 != 0 {
            let got = exchange(SdoTransfer::upload(address), &mut node, &mut server);
            read_is_the_same(&mut node, address, &got);
        } else {
            let data = input.take(usize::from(choice >> 2) % 9);
            // The node's id and bit rate stay unchanged.
            if matches!(address.index, 0x2000 | 0x1010 | 0x1011) {
                continue;
            }
            let mut twin = node.clone();
            let started = SdoTransfer::download(address, data, SEGMENT_LEN).expect("room");
            let got = exchange(started, &mut node, &mut server);
            write_is_the_same(&mut twin, address, data, &got);
        }
    }
}

/// `None` if the unit is silent.
type Exchanged = Option<Result<BoundedVec<u8, ROOM>, TransferError>>;

fn exchange(
    (mut transfer, mut request): (SdoTransfer<ROOM>, SdoRequest),
    node: &mut SimulatedDrive,
    server: &mut CanServer,
) -> Exchanged {
    let mut send = |request: SdoRequest| {
        let mut response = None;
        server.input(node, &request.to_frame(node_1()), &mut |frame| {
            response = match SdoResponse::parse(frame) {
                Ok((from, response)) if from == node_1() => Some(response),
                _ => response,
            };
        });
        response
    };
    loop {
        match transfer.handle_response(&send(request)?) {
            Ok(TransferStep::Send(next)) => request = next,
            Ok(TransferStep::Done(value)) => return Some(Ok(value)),
            Err(error) => {
                if let Some(code) = error.abort_code() {
                    let address = transfer.address();
                    send(SdoRequest::Abort {
                        address,
                        error: code,
                    });
                }
                return Some(Err(error));
            }
        }
    }
}

fn usb(node: &mut SimulatedDrive, request: &SerialFrame) -> UsbAnswer {
    let mut answer = None;
    let mut decoder = UsbDecoder::new();
    UsbServer::new(0).input(node, &usb::to_bytes(request), &mut |bytes| {
        let frame = bytes.iter().find_map(|&byte| decoder.push(byte));
        let frame = frame.and_then(Result::ok).expect("a whole frame");
        answer = UsbAnswer::parse(&frame).ok();
    });
    answer.expect("an answer")
}

fn read_is_the_same(node: &mut SimulatedDrive, address: Address, got: &Exchanged) {
    let request = ReadObject { node: 0, address }.to_frame();
    let answer = usb(node, &request);
    match got {
        Some(Ok(value)) if value.len() <= 4 => {
            assert_eq!(answer.error, AbortCode::NONE, "{address:?}");
            let words = answer.value().expect("a value").to_le_bytes();
            assert_eq!(**value, words[..value.len()], "{address:?}");
        }
        Some(Err(TransferError::Aborted(error))) => {
            assert_eq!(answer.error, *error, "{address:?}");
        }
        // Longer than the interface's or the client's buffer, or the unit is silent.
        _ => {}
    }
}

fn write_is_the_same(twin: &mut SimulatedDrive, address: Address, data: &[u8], got: &Exchanged) {
    if !matches!(got, Some(Ok(_))) || data.len() > 4 || data.is_empty() {
        return;
    }
    let mut bytes = [0; 4];
    bytes[..data.len()].copy_from_slice(data);
    let value = u32::from_le_bytes(bytes);
    let request = WriteObject {
        node: 0,
        address,
        value,
    }
    .to_frame();
    assert_eq!(usb(twin, &request).error, AbortCode::NONE, "{address:?}");
    if address == objects::TARGET_POSITION.address {
        let read = ReadObject { node: 0, address }.to_frame();
        assert_eq!(usb(twin, &read).value(), Ok(value));
    }
}
