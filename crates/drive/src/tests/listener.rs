//! The listener's observations of a log compared with the client's.

use proptest::prelude::*;
use protocol::record::{Direction, DriveLink};
use units::Span;

use super::rig::{Rig, to};
use super::test_drive::Fate;
use crate::{DriveCommand, DriveListener, Observation, ShaftSample};

fn sampled(observed: &[Observation]) -> Vec<ShaftSample> {
    observed
        .iter()
        .filter_map(|seen| match seen {
            Observation::Sample(sample) => Some(*sample),
            _ => None,
        })
        .collect()
}

#[test]
fn a_log_gives_the_clients_samples_writes_and_states() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let observed = rig.observations();
    assert_eq!(sampled(&observed), rig.samples());
    let wrote: Vec<_> = observed
        .iter()
        .filter_map(|seen| match seen {
            Observation::Wrote { address, value, .. } => Some((address.index, address.sub, *value)),
            _ => None,
        })
        .collect();
    assert_eq!(wrote, rig.writes());
    assert!(observed.iter().any(|seen| matches!(
        seen,
        Observation::Statusword { value, .. } if value & 0x417F == 0x0137
    )));
}

#[test]
fn lost_and_late_answers_do_not_corrupt_the_log() {
    let mut rig = Rig::homed();
    rig.drive.hand = Box::new(|n, request| match n % 31 {
        _ if matches!(
            request,
            protocol::epos2::message::SerialRequest::WriteObject(_)
        ) =>
        {
            Fate::Sent
        }
        3 => Fate::Lost,
        11 => Fate::Late(Span::from_millis(120)),
        19 => Fate::Damaged,
        27 => Fate::Twice,
        _ => Fate::Sent,
    });
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let observed = rig.observations();
    // A value after a long silence may be of another request: a log may lack what was between.
    let is_prompt = |s: &ShaftSample| s.answer - s.request < Span::from_millis(120);
    let samples = rig.samples();
    let prompt: Vec<ShaftSample> = samples.iter().copied().filter(is_prompt).collect();
    assert!(prompt.len() < samples.len());
    assert_eq!(sampled(&observed), prompt);
    assert!(
        observed
            .iter()
            .any(|seen| matches!(seen, Observation::Noise { .. }))
    );
}

#[test]
fn logs_that_start_in_mid_traffic_are_decoded() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let all = sampled(&rig.observations());
    for cut in [1, 2, 101, 102] {
        rig.log.drain(..cut);
        let rest = sampled(&rig.observations());
        assert_eq!(rest, all[all.len() - rest.len()..]);
        assert!(rest.len() + cut + 1 >= all.len().saturating_sub(200));
    }
}

#[test]
fn requests_to_other_nodes_are_ignored() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Goto(to(-15.0))).unwrap();
    let mut listener = DriveListener::new(2);
    for (direction, frame, host) in &rig.log {
        listener.observe(DriveLink::Usb, *direction, frame, *host, &mut |seen| {
            panic!("{seen:?}");
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Noise between frames, damaged and missing frames: fewer samples, never wrong ones.
    #[test]
    fn noise_never_produces_a_sample(
        noise in proptest::collection::vec((any::<prop::sample::Index>(), proptest::collection::vec(any::<u8>(), 0..20), any::<bool>()), 0..20),
        missing in proptest::collection::vec(any::<prop::sample::Index>(), 0..10),
    ) {
        let mut rig = Rig::homed();
        let until = rig.now + Span::from_millis(80);
        rig.run(DriveCommand::Hold { until }).unwrap();
        rig.run(DriveCommand::Goto(crate::MoveCommand { speed: units::Rpm(1500), ..to(-55.0) })).unwrap();
        let truth = sampled(&rig.observations());
        for index in &missing {
            // Only replies can be missing: a recorder has its own requests.
            let at = index.index(rig.log.len());
            if rig.log[at].0 == Direction::FromDrive {
                rig.log.remove(at);
            }
        }
        for (index, bytes, to_device) in &noise {
            let at = index.index(rig.log.len());
            let direction = if *to_device { Direction::ToDrive } else { Direction::FromDrive };
            let host = rig.log[at].2;
            rig.log.insert(at, (direction, bytes.clone(), host));
        }
        let observed = sampled(&rig.observations());
        for sample in &observed {
            prop_assert!(truth.contains(sample), "{sample:?}");
        }
    }
}
