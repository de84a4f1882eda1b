//! The drive on CAN behind an adapter that speaks SLCAN.

use crate::drive::Drive;
use crate::wire::{Link, Outbox, Upload, long_object};

/// Seconds until an SDO response leaves, and until a PDO does.
const RESPONSE: f64 = 0.000_5;
const PROCESS_DATA: f64 = 0.000_2;
/// The node's id.
const NODE: u16 = 1;

/// Adapter and node.
#[derive(Default)]
pub struct Slcan {
    line: Vec<u8>,
    is_open: bool,
    upload: Upload,
    outbox: Outbox,
    next_heartbeat: f64,
    /// When the host's heartbeat is missing.
    host_lost_at: Option<f64>,
    next_emergency: f64,
}

impl Slcan {
    fn frame(&mut self, drive: &mut Drive, delay: f64, id: u16, data: &[u8]) {
        if !self.is_open {
            return;
        }
        let hex: String = data.iter().map(|byte| format!("{byte:02X}")).collect();
        let mut line = format!("t{id:03X}{}{hex}\r", data.len()).into_bytes();
        if drive.faults.spoils_sums {
            // CAN controllers drop damaged frames; what reaches the host is a damaged line.
            drive.show();
            line[5] = b'x';
        }
        for _ in 0..drive.faults.copies {
            self.outbox.send(drive, delay, line.clone());
        }
    }

    fn command(&mut self, drive: &mut Drive, line: &[u8]) {
        let reply: &[u8] = match line.first() {
            None => return,
            Some(b'O') => {
                self.is_open = true;
                b"\r"
            }
            Some(b'C') => {
                self.is_open = false;
                b"\r"
            }
            Some(b'S' | b's') => b"\r",
            Some(b'F') => b"F00\r",
            Some(b'V') => b"V1013\r",
            Some(b'N') => b"NA123\r",
            Some(b't') if self.is_open => {
                if let Some((id, data)) = parse(line) {
                    if !drive.faults.is_deaf && drive.boots_at.is_none() {
                        self.bus(drive, id, &data);
                    }
                    b"z\r"
                } else {
                    b"\x07"
                }
            }
            _ => b"\x07",
        };
        self.outbox.send(drive, 0.000_1, reply.to_vec());
    }

    /// A frame from the host reaches the node.
    fn bus(&mut self, drive: &mut Drive, id: u16, data: &[u8]) {
        match id {
            0x000 if data.len() == 2 && (data[1] == 0 || u16::from(data[1]) == NODE) => {
                match data[0] {
                    0x01 => drive.operational = true,
                    0x81 | 0x82 => {
                        drive.lose_supply(0.0);
                    }
                    _ => drive.operational = false,
                }
            }
            0x080 => self.sync(drive),
            0x601 if data.len() == 8 => {
                let mut request = [0; 8];
                request.copy_from_slice(data);
                if let Some(mut response) = self.sdo(drive, request) {
                    if drive.faults.wrong_object && response[1] == 0x64 {
                        response[1] = 0x62;
                    }
                    let id = if drive.faults.wrong_node {
                        0x582
                    } else {
                        0x581
                    };
                    if drive.faults.wrong_node || drive.faults.wrong_object {
                        drive.show();
                    }
                    self.frame(drive, RESPONSE, id, &response);
                }
            }
            id if id > 0x700 => {
                let entry = drive.value(0x1016, 1);
                if u32::from(id - 0x700) == entry >> 16 & 0x7F && entry & 0xFFFF != 0 {
                    self.host_lost_at = Some(drive.now + f64::from(entry & 0xFFFF) / 1e3);
                }
            }
            _ => {}
        }
    }

    fn sync(&mut self, drive: &mut Drive) {
        let id = drive.value(0x1800, 1);
        let is_valid = id & 0x8000_0000 == 0 && drive.value(0x1800, 2) == 1;
        if !drive.operational || !is_valid {
            return;
        }
        let mut data = Vec::new();
        for sub in 1..=drive.value(0x1A00, 0).min(8) as u8 {
            let entry = drive.value(0x1A00, sub);
            let (index, sub, bits) = ((entry >> 16) as u16, (entry >> 8) as u8, entry & 0xFF);
            if let Ok((value, _)) = drive.read(index, sub) {
                data.extend(&value.to_le_bytes()[..(bits / 8).min(4) as usize]);
            }
        }
        self.frame(drive, PROCESS_DATA, (id & 0x7FF) as u16, &data);
    }

