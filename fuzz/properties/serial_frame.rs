//! EPOS2 frames on serial lines: frames decode to what was encoded, noise destroys at most one
//! frame, the simulated unit answers with complete frames. Client and listener agree with the bytes
//! on the line ([`super::drive_link`], [`super::drive_log`]).

use firmware_sim::epos2::{Rs232Server, SimulatedDrive, SimulatedDriveConfig, UsbServer};
use protocol::epos2::message::{SerialAnswer, SerialRequest};
use protocol::epos2::rs232::{self, BodyDecoder};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{MAX_WORDS, SerialFrame, SerialFrameError};

use super::input::Input;
use super::{drive_link, drive_log};

/// The first byte selects the property.
pub fn holds(data: &[u8]) {
    let mut input = Input::new(data);
    match input.u8() % 8 {
        0 => usb_bytes(input.rest()),
        1 => usb_frame_behind_noise(&mut input),
        2 => rs232_bytes(&mut input),
        3 => rs232_frame(&mut input),
        4 => usb_server(&mut input),
        5 => rs232_server(&mut input),
        6 => {
            drive_link::holds(&mut input);
        }
        _ => drive_log::holds(&mut input),
    }
}

/// A frame of up to [`MAX_WORDS`] words.
fn frame(input: &mut Input<'_>) -> SerialFrame {
    let opcode = input.u8();
    let len = usize::from(input.u8()) % (MAX_WORDS + 1);
    let words: Vec<u16> = (0..len).map(|_| input.u16()).collect();
    SerialFrame::new(opcode, &words).expect("no more words than a frame has")
}

fn decode_usb(bytes: &[u8]) -> Vec<Result<SerialFrame, SerialFrameError>> {
    let mut decoder = UsbDecoder::new();
    let pushed = bytes.iter().map(|&byte| decoder.push(byte));
    pushed.flatten().collect()
}

/// Any bytes: each decoded frame encodes to the same bytes.
fn usb_bytes(bytes: &[u8]) {
    let mut decoder = UsbDecoder::new();
    for (end, &byte) in (1..).zip(bytes) {
        if let Some(Ok(frame)) = decoder.push(byte) {
            let again = usb::to_bytes(&frame);
            assert!(bytes[..end].ends_with(&again), "{again:X?}");
            assert_eq!(decode_usb(&again), [Ok(frame)]);
            read_message(&frame);
        }
    }
}

/// Any frame can be read as a message, and an answer encodes to the same frame.
fn read_message(frame: &SerialFrame) {
    if let Ok(answer) = SerialAnswer::parse(frame) {
        assert_eq!(answer.to_frame(), *frame);
    }
    if let Ok(Some(SerialRequest::ReadObject(read))) = SerialRequest::parse(frame) {
        assert_eq!(read.to_frame(), *frame);
    }
    if let Ok(Some(SerialRequest::WriteObject(write))) = SerialRequest::parse(frame) {
        assert_eq!(write.to_frame(), *frame);
    }
}

/// Noise may end in the first half of a pair and destroy the start of one frame, never of two.
fn usb_frame_behind_noise(input: &mut Input<'_>) {
    let frame = frame(input);
    let whole = usb::to_bytes(&frame);
    assert_eq!(decode_usb(&whole), [Ok(frame)]);
    let noise = input.rest();
    let bytes = [noise, &whole, &whole].concat();
    assert_eq!(decode_usb(&bytes).last(), Some(&Ok(frame)), "{noise:X?}");
    if noise.last() != Some(&usb::DLE) {
        let bytes = [noise, &whole].concat();
        assert_eq!(decode_usb(&bytes).last(), Some(&Ok(frame)), "{noise:X?}");
    }
}

