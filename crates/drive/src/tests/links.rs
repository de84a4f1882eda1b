//! The same scenarios on each link: commands and faults do not depend on the link.

use protocol::epos2::DeviceError;
use protocol::epos2::message::SerialRequest;
use protocol::record::DriveLink;
use units::{Quadcounts, Span, Stamp};

use super::long_object::LongObject;
use super::rig::{Rig, to};
use super::test_drive::{Fate, SERIAL};
use crate::error::Deviation;
use crate::{
    AngleSource, AxisConfig, CommandOutcome, DriveCommand, DriveError, Observation,
    PositionValidity, ShaftSample,
};
use protocol::epos2::cia402::DeviceState;

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];
/// From the detection of a fault to the quick stop, or to the report that the axis cannot be
/// stopped.
const REACTION: Span = Span::from_millis(100);

fn moving_on(link: DriveLink) -> Rig {
    Rig::sweeping_on(link, Span::from_millis(600))
}

#[test]
fn connect_home_sweep_and_brake_work_on_each_link() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(connected.identity.name.as_str(), "EPOS2", "{link:?}");
        assert_eq!(connected.identity.serial, SERIAL);
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
        assert_eq!(rig.drive.get(0x1016, 1), 0, "the host may go");
    }
}

/// Whether two samples agree. On RS232 a log bounds the sample's time more tightly, by the
/// announcement of the answer.
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
fn a_log_gives_the_same_observations_on_each_link() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
        rig.run(DriveCommand::Brake).unwrap();
        let observed = rig.observations();
        let sampled: Vec<ShaftSample> = observed
            .iter()
            .filter_map(|seen| match seen {
                Observation::Sample(sample) => Some(*sample),
                _ => None,
            })
            .collect();
        // The client also reads the position without a sample.
        let samples = rig.samples();
        let mut rest = sampled.iter();
        assert!(
            samples
                .iter()
                .all(|s| rest.any(|other| same(link, s, other))),
            "{link:?}"
        );
        let is_read = |request: &SerialRequest| matches!(request, SerialRequest::ReadObject(read) if read.address.index == 0x6064);
        let requests = rig.drive.requests.iter();
        let reads = requests.filter(|(_, request)| is_read(request)).count();
        match link {
            // The last frame of the stream may be in flight.
            DriveLink::Can => assert!(sampled.len().abs_diff(samples.len() + reads) < 10),
            _ => assert_eq!(sampled.len(), reads, "{link:?}"),
        }
        let wrote: Vec<_> = observed
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
        assert_eq!(observed.iter().find(is_noise), None, "{link:?}");
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
            .filter(|s| (-37_500..-12_500).contains(&s.position.0))
            .collect();
        assert!(moving.len() > if link == DriveLink::Rs232 { 160 } else { 540 });
        // At 37,500 qc/s, after the ramp, all samples must agree on the start.
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
            (0x2310, PositionValidity::Valid),
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
            rig.drive.fault_at = Some((at, DeviceError(code)));
            let error = Some(DeviceError(code));
            assert_eq!(rig.finish(), Err(DriveError::Fault { error }), "{link:?}");
            let stopped = rig.made_safe().unwrap();
            assert_eq!((stopped.validity, stopped.fault), (place, true));
            assert_eq!(stopped.angle.is_some(), place == PositionValidity::Valid);
            assert_eq!(rig.drive.state(), DeviceState::Fault);
            let reaction = rig.quick_stop().unwrap() - at;
            // On CAN an EMCY message reports it at once, else the next statusword.
            let limit = if link == DriveLink::Can { 3 } else { 40 };
            assert!(
                reaction < Span::from_millis(limit),
                "{link:?}: {reaction:?}"
            );
        }
    }
}

#[test]
fn a_restart_in_mid_sweep_is_reported_and_the_position_is_lost() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let at = rig.now;
        rig.drive.restart(at);
        let error = rig.finish().unwrap_err();
        assert!(
            matches!(error, DriveError::Restarted { .. }),
            "{link:?}: {error}"
        );
        assert!(error.help().contains("home again"));
        let stopped = rig.made_safe().unwrap();
        assert_eq!(stopped.validity, PositionValidity::Lost { error: None });
        assert_eq!(stopped.angle, None);
        let reaction = rig.quick_stop().unwrap() - at;
        // On CAN the boot-up message reports it, and a request under way is abandoned for 50 ms;
        // else the last request must time out first.
        let limit = if link == DriveLink::Can { 53 } else { 200 };
        assert!(
            reaction < Span::from_millis(limit),
            "{link:?}: {reaction:?}"
        );
        // The drive must be connected before it moves.
        assert!(matches!(
            rig.run(DriveCommand::Goto(to(0.0))),
            Err(DriveError::Restarted { .. })
        ));
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        assert!(rig.run(DriveCommand::Goto(to(0.0))).is_ok(), "{link:?}");
    }
}

