//! Faults of the drive, of the axis and of the link.

use protocol::epos2::AbortCode;
use protocol::epos2::DeviceError;
use protocol::epos2::message::SerialRequest;
use protocol::epos2::objects::Address;
use protocol::record::DriveLink;
use units::{Degrees, Quadcounts, Rpm, Span};

use super::rig::{Rig, to};
use super::test_drive::Fate;
use crate::error::Deviation;
use crate::{AxisConfig, CommandOutcome, CommandProgress, DriveCommand, DriveError, MoveCommand};
use protocol::epos2::cia402::DeviceState;

pub(super) fn is_read(request: &SerialRequest, index: u16) -> bool {
    matches!(request, SerialRequest::ReadObject(read) if read.address.index == index)
}

pub(super) fn is_write(request: &SerialRequest, index: u16, value: u32) -> bool {
    matches!(request, SerialRequest::WriteObject(w) if w.address.index == index && w.value == value)
}

fn moving() -> Rig {
    Rig::sweeping_on(DriveLink::Usb, Span::from_millis(400))
}

#[test]
fn a_fault_in_mid_sweep_is_named_and_the_axis_is_made_safe() {
    let mut rig = moving();
    let at = rig.now + Span::from_millis(10);
    rig.drive.fault_at = Some((at, DeviceError::POSITIVE_LIMIT));
    assert_eq!(
        rig.finish(),
        Err(DriveError::Fault {
            error: Some(DeviceError::POSITIVE_LIMIT)
        })
    );
    assert!(rig.made_safe().is_some());
    assert_eq!(rig.drive.state(), DeviceState::Fault);
    let quick_stop = rig
        .drive
        .requests
        .iter()
        .find(|(_, request)| is_write(request, 0x6040, 0x0B))
        .unwrap();
    // Detected within a status period, handled within a few round trips.
    assert!(quick_stop.0 - at < Span::from_millis(30));
}

#[test]
fn a_blocked_axis_is_stopped_once_it_is_behind_its_plan() {
    let mut rig = Rig::homed();
    rig.drive.node.block();
    let began = rig.now;
    // In a faster move the drive's own following error of 3 deg comes first.
    let error = rig
        .run(DriveCommand::Goto(MoveCommand {
            speed: Rpm(200),
            ..to(45.0)
        }))
        .unwrap_err();
    let DriveError::OffPlan {
        deviation: Deviation::Behind,
        got,
        ..
    } = error
    else {
        panic!("{error:?}")
    };
    assert_eq!(got, Degrees(-60.0));
    // 1 deg of the plan takes 105 ms; the rest is preparation.
    let took = (rig.now - began).as_secs_f64();
    assert!(took < 0.5, "{took}");
    assert!(rig.made_safe().is_some());
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
}

#[test]
fn a_fault_that_does_not_clear_ends_the_connection() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive.on_write(0x6040, 0, Fate::Ignored);
    assert_eq!(
        rig.run(DriveCommand::Connect),
        Err(DriveError::FaultStays {
            error: Some(DeviceError::CAN_PASSIVE)
        })
    );
    assert!(matches!(
        rig.client.start(DriveCommand::Home),
        Err(DriveError::NotConnected { .. })
    ));
}

#[test]
fn a_limit_switch_mask_that_is_not_accepted_prevents_moves() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive.on_write(0x2071, 4, Fate::Ignored);
    let error = rig.run(DriveCommand::Connect).unwrap_err();
    assert_eq!(
        error.to_string(),
        "object 2071:04 read back: expected 0xB, got 0x8"
    );
}

#[test]
fn a_restart_between_commands_is_detected_before_the_next_move() {
    let mut rig = Rig::homed();
    rig.drive.set(0x2071, 4, 8);
    assert!(matches!(
        rig.run(DriveCommand::Goto(to(0.0))),
        Err(DriveError::NotTaken { .. })
    ));
    assert!(!rig.writes().iter().any(|w| w.2 == 0x1F));
}

