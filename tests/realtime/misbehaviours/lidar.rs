//! A VLP-16 that sees a wall: data packets on UDP, 754 a second.

use std::net::{Ipv4Addr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Microseconds of a firing of all lasers; a packet has 24.
const FIRING_US: f64 = 55.296;
const PACKET_US: f64 = 24.0 * FIRING_US;

/// Sends packets to a port until `end`.
pub fn run(port: u16, end: &AtomicBool) {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let begin = Instant::now();
    for number in 0_u64.. {
        if end.load(Ordering::Acquire) {
            return;
        }
        let due = Duration::from_micros((number as f64 * PACKET_US) as u64);
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
        // The client may not listen yet.
        let _ = socket.send_to(&packet(number), (Ipv4Addr::LOCALHOST, port));
    }
}

fn packet(number: u64) -> Vec<u8> {
    let us = number as f64 * PACKET_US;
    let mut bytes = Vec::with_capacity(1_206);
    for block in 0..12 {
        // 600 revolutions a minute: 3.6 hundredths of a degree in 10 us.
        let firing_us = us + f64::from(2 * block) * FIRING_US;
        let azimuth = (firing_us * 0.36) as u64 % 36_000;
        bytes.extend([0xFF, 0xEE]);
        bytes.extend((azimuth as u16).to_le_bytes());
        for channel in 0..32_u16 {
            // 5 m and a little, in units of 2 mm.
            bytes.extend((2_500 + channel).to_le_bytes());
            bytes.push(100);
        }
    }
    bytes.extend(((us as u64 % 3_600_000_000) as u32).to_le_bytes());
    // Strongest return, VLP-16.
    bytes.extend([0x37, 0x22]);
    bytes
}