#[test]
fn a_lost_link_in_mid_sweep_is_reported_in_time() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let died = rig.now;
        rig.drive.hand = Box::new(|_, _| Fate::Lost);
        rig.drive.bus.silent = true;
        rig.drive.bus.copies = Box::new(|_| 0);
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
        // The drive received the quick stop although its replies are lost.
        if link != DriveLink::Rs232 {
            assert_eq!(
                rig.drive.state(),
                DeviceState::SwitchOnDisabled,
                "{link:?}: power off follows"
            );
            let seen = rig.quick_stop().unwrap();
            assert!(
                rig.now - seen < REACTION + Span::from_millis(155),
                "{link:?}"
            );
        }
        // A second of silence, then the last attempt.
        assert!(
            rig.now - died < Span::from_millis(1_900),
            "{link:?} {:?}",
            rig.now - died
        );
    }
}

/// A busy machine delays replies, or loses them, for most of a second: the move goes on, and the
/// samples after the gap are compared with the plan.
#[test]
fn a_gap_of_most_of_a_second_does_not_end_a_move() {
    for link in LINKS {
        // Lost bytes of RS232 cost the drive's frame timeout of 500 ms, too.
        let silences: &[i64] = match link {
            DriveLink::Rs232 => &[50, 200],
            _ => &[50, 200, 500, 900],
        };
        for &silent_ms in silences {
            let mut rig = Rig::homed_on(link);
            let slow = crate::MoveCommand {
                speed: units::Rpm(400),
                ..to(45.0)
            };
            rig.client.start(DriveCommand::Sweep(slow)).unwrap();
            assert_eq!(rig.run_for(Span::from_millis(600)), None, "{link:?}");
            let until = rig.now + Span::from_millis(silent_ms);
            rig.drive.lose_replies_until(until);
            let end = rig.finish();
            assert!(
                matches!(end, Ok(CommandOutcome::Arrived(_))),
                "{link:?} {silent_ms} ms: {end:?}"
            );
        }
    }
}

/// Near the end of a move an unseen axis is stopped soon, since it could leave its limits. It has
/// arrived all the same, and its power is off.
#[test]
fn silence_at_the_end_of_a_move_does_not_fail_it() {
    for link in [DriveLink::Usb, DriveLink::Can] {
        let mut usual = Rig::homed_on(link);
        let began = usual.now;
        usual.run(DriveCommand::Sweep(to(-15.0))).unwrap();
        let took = usual.now - began;
        let stopped = (1..60).filter(|k| {
            let mut rig = Rig::homed_on(link);
            rig.client.start(DriveCommand::Sweep(to(-15.0))).unwrap();
            let before = took - Span::from_millis(10 * k);
            assert_eq!(rig.run_for(before), None, "{link:?} {k}");
            let until = rig.now + Span::from_millis(190);
            rig.drive.lose_replies_until(until);
            let end = rig.finish();
            if let Err(error) = end {
                // The stop came before the target was reached.
                let is_safe = !matches!(error, DriveError::NotStopped { .. });
                assert!(is_safe, "{link:?} {k}: {error}");
                return false;
            }
            let is_off = rig.drive.state() == DeviceState::SwitchOnDisabled;
            assert!(rig.drive.is_at_rest(), "{link:?} {k}");
            is_off
        });
        let stopped = stopped.count();
        assert!(stopped > 0, "{link:?}: no stop at the target");
    }
}

/// On a loaded host silence at the end of a move is no sign of a lost link: the move goes on.
#[test]
fn a_loaded_host_waits_at_the_end_of_a_move() {
    for link in [DriveLink::Usb, DriveLink::Can] {
        for k in 1..60 {
            let mut rig = Rig::homed_on(link);
            let began = rig.now;
            rig.client.handle_host_delay(Span::from_millis(20), began);
            rig.client.start(DriveCommand::Sweep(to(-15.0))).unwrap();
            assert_eq!(rig.run_for(Span::from_millis(15 * k)), None, "{link:?} {k}");
            let until = rig.now + Span::from_millis(900);
            rig.drive.lose_replies_until(until);
            let end = rig.finish();
            assert!(
                matches!(end, Ok(CommandOutcome::Arrived(_))),
                "{link:?} {k}: {end:?}"
            );
            assert_eq!(
                rig.drive.state(),
                DeviceState::OperationEnabled,
                "{link:?} {k}: no stop"
            );
        }
    }
}

