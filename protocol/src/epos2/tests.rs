//! Frames captured from a real drive and from maxon's guide, both ways, and properties of the
//! framing.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;

use super::message::{
    GatewayNmt, InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, ReadSegment,
    RequestCanFrame, SegmentedRead, SegmentedWrite, SendCanFrame, SerialAnswer, SerialRequest,
    WriteObject, WriteSegment,
};
use super::objects::{self, Address};
use super::rs232::{self, BodyDecoder};
use super::usb::{self, UsbDecoder};
use super::{AbortCode, BoundedVec, MAX_WORDS, SerialFrame, SerialFrameError, SerialLayer};

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|byte| u8::from_str_radix(byte, 16).unwrap())
        .collect()
}

fn decode_all(bytes: &[u8]) -> Vec<Result<SerialFrame, SerialFrameError>> {
    let mut decoder = UsbDecoder::new();
    bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .collect()
}

fn read(address: Address) -> SerialFrame {
    ReadObject { node: 1, address }.to_frame()
}

fn answer(value: u32) -> SerialFrame {
    ReadObject::answer(Ok(value))
}

/// Each golden USB frame with the message it is.
fn usb_frames() -> Vec<(&'static str, SerialFrame)> {
    let refused = AbortCode::NO_OBJECT;
    let mut in_four = SerialAnswer::bare(refused);
    in_four.data.extend([0, 0]);
    std::vec![
        (
            "90 02 10 02 41 60 00 01 64 CF",
            read(objects::STATUSWORD.address)
        ),
        ("90 02 00 04 00 00 00 00 37 02 00 00 68 00", answer(0x0237)),
        (
            "90 02 10 02 64 60 00 01 52 A2",
            read(objects::POSITION_ACTUAL.address)
        ),
        (
            "90 02 11 04 40 60 00 01 0F 00 00 00 2D 2C",
            WriteObject {
                node: 1,
                address: objects::CONTROLWORD.address,
                value: 0x000F
            }
            .to_frame(),
        ),
        ("90 02 00 02 00 00 00 00 40 8B", WriteObject::answer(Ok(()))),
        (
            "90 02 00 02 00 00 02 06 A4 01",
            ReadObject::answer(Err(refused))
        ),
        (
            "90 02 00 04 00 00 02 06 00 00 00 00 57 64",
            in_four.to_frame()
        ),
        (
            "90 02 10 02 81 20 00 01 0F 87",
            read(objects::HOME_POSITION.address)
        ),
        (
            "90 02 00 04 00 00 00 00 00 00 90 90 80 14 35",
            answer(0x8090_0000)
        ),
    ]
}

#[test]
fn usb_frames_match_golden_bytes_in_both_directions() {
    for (bytes, frame) in usb_frames() {
        assert_eq!(usb::to_bytes(&frame).as_slice(), hex(bytes), "{bytes}");
        assert_eq!(decode_all(&hex(bytes)), [Ok(frame)], "{bytes}");
    }
}

#[test]
fn rs232_frames_match_golden_bytes_in_both_directions() {
    let frames = [
        ("01 41 60 00 01 AB F0", read(objects::STATUSWORD.address)),
        ("03 00 00 00 00 37 02 00 00 19 80", answer(0x0237)),
        (
            "03 40 60 00 01 0F 00 00 00 52 EF",
            WriteObject {
                node: 1,
                address: objects::CONTROLWORD.address,
                value: 0x000F,
            }
            .to_frame(),
        ),
    ];
    for (bytes, frame) in frames {
        let mut out = Vec::new();
        rs232::encode_body(&frame, &mut out).unwrap();
        assert_eq!(out, hex(bytes));
        let mut decoder = BodyDecoder::new(frame.opcode);
        let decoded: Vec<_> = hex(bytes)
            .into_iter()
            .filter_map(|byte| decoder.push(byte))
            .collect();
        assert_eq!(decoded, [Ok(frame)]);
    }
}

