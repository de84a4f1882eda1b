//! Each command from its first frame to its outcome.

use firmware_sim::epos2::SimulatedDriveConfig;
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::message::SerialRequest;
use protocol::epos2::objects::Address;
use protocol::record::DriveLink;
use units::{Degrees, Quadcounts, Rpm, Span};

use super::rig::{Rig, to};
use super::test_drive::{Fate, SERIAL, near_its_switch};
use crate::{AxisConfig, CommandKind, CommandOutcome, CommandProgress, DriveCommand, DriveError};

fn target(qc: i32) -> (u16, u8, u32) {
    (0x607A, 0, qc as u32)
}

#[test]
fn connect_identifies_the_drive_clears_faults_and_configures() {
    let mut rig = Rig::new(AxisConfig::default());
    let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
        panic!("{:?}", rig.events)
    };
    assert_eq!(connected.identity.software, 0x2126);
    assert_eq!(connected.identity.serial, SERIAL);
    assert_eq!(connected.history, [DeviceError::CAN_PASSIVE]);
    assert!(!connected.referenced);
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
    let cleared = CommandProgress::FaultCleared {
        error: Some(DeviceError::CAN_PASSIVE),
    };
    assert!(rig.progress().contains(&cleared));
    let held = |index, sub| rig.drive.get(index, sub);
    assert_eq!(held(0x2071, 4), 8 | 3, "2071:4 stops at both switches");
    assert_eq!(held(0x607D, 1) as i32, -40_000);
    assert_eq!(held(0x607D, 2) as i32, 40_000);
    assert_eq!(held(0x607F, 0), 1500);
    assert_eq!(held(0x2079, 1), 2, "output 1 is the brake");
    assert_eq!(held(0x2078, 2), 4);
    assert_eq!(held(0x6085, 0), 20_000);
}

#[test]
fn missing_switches_and_brake_are_not_configured() {
    let mut rig = Rig::new(AxisConfig {
        brake: None,
        limit_switches: crate::config::LimitSwitchConfig {
            negative: None,
            positive: None,
            active_low: false,
        },
        ..AxisConfig::default()
    });
    rig.run(DriveCommand::Connect).unwrap();
    let fresh = Rig::new(AxisConfig::default()).drive;
    for (index, sub) in [(0x2071, 4), (0x2079, 1), (0x2078, 2), (0x2100, 1)] {
        assert_eq!(rig.drive.get(index, sub), fresh.get(index, sub));
    }
}

#[test]
fn connect_stops_an_axis_left_moving() {
    let mut rig = Rig::homed();
    rig.client.start(DriveCommand::Goto(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(300)), None);
    assert_eq!(rig.drive.state(), DeviceState::OperationEnabled);
    // Another process takes over.
    rig.client = crate::DriveClient::new(AxisConfig::default(), crate::DriveLink::Usb);
    rig.forget();
    rig.run(DriveCommand::Connect).unwrap();
    assert_eq!(rig.writes()[0], (0x6040, 0, 0x0B));
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
}

#[test]
fn home_finds_the_home_position() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.run(DriveCommand::Connect).unwrap();
    rig.forget();
    assert_eq!(
        rig.run(DriveCommand::Home),
        Ok(CommandOutcome::Homed {
            position: Quadcounts(-40_000),
            angle: Degrees(-60.0),
        })
    );
    let writes = rig.writes();
    for wanted in [(0x6098, 0, 17), (0x607C, 0, 3333), (0x6040, 0, 0x1F)] {
        assert!(writes.contains(&wanted), "{wanted:X?}");
    }
    assert_eq!(rig.drive.get(0x6060, 0), 1, "profile position again");
}

#[test]
fn homing_by_current_writes_its_threshold_and_others_do_not() {
    let threshold = |method, offset| {
        let mut config = AxisConfig::default();
        (config.homing.method, config.homing.offset) = (method, Degrees(offset));
        // A mechanical stop half a degree above.
        let drive = SimulatedDriveConfig {
            hard_stops: [None, Some(-42_967)],
            switches: [None; 4],
            ..near_its_switch()
        };
        let mut rig = Rig::with(DriveLink::Usb, config, drive);
        rig.drive.set(0x2080, 0, 0);
        rig.run(DriveCommand::Connect).unwrap();
        let homed = rig.run(DriveCommand::Home);
        assert!(homed.is_ok(), "method {method}: {homed:?}");
        rig.drive.get(0x2080, 0)
    };
    assert_eq!(threshold(-3, -5.0), 500);
    assert_eq!(threshold(35, 0.0), 0);
}