#[test]
fn another_device_is_refused() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive.hand = Box::new(|_, request| match request {
        SerialRequest::ReadObject(read) if read.address == Address::new(0x1018, 1) => {
            Fate::Value(0x2E)
        }
        _ => Fate::Sent,
    });
    let error = rig.run(DriveCommand::Connect).unwrap_err();
    assert_eq!(
        error.to_string(),
        "object 1018:01 (Vendor ID): expected 0xFB, got 0x2E"
    );
    assert!(rig.writes().is_empty());
}

#[test]
fn a_refusal_names_object_and_reason() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive
        .on_write(0x607F, 0, Fate::Refused(AbortCode::NO_OBJECT));
    let error = rig.run(DriveCommand::Connect).unwrap_err();
    assert!(matches!(
        error,
        DriveError::Refused {
            error: AbortCode::NO_OBJECT,
            ..
        }
    ));
    assert!(error.to_string().starts_with(
        "writing 0x5DC to object 607F:00 refused by the drive: 06020000 Object does not exist"
    ));
}

#[test]
fn stop_in_mid_sweep_stops() {
    let mut rig = moving();
    let at = rig.now;
    rig.client.start(DriveCommand::Stop).unwrap();
    let Ok(CommandOutcome::Stopped(stopped)) = rig.finish() else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!(stopped.position.0, rig.drive.position(rig.now));
    assert!(stopped.angle.is_some() && stopped.brake);
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
    let (seen, _) = rig
        .drive
        .requests
        .iter()
        .find(|(_, request)| is_write(request, 0x6040, 0x0B))
        .unwrap();
    assert!(*seen - at < Span::from_millis(2), "{:?}", *seen - at);
}

#[test]
fn stop_does_not_wait_for_a_lost_answer() {
    let mut rig = moving();
    // Every reply is lost until the drive receives a quick stop.
    let mut stopped = false;
    rig.drive.hand = Box::new(move |_, request| {
        stopped |= is_write(request, 0x6040, 0x0B);
        if stopped { Fate::Sent } else { Fate::Lost }
    });
    rig.run_for(Span::from_millis(10));
    let at = rig.now;
    rig.client.start(DriveCommand::Stop).unwrap();
    assert!(matches!(rig.finish(), Ok(CommandOutcome::Stopped(_))));
    let (seen, _) = rig
        .drive
        .requests
        .iter()
        .find(|(_, request)| is_write(request, 0x6040, 0x0B))
        .unwrap();
    assert!(*seen - at <= Span::from_millis(100), "{:?}", *seen - at);
}

#[test]
fn stop_of_an_idle_or_faulty_drive_is_harmless() {
    let mut rig = Rig::new(AxisConfig::default());
    let Ok(CommandOutcome::Stopped(stopped)) = rig.run(DriveCommand::Stop) else {
        panic!("{:?}", rig.events)
    };
    assert!(stopped.fault);
    assert_eq!(stopped.angle, None);
    assert_eq!(rig.drive.state(), DeviceState::Fault);
}

/// An encoder of 512 lines behind a configuration of 500 makes every angle 2.4 % wrong.
#[test]
fn a_drive_that_contradicts_the_configuration_is_not_moved() {
    for (object, value, key) in [
        ((0x2210, 1), 512, "encoder_lines"),
        ((0x2210, 2), 4, "EPOS Studio"),
        ((0x2210, 4), 1, "sensor_polarity"),
        ((0x2078, 3), 4, "brake_inverted"),
        ((0x605E, 0), 0, "EPOS Studio"),
        ((0x608B, 0), 0xFE, "EPOS Studio"),
        ((0x6410, 4), 1_000, "max_speed_deg_s"),
    ] {
        let mut rig = Rig::homed();
        // Some of these objects change only without power.
        rig.run(DriveCommand::Brake).unwrap();
        let (index, sub) = object;
        rig.drive.set(index, sub, value);
        let before = rig.drive.requests.len();
        let error = rig.run(DriveCommand::Sweep(to(45.0))).unwrap_err();
        assert!(
            matches!(error, DriveError::Contradiction { .. }),
            "{object:X?}: {error}"
        );
        assert!(error.help().contains(key), "{error}: {}", error.help());
        let enabled = rig.drive.requests[before..].iter().any(|(_, request)| {
            matches!(request, SerialRequest::WriteObject(write)
                if write.address.index == 0x6040 && write.value & 0xF == 0xF)
        });
        assert!(!enabled, "{object:X?}: the power was switched on");
    }
}

