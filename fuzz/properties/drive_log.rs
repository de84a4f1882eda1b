//! The listener on arbitrary records: any link, direction, content and time.
//!
//! Each sample must follow from the records. Its stamps are those of a record to the drive and of
//! one from it, which on RS232 is the announcement. Its value is in the bytes from the drive.

use std::collections::BTreeSet;

use drive::{DriveListener, Observation, ShaftSample};
use protocol::canopen::sdo::{Expedited, Initiate, SdoRequest, SdoResponse};
use protocol::canopen::{NodeId, SOCKETCAN_LEN};
use protocol::epos2::message::ReadObject;
use protocol::epos2::{AbortCode, SerialFrame, objects, usb};
use protocol::record::{Direction, DriveLink};
use units::{Span, Stamp};

use super::can_frames;
use super::input::Input;

/// Runs the listener on a log of these records.
pub fn holds(input: &mut Input<'_>) {
    let mut listener = DriveListener::new(1);
    // Times of records to and from the device.
    let mut sent = BTreeSet::new();
    let mut answered = BTreeSet::new();
    // All bytes from the device on a serial link, unstuffed.
    let mut received: Vec<u8> = Vec::new();
    let mut now = Stamp::from_nanos(input.i64());
    while !input.is_empty() {
        let head = input.u8();
        now = match head >> 6 {
            0 => now,
            1 => now.saturating_add(Span::from_micros(input.u16().into())),
            2 => now.saturating_add(Span::from_millis(input.u16().into())),
            _ => Stamp::from_nanos(input.i64()),
        };
        let link = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can][usize::from(head % 3)];
        let direction = [Direction::ToDrive, Direction::FromDrive][usize::from(head >> 5 & 1)];
        let record = match head >> 3 & 3 {
            0 => input.short().to_vec(),
            1 => valid_message(link, direction, input.u32()),
            _ => frame(link, input),
        };
        match direction {
            Direction::ToDrive => {
                sent.insert(now);
            }
            Direction::FromDrive => {
                answered.insert(now);
                received.extend(&record);
            }
        }
        let mut observations = 0;
        listener.observe(link, direction, &record, now, &mut |seen| {
            observations += 1;
            if let Observation::Sample(sample) = seen {
                let in_time = sample.answer == now || link == DriveLink::Rs232;
                assert!(in_time && answered.contains(&sample.answer), "{sample:?}");
                assert!(sent.contains(&sample.request), "{sample:?}");
                check(&sample, &received);
            }
        });
        assert!(observations <= record.len() + 1);
    }
}

/// Checks that the bytes contain the position.
fn check(sample: &ShaftSample, received: &[u8]) {
    // 90 is doubled on USB.
    let plain = sample.position.0.to_le_bytes();
    let stuffed: Vec<u8> = plain
        .iter()
        .flat_map(|&byte| std::iter::repeat_n(byte, if byte == usb::DLE { 2 } else { 1 }))
        .collect();
    let within = |part: &[u8]| received.windows(part.len()).any(|window| window == part);
    assert!(within(&plain) || within(&stuffed), "{sample:?}");
}

/// A valid request for the position, or an answer to it.
fn valid_message(link: DriveLink, direction: Direction, value: u32) -> Vec<u8> {
    let address = objects::POSITION_ACTUAL.address;
    let node = NodeId::new(1).expect("an id");
    let message = match direction {
        Direction::ToDrive => ReadObject { node: 1, address }.to_frame(),
        Direction::FromDrive => {
            let [low, high] = [value as u16, (value >> 16) as u16];
            let none = AbortCode::NONE.to_words();
            SerialFrame::new(SerialFrame::ANSWER, &[none[0], none[1], low, high])
                .expect("few words")
        }
    };
    match (link, direction) {
        (DriveLink::Usb, _) => usb::to_bytes(&message).as_slice().to_vec(),
        (DriveLink::Rs232, _) => {
            let mut body = Vec::new();
            protocol::epos2::rs232::encode_body(&message, &mut body).expect("it has words");
            body
        }
        (DriveLink::Can, Direction::ToDrive) => {
            let request = SdoRequest::InitiateUpload { address };
            request.to_frame(node).to_socketcan().to_vec()
        }
        (DriveLink::Can, Direction::FromDrive) => {
            let transfer = Initiate::Expedited(Expedited::of(value));
            let answer = SdoResponse::InitiateUpload { address, transfer };
            answer.to_frame(node).to_socketcan().to_vec()
        }
    }
}

/// A frame of the link with any content.
fn frame(link: DriveLink, input: &mut Input<'_>) -> Vec<u8> {
    let opcode = input.u8();
    match link {
        DriveLink::Can => {
            let mut bytes = can_frames::frame(input).to_socketcan().to_vec();
            bytes.truncate(SOCKETCAN_LEN - usize::from(opcode & 1));
            bytes
        }
        DriveLink::Usb | DriveLink::Rs232 => {
            let words: Vec<u16> = (0..input.u8() % 8).map(|_| input.u16()).collect();
            let frame = SerialFrame::new(opcode % 0x22, &words).expect("few words");
            match link {
                DriveLink::Usb => usb::to_bytes(&frame).as_slice().to_vec(),
                _ => {
                    let mut bytes = Vec::new();
                    // A body without words is not encoded.
                    let _ = protocol::epos2::rs232::encode_body(&frame, &mut bytes);
                    bytes
                }
            }
        }
    }
}
