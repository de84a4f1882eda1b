//! The adapter and its drive, as text.

extern crate std;
use std::string::String;
use std::vec::Vec;

use proptest::prelude::*;
use protocol::epos2::DeviceError;

use super::super::{SimulatedDrive, SimulatedDriveConfig};
use super::SlcanServer;

struct Port {
    node: SimulatedDrive,
    server: SlcanServer,
}

impl Port {
    fn new() -> Self {
        let mut port = Self {
            node: SimulatedDrive::new(SimulatedDriveConfig {
                fault_at_power_on: DeviceError::NONE,
                initial_position: 0,
                ..SimulatedDriveConfig::default()
            }),
            server: SlcanServer::new(),
        };
        assert_eq!(port.ticks(1), "", "closed");
        port
    }

    fn send(&mut self, bytes: &[u8]) -> String {
        let mut out = Vec::new();
        self.server.input(&mut self.node, bytes, &mut |line| {
            out.extend_from_slice(line)
        });
        String::from_utf8(out).unwrap()
    }

    fn ticks(&mut self, n: usize) -> String {
        let mut out = Vec::new();
        for _ in 0..n {
            self.node.tick();
            self.server
                .poll(&mut self.node, &mut |line| out.extend_from_slice(line));
        }
        String::from_utf8(out).unwrap()
    }
}

#[test]
fn a_host_opens_reads_and_closes() {
    let mut port = Port::new();
    assert_eq!(port.send(b"\r\r\r"), "\r\r\r");
    assert_eq!(port.send(b"V\rN\r"), "V1013\rNEPOS\r");
    assert_eq!(
        port.send(b"t6018404160000000\r"),
        "\x07",
        "closed and too short"
    );
    assert_eq!(port.send(b"t60184041600000000000\r"), "\x07", "closed");
    assert_eq!(port.send(b"S8\rO\r"), "\r\r");
    assert_eq!(port.send(b"S8\rO\rZ1\r"), "\x07\x07\x07", "already open");
    assert_eq!(port.send(b"F\r"), "F00\r");
    assert_eq!(
        port.send(b"t60184041600000000000\r"),
        "z\rt58184B41600040010000\r"
    );
    // The device name, in segments.
    assert_eq!(
        port.send(b"t60184008100000000000\r"),
        "z\rt58184108100005000000\r"
    );
    assert_eq!(
        port.send(b"t60186000000000000000\r"),
        "z\rt58180545504F53320000\r"
    );
    // NMT: a reset boots, a remote frame is a guarding request.
    assert_eq!(port.send(b"t00028101\r"), "z\rt701100\r");
    assert_eq!(port.send(b"r7011\r"), "z\rt70117F\r");
    assert_eq!(
        port.send(b"T000006018FFFFFFFFFFFFFFFF\r"),
        "Z\r",
        "29-bit identifiers get no answer"
    );
    assert_eq!(port.send(b"X\r"), "\x07");
    assert_eq!(port.send(b"C\rC\r"), "\r\x07");
    assert_eq!(port.send(b"t60184041600000000000\r"), "\x07");
}

#[test]
fn listen_only_mode_receives_and_does_not_send() {
    let mut port = Port::new();
    assert_eq!(port.send(b"L\r"), "\r");
    assert_eq!(port.send(b"t00028101\r"), "\x07");
    port.node.power_cycle();
    assert_eq!(port.ticks(1), "t701100\r");
}

#[test]
fn frames_carry_time_stamps_when_enabled() {
    let mut port = Port::new();
    assert_eq!(port.send(b"Z1\rO\r"), "\r\r");
    port.ticks(60_998);
    assert_eq!(
        port.send(b"r7011\r"),
        "z\rt70117F03E7\r",
        "999 ms into the minute"
    );
}

#[test]
fn a_sync_stream_loses_no_samples() {
    let mut port = Port::new();
    port.send(b"S8\rO\r");
    for line in [
        "t60182300180181010080", // 1800:1 disabled
        "t60182F00180201000000", // on each SYNC
        "t60182B00180300000000", // no inhibit time
        "t60182F001A0000000000", // nothing mapped
        "t601823001A0120006460", // 6064
        "t601823001A0220001310", // 1013
        "t60182F001A0002000000", // two objects
        "t60182300180181010040", // 1800:1 enabled
    ] {
        let answer = port.send(std::format!("{line}\r").as_bytes());
        assert!(answer.starts_with("z\rt581860"), "{line}: {answer}");
    }
    assert_eq!(port.send(b"t00020101\r"), "z\r");
    let mut stamps = Vec::new();
    for _ in 0..2_000 {
        port.ticks(1);
        let answer = port.send(b"t0800\r");
        let data = answer.strip_prefix("z\rt1818").unwrap().trim_end();
        let stamp = u32::from_str_radix(&data[8..], 16).unwrap().swap_bytes();
        stamps.push(stamp);
    }
    assert!(stamps.windows(2).all(|pair| pair[1] - pair[0] == 1_000));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_adapter_recovers_from_arbitrary_bytes_after_a_cr(
        junk in prop::collection::vec(prop_oneof![3 => any::<u8>(), 1 => Just(b'\r'), 2 => prop::sample::select(b"tTrRSOCLZ0123456789ABCDEF".as_slice())], 0..300),
    ) {
        let mut port = Port::new();
        port.send(&junk);
        // Ends a partial line, then closes and opens the channel.
        port.send(b"\r");
        port.send(b"C\r");
        prop_assert_eq!(port.send(b"O\r"), "\r");
        prop_assert_eq!(port.send(b"V\r"), "V1013\r");
    }
}
