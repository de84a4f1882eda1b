//! SDO on both ends: the client accepts only answers to its request, the simulated unit answers
//! every request, and both survive any frame of the bus at any time.

use firmware_sim::epos2::{CanServer, Node, NodeConfig, UsbServer};
use protocol::canopen::sdo::{
    Expedited, FrameDisposition, Initiate, SdoClient, SdoOutcome, SdoRequest, SdoResponse,
    SdoSegment, SdoValue, TransferDirection, TransferError,
};
use protocol::canopen::{BusMessage, CanFrame, CommunicationObject, NodeId};
use protocol::epos2::message::{ReadObject, SerialAnswer as UsbAnswer, WriteObject};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{CommError, SerialFrame};
use units::{Host, Span, Stamp};

use super::can_frames;
use super::input::Input;

/// Buffer of the client under test, small enough that objects exceed it.
const ROOM: usize = 24;
const TIMEOUT: Span = Span::from_millis(20);

/// Mode 0: the client and scripted answers. 1: the unit and any frames. Else the client and the
/// unit, compared with its USB interface.
pub fn holds(data: &[u8]) {
    let mut input = Input::new(data);
    match input.u8() % 3 {
        0 => client(&mut input),
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

/// A client with its request, its frames, and its answers.
struct ClientUnderTest {
    client: SdoClient<ROOM>,
    now: Stamp<Host>,
    address: Address,
    data: Vec<u8>,
    sent: Vec<SdoRequest>,
    taken: Vec<SdoResponse>,
}

fn client(input: &mut Input<'_>) {
    let mut client = ClientUnderTest {
        client: SdoClient::new(node_1(), TIMEOUT),
        now: Stamp::from_nanos(0),
        address: Address::default(),
        data: Vec::new(),
        sent: Vec::new(),
        taken: Vec::new(),
    };
    while !input.is_empty() {
        client.act(input);
    }
    client.finish();
}

impl ClientUnderTest {
    fn act(&mut self, input: &mut Input<'_>) {
        match input.u8() % 8 {
            0 => self.read(address(input)),
            1 => self.write(address(input), input),
            2 => self.transmit(),
            3 => {
                self.now += Span::from_millis((input.u8() & 0x1F).into());
                self.client.handle_timeout(self.now);
            }
            4 if input.u8() & 7 == 0 => self.client.cancel(),
            _ => {
                let frame = self.answer(input);
                self.receive(&frame);
            }
        }
        // Fetched at once or later.
        if input.u8() & 3 != 0 {
            self.fetch();
        }
    }

    fn read(&mut self, address: Address) {
        if self.client.read(address).is_ok() {
            self.begin(address, &[]);
        }
    }

    fn write(&mut self, address: Address, input: &mut Input<'_>) {
        let len = usize::from(input.u8()) % (ROOM + 2);
        let data = input.take(len);
        let started = self.client.write(address, data);
        assert!(started.is_err() || data.len() <= ROOM);
        if started.is_ok() {
            self.begin(address, data);
        }
    }

    fn begin(&mut self, address: Address, data: &[u8]) {
        self.address = address;
        self.data = data.to_vec();
        self.sent.clear();
        self.taken.clear();
    }

    fn transmit(&mut self) {
        while let Some(frame) = self.client.poll_transmit(self.now) {
            let (node, request) = SdoRequest::parse(&frame).expect("a request");
            assert_eq!(node, node_1());
            // An abort belongs to the transfer before.
            if !matches!(request, SdoRequest::Abort { .. }) {
                self.sent.push(request);
            }
        }
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
                error: CommError(input.u32()),
            },
        };
        answer.to_frame(node_1())
    }

    fn receive(&mut self, frame: &CanFrame) {
        let was_busy = self.client.is_busy();
        let handled = self.client.handle_frame(frame);
        let answer = SdoResponse::parse(frame).ok().map(|(_, answer)| answer);
        match handled {
            FrameDisposition::Foreign => {
                assert_ne!(
                    frame.cob_id(),
                    Some(CommunicationObject::SdoResponse(node_1()).cob_id())
                );
            }
            FrameDisposition::Accepted => {
                assert!(was_busy);
                let Some(answer) = answer else {
                    // No SDO message: the transfer has failed.
                    assert!(!self.client.is_busy());
                    return;
                };
                let other = answer.address().is_some_and(|got| got != self.address);
                assert!(
                    !other || !self.client.is_busy(),
                    "an answer about {:?}",
                    answer.address()
                );
                self.taken.push(answer);
            }
            FrameDisposition::Stale => {}
            FrameDisposition::Unsolicited => assert!(!was_busy || !self.was_sent()),
        }
    }

    /// Whether all requests were sent.
    fn was_sent(&self) -> bool {
        let mut client = self.client.clone();
        client.poll_transmit(self.now).is_none()
    }

    fn fetch(&mut self) {
        let Some(SdoOutcome {
            address,
            direction,
            result,
        }) = self.client.poll_outcome()
        else {
            return;
        };
        assert!(!self.client.is_busy());
        assert_eq!(address, self.address);
        match (direction, result) {
            (TransferDirection::Upload, Ok(value)) => self.was_read(&value),
            (TransferDirection::Download, Ok(value)) => {
                assert!(value.bytes.is_empty());
                self.was_written();
            }
            (_, Err(TransferError::Aborted(error))) => {
                let Some(SdoResponse::Abort {
                    address,
                    error: got,
                }) = self.taken.last()
                else {
                    panic!("no side aborted");
                };
                assert_eq!((*address, *got), (self.address, error));
            }
            (_, Err(_)) => {}
        }
    }

    /// Checks a read value against a second implementation.
    fn was_read(&self, value: &SdoValue<ROOM>) {
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
        assert_eq!(*value.bytes, expected[..]);
        assert_eq!(value.sized, !matches!(transfer, Initiate::Unsized(_)));
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

    /// Checks that every transfer ends without further frames.
    fn finish(&mut self) {
        self.transmit();
        if let Some(deadline) = self.client.poll_timeout() {
            self.client.handle_timeout(deadline);
        }
        assert!(!self.client.is_busy());
        self.fetch();
    }
}

/// The unit between any frames and any time spans.
fn server(input: &mut Input<'_>) {
    let mut node = Node::new(NodeConfig::default());
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
            error: CommError::GENERAL,
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

fn pass_time(node: &mut Node, server: &mut CanServer, choice: u8) {
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
    node: &mut Node,
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

/// The client and the unit directly connected: each object equals that of the unit's USB interface.
fn dialogue(input: &mut Input<'_>) {
    let mut node = Node::new(NodeConfig::default());
    let mut server = CanServer::new();
    let mut client = SdoClient::<ROOM>::new(node_1(), TIMEOUT);
    while !input.is_empty() {
        pass_time(&mut node, &mut server, input.u8() & 0x3F);
        let choice = input.u8();
        let address = address(input);
        if choice & 3 != 0 {
            client.read(address).expect("nothing under way");
            let got = exchange(&mut client, &mut node, &mut server);
            read_is_the_same(&mut node, address, &got);
        } else {
            let data = input.take(usize::from(choice >> 2) % 9);
            // The node's id and bit rate stay unchanged.
            if matches!(address.index, 0x2000 | 0x1010 | 0x1011) {
                continue;
            }
            let mut twin = node.clone();
            client.write(address, data).expect("nothing under way");
            let got = exchange(&mut client, &mut node, &mut server);
            write_is_the_same(&mut twin, address, data, &got);
        }
    }
}

type Exchanged = Result<SdoValue<ROOM>, TransferError>;

fn exchange(client: &mut SdoClient<ROOM>, node: &mut Node, server: &mut CanServer) -> Exchanged {
    let now = Stamp::from_nanos(0);
    // The longest object has ten segments.
    for _ in 0..16 {
        while let Some(frame) = client.poll_transmit(now) {
            let mut answers = Vec::new();
            server.input(node, &frame, &mut |answer| answers.push(*answer));
            for answer in &answers {
                client.handle_frame(answer);
            }
        }
        if let Some(outcome) = client.poll_outcome() {
            return outcome.result;
        }
    }
    // The write silenced the node.
    client.cancel();
    while client.poll_transmit(now).is_some() {}
    client.poll_outcome().expect("a cancelled transfer").result
}

fn usb(node: &mut Node, request: &SerialFrame) -> UsbAnswer {
    let mut answer = None;
    let mut decoder = UsbDecoder::new();
    UsbServer::new(0).input(node, &usb::to_bytes(request), &mut |bytes| {
        let frame = bytes.iter().find_map(|&byte| decoder.push(byte));
        let frame = frame.and_then(Result::ok).expect("a whole frame");
        answer = UsbAnswer::parse(&frame).ok();
    });
    answer.expect("an answer")
}

fn read_is_the_same(node: &mut Node, address: Address, got: &Exchanged) {
    let request = ReadObject { node: 0, address }.to_frame();
    let answer = usb(node, &request);
    match got {
        Ok(value) if value.bytes.len() <= 4 => {
            assert_eq!(answer.error, CommError::NONE, "{address:?}");
            let words = answer.value().expect("a value").to_le_bytes();
            assert_eq!(*value.bytes, words[..value.bytes.len()], "{address:?}");
        }
        Err(TransferError::Aborted(error)) => assert_eq!(answer.error, *error, "{address:?}"),
        // Longer than the interface's or the client's buffer, or the unit is silent.
        _ => {}
    }
}

fn write_is_the_same(twin: &mut Node, address: Address, data: &[u8], got: &Exchanged) {
    if got.is_err() || data.len() > 4 || data.is_empty() {
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
    assert_eq!(usb(twin, &request).error, CommError::NONE, "{address:?}");
    if address == objects::TARGET_POSITION.address {
        let read = ReadObject { node: 0, address }.to_frame();
        assert_eq!(usb(twin, &read).value(), Ok(value));
    }
}