    fn sdo(&mut self, drive: &mut Drive, request: [u8; 8]) -> Option<[u8; 8]> {
        let [command, low, high, sub, ..] = request;
        let index = u16::from_le_bytes([low, high]);
        let abort = |code: u32| {
            let [a, b, c, d] = code.to_le_bytes();
            Some([0x80, low, high, sub, a, b, c, d])
        };
        match command >> 5 {
            1 if command & 2 == 0 => abort(0x0504_0001),
            1 => {
                let value = request[4..8]
                    .iter()
                    .rev()
                    .fold(0, |sum, b| sum << 8 | u32::from(*b));
                match drive.write(index, sub, value) {
                    Ok(()) => Some([0x60, low, high, sub, 0, 0, 0, 0]),
                    Err(code) => abort(code),
                }
            }
            2 => match long_object(drive, index, sub) {
                Err(code) => abort(code),
                Ok(bytes) if bytes.len() <= 4 => {
                    let mut response = [0; 8];
                    response[0] = 0x43 | ((4 - bytes.len()) as u8) << 2;
                    response[1..4].copy_from_slice(&[low, high, sub]);
                    response[4..4 + bytes.len()].copy_from_slice(&bytes);
                    Some(response)
                }
                Ok(rest) => {
                    let length = rest.len() as u8;
                    self.upload = Upload {
                        rest,
                        toggle: false,
                        is_open: true,
                    };
                    Some([0x41, low, high, sub, length, 0, 0, 0])
                }
            },
            3 if !self.upload.is_open => abort(0x0504_0001),
            3 if (command & 0x10 != 0) != self.upload.toggle => abort(0x0503_0000),
            3 => {
                let toggle = u8::from(self.upload.toggle) << 4;
                let (bytes, last) = self.upload.next(7, drive.faults.drops_segments);
                let mut response = [0; 8];
                response[0] = toggle | ((7 - bytes.len()) as u8) << 1 | u8::from(last);
                response[1..1 + bytes.len()].copy_from_slice(&bytes);
                Some(response)
            }
            4 => {
                self.upload.is_open = false;
                None
            }
            _ => abort(0x0504_0001),
        }
    }
}

/// Identifier and data of a line.
fn parse(line: &[u8]) -> Option<(u16, Vec<u8>)> {
    let text = std::str::from_utf8(line).ok()?;
    let id = u16::from_str_radix(text.get(1..4)?, 16).ok()?;
    let length: usize = text.get(4..5)?.parse().ok()?;
    let byte = |n: usize| u8::from_str_radix(text.get(5 + 2 * n..7 + 2 * n)?, 16).ok();
    Some((id, (0..length).map(byte).collect::<Option<_>>()?))
}

impl Link for Slcan {
    fn receive(&mut self, drive: &mut Drive, bytes: &[u8]) {
        for &byte in bytes {
            if byte == b'\r' {
                let line = std::mem::take(&mut self.line);
                self.command(drive, &line);
            } else if self.line.len() < 64 {
                self.line.push(byte);
            }
        }
    }

    fn idle(&mut self, drive: &mut Drive) {
        if drive.boots_at.is_some() {
            return;
        }
        if std::mem::take(&mut drive.booted) {
            self.host_lost_at = None;
            self.frame(drive, 0.0, 0x700 + NODE, &[0]);
        }
        let period = f64::from(drive.value(0x1017, 0)) / 1e3;
        if period > 0.0 && drive.now >= self.next_heartbeat && !drive.faults.stops_heartbeat {
            self.next_heartbeat = drive.now + period;
            let state = if drive.operational { 0x05 } else { 0x7F };
            self.frame(drive, 0.0, 0x700 + NODE, &[state]);
            if drive.faults.second_node {
                drive.show();
                self.frame(drive, 0.0, 0x700 + NODE, &[0x7F]);
            }
        }
        if self.host_lost_at.is_some_and(|at| drive.now > at) {
            self.host_lost_at = None;
            let is_monitored = drive.value(0x1016, 1) & 0xFFFF != 0;
            // In quick stop active as well. Other reactions than 1 keep the power on.
            if is_monitored && drive.axis.powered && drive.value(0x6007, 0) == 1 {
                drive.fail(0x8130, true);
            }
        }
        if drive.faults.emcy_storm && drive.now >= self.next_emergency {
            self.next_emergency = drive.now + 0.001;
            drive.emergencies.push_back(0x8110);
        }
        while let Some(code) = drive.emergencies.pop_front() {
            let [low, high] = code.to_le_bytes();
            drive.show();
            self.frame(drive, 0.0, 0x080 + NODE, &[low, high, 0x11, 0, 0, 0, 0, 0]);
        }
    }

    fn outbox(&mut self) -> &mut Outbox {
        &mut self.outbox
    }
}