#[test]
fn golden_answers_are_interpreted_correctly() {
    let frames = usb_frames();
    let (refused, in_four, stuffed) = (frames[5], frames[6], frames[8]);
    for (_, frame) in [refused, in_four] {
        assert_eq!(
            ReadObject::parse_answer(&frame),
            Ok(Err(AbortCode::NO_OBJECT))
        );
        assert_eq!(
            WriteObject::parse_answer(&frame),
            Ok(Err(AbortCode::NO_OBJECT))
        );
    }
    assert_eq!(ReadObject::parse_answer(&stuffed.1), Ok(Ok(0x8090_0000)));
}

#[test]
fn escape_bytes_are_handled_at_every_position() {
    // Opcode, length (0x90 words are too many, so not there), each data byte and both CRC bytes in
    // turn.
    let mut seen_in_crc = [false; 2];
    for opcode in [0x10, 0x90] {
        for position in 0..8 {
            for filler in 0..=255u8 {
                let mut data = [filler; 8];
                data[position] = 0x90;
                let words: Vec<u16> = data
                    .chunks(2)
                    .map(|b| u16::from_le_bytes([b[0], b[1]]))
                    .collect();
                let frame = SerialFrame::new(opcode, &words).unwrap();
                let bytes = usb::to_bytes(&frame);
                assert_eq!(decode_all(&bytes), [Ok(frame)]);
                let [.., a, b] = bytes.as_slice() else {
                    panic!()
                };
                seen_in_crc[1] |= [*a, *b] == [0x90, 0x90];
                let [.., a, b, _] = bytes.as_slice() else {
                    panic!()
                };
                seen_in_crc[0] |= [*a, *b] == [0x90, 0x90];
            }
        }
    }
    assert_eq!(seen_in_crc, [true; 2], "no frame had 0x90 in its CRC");
}

#[test]
fn a_sync_pair_restarts_a_frame_at_any_point() {
    for (bytes, frame) in usb_frames() {
        let whole = hex(bytes);
        for cut in 0..whole.len() {
            let mut stream = whole[..cut].to_vec();
            // Cut between an escape and its double, the new sync pair completes the double and
            // cannot be distinguished.
            let open_escape = decoder_after(&stream).is_none();
            stream.extend(&whole);
            let mut got = decode_all(&stream);
            let last = got.pop();
            if open_escape && cut > 1 {
                assert_ne!(last, Some(Ok(frame)));
                let mut decoder = UsbDecoder::new();
                let after: Vec<_> = [stream, whole.clone()]
                    .concat()
                    .into_iter()
                    .filter_map(|b| decoder.push(b))
                    .collect();
                assert_eq!(
                    after.last(),
                    Some(&Ok(frame)),
                    "the decoder did not resynchronise"
                );
                continue;
            }
            assert_eq!(last, Some(Ok(frame)), "cut at {cut} of {bytes}");
            assert!(
                got.iter()
                    .all(|e| matches!(e, Err(SerialFrameError::BrokenOff { .. })))
            );
            assert_eq!(got.len(), usize::from(cut > 1));
        }
    }
}

/// `None` if the bytes end with an open escape inside a frame.
fn decoder_after(bytes: &[u8]) -> Option<UsbDecoder> {
    let mut decoder = UsbDecoder::new();
    for &byte in bytes {
        decoder.push(byte);
    }
    let mut probe = decoder.clone();
    let open = probe.is_within_frame()
        && matches!(
            probe.push(0x55),
            Some(Err(SerialFrameError::Stuffing { .. }))
        );
    (!open).then_some(decoder)
}

