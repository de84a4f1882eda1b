use super::*;
use proptest::prelude::*;
use std::collections::VecDeque;

use crate::log::OwnedRecord;

/// A port that plays back chunks at their times.
struct Script {
    chunks: VecDeque<(i64, Vec<u8>)>,
}

impl Port for Script {
    fn write_frame(&mut self, _frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        Ok(Stamp::from_nanos(1))
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        _timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let Some((ns, chunk)) = self.chunks.pop_front() else {
            return Ok(None);
        };
        buffer[..chunk.len()].copy_from_slice(&chunk);
        Ok(Some((chunk.len(), Stamp::from_nanos(ns))))
    }
}

fn play(link: DriveLink, chunks: Vec<(i64, Vec<u8>)>) -> Vec<(i64, Vec<u8>)> {
    let mut seen = Vec::new();
    let mut port = RecordingPort::new(
        Script {
            chunks: chunks.into(),
        },
        link,
        |record| seen.push(OwnedRecord::from(record)),
    );
    let mut buffer = [0; 512];
    while port.read(&mut buffer, Span::ZERO).unwrap().is_some() {}
    drop(port);
    seen.iter()
        .map(|record| match record.as_record().wire {
            Wire::Drive {
                frame,
                direction: Direction::FromDrive,
                ..
            } => (record.host().as_nanos(), frame.to_vec()),
            other => panic!("{other:?}"),
        })
        .collect()
}

const ANSWER: [u8; 14] = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x37, 2, 0, 0, 0x68, 0];

#[test]
fn a_frame_in_pieces_is_one_record_with_its_last_time() {
    let chunks = vec![
        (10, vec![0x55]),
        (20, ANSWER[..1].to_vec()),
        (30, ANSWER[1..9].to_vec()),
        (40, [&ANSWER[9..], &ANSWER].concat()),
        (50, ANSWER[..3].to_vec()),
    ];
    assert_eq!(
        play(DriveLink::Usb, chunks),
        [
            (10, vec![0x55]),
            (40, ANSWER.to_vec()),
            (40, ANSWER.to_vec()),
            (50, ANSWER[..3].to_vec()), // pending when the port is dropped
        ]
    );
}

#[test]
fn an_incomplete_frame_is_recorded_with_the_next_bytes() {
    let half_a_second = 500_000_000;
    let chunks = vec![
        (10, ANSWER[..8].to_vec()),
        (10 + half_a_second + 1, ANSWER.to_vec()),
    ];
    assert_eq!(
        play(DriveLink::Usb, chunks),
        [
            (10, ANSWER[..8].to_vec()),
            (10 + half_a_second + 1, ANSWER.to_vec()),
        ]
    );
}

#[test]
fn rs232_bytes_are_recorded_by_read() {
    let chunks = vec![(1, b"O".to_vec()), (2, vec![0x90, 2, 3]), (3, vec![0])];
    assert_eq!(play(DriveLink::Rs232, chunks.clone()), chunks);
}

#[test]
fn written_frames_are_recorded_with_their_time() {
    let mut seen = Vec::new();
    let script = Script {
        chunks: VecDeque::new(),
    };
    let mut port = RecordingPort::new(script, DriveLink::Usb, |record| {
        seen.push(OwnedRecord::from(record));
    });
    let host = port.write_frame(&ANSWER).unwrap();
    drop(port);
    let record = seen[0].as_record();
    assert_eq!(record.host, host);
    assert_eq!(
        record.wire,
        Wire::Drive {
            link: DriveLink::Usb,
            direction: Direction::ToDrive,
            frame: &ANSWER
        }
    );
}

proptest! {
    #[test]
    fn every_byte_is_recorded_in_order_of_time(
        chunks in prop::collection::vec(
            (0..400_000_000_i64, prop::collection::vec(prop_oneof![Just(0x90_u8), Just(2), Just(0), any::<u8>()], 0..40)),
            0..20,
        ),
    ) {
        let mut ns = 0;
        let chunks: Vec<_> = chunks.into_iter().map(|(step, bytes)| { ns += step; (ns, bytes) }).collect();
        let sent: Vec<u8> = chunks.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        let records = play(DriveLink::Usb, chunks);
        let recorded: Vec<u8> = records.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        prop_assert_eq!(recorded, sent);
        prop_assert!(records.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        prop_assert!(records.iter().all(|(_, bytes)| !bytes.is_empty()));
    }
}