/// Replies that come later than the client waits for in a move would end each move as unanswered.
#[test]
fn a_drive_that_always_answers_late_is_not_moved() {
    for link in [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can] {
        let mut rig = Rig::homed_on(link);
        rig.run(DriveCommand::Brake).unwrap();
        rig.drive.turnaround = Span::from_millis(150);
        let before = rig.drive.requests.len();
        for command in [DriveCommand::Sweep(to(45.0)), DriveCommand::Home] {
            let error = rig.run(command).unwrap_err();
            let DriveError::SlowReplies { took, limit } = error else {
                panic!("{link:?}: {error}")
            };
            assert!(took >= Span::from_millis(150) && limit < took, "{link:?}");
        }
        let enabled = rig.drive.requests[before..].iter().any(|(_, request)| {
            matches!(request, SerialRequest::WriteObject(write)
                if write.address.index == 0x6040 && write.value & 0xF == 0xF)
        });
        assert!(!enabled, "{link:?}: the power was switched on");
    }
}

/// An axis in a slow move, whose states may take 100 ms.
fn slowly_moving() -> Rig {
    let mut config = AxisConfig::default();
    config.timing.state_limit = Span::from_millis(100);
    let mut rig = Rig::new(config);
    rig.run(DriveCommand::Connect).unwrap();
    rig.run(DriveCommand::Home).unwrap();
    rig.client
        .start(DriveCommand::Goto(crate::MoveCommand {
            speed: units::Rpm(200),
            ..to(45.0)
        }))
        .unwrap();
    assert_eq!(rig.run_for(Span::from_millis(500)), None);
    rig
}

#[test]
fn power_off_follows_a_quick_stop_that_does_not_stop() {
    let mut rig = slowly_moving();
    rig.drive.hand = Box::new(|_, request| match request {
        _ if is_write(request, 0x6040, 0x0B) => Fate::Ignored,
        _ => Fate::Sent,
    });
    rig.client.start(DriveCommand::Stop).unwrap();
    assert!(matches!(rig.finish(), Ok(CommandOutcome::Stopped(_))));
    assert!(rig.progress().contains(&CommandProgress::PowerCut));
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
}