#[test]
fn errors_name_layer_offset_and_values() {
    assert_eq!(
        decode_all(&hex("90 02 10 02 41 60 00 01 64 CE")),
        [Err(SerialFrameError::Crc {
            layer: SerialLayer::Usb,
            offset: 6,
            expected: 0xCF64,
            got: 0xCE64
        })]
    );
    assert_eq!(
        decode_all(&hex("90 02 10 41")),
        [Err(SerialFrameError::TooLong {
            layer: SerialLayer::Usb,
            offset: 1,
            max: MAX_WORDS,
            got: 0x41
        })]
    );
    assert_eq!(
        decode_all(&hex("90 02 10 02 41 90 41")),
        [Err(SerialFrameError::Stuffing {
            layer: SerialLayer::Usb,
            offset: 3,
            got: 0x41
        })]
    );
    assert_eq!(
        SerialAnswer::parse(&read(objects::STATUSWORD.address)),
        Err(SerialFrameError::Opcode {
            layer: SerialLayer::Message,
            expected: 0,
            got: 0x10
        })
    );
    assert_eq!(
        ReadObject::parse_answer(&WriteObject::answer(Ok(()))),
        Err(SerialFrameError::WordCount {
            layer: SerialLayer::Message,
            expected: 4,
            got: 2
        })
    );
    assert_eq!(
        SerialFrame::new(0, &[0; MAX_WORDS + 1]),
        Err(SerialFrameError::TooLong {
            layer: SerialLayer::Message,
            offset: 1,
            max: MAX_WORDS,
            got: MAX_WORDS + 1
        })
    );
    let mut out = Vec::new();
    assert!(rs232::encode_body(&SerialFrame::new(0x10, &[]).unwrap(), &mut out).is_err());
    assert!(out.is_empty());
}

fn address() -> impl Strategy<Value = Address> {
    (any::<u16>(), any::<u8>()).prop_map(|(index, sub)| Address { index, sub })
}

fn segment_bytes() -> impl Strategy<Value = BoundedVec<u8, 63>> {
    prop::collection::vec(any::<u8>(), 0..=63).prop_map(|b| BoundedVec::from_slice(&b).unwrap())
}

fn request() -> impl Strategy<Value = SerialRequest> {
    prop_oneof![
        (any::<u8>(), address())
            .prop_map(|(node, address)| SerialRequest::ReadObject(ReadObject { node, address })),
        (any::<u8>(), address(), any::<u32>()).prop_map(|(node, address, value)| {
            SerialRequest::WriteObject(WriteObject {
                node,
                address,
                value,
            })
        }),
        (any::<u8>(), address()).prop_map(|(node, address)| SerialRequest::InitiateSegmentedRead(
            InitiateSegmentedRead { node, address }
        )),
        (any::<u8>(), address(), any::<u32>()).prop_map(|(node, address, len)| {
            SerialRequest::InitiateSegmentedWrite(InitiateSegmentedWrite { node, address, len })
        }),
        any::<bool>().prop_map(|toggle| SerialRequest::SegmentedRead(SegmentedRead { toggle })),
        (any::<bool>(), segment_bytes()).prop_map(|(toggle, bytes)| SerialRequest::SegmentedWrite(
            SegmentedWrite(WriteSegment { toggle, bytes })
        )),
        (any::<u16>(), any::<u16>()).prop_map(|(node, cs)| SerialRequest::GatewayNmt(GatewayNmt {
            node,
            specifier: cs
        })),
        (any::<u16>(), any::<u16>(), any::<[u8; 8]>()).prop_map(|(cob_id, len, data)| {
            SerialRequest::SendCanFrame(SendCanFrame { cob_id, len, data })
        }),
        (any::<u16>(), any::<u16>()).prop_map(|(cob_id, len)| SerialRequest::RequestCanFrame(
            RequestCanFrame { cob_id, len }
        )),
    ]
}