/// Any bytes as bodies of one opcode: a valid frame encodes to the same bytes, others are skipped.
fn rs232_bytes(input: &mut Input<'_>) {
    let opcode = input.u8();
    let bytes = input.rest();
    let mut decoder = BodyDecoder::new(opcode);
    for (end, &byte) in (1..).zip(bytes) {
        if let Some(Ok(frame)) = decoder.push(byte) {
            let mut again = Vec::new();
            rs232::encode_body(&frame, &mut again).expect("a body has words");
            assert!(bytes[..end].ends_with(&again), "{again:X?}");
            assert_eq!(frame.opcode, opcode);
            read_message(&frame);
        }
    }
}

fn rs232_frame(input: &mut Input<'_>) {
    let frame = frame(input);
    let mut body = Vec::new();
    if let Err(error) = rs232::encode_body(&frame, &mut body) {
        assert!(frame.words.is_empty() && body.is_empty(), "{error}");
        return;
    }
    let mut decoder = BodyDecoder::new(frame.opcode);
    // Twice: after a body the next one is expected.
    for _ in 0..2 {
        let got: Vec<_> = body.iter().filter_map(|&byte| decoder.push(byte)).collect();
        assert_eq!(got, [Ok(frame)]);
    }
}

/// Events of a simulated unit between bytes.
fn pass_time(node: &mut SimulatedDrive, input: &mut Input<'_>) {
    match input.u8() {
        long @ 0xF0.. => (0..50 * u32::from(long & 0xF)).for_each(|_| node.tick()),
        0x80.. => node.tick(),
        short => node.set_phase_us(8 * u32::from(short)),
    }
}

/// Requests of any content and framing: at most one answer per request, each a complete frame.
fn usb_server(input: &mut Input<'_>) {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    let mut server = UsbServer::new(1);
    while !input.is_empty() {
        pass_time(&mut node, input);
        let raw;
        let framed;
        let bytes: &[u8] = if input.u8() & 1 == 0 {
            raw = input.short();
            raw
        } else {
            framed = usb::to_bytes(&frame(input));
            &framed
        };
        let mut answers = 0;
        server.input(&mut node, bytes, &mut |answer| {
            answers += 1;
            let [Ok(frame)] = decode_usb(answer)[..] else {
                panic!("no whole frame: {answer:X?}");
            };
            SerialAnswer::parse(&frame).expect("an answer");
        });
        // The shortest frame has two bytes of sync, two of head and two of checksum.
        assert!(answers <= bytes.len() / 4 + 1);
    }
}

/// Any bytes: the unit sends handshakes, announcements of an answer, and complete bodies only.
fn rs232_server(input: &mut Input<'_>) {
    let mut node = SimulatedDrive::new(SimulatedDriveConfig::default());
    let mut server = Rs232Server::new(1);
    while !input.is_empty() {
        pass_time(&mut node, input);
        let choice = input.u8();
        if choice & 1 == 0 {
            let bytes = input.short();
            say_rs232(&mut server, &mut node, bytes);
        } else {
            let frame = frame(input);
            let mut body = Vec::new();
            if rs232::encode_body(&frame, &mut body).is_ok() {
                say_rs232(&mut server, &mut node, &[frame.opcode]);
                say_rs232(&mut server, &mut node, &body);
                say_rs232(&mut server, &mut node, b"OO");
            }
        }
    }
}

fn say_rs232(server: &mut Rs232Server, node: &mut SimulatedDrive, bytes: &[u8]) {
    let mut decoded = 0;
    server.input(node, bytes, &mut |chunk| {
        decoded += 1;
        if let [byte] = chunk {
            assert!([rs232::OKAY, rs232::FAILED, SerialFrame::ANSWER].contains(byte));
            return;
        }
        let mut decoder = BodyDecoder::new(SerialFrame::ANSWER);
        let got: Vec<_> = chunk
            .iter()
            .filter_map(|&byte| decoder.push(byte))
            .collect();
        let [Ok(frame)] = got[..] else {
            panic!("no whole body: {chunk:X?}");
        };
        SerialAnswer::parse(&frame).expect("an answer");
    });
    assert!(
        decoded <= 2 * bytes.len(),
        "a handshake and an announcement"
    );
}