#[test]
fn an_axis_that_power_off_does_not_stop_is_reported() {
    let mut rig = slowly_moving();
    rig.drive.on_write(0x6040, 0, Fate::Ignored);
    rig.client.start(DriveCommand::Stop).unwrap();
    let error = rig.finish().unwrap_err();
    assert!(
        matches!(
            error,
            DriveError::StillMoving {
                power_off: true,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn a_lost_link_in_mid_sweep_is_reported_as_not_stopped() {
    let mut rig = moving();
    let died = rig.now;
    rig.drive.hand = Box::new(|_, _| Fate::Lost);
    let error = rig.finish().unwrap_err();
    let DriveError::NotStopped { cause, stop } = &error else {
        panic!("{error:?}")
    };
    assert!(matches!(**cause, DriveError::LinkLost { .. }), "{cause:?}");
    assert!(matches!(**stop, DriveError::LinkLost { .. }), "{stop:?}");
    assert!(rig.now - died < Span::from_secs(2));
    // The drive received the quick stop although its replies are lost.
    assert!(rig.drive.state() != DeviceState::OperationEnabled);
}

#[test]
fn lost_answers_to_polls_cost_only_samples() {
    let mut rig = Rig::homed();
    rig.drive.hand = Box::new(|n, request| {
        if is_read(request, 0x6064) && n % 40 == 7 {
            Fate::Lost
        } else {
            Fate::Sent
        }
    });
    let Ok(CommandOutcome::Arrived(arrived)) = rig.run(DriveCommand::Sweep(to(-15.0))) else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!(arrived.position, Quadcounts(-10_000));
    assert!(rig.client.link_stats().lost > 0);
}

#[test]
fn late_replies_are_used_with_their_actual_times() {
    let mut rig = Rig::homed();
    rig.drive.hand = Box::new(|n, _| match n % 50 {
        20 => Fate::Late(Span::from_millis(130)),
        _ => Fate::Sent,
    });
    assert!(rig.run(DriveCommand::Sweep(to(-15.0))).is_ok());
    let late = rig
        .samples()
        .iter()
        .filter(|s| s.answer - s.request > Span::from_millis(100))
        .count();
    assert!(late > 0, "late answers count, with their true times");
}

#[test]
fn damage_and_repetition_are_survived() {
    for (fate, every) in [
        (Fate::Damaged, 9),
        (Fate::Twice, 5),
        (Fate::Rejected, 7),
        (Fate::Late(Span::from_millis(3)), 3),
    ] {
        let mut rig = Rig::new(AxisConfig::default());
        // Reads and rejected writes are repeated; a write whose answer is damaged is not.
        rig.drive.hand = Box::new(move |n, request| {
            let write = matches!(request, SerialRequest::WriteObject(_));
            if n % every == 0 && !(write && fate == Fate::Damaged) {
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
            assert!(result.is_ok(), "{fate:?} {command:?}: {result:?}");
        }
        assert_eq!(rig.drive.position(rig.now), -10_000);
    }
}

#[test]
fn a_write_is_not_repeated_when_its_answer_is_lost() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive.hand = Box::new(|_, request| {
        if is_write(request, 0x607F, 1500) {
            Fate::Lost
        } else {
            Fate::Sent
        }
    });
    assert!(matches!(
        rig.run(DriveCommand::Connect),
        Err(DriveError::NoAnswer { attempts: 1, .. })
    ));
    let writes = rig.writes();
    assert_eq!(writes.iter().filter(|w| w.0 == 0x607F).count(), 1);
}

#[test]
fn a_lost_last_answer_does_not_fail_the_sweep() {
    let mut rig = Rig::homed();
    assert!(rig.run(DriveCommand::Sweep(to(-15.0))).is_ok());
    let mut lost = 0;
    rig.drive.hand = Box::new(move |_, request| {
        // Disabling the voltage may be repeated.
        if is_write(request, 0x6040, 0) && lost < 2 {
            lost += 1;
            return Fate::Lost;
        }
        Fate::Sent
    });
    let before = rig.writes().len();
    assert!(matches!(
        rig.run(DriveCommand::Brake),
        Ok(CommandOutcome::Stopped(_))
    ));
    let off = rig.writes().split_off(before);
    assert_eq!(off.iter().filter(|w| w.0 == 0x6040).count(), 3);
}

#[test]
fn silence_ends_a_command_in_bounded_time() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.drive.hand = Box::new(|_, _| Fate::Lost);
    let began = rig.now;
    let error = rig.run(DriveCommand::Connect).unwrap_err();
    assert!(matches!(error, DriveError::LinkLost { .. }));
    assert!(rig.now - began <= Span::from_millis(1600));
    assert!(error.to_string().contains("silence for 1500 ms"), "{error}");
    assert!(!error.help().is_empty());
}

/// Reads the literals of the source, since no list of all errors exists.
#[test]
fn advice_begins_in_lower_case_and_has_no_full_stop() {
    let (_, source) = include_str!("../error.rs")
        .split_once("pub fn help")
        .unwrap();
    let literals: Vec<&str> = source.split('"').skip(1).step_by(2).collect();
    assert!(literals.len() > 25, "{literals:?}");
    for advice in literals {
        assert!(!advice.starts_with(|c: char| c.is_uppercase()), "{advice}");
        assert!(!advice.ends_with('.') && !advice.contains(". "), "{advice}");
    }
}
