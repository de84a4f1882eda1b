//! The same story on each link: what the client does and what becomes of faults does not depend on how the drive is attached.

use protocol::epos2::DeviceError;
use protocol::epos2::message::Request;
use protocol::record::DriveLink;
use units::{Quadcounts, Span, Stamp};

use super::fake::{DISABLED, FAULT, Fate};
use super::rig::{Rig, to};
use crate::{
    AngleSource, AxisConfig, CommandOutcome, CommandProgress, DriveCommand, DriveError,
    Observation, PositionValidity, ShaftSample, StopReport,
};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];
/// From seeing that something is wrong to the quick stop, or to saying that the axis cannot be stopped.
const REACTION: Span = Span::from_millis(100);

fn moving_on(link: DriveLink) -> Rig {
    let mut rig = Rig::homed_on(link);
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(600)), None, "{link:?}");
    let moved = rig.fake.position(rig.now) + 40_000.0;
    assert!(moved > 5_000.0, "{link:?}: {moved}");
    rig
}

fn made_safe(rig: &Rig) -> Option<StopReport> {
    rig.progress().iter().find_map(|p| match p {
        CommandProgress::MadeSafe(stopped) => Some(*stopped),
        _ => None,
    })
}

#[test]
fn the_whole_story() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(connected.identity.name.as_str(), "EPOS2", "{link:?}");
        assert_eq!(connected.identity.serial, 0x9090_9090);
        assert_eq!(connected.history, [DeviceError::CAN_PASSIVE]);
        let on_can = link == DriveLink::Can;
        assert_eq!(connected.monitors_host, on_can);
        assert_eq!(connected.angle == AngleSource::Stream, on_can);
        rig.run(DriveCommand::Home).unwrap();
        let Ok(CommandOutcome::Arrived(arrived)) = rig.run(DriveCommand::Sweep(to(-15.0))) else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(arrived.position, Quadcounts(-10_000));
        let Ok(CommandOutcome::Stopped(stopped)) = rig.run(DriveCommand::Brake) else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(
            (stopped.validity, stopped.fault),
            (PositionValidity::Valid, false)
        );
        let stats = rig.client.link_stats();
        assert_eq!(
            (stats.lost, stats.unmatched, stats.damaged),
            (0, 0, 0),
            "{link:?}"
        );
        assert_eq!(rig.fake.objects[&(0x1016, 1)], 0, "the host may go");
    }
}

/// On RS232 a log tells more narrowly when the position was trigger: by when the answer was announced.
pub fn same(link: DriveLink, client: &ShaftSample, log: &ShaftSample) -> bool {
    let narrowed = ShaftSample {
        answer: log.answer,
        ..*client
    };
    match link {
        DriveLink::Rs232 => *log == narrowed && log.answer <= client.answer,
        DriveLink::Usb | DriveLink::Can => log == client,
    }
}

#[test]
fn a_log_tells_the_same_on_each_link() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
        rig.run(DriveCommand::Brake).unwrap();
        let heard = rig.heard();
        let sampled: Vec<ShaftSample> = heard
            .iter()
            .filter_map(|seen| match seen {
                Observation::Sample(sample) => Some(*sample),
                _ => None,
            })
            .collect();
        // The client also reads the position where it needs no sample.
        let samples = rig.samples();
        let mut rest = sampled.iter();
        assert!(
            samples
                .iter()
                .all(|s| rest.any(|other| same(link, s, other))),
            "{link:?}"
        );
        assert!(sampled.len() < samples.len() + 10);
        let wrote: Vec<_> = heard
            .iter()
            .filter_map(|seen| match seen {
                Observation::Wrote { address, value, .. } => {
                    Some((address.index, address.sub, *value))
                }
                _ => None,
            })
            .collect();
        assert_eq!(wrote, rig.writes(), "{link:?}");
        let is_noise = |seen: &&Observation| matches!(seen, Observation::Noise { .. });
        assert_eq!(heard.iter().find(is_noise), None, "{link:?}");
    }
}