/// A stop waits no longer on a loaded host.
#[test]
fn a_loaded_host_does_not_delay_a_stop() {
    let duration = |is_loaded: bool| {
        let mut rig = Rig::sweeping_on(DriveLink::Usb, Span::from_millis(600));
        if is_loaded {
            rig.client.handle_host_delay(Span::from_millis(20), rig.now);
        }
        rig.drive.distort = Box::new(|_, _| Vec::new());
        let from = rig.now;
        rig.client.start(DriveCommand::Stop).unwrap();
        assert!(rig.finish().is_err());
        rig.now - from
    };
    assert_eq!(duration(true), duration(false));
}

#[test]
fn a_blocked_axis_fails_the_move() {
    for link in LINKS {
        let mut rig = Rig::homed_on(link);
        rig.drive.node.block();
        // In a faster move the drive's own following error of 3 deg comes first.
        let error = rig
            .run(DriveCommand::Goto(crate::MoveCommand {
                speed: units::Rpm(200),
                ..to(45.0)
            }))
            .unwrap_err();
        assert!(
            matches!(
                error,
                DriveError::OffPlan {
                    deviation: Deviation::Behind,
                    ..
                }
            ),
            "{link:?}: {error}"
        );
        assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
    }
}

/// The host is delayed by more than the margin, just before, at and after the arrival, at any point
/// of a dialogue.
#[test]
fn a_host_delayed_through_the_arrival_completes_the_move() {
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

/// On CAN the drive stops when the host is delayed, and reports it.
#[test]
fn a_host_delayed_on_can_reports_that_the_drive_stopped() {
    let mut rig = moving_on(DriveLink::Can);
    // The drive's own time advances meanwhile.
    for _ in 0..1_700 {
        rig.now += Span::from_millis(1);
        rig.drive.live(rig.now);
    }
    let error = rig.finish().unwrap_err();
    let error_8130 = DriveError::Fault {
        error: Some(DeviceError(0x8130)),
    };
    assert_eq!(error, error_8130);
    assert_eq!(rig.made_safe().unwrap().validity, PositionValidity::Valid);
}

/// A state change and a standstill during a delay of the host are detected, too.
#[test]
fn a_host_delayed_at_any_time_detects_the_outcome() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for k in 0..150 {
            let mut config = AxisConfig::default();
            config.homing.time_limit = Span::from_millis(1_500);
            config.timing.state_limit = Span::from_secs(1);
            let mut rig = Rig::on(link, config);
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
                // After an interrupted RS232 dialogue it is unknown whether a write was executed.
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
            // Reads and rejected writes are repeated; a write with a lost reply is not. A segmented
            // transfer is restarted as a whole.
            rig.drive.hand = Box::new(move |n, request| {
                let repeated = match request {
                    SerialRequest::ReadObject(_) => true,
                    _ => {
                        matches!(fate, Fate::Rejected | Fate::Twice)
                            || fate == Fate::Late(Span::from_millis(3))
                    }
                };
                // CAN has no rejection of a damaged request.
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
            assert_eq!(rig.drive.position(rig.now), -10_000);
        }
    }
}

#[test]
fn a_wrong_toggle_bit_is_reported() {
    for link in LINKS {
        let mut rig = Rig::on(link, AxisConfig::default());
        let mut name = LongObject::new(link == DriveLink::Can);
        name.wrong_toggle = true;
        rig.drive.long_object = Some(name);
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
        let start = rig.now;
        rig.client.start(DriveCommand::Stop).unwrap();
        let Ok(CommandOutcome::Stopped(stopped)) = rig.finish() else {
            panic!("{link:?}: {:?}", rig.events.last())
        };
        assert_eq!(stopped.validity, PositionValidity::Valid);
        assert_eq!(stopped.position.0, rig.drive.position(rig.now));
        let reaction = rig.quick_stop().unwrap() - start;
        assert!(reaction < Span::from_millis(10), "{link:?}: {reaction:?}");
        assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
        assert_eq!(rig.drive.get(0x1016, 1), 0);
    }
}

/// Its value is not used, and the request is repeated.
#[test]
fn a_reply_to_another_request_in_mid_sweep_is_ignored() {
    for link in LINKS {
        let mut rig = Rig::homed_on(link);
        rig.drive.hand = Box::new(|n, request| match request {
            SerialRequest::ReadObject(read) if n % 11 == 5 && read.address.index == 0x6041 => {
                Fate::Another
            }
            SerialRequest::ReadObject(read) if n % 17 == 5 && read.address.index == 0x6064 => {
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
