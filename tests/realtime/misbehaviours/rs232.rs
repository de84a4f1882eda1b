//! The drive on RS232: opcode, handshake, body with checksum, handshake.

use crate::drive::Drive;
use crate::wire::{Link, Outbox, Upload, crc, execute, swapped};

/// Seconds of a byte at 115,200 baud.
const BYTE: f64 = 10.0 / 115_200.0;
/// Seconds after which an unfinished frame is forgotten.
const TIMEOUT: f64 = 0.5;
const OKAY: u8 = b'O';
const FAILED: u8 = b'F';

#[derive(Default)]
enum Phase {
    /// Waits for an opcode.
    #[default]
    Idle,
    /// Receives the body after this opcode.
    Body(u8, Vec<u8>),
    /// Waits for the master's handshake after the answer's opcode, then sends this body.
    Announced(Vec<u8>),
    /// Waits for the master's handshake after the answer.
    Answered,
}

/// The receiver.
#[derive(Default)]
pub struct Rs232 {
    phase: Phase,
    since: f64,
    upload: Upload,
    outbox: Outbox,
}

/// Length, data and checksum after an opcode.
pub fn body(opcode: u8, data: &[u8], spoil: u16) -> Vec<u8> {
    let length = (data.len() / 2) as u8 - 1;
    let sum = crc([opcode, length].into_iter().chain(swapped(data))) ^ spoil;
    let mut bytes = vec![length];
    bytes.extend(data);
    bytes.extend(sum.to_le_bytes());
    bytes
}

impl Rs232 {
    fn send(&mut self, drive: &mut Drive, bytes: Vec<u8>) {
        let delay = bytes.len() as f64 * BYTE + 0.000_2;
        self.outbox.send(drive, delay, bytes);
    }

    fn complete(&mut self, drive: &mut Drive, opcode: u8, bytes: &[u8]) {
        let data = &bytes[1..bytes.len() - 2];
        if body(opcode, data, 0) != bytes {
            self.send(drive, vec![FAILED]);
            return;
        }
        self.send(drive, vec![OKAY]);
        let Some(answer) = execute(drive, &mut self.upload, opcode, data) else {
            return;
        };
        // NMT and CAN services have no answer on RS232.
        if matches!(opcode, 0x0E | 0x20) {
            return;
        }
        let spoil = if drive.faults.spoils_sums { 0x0100 } else { 0 };
        if spoil != 0 {
            drive.show();
        }
        let answer = body(0, &answer, spoil);
        self.send(drive, vec![0]);
        self.phase = Phase::Announced(answer);
    }
}

impl Link for Rs232 {
    fn receive(&mut self, drive: &mut Drive, bytes: &[u8]) {
        for &byte in bytes {
            if drive.now - self.since > TIMEOUT {
                self.phase = Phase::Idle;
            }
            self.since = drive.now;
            match std::mem::take(&mut self.phase) {
                Phase::Idle => match byte {
                    0x0E..=0x15 | 0x20 | 0x21 => {
                        self.phase = Phase::Body(byte, Vec::new());
                        self.send(drive, vec![OKAY]);
                    }
                    _ => self.send(drive, vec![FAILED]),
                },
                Phase::Body(opcode, mut frame) => {
                    frame.push(byte);
                    if frame.len() == 1 + 2 * (usize::from(frame[0]) + 1) + 2 {
                        self.complete(drive, opcode, &frame);
                    } else {
                        self.phase = Phase::Body(opcode, frame);
                    }
                }
                Phase::Announced(answer) if byte == OKAY => {
                    for _ in 0..drive.faults.copies {
                        self.send(drive, answer.clone());
                    }
                    self.phase = Phase::Answered;
                }
                Phase::Announced(_) => {}
                Phase::Answered => {}
            }
        }
    }

    fn idle(&mut self, drive: &mut Drive) {
        if drive.now - self.since > TIMEOUT {
            self.phase = Phase::Idle;
        }
    }

    fn outbox(&mut self) -> &mut Outbox {
        &mut self.outbox
    }
}