#[test]
fn samples_lie_between_their_stamps_on_each_link() {
    for link in LINKS {
        let mut rig = Rig::homed_on(link);
        rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
        let samples = rig.samples();
        let moving: Vec<_> = samples
            .iter()
            .filter(|s| !matches!(s.position.0, -40_000 | -10_000))
            .collect();
        assert!(moving.len() > if link == DriveLink::Rs232 { 200 } else { 650 });
        // 37,500 qc/s from a start that all samples must agree on.
        let began =
            |at: Stamp<_>, qc: i32| at.as_nanos() as f64 / 1e9 - f64::from(qc + 40_000) / 37_500.0;
        let base = moving[0].request.as_nanos() as f64 / 1e9;
        let earliest = moving.iter().map(|s| began(s.answer, s.position.0) - base);
        let latest = moving
            .iter()
            .map(|s| began(s.request, s.position.0 + 1) - base);
        let (least, most) = (
            earliest.fold(f64::MAX, f64::min),
            latest.fold(f64::MIN, f64::max),
        );
        assert!(most <= least + 1e-6, "{link:?}: {most} {least}");
    }
}

#[test]
fn a_fault_in_mid_sweep_stops_it() {
    for link in LINKS {
        for (code, place) in [
            (0x8611, PositionValidity::Valid),
            (0xFF07, PositionValidity::Valid),
            (
                0x7320,
                PositionValidity::Lost {
                    error: Some(DeviceError::POSITION_SENSOR),
                },
            ),
        ] {
            let mut rig = moving_on(link);
            let at = rig.now + Span::from_millis(3);
            rig.fake.fault_at = Some((at, code));
            let error = Some(DeviceError(code));
            assert_eq!(rig.finish(), Err(DriveError::Fault { error }), "{link:?}");
            let stopped = made_safe(&rig).unwrap();
            assert_eq!((stopped.validity, stopped.fault), (place, true));
            assert_eq!(stopped.angle.is_some(), place == PositionValidity::Valid);
            assert_eq!(rig.fake.state, FAULT);
            let reaction = rig.quick_stop().unwrap() - at;
            // On CAN an emergency says it at once; else a look at the statusword does.
            let limit = if link == DriveLink::Can { 3 } else { 40 };
            assert!(
                reaction < Span::from_millis(limit),
                "{link:?}: {reaction:?}"
            );
        }
    }
}

#[test]
fn a_restart_in_mid_sweep_is_told_and_the_position_is_lost() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let at = rig.now;
        rig.fake.restart(at);
        let error = rig.finish().unwrap_err();
        assert!(
            matches!(error, DriveError::Restarted { .. }),
            "{link:?}: {error}"
        );
        assert!(error.help().contains("home again"));
        let stopped = made_safe(&rig).unwrap();
        assert_eq!(stopped.validity, PositionValidity::Lost { error: None });
        assert_eq!(stopped.angle, None);
        let reaction = rig.quick_stop().unwrap() - at;
        // On CAN the boot-up message says it; else what was asked last is not answered, and its time has to pass first.
        let limit = if link == DriveLink::Can { 3 } else { 200 };
        assert!(
            reaction < Span::from_millis(limit),
            "{link:?}: {reaction:?}"
        );
        // No move before it has been connected again.
        assert!(rig.run(DriveCommand::Goto(to(0.0))).is_err());
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        assert!(rig.run(DriveCommand::Goto(to(0.0))).is_ok(), "{link:?}");
    }
}