proptest! {
    #[test]
    fn usb_frames_round_trip(opcode: u8, words in prop::collection::vec(any::<u16>(), 0..=MAX_WORDS)) {
        let frame = SerialFrame::new(opcode, &words).unwrap();
        prop_assert_eq!(decode_all(&usb::to_bytes(&frame)), [Ok(frame)]);
    }

    #[test]
    fn frames_with_heavy_stuffing_round_trip(
        opcode in prop::sample::select(&[0x00u8, 0x02, 0x90][..]),
        bytes in prop::collection::vec(prop::sample::select(&[0x90u8, 0x02, 0x00][..]), 0..=2 * MAX_WORDS),
    ) {
        let words: Vec<u16> = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        let frame = SerialFrame::new(opcode, &words).unwrap();
        prop_assert_eq!(decode_all(&usb::to_bytes(&frame)), [Ok(frame)]);
    }

    #[test]
    fn rs232_frames_round_trip(opcode: u8, words in prop::collection::vec(any::<u16>(), 1..=MAX_WORDS)) {
        let frame = SerialFrame::new(opcode, &words).unwrap();
        let mut bytes = Vec::new();
        rs232::encode_body(&frame, &mut bytes).unwrap();
        let mut decoder = BodyDecoder::new(opcode);
        let got: Vec<_> = bytes.into_iter().filter_map(|byte| decoder.push(byte)).collect();
        prop_assert_eq!(got, [Ok(frame)]);
    }

    #[test]
    fn the_second_frame_after_arbitrary_bytes_is_found(
        junk in prop::collection::vec(prop_oneof![3 => any::<u8>(), 1 => Just(0x90), 1 => Just(0x02)], 0..600),
        words in prop::collection::vec(any::<u16>(), 0..8),
    ) {
        let frame = SerialFrame::new(0, &words).unwrap();
        let mut stream = junk;
        stream.extend_from_slice(&usb::to_bytes(&frame));
        stream.extend_from_slice(&usb::to_bytes(&frame));
        let all = decode_all(&stream);
        prop_assert_eq!(all.last(), Some(&Ok(frame)));
    }

    #[test]
    fn flipped_bits_are_detected(
        words in prop::collection::vec(any::<u16>(), 1..8),
        bit in any::<prop::sample::Index>(),
    ) {
        let frame = SerialFrame::new(0, &words).unwrap();
        let mut bytes = usb::to_bytes(&frame).to_vec();
        // After the length: a frame of another length has a valid CRC once in 65536.
        let bit = 32 + bit.index(8 * (bytes.len() - 4));
        bytes[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(decode_all(&bytes).iter().all(Result::is_err));
    }

    #[test]
    fn requests_round_trip(request in request()) {
        prop_assert_eq!(SerialRequest::parse(&request.to_frame()), Ok(Some(request)));
    }

    #[test]
    fn arbitrary_frames_parse_or_give_an_error(opcode: u8, words in prop::collection::vec(any::<u16>(), 0..=MAX_WORDS)) {
        let frame = SerialFrame::new(opcode, &words).unwrap();
        if let Ok(Some(request)) = SerialRequest::parse(&frame) {
            prop_assert_eq!(request.to_frame().opcode, opcode);
        }
        let _ = (
            ReadObject::parse_answer(&frame), WriteObject::parse_answer(&frame), SegmentedRead::parse_answer(&frame),
            SegmentedWrite::parse_answer(&frame), RequestCanFrame::parse_answer(&frame),
        );
    }

    #[test]
    fn answers_round_trip(value: u32, toggle: bool, more: bool, bytes in segment_bytes(), data: [u8; 8], code in 1u32..) {
        let error = AbortCode(code);
        prop_assert_eq!(ReadObject::parse_answer(&ReadObject::answer(Ok(value))), Ok(Ok(value)));
        prop_assert_eq!(ReadObject::parse_answer(&ReadObject::answer(Err(error))), Ok(Err(error)));
        prop_assert_eq!(WriteObject::parse_answer(&WriteObject::answer(Err(error))), Ok(Err(error)));
        let segment = Ok(ReadSegment { toggle, more, bytes });
        prop_assert_eq!(SegmentedRead::parse_answer(&SegmentedRead::answer(&segment)), Ok(segment));
        prop_assert_eq!(SegmentedRead::parse_answer(&SegmentedRead::answer(&Err(error))), Ok(Err(error)));
        prop_assert_eq!(SegmentedWrite::parse_answer(&SegmentedWrite::answer(Ok(toggle))), Ok(Ok(toggle)));
        prop_assert_eq!(RequestCanFrame::parse_answer(&RequestCanFrame::answer(Ok(data))), Ok(Ok(data)));
    }
}
