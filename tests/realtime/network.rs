//! The lidar's network settings: group, source and ports of a live capture; IP fragments of a
//! recording.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::simulated_drive::Drive;
use sim::{Rig, RigConfig};
use units::{Span, Stamp};

const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 76, 70);
/// Addresses of the lidar and of another sender.
const LIDAR: Ipv4Addr = Ipv4Addr::new(127, 0, 0, 2);
const OTHER: Ipv4Addr = Ipv4Addr::new(127, 0, 0, 3);

fn velomotion(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", folder)
        .output()
        .unwrap()
}

/// The text on stderr without line breaks.
fn printed(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).replace('│', " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn json(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", printed(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A simulated lidar and another sender of the same packets, running until dropped.
struct Lidar(Arc<AtomicBool>, Option<JoinHandle<()>>);

impl Lidar {
    fn start(to: Ipv4Addr, data: u16, position: u16) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let stopping = Arc::clone(&stop);
        // The bound address selects the interface.
        let senders = [LIDAR, OTHER].map(|from| UdpSocket::bind((from, 0)).unwrap());
        let thread = thread::spawn(move || {
            let mut rig = Rig::new(RigConfig::new(io::clock::now()));
            while !stopping.load(Ordering::Relaxed) {
                rig.advance(io::clock::now());
                while let Some(datagram) = rig.poll_datagram() {
                    let port = if datagram.port == 2368 {
                        data
                    } else {
                        position
                    };
                    for sender in &senders {
                        sender.send_to(&datagram.payload, (to, port)).unwrap();
                    }
                }
                thread::sleep(Duration::from_millis(1));
            }
        });
        Self(stop, Some(thread))
    }
}

impl Drop for Lidar {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        self.1.take().unwrap().join().unwrap();
    }
}

/// Whether this machine carries multicast on its loopback interface.
fn has_multicast() -> bool {
    let received = || {
        let receiver = UdpSocket::bind("0.0.0.0:0")?;
        receiver.join_multicast_v4(&GROUP, &Ipv4Addr::LOCALHOST)?;
        receiver.set_read_timeout(Some(Duration::from_secs(2)))?;
        let to = (GROUP, receiver.local_addr()?.port());
        UdpSocket::bind((LIDAR, 0))?.send_to(b"anybody?", to)?;
        receiver.recv(&mut [0; 16])
    };
    match received() {
        Ok(_) => true,
        Err(error) => {
            eprintln!(
                "without multicast: this machine has none on its loopback interface ({error})"
            );
            false
        }
    }
}

fn free_port() -> u16 {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.local_addr().unwrap().port()
}

#[test]
fn group_sender_and_ports_follow_the_configuration_and_the_log_replays() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let group = has_multicast().then_some(GROUP);
    let (data, position) = (free_port(), free_port());
    let _drive = Drive::plug(&place.join("epos"));
    let configure = |source: Ipv4Addr| {
        let group = group.map_or(String::new(), |group| format!("lidar_group = '{group}'\n"));
        let config = format!(
            "[device]\ndefault = 'soft'\n[device.soft]\nkind = 'usb'\nport = 'epos'\nlidar = '127.0.0.1'\n\
             {group}lidar_source = '{source}'\ndata_port = {data}\nposition_port = {position}\n"
        );
        std::fs::write(place.join("velomotion.toml"), config).unwrap();
    };
    let _lidar = Lidar::start(group.unwrap_or(Ipv4Addr::LOCALHOST), data, position);

    configure(Ipv4Addr::new(127, 0, 0, 9));
    let silent = velomotion(place, "capture --speed 80 --to -8 -o scan.ply");
    let why = printed(&silent);
    assert_eq!(silent.status.code(), Some(4), "{why}");
    for word in [
        "no packet came from 127.0.0.9",
        &format!("UDP ports {data} and {position}"),
        "packets came from other addresses",
    ] {
        assert!(why.contains(word), "no {word:?} in: {why}");
    }

    configure(LIDAR);
    let output = velomotion(
        place,
        "capture --speed 80 --to -8 -o scan.ply --json --force",
    );
    assert!(output.status.success(), "{}", printed(&output));
    let scan = json(&output);
    let received = |name: &str| scan["reception"][name].as_u64().unwrap();
    assert!(received("received") > 100, "{scan}");
    assert!(received("from_others") > 100, "{scan}");
    assert_eq!(
        received("dropped_by_kernel") + received("dropped_by_log"),
        0
    );
    assert_eq!(received("without_kernel_time"), 0);
    assert!(scan["packets"]["data"].as_u64().unwrap() > 100, "{scan}");
    assert!(scan["packets"]["position"].as_u64().unwrap() > 0, "{scan}");

    let replay = velomotion(place, "replay scan.pcapng -o again.ply");
    let table = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(replay.status.success(), "{}", printed(&replay));
    assert!(
        !table.contains("recorded"),
        "a replay records nothing:\n{table}"
    );
    let [first, again] = ["scan.ply", "again.ply"].map(|name| std::fs::read(place.join(name)));
    assert!(first.unwrap() == again.unwrap(), "not the same cloud");
}

/// A classic pcap of bare IP packets: each datagram in two fragments, on a port that is not the
/// factory's.
fn fragmented(rig: &mut Rig) -> (Vec<u8>, u64) {
    let mut file = vec![0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0];
    file.extend([0; 8]);
    file.extend(65_535_u32.to_le_bytes());
    file.extend(101_u32.to_le_bytes());
    let mut count = 0;
    while let Some(datagram) = rig.poll_datagram() {
        let mut udp = Vec::new();
        for word in [443, datagram.port + 1, datagram.payload.len() as u16 + 8, 0] {
            udp.extend(word.to_be_bytes());
        }
        udp.extend(&datagram.payload);
        let us = datagram.at.as_nanos() / 1000;
        let (head, tail) = udp.split_at(400);
        for (part, offset, more) in [(head, 0, 1 << 13), (tail, 50, 0)] {
            let mut packet = vec![0x45, 0];
            for word in [part.len() as u16 + 20, count as u16, more | offset] {
                packet.extend(word.to_be_bytes());
            }
            packet.extend([64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255]);
            packet.extend(part);
            file.extend(((us / 1_000_000) as u32).to_le_bytes());
            file.extend(((us % 1_000_000) as u32).to_le_bytes());
            file.extend([(packet.len() as u32).to_le_bytes(); 2].concat());
            file.extend(packet);
        }
        count += 1;
    }
    (file, count)
}

#[test]
fn reassembled_packets_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let start = Stamp::from_nanos(1_700_000_000_000_000_000);
    let mut rig = Rig::new(RigConfig::new(start));
    rig.advance(start + Span::from_millis(300));
    let (file, count) = fragmented(&mut rig);
    assert!(count > 200);
    std::fs::write(folder.path().join("parts.pcap"), file).unwrap();
    let warning = format!("{count} packets were reassembled from IP fragments");
    for line in [
        "info parts.pcap --json",
        "replay parts.pcap --tilt none -o parts.ply --json",
    ] {
        let report = json(&velomotion(folder.path(), line));
        let packets = |of: &str| report["packets"][of].as_u64().unwrap();
        assert_eq!(packets("data") + packets("position"), count, "{report}");
        assert_eq!(packets("other"), 0, "{report}");
        let warnings = report["warnings"].as_array().unwrap();
        assert!(warnings.contains(&warning.clone().into()), "{report}");
    }
}