#[test]
fn a_lost_link_in_mid_sweep_is_told_in_time() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let died = rig.now;
        rig.fake.hand = Box::new(|_, _| Fate::Lost);
        rig.fake.bus.mute = true;
        rig.fake.bus.copies = Box::new(|_| 0);
        let error = rig.finish().unwrap_err();
        let DriveError::NotStopped { cause, stop } = &error else {
            panic!("{link:?}: {error:?}")
        };
        assert!(
            matches!(
                **cause,
                DriveError::LinkLost { .. } | DriveError::NodeSilent { .. }
            ),
            "{cause:?}"
        );
        assert!(matches!(**stop, DriveError::LinkLost { .. }), "{stop:?}");
        // The quick stop went out all the same, for a drive that hears but cannot be heard.
        if link != DriveLink::Rs232 {
            assert_eq!(rig.fake.state, super::fake::QUICK_STOP, "{link:?}");
            let seen = rig.quick_stop().unwrap();
            assert!(rig.now - seen < REACTION, "{link:?}");
        }
        // The time of one answer, and of the markers after it; then the last try.
        assert!(
            rig.now - died < Span::from_millis(500),
            "{link:?} {:?}",
            rig.now - died
        );
    }
}

#[test]
fn an_axis_that_does_not_follow_is_given_up() {
    for link in LINKS {
        let mut rig = Rig::homed_on(link);
        rig.fake.blocked = true;
        let error = rig.run(DriveCommand::Goto(to(45.0))).unwrap_err();
        assert!(
            matches!(error, DriveError::NotArrived { .. }),
            "{link:?}: {error}"
        );
        assert_eq!(rig.fake.state, DISABLED);
    }
}

/// The host is held up for longer than the margin, shortly before, at and after the arrival, at any point of a dialogue.
#[test]
fn a_host_that_sleeps_through_the_arrival_finds_the_axis_there() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        let mut usual = Rig::homed_on(link);
        let began = usual.now;
        usual.run(DriveCommand::Goto(to(-15.0))).unwrap();
        let took = usual.now - began;
        for k in 1..60 {
            let mut rig = Rig::homed_on(link);
            rig.client.start(DriveCommand::Goto(to(-15.0))).unwrap();
            let before = took - Span::from_micros(970 * k);
            assert_eq!(rig.run_for(before), None, "{link:?}");
            rig.sleep(Span::from_millis(1_700));
            let ended = rig.finish();
            let Ok(CommandOutcome::Arrived(arrived)) = ended else {
                panic!("{link:?} {before:?}: {ended:?}")
            };
            assert_eq!(arrived.position, Quadcounts(-10_000));
        }
    }
}

/// On CAN the drive does not wait for such a host, and its word stands.
#[test]
fn a_host_that_sleeps_on_can_is_told_that_the_drive_stopped() {
    let mut rig = moving_on(DriveLink::Can);
    // The drive's own time goes on meanwhile.
    for _ in 0..1_700 {
        rig.now += Span::from_millis(1);
        rig.fake.live(rig.now);
    }
    let error = rig.finish().unwrap_err();
    let error_8130 = DriveError::Fault {
        error: Some(DeviceError(0x8130)),
    };
    assert_eq!(error, error_8130);
    assert_eq!(made_safe(&rig).unwrap().validity, PositionValidity::Valid);
}

/// A change of state and a standstill that the host slept through are seen, too.
#[test]
fn a_host_that_sleeps_at_any_time_finds_what_has_become_of_it() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for k in 0..150 {
            let mut config = AxisConfig::default();
            config.homing.time_limit = Span::from_millis(1_500);
            config.timing.state_limit = Span::from_secs(1);
            let mut rig = Rig::on(link, config);
            rig.fake.homing_time = Span::from_millis(300);
            for command in [
                DriveCommand::Connect,
                DriveCommand::Home,
                DriveCommand::Goto(to(-50.0)),
                DriveCommand::Stop,
            ] {
                rig.client.start(command).unwrap();
                let mut ended = rig.run_for(Span::from_micros(1 + 970 * k));
                if ended.is_none() {
                    rig.sleep(Span::from_millis(1_800));
                    ended = Some(rig.finish());
                }
                // A dialogue of RS232 broken off by sleep leaves open what became of a write.
                let open = matches!(ended, Some(Err(DriveError::NoAnswer { .. })))
                    && link == DriveLink::Rs232;
                assert!(
                    open || matches!(ended, Some(Ok(_))),
                    "{link:?} {command:?} {k}: {ended:?}"
                );
                if open {
                    break;
                }
            }
        }
    }
}

