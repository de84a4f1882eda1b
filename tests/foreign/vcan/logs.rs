//! Checks of the sweep's logs, the project's own and `candump`'s, also with tshark.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use io::recording::Recording;
use protocol::canopen::{CanFrame, CobId, CommunicationObject, NodeId, PdoNumber};
use protocol::record::{Direction, Wire};

use crate::candump;

/// Name of the project's log.
pub const LOG: &str = "sweep.pcapng";
/// Name of `candump`'s log.
pub const CANDUMP_LOG: &str = "candump.log";

/// Frames with their counts.
type Passed = BTreeMap<[u8; 16], usize>;

/// Checks that SYNCs have their samples, that `candump` logged the same frames, and that tshark
/// dissects both logs as CANopen.
pub fn check(folder: &Path) {
    let ours = frames_of_log(&folder.join(LOG));
    tshark(&folder.join(LOG), &ours);
    let candump = folder.join(CANDUMP_LOG);
    let theirs = frames_of_candump(&fs::read_to_string(&candump).unwrap());
    compare(&ours, &theirs);
    tshark(&candump, &theirs);
}

fn node() -> NodeId {
    NodeId::new(1).unwrap()
}

/// Reads the frames of the log. Samples may be missing only where the machine was busy.
fn frames_of_log(path: &Path) -> Passed {
    let mut recording = Recording::open(path).unwrap();
    let mut passed = Passed::new();
    while let Some(record) = recording.next_record().unwrap() {
        let Wire::Drive {
            direction, frame, ..
        } = record.wire
        else {
            panic!("{record:?}");
        };
        let frame = CanFrame::from_socketcan(frame).unwrap();
        let is_sync = frame.cob_id() == Some(CobId::SYNC);
        assert_eq!(is_sync, is_sync && direction == Direction::ToDrive);
        *passed.entry(frame.to_socketcan()).or_default() += 1;
    }
    assert!(recording.end().is_some());
    let [syncs, samples] = [CobId::SYNC, stream()].map(|id| of(&passed, id));
    println!("{syncs} SYNCs, {samples} samples");
    // More than a second of the sweep at 1 kHz.
    assert!(syncs > 1_000, "{syncs}");
    // On an idle machine every SYNC has its sample; the test prints how many. On a busy one the
    // simulated drive misses a few, and it never sends an unsolicited sample.
    let lost = syncs.checked_sub(samples).unwrap();
    assert!(lost <= 3 + syncs / 50, "{lost} of {syncs}");
    passed
}

fn stream() -> CobId {
    CommunicationObject::TransmitPdo(PdoNumber::One, node()).cob_id()
}

/// Number of frames with this identifier.
fn of(passed: &Passed, id: CobId) -> usize {
    let has = |bytes: &[u8; 16]| CanFrame::from_socketcan(bytes).unwrap().cob_id() == Some(id);
    let with_id = passed.iter().filter(|(bytes, _)| has(bytes));
    with_id.map(|(_, count)| count).sum()
}

/// Parses lines like `(1700000000.000000) vcan0 181#0011223344556677`.
fn frames_of_candump(text: &str) -> Passed {
    let mut passed = Passed::new();
    for line in text.lines() {
        let (id, data) = line.rsplit(' ').next().unwrap().split_once('#').unwrap();
        let id = CobId::new(u16::from_str_radix(id, 16).unwrap()).unwrap();
        let data: Vec<u8> = (0..data.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&data[at..at + 2], 16).unwrap())
            .collect();
        let frame = CanFrame::new(id, &data).unwrap();
        *passed.entry(frame.to_socketcan()).or_default() += 1;
    }
    passed
}

/// Compares the logs. Every frame of the project's log is in `candump`'s as often. The rest of
/// `candump`'s log is probes, the node's heartbeats before and after the client, and last answers
/// that the client did not read.
fn compare(ours: &Passed, theirs: &Passed) {
    let mut unread = 0;
    for (frame, received) in theirs {
        let count = ours.get(frame).copied().unwrap_or_default();
        let frame = CanFrame::from_socketcan(frame).unwrap();
        let heartbeat = frame.cob_id() == Some(CommunicationObject::Heartbeat(node()).cob_id());
        if heartbeat || candump::is_probe(&frame) {
            continue;
        }
        assert!(
            count <= *received,
            "{frame}: {received} received, {count} in the log"
        );
        unread += received - count;
        let answer = frame.cob_id() == Some(stream());
        assert!(
            count == *received || answer,
            "{frame}: {received} received, {count} in the log"
        );
    }
    for frame in ours.keys() {
        assert!(theirs.contains_key(frame), "{frame:?}");
    }
    let samples = of(theirs, stream());
    assert!(unread <= 3 + samples / 50, "{unread} of {samples}");
}

/// Checks that tshark finds every frame and no malformed one.
fn tshark(path: &Path, passed: &Passed) {
    let lines = |filter: &str| {
        let output = Command::new("tshark")
            .args(["-n", "-d", "can.subdissector,canopen", "-r"])
            .arg(path)
            .args(["-Y", filter])
            .output();
        let output = output.unwrap_or_else(|error| panic!("tshark: {error}"));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{path:?}: {errors}");
        String::from_utf8(output.stdout).unwrap()
    };
    let malformed = lines("_ws.malformed");
    assert_eq!(malformed, "");
    // A SYNC has no data.
    assert_eq!(lines("can && !canopen && can.len > 0"), "");
    let frames = lines("can").lines().count();
    assert_eq!(frames, passed.values().sum::<usize>());
}
