//! The drive on USB: frames with a start pair, doubled 0x90 and a checksum.

use crate::drive::Drive;
use crate::wire::{Link, Outbox, Upload, crc, execute, swapped};

/// Seconds until an answer leaves: a USB frame and the converter's timer.
const DELAY: f64 = 0.001_2;

/// The receiver of frames.
#[derive(Default)]
pub struct Usb {
    /// Bytes of the frame, opcode first, once the start was seen.
    frame: Option<Vec<u8>>,
    /// The previous byte was a single 0x90.
    escaped: bool,
    upload: Upload,
    outbox: Outbox,
}

/// A frame of an opcode and data.
pub fn frame(opcode: u8, data: &[u8], spoil: u16) -> Vec<u8> {
    let length = (data.len() / 2) as u8;
    let sum = crc([length, opcode].into_iter().chain(swapped(data))) ^ spoil;
    let body = [opcode, length]
        .into_iter()
        .chain(data.iter().copied())
        .chain(sum.to_le_bytes());
    let mut bytes = vec![0x90, 0x02];
    for byte in body {
        bytes.push(byte);
        if byte == 0x90 {
            bytes.push(byte);
        }
    }
    bytes
}

impl Usb {
    fn complete(&mut self, drive: &mut Drive, frame_bytes: &[u8]) {
        let (body, sum) = frame_bytes.split_at(frame_bytes.len() - 2);
        let expected = crc([body[1], body[0]].into_iter().chain(swapped(&body[2..])));
        if expected.to_le_bytes() != sum {
            let answer = frame(0, &0x0504_0004_u32.to_le_bytes(), 0);
            self.outbox.send(drive, DELAY, answer);
            return;
        }
        if let Some(data) = execute(drive, &mut self.upload, body[0], &body[2..]) {
            let spoil = if drive.faults.spoils_sums { 0x0100 } else { 0 };
            if spoil != 0 {
                drive.show();
            }
            let answer = frame(0, &data, spoil);
            for _ in 0..drive.faults.copies {
                self.outbox.send(drive, DELAY, answer.clone());
            }
        }
    }
}

impl Link for Usb {
    fn receive(&mut self, drive: &mut Drive, bytes: &[u8]) {
        for &byte in bytes {
            if self.escaped {
                self.escaped = false;
                match byte {
                    0x02 => {
                        self.frame = Some(Vec::new());
                        continue;
                    }
                    0x90 => {}
                    _ => {
                        self.frame = None;
                        continue;
                    }
                }
            } else if byte == 0x90 {
                self.escaped = true;
                continue;
            }
            let Some(frame) = &mut self.frame else {
                continue;
            };
            frame.push(byte);
            if frame.len() >= 2 && frame.len() == 4 + 2 * usize::from(frame[1]) {
                let frame = self.frame.take().unwrap_or_default();
                self.complete(drive, &frame);
            }
        }
    }

    fn idle(&mut self, _: &mut Drive) {}

    fn outbox(&mut self) -> &mut Outbox {
        &mut self.outbox
    }
}
