use proptest::prelude::*;
use protocol::epos2::AbortCode;
use protocol::epos2::rs232::{FAILED, OKAY};

use super::*;

const STATUSWORD: Address = Address::new(0x6041, 0);
const CONTROLWORD: Address = Address::new(0x6040, 0);

fn at(ms: i64) -> Stamp<Host> {
    Stamp::from_nanos(ms * 1_000_000)
}

fn encode(codec: &mut Codec, address: Address, access: ObjectAccess) -> Vec<u8> {
    codec.encode(address, access, at(500))
}

fn decode(bytes: &[u8]) -> Vec<DecodedFrame> {
    let mut codec = Codec::usb(1);
    bytes
        .chunks(1)
        .filter_map(|b| codec.push(b, at(0)))
        .collect()
}

fn shape(decoded: &[DecodedFrame]) -> Vec<(u32, usize, Option<u32>)> {
    decoded
        .iter()
        .map(|one| match one {
            DecodedFrame::Reply(Reply::Serial(reply)) => (reply.error.0, reply.words, reply.value),
            other => panic!("{other:?}"),
        })
        .collect()
}

/// Frames in the Communication Guide's format, CRC calculated independently.
#[test]
fn usb_requests_match_golden_bytes() {
    let mut codec = Codec::usb(1);
    assert_eq!(
        encode(&mut codec, STATUSWORD, ObjectAccess::Read),
        [0x90, 2, 0x10, 2, 0x41, 0x60, 0, 1, 0x64, 0xCF]
    );
    assert_eq!(
        encode(
            &mut codec,
            CONTROLWORD,
            ObjectAccess::Write {
                value: 0x0F,
                width: 2
            }
        ),
        [
            0x90, 2, 0x11, 4, 0x40, 0x60, 0, 1, 0x0F, 0, 0, 0, 0x2D, 0x2C
        ]
    );
}

#[test]
fn usb_answers_match_golden_bytes() {
    let read = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x37, 2, 0, 0, 0x68, 0];
    assert_eq!(shape(&decode(&read)), [(0, 2, Some(0x237))]);
    let written = [0x90, 2, 0, 2, 0, 0, 0, 0, 0x40, 0x8B];
    assert_eq!(shape(&decode(&written)), [(0, 0, None)]);
    let absent = [0x90, 2, 0, 2, 0, 0, 2, 6, 0xA4, 1];
    assert_eq!(shape(&decode(&absent)), [(0x0602_0000, 0, None)]);
}

#[test]
fn an_echo_is_not_an_answer() {
    let mut codec = Codec::usb(1);
    let echo = encode(&mut codec, STATUSWORD, ObjectAccess::Read);
    assert_eq!(decode(&echo), [DecodedFrame::Foreign]);
}

#[test]
fn a_wrong_checksum_is_reported() {
    let read = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x36, 2, 0, 0, 0x68, 0];
    assert_eq!(decode(&read), [DecodedFrame::Damaged]);
}

/// A known defect of other clients: reception fails if the last data byte, or any other, is 0x90.
#[test]
fn stuffing_is_handled_at_every_position() {
    for place in 0..4 {
        for others in [0u32, 0x0101_0101, 0x9090_9090, 0x0290_0290] {
            let value = others & !(0xFF << (8 * place)) | 0x90 << (8 * place);
            let bytes = usb::to_bytes(&ReadObject::answer(Ok(value)));
            assert_eq!(shape(&decode(&bytes)), [(0, 2, Some(value))]);
        }
    }
    // A checksum with 0x90 in either byte.
    let crc_byte = |place: usize| {
        (0u32..)
            .map(|value| (value, usb::to_bytes(&ReadObject::answer(Ok(value)))))
            .find(|(value, bytes)| {
                let doubled = bytes.iter().filter(|&&b| b == 0x90).count() == 3;
                let end = bytes.len() - 1 - place;
                !value.to_le_bytes().contains(&0x90) && doubled && bytes[end] == 0x90
            })
            .unwrap()
    };
    for place in [0, 1] {
        let (value, bytes) = crc_byte(place);
        assert_eq!(shape(&decode(&bytes)), [(0, 2, Some(value))]);
    }
}