#[test]
fn loss_damage_repetition_and_refusal_are_survived() {
    for link in LINKS {
        for (fate, every) in [
            (Fate::Lost, 41),
            (Fate::Damaged, 23),
            (Fate::Twice, 17),
            (Fate::Rejected, 19),
            (Fate::Late(Span::from_millis(3)), 13),
            (Fate::Late(Span::from_millis(130)), 47),
        ] {
            let mut rig = Rig::on(link, AxisConfig::default());
            // Reads and rejected writes are repeated; a write whose answer is lost is not. Segments are begun anew by the whole.
            rig.fake.hand = Box::new(move |n, request| {
                let repeated = match request {
                    Request::ReadObject(_) => true,
                    _ => {
                        matches!(fate, Fate::Rejected | Fate::Twice)
                            || fate == Fate::Late(Span::from_millis(3))
                    }
                };
                // An answer of CAN cannot be refused but by name.
                let possible = !(link == DriveLink::Can && fate == Fate::Rejected);
                if n % every == 0 && repeated && possible {
                    fate
                } else {
                    Fate::Sent
                }
            });
            for command in [
                DriveCommand::Connect,
                DriveCommand::Home,
                DriveCommand::Sweep(to(-15.0)),
                DriveCommand::Brake,
            ] {
                let result = rig.run(command);
                assert!(result.is_ok(), "{link:?} {fate:?} {command:?}: {result:?}");
            }
            assert_eq!(rig.fake.position(rig.now), -10_000.0);
        }
    }
}

#[test]
fn a_wrong_toggle_bit_is_told() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        rig.fake.wrong_toggle = true;
        let error = rig.run(DriveCommand::Connect).unwrap_err();
        assert_eq!(
            error.to_string(),
            "reading object 1008:00 in segments: SDO: toggle bit 1, expected 0",
            "{link:?}"
        );
        assert!(rig.writes().is_empty());
    }
}

#[test]
fn a_stop_from_mid_sweep_is_immediate_and_keeps_the_position() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let asked = rig.now;
        rig.client.start(DriveCommand::Stop).unwrap();
        let Ok(CommandOutcome::Stopped(stopped)) = rig.finish() else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(stopped.validity, PositionValidity::Valid);
        assert_eq!(
            f64::from(stopped.position.0),
            rig.fake.position(rig.now).floor()
        );
        let reaction = rig.quick_stop().unwrap() - asked;
        assert!(reaction < Span::from_millis(10), "{link:?}: {reaction:?}");
        assert_eq!(rig.fake.state, DISABLED);
        assert_eq!(rig.fake.objects[&(0x1016, 1)], 0);
    }
}

/// No value of it is taken, and what was asked is asked again.
#[test]
fn an_answer_to_another_request_in_mid_sweep_is_passed_over() {
    for link in LINKS {
        let mut rig = Rig::homed_on(link);
        rig.fake.hand = Box::new(|n, request| match request {
            Request::ReadObject(read) if n % 11 == 5 && read.address.index == 0x6041 => {
                Fate::Another
            }
            Request::ReadObject(read) if n % 17 == 5 && read.address.index == 0x6064 => {
                Fate::Another
            }
            _ => Fate::Sent,
        });
        let Ok(CommandOutcome::Arrived(arrived)) = rig.run(DriveCommand::Sweep(to(-15.0))) else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(arrived.position, Quadcounts(-10_000));
        let in_order = |pair: &[ShaftSample]| pair[0].position <= pair[1].position;
        assert!(rig.samples().windows(2).all(in_order), "{link:?}");
        assert!(rig.client.link_stats().unmatched > 0, "{link:?}");
    }
}
