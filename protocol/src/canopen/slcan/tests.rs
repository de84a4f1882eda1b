//! Lines of the Lawicel manuals both ways, what adapters and noise make of them, and any bytes.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::canopen::tests::any_frame;
use crate::canopen::{CanFrame, CobId, ExtendedId};

fn line(text: &str) -> Line {
    Line::from_slice(text.as_bytes()).unwrap()
}

fn standard(id: u16, data: &[u8]) -> CanFrame {
    CanFrame::new(CobId::new(id).unwrap(), data).unwrap()
}

fn extended(id: u32, data: &[u8]) -> CanFrame {
    CanFrame::new(ExtendedId::new(id).unwrap(), data).unwrap()
}

fn received(frame: CanFrame, stamp_ms: Option<u16>) -> SlcanReply {
    SlcanReply::Received { frame, stamp_ms }
}

fn commands(bytes: &[u8]) -> Vec<Result<SlcanCommand, SlcanError>> {
    let mut decoder = CommandDecoder::new();
    bytes.iter().filter_map(|&b| decoder.push(b)).collect()
}

fn replies(bytes: &[u8]) -> Vec<Result<SlcanReply, SlcanError>> {
    let mut decoder = ReplyDecoder::new();
    bytes.iter().filter_map(|&b| decoder.push(b)).collect()
}

fn encoded(encode: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut out = Vec::new();
    encode(&mut out);
    out
}

#[test]
fn commands_match_golden_bytes_in_both_directions() {
    let request = standard(0x601, &[0x40, 0x41, 0x60, 0, 0, 0, 0, 0]);
    let golden: [(&str, SlcanCommand); 17] = [
        ("\r", SlcanCommand::Empty),
        ("S0\r", SlcanCommand::Bitrate(Bitrate::Kbit10)),
        ("S8\r", SlcanCommand::Bitrate(Bitrate::Kbit1000)),
        ("O\r", SlcanCommand::Open),
        ("L\r", SlcanCommand::OpenListening),
        ("C\r", SlcanCommand::Close),
        ("V\r", SlcanCommand::Version),
        ("N\r", SlcanCommand::SerialNumber),
        ("F\r", SlcanCommand::Status),
        ("Z1\r", SlcanCommand::Stamps(true)),
        ("t60184041600000000000\r", SlcanCommand::Transmit(request)),
        ("t0800\r", SlcanCommand::Transmit(standard(0x080, &[]))),
        (
            "T000001232AABB\r",
            SlcanCommand::Transmit(extended(0x123, &[0xAA, 0xBB])),
        ),
        (
            "r7011\r",
            SlcanCommand::Transmit(CanFrame::remote(CobId::new(0x701).unwrap(), 1).unwrap()),
        ),
        (
            "R1FFFFFFF8\r",
            SlcanCommand::Transmit(CanFrame::remote(ExtendedId::MAX, 8).unwrap()),
        ),
        ("M00000000\r", SlcanCommand::Unknown(line("M00000000"))),
        ("s031C\r", SlcanCommand::Unknown(line("s031C"))),
    ];
    for (text, command) in golden {
        assert_eq!(
            encoded(|out| command.encode(out)),
            text.as_bytes(),
            "{text}"
        );
        assert_eq!(commands(text.as_bytes()), [Ok(command)], "{text}");
    }
}

#[test]
fn replies_match_golden_bytes_in_both_directions() {
    let answer = standard(0x581, &[0x4B, 0x41, 0x60, 0, 0x40, 1, 0, 0]);
    let golden: [(&str, SlcanReply); 10] = [
        ("\r", SlcanReply::Done),
        ("\x07", SlcanReply::Refused),
        ("z\r", SlcanReply::Sent),
        ("Z\r", SlcanReply::SentExtended),
        ("t58184B41600040010000\r", received(answer, None)),
        (
            "t58184B4160004001000012C7\r",
            received(answer, Some(0x12C7)),
        ),
        (
            "r70110001\r",
            received(
                CanFrame::remote(CobId::new(0x701).unwrap(), 1).unwrap(),
                Some(1),
            ),
        ),
        ("V1013\r", SlcanReply::Version(line("1013"))),
        ("NA123\r", SlcanReply::SerialNumber(line("A123"))),
        ("F08\r", SlcanReply::Status(8)),
    ];
    for (text, reply) in golden {
        assert_eq!(encoded(|out| reply.encode(out)), text.as_bytes(), "{text}");
        assert_eq!(replies(text.as_bytes()), [Ok(reply)], "{text}");
    }
}

#[test]
fn bit_rates_map_to_their_digits() {
    for (digit, rate) in (b'0'..).zip(Bitrate::ALL) {
        assert_eq!(
            commands(&[b'S', digit, CR]),
            [Ok(SlcanCommand::Bitrate(rate))]
        );
    }
    let character = |got| {
        Err(SlcanError::Character {
            offset: 1,
            expected: "0 to 8",
            got,
        })
    };
    assert_eq!(commands(b"S9\r"), [character(b'9')]);
    let length = |got| Err(SlcanError::Length { expected: 2, got });
    assert_eq!(commands(b"S\rS10\r"), [length(1), length(3)]);
}

