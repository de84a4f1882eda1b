//! The angle of a rotating motor at each SYNC, as in a capture over CAN: TPDO 1 with position and
//! time, 1000 per second.

use std::fmt;

use io::clock;
use protocol::canopen::heartbeat::Heartbeat;
use protocol::canopen::pdo::{
    Configuration, MappedObject, Pdo, PdoLayout, TransmissionType, configuration,
};
use protocol::canopen::sync::SyncMessage;
use protocol::canopen::{CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects;
use units::{Host, Span, Stamp};

use crate::bus::{Master, ReceivedFrame};

const SYNCS: usize = 1000;
const PERIOD: Span = Span::from_millis(1);
/// Wait for the samples of the last SYNCs.
const REST: Span = Span::from_secs(1);
/// Away from the positive limit switch, where the axis starts; 20 qc/ms, 30 deg in the second.
const SPEED_RPM: i32 = -600;
/// The same speed with the default rig's 2000 qc per revolution.
const SPEED_QC_US: f64 = SPEED_RPM as f64 * 2000.0 / 60e6;
const PDO: Pdo = Pdo::Transmit(PdoNumber::One);

/// The process data: position and time of the same instant.
fn layout() -> PdoLayout {
    let entries = [
        MappedObject::of(objects::POSITION_ACTUAL),
        MappedObject::of(objects::TIMESTAMP),
    ];
    PdoLayout::new(&entries).unwrap()
}

/// Makes the node send its angle and time at each SYNC.
pub fn map_angle(master: &mut Master, node: NodeId) {
    let wanted = Configuration {
        transmission: TransmissionType::EACH_SYNC,
        inhibit_100us: Some(0),
        layout: layout(),
    };
    for write in configuration(PDO, node, &wanted) {
        master
            .write_raw(write.address, write.data.as_slice())
            .unwrap_or_else(|error| panic!("{}: {error}", write.address));
    }
}

/// Enables operation, then moves at constant speed.
pub fn enable_and_rotate(master: &mut Master) {
    for (word, state) in [
        (control::SHUTDOWN, DeviceState::ReadyToSwitchOn),
        (control::SWITCH_ON, DeviceState::SwitchedOn),
        (control::ENABLE_OPERATION, DeviceState::OperationEnabled),
    ] {
        master.write(objects::CONTROLWORD, word);
        wait_for_state(master, state);
    }
    master.write(objects::MODE, mode::PROFILE_VELOCITY);
    master.write(objects::PROFILE_ACCELERATION, 10_000);
    master.write(objects::PROFILE_DECELERATION, 10_000);
    master.write(objects::TARGET_VELOCITY, SPEED_RPM);
    master.write(objects::CONTROLWORD, control::ENABLE_OPERATION);
    master.poll("the speed", |master| {
        master.read(objects::VELOCITY_DEMAND) == SPEED_RPM
            && master.read(objects::STATUSWORD) & status::TARGET_REACHED != 0
    });
}

/// Stops the motor.
pub fn halt(master: &mut Master) {
    master.write(objects::CONTROLWORD, control::HALT_MOTION);
    master.poll("the stop", |master| {
        master.read(objects::VELOCITY_DEMAND) == 0
    });
}

/// Waits until the statusword shows `state`.
pub fn wait_for_state(master: &mut Master, state: DeviceState) {
    master.poll(&format!("{state:?}"), |master| {
        DeviceState::from_statusword(master.read(objects::STATUSWORD)) == Some(state)
    });
}

/// A SYNC and its sample.
struct Sample {
    position_qc: i32,
    time_us: u32,
    host: Stamp<Host>,
}

impl Sample {
    fn of((frame, host): &ReceivedFrame, node: NodeId) -> Option<Self> {
        let wanted = CommunicationObject::TransmitPdo(PdoNumber::One, node).cob_id();
        let layout = layout();
        let data = (frame.cob_id() == Some(wanted)).then(|| frame.data())?;
        Some(Self {
            position_qc: layout.get(objects::POSITION_ACTUAL, data).unwrap()?,
            time_us: layout.get(objects::TIMESTAMP, data).unwrap()?,
            host: *host,
        })
    }
}

/// Results of one second.
pub struct Report {
    samples: usize,
    beats: usize,
    took: Span,
    latest_sync: Span,
    median_answer: Span,
    latest_answer: Span,
    instants: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{SYNCS} SYNC in {:.4} s (the latest {:.0} us after its time), {} samples, {} lost, of {} instants; answered after \
             {:.0} us in the middle, {:.0} us at most; {} heartbeats",
            self.took.as_secs_f64(),
            self.latest_sync.as_micros_f64(),
            self.samples,
            SYNCS - self.samples,
            self.instants,
            self.median_answer.as_micros_f64(),
            self.latest_answer.as_micros_f64(),
            self.beats,
        )
    }
}

/// Sends SYNCs for a second. Every SYNC must have its sample, and every sample must lie on the
/// motor's line.
pub fn one_second(master: &mut Master, node: NodeId) -> Report {
    master.take_received();
    let begin = clock::now() + PERIOD;
    let due = |beat: usize| begin + Span::from_nanos(PERIOD.as_nanos() * beat as i64);
    let mut syncs = Vec::with_capacity(SYNCS);
    for beat in 0..SYNCS {
        master.listen(due(beat));
        syncs.push(master.send(&SyncMessage::default().to_frame()));
    }
    master.listen(due(SYNCS) + REST);
    let received = master.take_received();
    let samples: Vec<_> = received
        .iter()
        .filter_map(|h| Sample::of(h, node))
        .collect();
    assert_eq!(samples.len(), SYNCS, "samples of {SYNCS} SYNC");
    on_the_line(&samples);

    let sent = (0..).zip(&syncs);
    let late = sent.map(|(beat, at)| at.saturating_since(due(beat)));
    let answers = syncs.iter().zip(&samples);
    let mut answers: Vec<_> = answers
        .map(|(sync, sample)| sample.host.saturating_since(*sync))
        .collect();
    answers.sort_unstable();
    // Pairs are made in order: a sample before its SYNC would belong to another.
    assert!(answers[0] > Span::ZERO, "{:?}", answers[0]);
    let took = syncs[SYNCS - 1].saturating_since(syncs[0]);
    assert!(took < Span::from_millis(1_200), "{took:?}: not 1 kHz");
    let mut instants: Vec<_> = samples.iter().map(|sample| sample.time_us).collect();
    instants.dedup();
    Report {
        samples: samples.len(),
        beats: received
            .iter()
            .filter(|h| Heartbeat::parse(&h.0).is_ok())
            .count(),
        took,
        latest_sync: late.max().unwrap(),
        median_answer: answers[SYNCS / 2],
        latest_answer: answers[SYNCS - 1],
        instants: instants.len(),
    }
}

/// Checks that position and time of a sample belong together: at constant speed they form a line up
/// to whole counts.
fn on_the_line(samples: &[Sample]) {
    let first = &samples[0];
    let mut before_us = 0;
    for (number, sample) in samples.iter().enumerate() {
        let since_us = sample.time_us.wrapping_sub(first.time_us);
        assert!(since_us >= before_us, "sample {number}: time runs back");
        before_us = since_us;
        let moved_qc = f64::from(sample.position_qc.wrapping_sub(first.position_qc));
        let off_qc = moved_qc - SPEED_QC_US * f64::from(since_us);
        assert!(off_qc.abs() <= 1.01, "sample {number}: {off_qc} qc off");
    }
    let whole_us = f64::from(before_us);
    assert!((9e5..1.3e6).contains(&whole_us), "{whole_us} us of samples");
}
