//! The logs of a sweep, the project's own and `candump`'s: what is in them, and what tshark makes
//! of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use io::recording::Recording;
use protocol::canopen::{CanFrame, CobId, CommunicationObject, NodeId, PdoNumber};
use protocol::record::{Direction, Wire};

use crate::onlooker;

/// The project's log.
pub const LOG: &str = "sweep.pcapng";
/// `candump`'s.
pub const CANDUMP_LOG: &str = "candump.log";

/// Frames and how often each of them passed.
type Passed = BTreeMap<[u8; 16], usize>;

/// SYNCs have their samples, `candump` heard what the client said and heard, and tshark dissects
/// both logs as CANopen.
pub fn check(folder: &Path) {
    let ours = of_the_log(&folder.join(LOG));
    tshark(&folder.join(LOG), &ours);
    let candump = folder.join(CANDUMP_LOG);
    let theirs = of_candump(&fs::read_to_string(&candump).unwrap());
    compare(&ours, &theirs);
    tshark(&candump, &theirs);
}

fn node() -> NodeId {
    NodeId::new(1).unwrap()
}

/// The frames of the log; none of the stream's may be missing but where the machine is kept
/// waiting.
fn of_the_log(path: &Path) -> Passed {
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
        assert_eq!(is_sync, is_sync && direction == Direction::ToDevice);
        *passed.entry(frame.to_socketcan()).or_default() += 1;
    }
    assert!(recording.end().is_some());
    let [syncs, samples] = [CobId::SYNC, stream()].map(|id| of(&passed, id));
    println!("{syncs} SYNCs, {samples} samples");
    // A second and more of the sweep alone, at 1 kHz.
    assert!(syncs > 1_000, "{syncs}");
    // On a machine that has time every SYNC has its sample (the test says how many). Where this one
    // is kept waiting, the software drive is late for some; never for many, and it never sends what
    // was not asked for.
    let lost = syncs.checked_sub(samples).unwrap();
    assert!(lost <= 3 + syncs / 50, "{lost} of {syncs}");
    passed
}

fn stream() -> CobId {
    CommunicationObject::TransmitPdo(PdoNumber::One, node()).cob_id()
}

/// How many frames have this identifier.
fn of(passed: &Passed, id: CobId) -> usize {
    let has = |bytes: &[u8; 16]| CanFrame::from_socketcan(bytes).unwrap().cob_id() == Some(id);
    let with_id = passed.iter().filter(|(bytes, _)| has(bytes));
    with_id.map(|(_, count)| count).sum()
}

/// The frames of lines like `(1700000000.000000) vcan0 181#0011223344556677`.
fn of_candump(text: &str) -> Passed {
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

/// What is in the log was on the bus, as often; what `candump` has besides is what it was shown,
/// the node's heartbeat before and after the client, and the last answers, which nobody read any
/// more.
fn compare(ours: &Passed, theirs: &Passed) {
    let mut unread = 0;
    for (frame, heard) in theirs {
        let count = ours.get(frame).copied().unwrap_or_default();
        let frame = CanFrame::from_socketcan(frame).unwrap();
        let heartbeat = frame.cob_id() == Some(CommunicationObject::Heartbeat(node()).cob_id());
        if heartbeat || onlooker::is_probe(&frame) {
            continue;
        }
        assert!(
            count <= *heard,
            "{frame}: {heard} heard, {count} in the log"
        );
        unread += heard - count;
        let answer = frame.cob_id() == Some(stream());
        assert!(
            count == *heard || answer,
            "{frame}: {heard} heard, {count} in the log"
        );
    }
    for frame in ours.keys() {
        assert!(theirs.contains_key(frame), "{frame:?}");
    }
    let samples = of(theirs, stream());
    assert!(unread <= 3 + samples / 50, "{unread} of {samples}");
}

/// Somebody else's CANopen finds every frame and no fault in any.
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
    // A SYNC has no data to dissect.
    assert_eq!(lines("can && !canopen && can.len > 0"), "");
    let frames = lines("can").lines().count();
    assert_eq!(frames, passed.values().sum::<usize>());
}