/// The dialogue of the Communication Guide, "RS232 Communication": reading the statusword.
#[test]
fn rs232_read_frames_match_golden_bytes() {
    let mut codec = Codec::new(DriveLink::Rs232, 1);
    assert_eq!(encode(&mut codec, STATUSWORD, ObjectAccess::Read), [0x10]);
    assert!(!codec.is_ready());
    assert_eq!(codec.outgoing(at(0)), None, "not before the drive is ready");
    assert_eq!(codec.push(&[OKAY], at(1)), Some(DecodedFrame::Handshake));
    let body = codec.outgoing(at(1)).unwrap();
    assert_eq!(body.bytes, [0x01, 0x41, 0x60, 0x00, 0x01, 0xAB, 0xF0]);
    assert!(body.is_body);
    assert_eq!(codec.push(&[OKAY], at(2)), Some(DecodedFrame::Handshake));
    assert_eq!(codec.push(&[0x00], at(2)), Some(DecodedFrame::Handshake));
    assert_eq!(codec.outgoing(at(2)).unwrap().bytes, [OKAY]);
    let answer = [0x03, 0, 0, 0, 0, 0x37, 2, 0, 0, 0x19, 0x80];
    let decoded: Vec<_> = answer
        .chunks(1)
        .filter_map(|b| codec.push(b, at(3)))
        .collect();
    assert_eq!(shape(&decoded), [(0, 2, Some(0x237))]);
    assert!(!codec.is_ready(), "the master sends the last byte");
    assert_eq!(codec.outgoing(at(3)).unwrap().bytes, [OKAY]);
    assert!(codec.is_ready());
}

#[test]
fn rs232_write_frames_match_golden_bytes() {
    let mut codec = Codec::new(DriveLink::Rs232, 1);
    let opcode = encode(
        &mut codec,
        CONTROLWORD,
        ObjectAccess::Write {
            value: 0x0F,
            width: 2,
        },
    );
    assert_eq!(opcode, [0x11]);
    codec.push(&[OKAY], at(1));
    assert_eq!(
        codec.outgoing(at(1)).unwrap().bytes,
        [0x03, 0x40, 0x60, 0, 1, 0x0F, 0, 0, 0, 0x52, 0xEF]
    );
}

#[test]
fn rs232_refusals_are_reported_and_end_the_exchange() {
    for accepted in [false, true] {
        let mut codec = Codec::new(DriveLink::Rs232, 1);
        encode(&mut codec, STATUSWORD, ObjectAccess::Read);
        if accepted {
            codec.push(&[OKAY], at(1));
            codec.outgoing(at(1)).unwrap();
        }
        assert_eq!(codec.push(&[FAILED], at(2)), Some(DecodedFrame::Refused));
        assert_eq!(codec.outgoing(at(2)), None);
        assert_eq!(codec.deadline(), Some(at(22)), "more bytes may follow");
        codec.expire(at(22));
        assert!(codec.is_ready());
    }
}

#[test]
fn rs232_recovers_after_a_flush_and_silence() {
    let mut codec = Codec::new(DriveLink::Rs232, 1);
    for failure in 1..=3 {
        encode(&mut codec, STATUSWORD, ObjectAccess::Read);
        codec.cancel(at(0));
        assert!(!codec.is_ready());
        let flush = codec.outgoing(at(0));
        assert_eq!(
            flush.is_some(),
            failure < 3,
            "the guide prescribes silence after three flushes"
        );
        if let Some(flush) = flush {
            assert!(flush.bytes.iter().all(|&b| b == FAILED));
        }
        // The drive's last bytes are discarded, but awaited.
        assert_eq!(codec.push(&[OKAY], at(30)), Some(DecodedFrame::Handshake));
        codec.expire(at(49));
        assert!(!codec.is_ready());
        let quiet = if failure < 3 { 50 } else { 550 };
        assert_eq!(codec.deadline(), Some(at(quiet)));
        codec.expire(at(quiet));
        assert!(codec.is_ready());
        assert_eq!(codec.deadline(), None);
    }
}