#[test]
fn sweeps_are_sampled_from_standstill_to_standstill() {
    let mut rig = Rig::homed();
    let Ok(CommandOutcome::Arrived(arrived)) = rig.run(DriveCommand::Sweep(to(-15.0))) else {
        panic!("{:?}", rig.events)
    };
    assert_eq!(arrived.position, Quadcounts(-10_000));
    assert_eq!(arrived.plan.speed, Rpm(1125));
    assert!(rig.writes().contains(&target(-10_000)));
    let samples = rig.samples();
    let still = |at| {
        samples
            .iter()
            .filter(|s| s.position == Quadcounts(at))
            .count()
    };
    assert!(still(-40_000) >= 30, "{} before", still(-40_000));
    assert!(still(-10_000) >= 30, "{} after", still(-10_000));
    // 45 deg at 56.25 deg/s and 500 deg/s2: 912.5 ms of motion at 1 kHz; a statusword replaces a
    // poll now and then.
    let moving = samples.len() - still(-40_000) - still(-10_000);
    assert!((800..=912).contains(&moving), "{moving}");
    for pair in samples.windows(2) {
        assert!(pair[0].answer <= pair[1].request);
        assert!(pair[0].request < pair[0].answer);
        let apart = pair[1].request - pair[0].request;
        assert!(apart >= rig.drive.turnaround, "{apart:?}");
        assert!(apart < Span::from_millis(60), "{apart:?}");
    }
}

#[test]
fn samples_lie_between_their_stamps() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let samples = rig.samples();
    let began = samples
        .iter()
        // The end of the ramp.
        .rposition(|s| s.position.0 < -37_500)
        .unwrap();
    let t0 = samples[began + 1].request;
    for s in samples.iter().skip(began + 1).take(600) {
        // The drive reads its counter when the request arrives.
        let way = 37_500.0 * (s.request - t0).as_secs_f64();
        let got = f64::from(s.position.0 - samples[began + 1].position.0);
        assert!((got - way).abs() <= 1.0, "{got} {way}");
    }
}

#[test]
fn polls_follow_each_answer_immediately() {
    let mut config = AxisConfig::default();
    config.timing.poll_period = Span::ZERO;
    let mut rig = Rig::new(config);
    rig.drive.turnaround = Span::from_micros(250);
    rig.run(DriveCommand::Connect).unwrap();
    rig.run(DriveCommand::Home).unwrap();
    rig.forget();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    assert!(rig.samples().len() > 3_000, "{}", rig.samples().len());
}

#[test]
fn a_goto_does_not_wait_for_standstill() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Goto(to(-15.0))).unwrap();
    let samples = rig.samples();
    let still = samples.iter().filter(|s| s.position.0 == -40_000).count();
    assert!(still <= 3, "{still}");
}

#[test]
fn a_move_to_the_current_position_arrives() {
    let mut rig = Rig::homed();
    assert!(matches!(
        rig.run(DriveCommand::Goto(to(-60.0))),
        Ok(CommandOutcome::Arrived(_))
    ));
}

#[test]
fn hold_samples_until_its_end() {
    let mut rig = Rig::homed();
    let until = rig.now + Span::from_millis(100);
    assert_eq!(
        rig.run(DriveCommand::Hold { until }),
        Ok(CommandOutcome::Held)
    );
    assert!((90..=101).contains(&rig.samples().len()));
    assert!(rig.writes().is_empty());
}

#[test]
fn brake_switches_the_power_off_without_a_quick_stop() {
    let mut rig = Rig::homed();
    let Ok(CommandOutcome::Stopped(stopped)) = rig.run(DriveCommand::Brake) else {
        panic!("{:?}", rig.events)
    };
    assert_eq!(stopped.angle, Some(Degrees(-60.0)));
    assert!(stopped.brake && !stopped.fault);
    assert_eq!(rig.writes(), [(0x6040, 0, 0)]);
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
}

#[test]
fn status_changes_nothing() {
    let mut rig = Rig::new(AxisConfig::default());
    let Ok(CommandOutcome::Status(status)) = rig.run(DriveCommand::Status) else {
        panic!("{:?}", rig.events)
    };
    assert_eq!(status.state, Some(crate::cia402::DeviceState::Fault));
    assert_eq!(status.history, [DeviceError::CAN_PASSIVE]);
    assert_eq!((status.angle, status.position.0), (None, 0));
    assert_eq!(status.mode, 1);
    assert!(rig.writes().is_empty());
}

#[test]
fn clear_faults_clears_the_fault() {
    let mut rig = Rig::new(AxisConfig::default());
    assert_eq!(
        rig.run(DriveCommand::ClearFaults),
        Ok(CommandOutcome::FaultsCleared(vec![
            DeviceError::CAN_PASSIVE
        ]))
    );
    assert_eq!(rig.drive.state(), DeviceState::SwitchOnDisabled);
}

#[test]
fn refusals_precede_the_first_byte() {
    let mut rig = Rig::homed();
    let fast = crate::MoveCommand {
        speed: Rpm(1501),
        ..to(0.0)
    };
    let still = crate::MoveCommand {
        speed: Rpm(0),
        ..to(0.0)
    };
    for (command, kind) in [
        (DriveCommand::Goto(to(60.1)), "Limits"),
        (DriveCommand::Sweep(to(-60.1)), "Limits"),
        (DriveCommand::Goto(to(f64::NAN)), "Limits"),
        (DriveCommand::Goto(fast), "Speed"),
        (DriveCommand::Sweep(still), "Speed"),
    ] {
        let error = rig.client.start(command).unwrap_err();
        assert!(format!("{error:?}").starts_with(kind), "{error:?}");
        assert_eq!(rig.client.poll_transmit(rig.now), None);
        assert_eq!(rig.client.running(), None);
    }
}

