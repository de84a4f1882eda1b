//! What the links have in common: their checksum, answers that leave later, and what goes wrong
//! on the way.

use std::collections::VecDeque;

use crate::drive::Drive;
use crate::faults::Damage;

/// A link on which a drive is reached.
pub trait Link {
    /// Bytes from the client arrived.
    fn receive(&mut self, drive: &mut Drive, bytes: &[u8]);
    /// Sends what is due by itself.
    fn idle(&mut self, drive: &mut Drive);
    /// Bytes for the client.
    fn outbox(&mut self) -> &mut Outbox;
}

/// Bytes on their way to the client.
#[derive(Default)]
pub struct Outbox {
    waiting: VecDeque<(f64, Vec<u8>)>,
    seed: u32,
}

impl Outbox {
    /// Sends bytes after `delay` seconds. `is_answer` is false for what no request asked for.
    pub fn send(&mut self, drive: &mut Drive, delay: f64, mut bytes: Vec<u8>) {
        let mut delay = delay;
        match drive.faults.damage {
            Damage::None => {}
            Damage::Silence => {
                drive.show();
                return;
            }
            Damage::Late(by) => delay += by,
            Damage::Garbage => {
                drive.show();
                for byte in &mut bytes {
                    *byte = self.random();
                }
            }
            Damage::Every(n) => {
                self.seed = self.seed.wrapping_add(1);
                if self.seed.is_multiple_of(n) {
                    return;
                }
            }
        }
        let at = drive.now + delay;
        let at = self.waiting.back().map_or(at, |(last, _)| at.max(*last));
        self.waiting.push_back((at, bytes));
    }

    fn random(&mut self) -> u8 {
        self.seed = self
            .seed
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        (self.seed >> 24) as u8
    }

    /// The bytes that are due.
    pub fn due(&mut self, now: f64) -> Vec<u8> {
        let mut due = Vec::new();
        while self.waiting.front().is_some_and(|(at, _)| *at <= now) {
            due.extend(self.waiting.pop_front().unwrap_or_default().1);
        }
        due
    }
}

/// CRC-16 with polynomial 0x1021 and initial value 0.
pub fn crc(bytes: impl IntoIterator<Item = u8>) -> u16 {
    bytes.into_iter().fold(0_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(byte) << 8, |crc, _| {
            if crc & 0x8000 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 0x1021
            }
        })
    })
}

/// Bytes of words in the order of the checksum: the high one first.
pub fn swapped(data: &[u8]) -> impl Iterator<Item = u8> {
    data.chunks(2).flat_map(|word| word.iter().rev().copied())
}

/// A transfer in segments to the client.
#[derive(Clone, Debug, Default)]
pub struct Upload {
    /// Bytes that are left.
    pub rest: Vec<u8>,
    /// Toggle bit of the next segment.
    pub toggle: bool,
    /// A transfer is in progress.
    pub is_open: bool,
}

impl Upload {
    /// The next segment of up to `most` bytes, and whether it is the last.
    pub fn next(&mut self, most: usize, drops: bool) -> (Vec<u8>, bool) {
        let count = most.min(self.rest.len());
        let mut segment: Vec<u8> = self.rest.drain(..count).collect();
        if drops {
            segment.clear();
        }
        self.toggle = !self.toggle;
        self.is_open = !self.rest.is_empty();
        (segment, !self.is_open)
    }
}

/// The bytes of an object of any length.
pub fn long_object(drive: &mut Drive, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
    if (index, sub) == (0x1008, 0) {
        return Ok(b"EPOS2".to_vec());
    }
    let (value, width) = drive.read(index, sub)?;
    Ok(value.to_le_bytes()[..usize::from(width)].to_vec())
}

/// Executes a command of the serial links; returns the data of its answer.
pub fn execute(drive: &mut Drive, upload: &mut Upload, opcode: u8, data: &[u8]) -> Option<Vec<u8>> {
    let at = |n: usize| data.get(n).copied().unwrap_or(0);
    let index = u16::from_le_bytes([at(0), at(1)]);
    let (sub, node) = (at(2), at(3));
    let error = |code: u32| Some(code.to_le_bytes().to_vec());
    let is_ours = node == 0 || node == 1;
    match opcode {
        0x10..=0x12 if !is_ours => error(0x0504_0000),
        0x10 => match drive.read(index, sub) {
            Ok((value, width)) => {
                let mut answer = vec![0; 4];
                let mut value = value.to_le_bytes();
                // A real drive leaves garbage above the object's width.
                value
                    .iter_mut()
                    .skip(width.into())
                    .for_each(|byte| *byte = 0xA5);
                answer.extend(value);
                Some(answer)
            }
            Err(code) => {
                let mut answer = code.to_le_bytes().to_vec();
                answer.extend([0; 4]);
                Some(answer)
            }
        },
        0x11 => {
            let value = u32::from_le_bytes([at(4), at(5), at(6), at(7)]);
            error(drive.write(index, sub, value).err().unwrap_or(0))
        }
        0x12 => match long_object(drive, index, sub) {
            Ok(rest) => {
                *upload = Upload {
                    rest,
                    toggle: false,
                    is_open: true,
                };
                error(0)
            }
            Err(code) => error(code),
        },
        0x14 if !upload.is_open => error(0x0504_0001),
        0x14 if (at(0) & 0x40 != 0) != upload.toggle => error(0x0503_0000),
        0x14 => {
            let toggle = u8::from(upload.toggle) << 6;
            let (segment, last) = upload.next(63, drive.faults.drops_segments);
            let mut answer = vec![0; 4];
            answer.push(segment.len() as u8 | toggle | u8::from(!last) << 7);
            answer.extend(segment);
            if answer.len() % 2 == 1 {
                answer.push(0);
            }
            Some(answer)
        }
        0x0E => {
            drive.operational = at(2) == 1 || at(0) == 1;
            error(0)
        }
        _ => error(0x0F00_FFBF),
    }
}