/// SDO requests and responses (CiA 301, "SDO services").
#[test]
fn can_frames_match_golden_bytes() {
    let mut codec = Codec::new(DriveLink::Can, 1);
    let frame =
        |id: [u8; 2], data: [u8; 8]| [&[0, 0, id[0], id[1], 8, 0, 0, 0][..], &data].concat();
    let bytes = [0x40, 0x41, 0x60, 0, 0, 0, 0, 0];
    let request = encode(&mut codec, STATUSWORD, ObjectAccess::Read);
    assert_eq!(request, frame([6, 1], bytes));
    let written = encode(
        &mut codec,
        CONTROLWORD,
        ObjectAccess::Write {
            value: 0x0F,
            width: 2,
        },
    );
    assert_eq!(written, frame([6, 1], [0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0]));
    let mode = encode(
        &mut codec,
        Address::new(0x6060, 0),
        ObjectAccess::Write {
            value: 0xFFFF_FFFD,
            width: 1,
        },
    );
    assert_eq!(mode, frame([6, 1], [0x2F, 0x60, 0x60, 0, 0xFD, 0, 0, 0]));
    let answer = frame([5, 0x81], [0x4B, 0x41, 0x60, 0, 0x40, 1, 0, 0]);
    let Some(DecodedFrame::Reply(reply)) = codec.push(&answer, at(0)) else {
        panic!()
    };
    assert_eq!((reply.error().0, reply.value()), (0, Some(0x140)));
    let abort = frame([5, 0x81], [0x80, 0x41, 0x60, 0, 0, 0, 2, 6]);
    let Some(DecodedFrame::Reply(reply)) = codec.push(&abort, at(0)) else {
        panic!()
    };
    assert_eq!((reply.error(), reply.value()), (AbortCode::NO_OBJECT, None));
    let other_node = frame([5, 0x82], [0x4B, 0x41, 0x60, 0, 0x40, 1, 0, 0]);
    assert!(matches!(
        codec.push(&other_node, at(0)),
        Some(DecodedFrame::Bus(_))
    ));
    assert_eq!(codec.push(&answer[..9], at(0)), Some(DecodedFrame::Noise));
}

/// The device name of the guide's example, in segments.
#[test]
fn can_segments_match_golden_bytes() {
    let mut codec = Codec::new(DriveLink::Can, 1);
    let name = Address::new(0x1008, 0);
    let open = encode(
        &mut codec,
        name,
        ObjectAccess::Transfer(TransferRequest::InitiateUpload { address: name }),
    );
    assert_eq!(open[8..], [0x40, 8, 0x10, 0, 0, 0, 0, 0]);
    let push = |codec: &mut Codec, data: [u8; 8]| {
        let frame = [&[0, 0, 5, 0x81, 8, 0, 0, 0][..], &data].concat();
        match codec.push(&frame, at(0)) {
            Some(DecodedFrame::Reply(reply)) => reply,
            other => panic!("{other:?}"),
        }
    };
    let opened = push(&mut codec, [0x41, 8, 0x10, 0, 5, 0, 0, 0]);
    assert_eq!((opened.value(), opened.error()), (None, AbortCode::NONE));
    let next = encode(
        &mut codec,
        name,
        ObjectAccess::Transfer(TransferRequest::UploadSegment { toggle: false }),
    );
    assert_eq!(next[8], 0x60);
    let segment = push(&mut codec, [0x05, b'E', b'P', b'O', b'S', b'2', 0, 0]);
    let Reply::Sdo(TransferResponse::UploadSegment(segment)) = segment else {
        panic!("{segment:?}")
    };
    assert_eq!(segment.bytes.as_slice(), b"EPOS2");
    assert!(segment.last && !segment.toggle);
}

proptest! {
    #[test]
    fn arbitrary_bytes_are_accepted(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        for link in [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can] {
            let mut codec = Codec::new(link, 1);
            codec.encode(STATUSWORD, ObjectAccess::Read, at(500));
            for piece in bytes.chunks(codec.chunk_len()) {
                codec.push(piece, at(0));
                codec.outgoing(at(0));
            }
        }
    }
}