#[test]
fn moves_need_a_connection_and_a_reference() {
    let mut rig = Rig::new(AxisConfig::default());
    assert_eq!(
        rig.client.start(DriveCommand::Home),
        Err(DriveError::NotConnected {
            requested: CommandKind::Home
        })
    );
    rig.run(DriveCommand::Connect).unwrap();
    assert!(matches!(
        rig.run(DriveCommand::Goto(to(0.0))),
        Err(DriveError::NotReferenced { .. })
    ));
    assert!(!rig.writes().iter().any(|w| w.0 == 0x607A));
}

#[test]
fn only_one_command_runs_at_a_time() {
    let mut rig = Rig::homed();
    rig.client.start(DriveCommand::Goto(to(0.0))).unwrap();
    assert_eq!(
        rig.client.start(DriveCommand::Status),
        Err(DriveError::Busy {
            requested: CommandKind::Status,
            running: CommandKind::Goto,
        })
    );
    assert!(rig.finish().is_ok());
}

#[test]
fn the_client_is_send() {
    fn sendable<T: Send + 'static>(_: &T) {}
    let mut client = crate::DriveClient::new(AxisConfig::default(), crate::DriveLink::Usb);
    client.start(DriveCommand::Connect).unwrap();
    sendable(&client);
    let first = std::thread::spawn(move || client.poll_transmit(units::Stamp::from_nanos(0)));
    assert!(first.join().unwrap().is_some());
}

/// Reads of an object give these values in turn, the last one from then on.
fn reads_as(rig: &mut Rig, address: Address, values: &'static [u32]) {
    let mut next = 0;
    rig.drive.hand = Box::new(move |_, request| match request {
        SerialRequest::ReadObject(read) if read.address == address => {
            let value = values[next.min(values.len() - 1)];
            next += 1;
            Fate::Value(value)
        }
        _ => Fate::Sent,
    });
}

const SWITCHES: Address = Address::new(0x2071, 1);

#[test]
fn a_powered_axis_that_moves_away_in_a_hold_is_stopped() {
    let mut rig = Rig::homed();
    let here = rig.drive.position(rig.now);
    // 0.6 deg further after ten samples.
    let mut left = 10;
    rig.drive.hand = Box::new(move |_, request| match request {
        SerialRequest::ReadObject(read) if read.address == Address::new(0x6064, 0) => {
            left -= 1;
            Fate::Value((here + if left < 0 { 400 } else { 0 }).cast_unsigned())
        }
        _ => Fate::Sent,
    });
    let began = rig.now;
    let until = rig.now + Span::from_secs(10);
    let error = rig.run(DriveCommand::Hold { until }).unwrap_err();
    assert!(error.to_string().contains("-60.0"), "{error}");
    assert!(rig.quick_stop().unwrap() - began < Span::from_millis(30));
}

#[test]
fn an_axis_without_power_may_be_turned_by_hand_in_a_hold() {
    let mut rig = Rig::homed();
    rig.run(DriveCommand::Brake).unwrap();
    reads_as(&mut rig, Address::new(0x6064, 0), &[0, 10_000, 20_000]);
    let until = rig.now + Span::from_millis(100);
    let held = rig.run(DriveCommand::Hold { until });
    assert_eq!(held, Ok(CommandOutcome::Held));
}

#[test]
fn a_switch_under_the_axis_counts_again_once_it_is_released() {
    let mut rig = Rig::homed();
    reads_as(&mut rig, SWITCHES, &[1, 1, 0, 1]);
    let error = rig.run(DriveCommand::Goto(to(0.0))).unwrap_err();
    let positive = false;
    assert_eq!(
        error,
        DriveError::LimitSwitch {
            positive,
            inputs: 1
        }
    );
    let mut rig = Rig::homed();
    reads_as(&mut rig, SWITCHES, &[1]);
    assert!(rig.run(DriveCommand::Goto(to(0.0))).is_ok());
}

#[test]
fn no_move_begins_towards_a_pressed_switch() {
    let mut rig = Rig::homed();
    reads_as(&mut rig, SWITCHES, &[2]);
    let error = rig.run(DriveCommand::Goto(to(0.0))).unwrap_err();
    let positive = true;
    assert_eq!(
        error,
        DriveError::LimitSwitch {
            positive,
            inputs: 2
        }
    );
    assert!(rig.drive.is_at_rest() && !rig.writes().contains(&(0x6040, 0, 0x1F)));
}

#[test]
fn homing_that_reaches_the_other_limit_switch_is_stopped() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.run(DriveCommand::Connect).unwrap();
    // It may begin on that switch.
    reads_as(&mut rig, SWITCHES, &[2, 0, 2]);
    let error = rig.run(DriveCommand::Home).unwrap_err();
    let positive = true;
    assert_eq!(
        error,
        DriveError::LimitSwitch {
            positive,
            inputs: 2
        }
    );
}