#[test]
fn lower_case_line_feeds_and_versions_of_any_length_are_accepted() {
    let frame = standard(0x7AB, &[0xCD]);
    assert_eq!(replies(b"t7ab1cd\r\n"), [Ok(received(frame, None))]);
    assert_eq!(
        commands(b"C\r\nt7ab1Cd\r\n"),
        [Ok(SlcanCommand::Close), Ok(SlcanCommand::Transmit(frame))]
    );
    let version = "CANable slcan Rev 2, https://example.org";
    let reply = [b"V", version.as_bytes(), b"\r"].concat();
    assert_eq!(replies(&reply), [Ok(SlcanReply::Version(line(version)))]);
}

#[test]
fn invalid_lines_are_refused_with_a_reason() {
    let character = |offset, expected, got| SlcanError::Character {
        offset,
        expected,
        got,
    };
    let length = |expected, got| SlcanError::Length { expected, got };
    let digit = "a hexadecimal digit";
    let max = 0x7FF;
    for (text, error) in [
        ("t\r", length(4, 1)),
        ("t60\r", length(4, 3)),
        ("t601\r", length(5, 4)),
        ("t6012AA\r", length(9, 7)),
        ("t6011AABB\r", length(11, 9)),
        ("t6G1\r", character(2, digit, b'G')),
        ("t6011A \r", character(6, digit, b' ')),
        ("t6019AABBCCDDEEFF001122\r", character(4, "0 to 8", b'9')),
        ("rFFF0\r", SlcanError::Id { max, got: 0xFFF }),
        (
            "T200000000\r",
            SlcanError::Id {
                max: 0x1FFF_FFFF,
                got: 0x2000_0000,
            },
        ),
    ] {
        assert_eq!(replies(text.as_bytes()), [Err(error)], "{text}");
        assert_eq!(commands(text.as_bytes()), [Err(error)], "{text}");
    }
    // A host has no time stamps.
    assert_eq!(commands(b"t60110012C7\r"), [Err(length(7, 11))]);
    assert_eq!(replies(b"F0\r"), [Err(length(3, 2))]);
}

#[test]
fn noise_damages_at_most_its_own_line() {
    let frame = standard(0x581, &[1]);
    let good = received(frame, None);
    // Between lines.
    assert_eq!(replies(b"\x00\xFF\x80 t581101\r"), [Ok(good)]);
    // A frame whose end was lost, before a frame.
    assert_eq!(
        replies(b"t5811t581101\r"),
        [Err(SlcanError::BrokenOff { got: 5 }), Ok(good)]
    );
    assert_eq!(
        replies(b"x#z\xA0t581101\r"),
        [Err(SlcanError::BrokenOff { got: 4 }), Ok(good)]
    );
    // In a line, and BEL in a line.
    assert_eq!(replies(b"t58\xE31101\rt581101\r")[1..], [Ok(good)]);
    assert_eq!(
        replies(b"t5811\x07t581101\r"),
        [Ok(SlcanReply::Refused), Ok(good)]
    );
    assert_eq!(commands(b"\x07C\x07O\r"), [Ok(SlcanCommand::Open)]);
    // Without any CR.
    let long = [&[b'x'; 500][..], b"\rt581101\r"].concat();
    let max = MAX_LINE;
    assert_eq!(replies(&long), [Err(SlcanError::TooLong { max }), Ok(good)]);
}

proptest! {
    #[test]
    fn frames_round_trip(frames in prop::collection::vec((any_frame(), any::<Option<u16>>()), 0..8)) {
        let mut to_adapter = Vec::new();
        let mut to_host = Vec::new();
        for (frame, stamp_ms) in &frames {
            SlcanCommand::Transmit(*frame).encode(&mut to_adapter);
            received(*frame, *stamp_ms).encode(&mut to_host);
        }
        let sent: Vec<_> = frames.iter().map(|(frame, _)| Ok(SlcanCommand::Transmit(*frame))).collect();
        prop_assert_eq!(commands(&to_adapter), sent);
        let expected: Vec<_> = frames.iter().map(|(frame, stamp)| Ok(received(*frame, *stamp))).collect();
        prop_assert_eq!(replies(&to_host), expected);
    }

    #[test]
    fn valid_lines_are_decoded_among_arbitrary_bytes(bytes in prop::collection::vec(
        prop_oneof![
            2 => prop::sample::select(&b"tTrRzZVNFSOC0128F\r\n\x07"[..]),
            1 => any::<u8>(),
        ], 0..300)) {
        let frame = standard(0x601, &[0x40]);
        for reply in replies(&bytes).into_iter().flatten() {
            prop_assert_eq!(replies(&encoded(|out| reply.encode(out))), [Ok(reply)]);
        }
        for command in commands(&bytes).into_iter().flatten() {
            prop_assert_eq!(commands(&encoded(|out| command.encode(out))), [Ok(command)]);
        }
        let good = [&bytes[..], b"\rt601140\r"].concat();
        prop_assert_eq!(replies(&good).pop(), Some(Ok(received(frame, None))));
        prop_assert_eq!(commands(&good).pop(), Some(Ok(SlcanCommand::Transmit(frame))));
    }
}
