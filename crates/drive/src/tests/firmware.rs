//! The client with the simulated EPOS2 of firmware-sim, in virtual time. The two share only the
//! frames.

mod load;

use firmware_sim::epos2::{BrakeState, Servo, SimulatedDriveConfig};
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, BoundedVec, DeviceError};
use protocol::record::{Direction, DriveLink};
use units::{Host, Rpm, Span, Stamp};

use super::rig::{Rig, to};
use crate::{
    AxisConfig, CommandOutcome, CommandProgress, DriveCommand, DriveError, DriveEvent, MoveCommand,
    MovePlan, PositionValidity, StopReport,
};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];

/// A rig with a drive as it leaves the factory, and the delays of its link.
pub(super) fn rig_with(link: DriveLink, config: SimulatedDriveConfig) -> Rig {
    let mut rig = Rig::with(link, AxisConfig::default(), config);
    let delay = match link {
        DriveLink::Usb => Span::from_micros(300),
        DriveLink::Rs232 => Span::from_micros(200),
        DriveLink::Can => Span::from_micros(160),
    };
    (rig.drive.forth, rig.drive.turnaround) = (delay, delay);
    if link == DriveLink::Rs232 {
        // 115,200 baud, 8N1.
        rig.drive.per_byte = Span::from_nanos(86_806);
    }
    rig
}

fn homed_on(link: DriveLink) -> Rig {
    let mut rig = rig_with(link, SimulatedDriveConfig::default());
    rig.run(DriveCommand::Connect).unwrap();
    rig.run(DriveCommand::Home).unwrap();
    rig.forget();
    rig
}

/// In mid-sweep.
fn moving_on(link: DriveLink) -> Rig {
    let mut rig = homed_on(link);
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(1_000)), None);
    rig.forget();
    rig
}

/// When the client sent a quick stop, whether the drive received it or not: controlword (6040) 000B
/// in a frame of USB or CAN, or in a body of RS232.
fn sent_quick_stop(rig: &Rig) -> Option<Stamp<Host>> {
    let is_quick_stop = |bytes: &[u8]| {
        let has = |wanted: &[u8]| bytes.windows(wanted.len()).any(|w| w == wanted);
        has(&[0x40, 0x60, 0, 1, 0x0B, 0]) || has(&[0x2B, 0x40, 0x60, 0, 0x0B, 0])
    };
    let mut sent = rig.log.iter().filter(|it| it.0 == Direction::ToDrive);
    sent.find(|(_, bytes, _)| is_quick_stop(bytes))
        .map(|it| it.2)
}

fn from_home(rig: &Rig, angle_deg: f64) -> MovePlan {
    let axis = rig.client.config();
    let home = axis.gearing.position(axis.homing.home_position).unwrap();
    axis.plan_move(home, axis.validate(to(angle_deg)).unwrap())
}

/// A complete capture, from power-on to the brake.
#[test]
fn connect_home_sweep_and_brake_succeed() {
    let mut rig = rig_with(DriveLink::Usb, SimulatedDriveConfig::default());
    assert_eq!(rig.drive.node.state(), DeviceState::Fault);
    let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!(connected.history.first(), Some(&DeviceError::CAN_PASSIVE));
    assert_eq!(connected.identity.serial, 1);
    assert_eq!(rig.drive.node.brake(), BrakeState::Closed);
    let Ok(CommandOutcome::Homed { angle, .. }) = rig.run(DriveCommand::Home) else {
        panic!("{:?}", rig.events.last())
    };
    assert!((angle.0 + 60.0).abs() < 0.01, "{angle:?}");
    assert_eq!(rig.drive.node.brake(), BrakeState::Open);
    rig.events.clear();
    let Ok(CommandOutcome::Arrived(arrived)) = rig.run(DriveCommand::Sweep(to(-15.0))) else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!(arrived.position.0, -10_000);
    assert_eq!(arrived.plan.duration, from_home(&rig, -15.0).duration);
    let took = (arrived.arrived - arrived.started).as_secs_f64();
    let planned = arrived.plan.duration.as_secs_f64();
    assert!(
        (took - planned).abs() < 0.03,
        "{took} s, planned {planned} s"
    );
    let Ok(CommandOutcome::Stopped(stopped)) = rig.run(DriveCommand::Brake) else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!((stopped.position.0, stopped.fault), (-10_000, false));
    assert_eq!(rig.drive.node.brake(), BrakeState::Closed);
    assert_eq!(rig.client.link_stats().lost, 0);
    assert_eq!(rig.client.link_stats().unmatched, 0);
}

#[test]
fn samples_are_shaft_positions_between_their_stamps() {
    for link in LINKS {
        let mut rig = homed_on(link);
        rig.run(DriveCommand::Sweep(to(45.0))).unwrap();
        let samples = rig.samples();
        let least = match link {
            DriveLink::Usb => 1_800,
            DriveLink::Rs232 => 300,
            DriveLink::Can => 1_900,
        };
        assert!(samples.len() > least, "{link:?}: {}", samples.len());
        // Drive zero and world zero differ by a constant of whole counts.
        let origin = {
            let first = samples[0];
            rig.drive.world_qc(first.request).floor() - f64::from(first.position.0)
        };
        for s in &samples {
            let [before, after] = [s.request, s.answer].map(|at| rig.drive.world_qc(at) - origin);
            let got = f64::from(s.position.0);
            assert!(
                before.floor() <= got && got <= after + 0.01,
                "{link:?}: {before} {got} {after} at {:?}",
                s.request
            );
        }
    }
}

#[test]
fn slow_and_short_moves_arrive() {
    let mut rig = homed_on(DriveLink::Usb);
    for (to_deg, rpm) in [(-59.9, 1), (-59.9, 1), (-59.8985, 1500), (-30.0, 1500)] {
        let command = DriveCommand::Goto(MoveCommand {
            speed: Rpm(rpm),
            ..to(to_deg)
        });
        let Ok(CommandOutcome::Arrived(arrived)) = rig.run(command) else {
            panic!("{to_deg} at {rpm}: {:?}", rig.events.last())
        };
        assert!((arrived.angle.0 - to_deg).abs() < 0.002, "{arrived:?}");
    }
}

#[test]
fn stop_in_mid_sweep_keeps_the_position() {
    let mut rig = homed_on(DriveLink::Usb);
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    let until = rig.now + Span::from_millis(800);
    while rig.now < until {
        assert_eq!(rig.step(), None);
    }
    rig.client.start(DriveCommand::Stop).unwrap();
    let start = rig.now;
    let Ok(CommandOutcome::Stopped(stopped)) = rig.finish() else {
        panic!("{:?}", rig.events.last())
    };
    assert!(stopped.angle.is_some());
    assert_eq!(rig.drive.node.brake(), BrakeState::Closed);
    // 1125 rpm at 20,000 rpm/s take 56 ms to stop; then 50 ms of standstill, the brake, and some
    // round trips.
    assert!(rig.now - start < Span::from_millis(200));
    // The axis can move on.
    assert!(rig.run(DriveCommand::Goto(to(0.0))).is_ok());
}

#[test]
fn a_limit_switch_in_mid_sweep_is_named() {
    for link in LINKS {
        // The positive switch has slipped to 20 deg.
        let mut config = SimulatedDriveConfig::default();
        if let Some(switch) = &mut config.switches[1] {
            switch.pressed = firmware_sim::epos2::Region::AtLeast(13_333);
        }
        let mut rig = rig_with(link, config);
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        let error = rig.run(DriveCommand::Sweep(to(45.0))).unwrap_err();
        assert_eq!(
            error,
            DriveError::Fault {
                error: Some(DeviceError::POSITIVE_LIMIT)
            },
            "{link:?}"
        );
        assert!(error.to_string().contains("FF07"), "{error}");
        let stopped = rig.made_safe().unwrap();
        assert_eq!(stopped.validity, PositionValidity::Valid, "{link:?}");
        let Ok(CommandOutcome::FaultsCleared(found)) = rig.run(DriveCommand::ClearFaults) else {
            panic!("{:?}", rig.events.last())
        };
        assert_eq!(found.first(), Some(&DeviceError::POSITIVE_LIMIT));
        assert!(
            rig.run(DriveCommand::Goto(to(0.0))).is_ok(),
            "{link:?}: the axis can leave the switch"
        );
    }
}

#[test]
fn a_blocked_motor_is_a_following_error() {
    for link in LINKS {
        let mut rig = moving_on(link);
        rig.drive.node.block();
        let error = Some(DeviceError::FOLLOWING);
        assert_eq!(rig.finish(), Err(DriveError::Fault { error }), "{link:?}");
        assert_eq!(rig.made_safe().unwrap().validity, PositionValidity::Valid);
        // The axis can move on once it is free.
        rig.drive.node.unblock();
        rig.run(DriveCommand::ClearFaults).unwrap();
        assert!(rig.run(DriveCommand::Goto(to(0.0))).is_ok(), "{link:?}");
    }
}

#[test]
fn a_cut_cable_in_mid_sweep_is_reported_and_stops_the_axis_on_can() {
    for link in LINKS {
        let mut rig = moving_on(link);
        let at = rig.now;
        rig.drive.cut();
        let error = rig.finish().unwrap_err();
        assert!(matches!(error, DriveError::NotStopped { .. }), "{error}");
        let replies = rig.now - sent_quick_stop(&rig).unwrap_or(rig.now);
        // Quick stop, its ramp, and power off, each without a reply.
        assert!(replies < Span::from_millis(240), "{link:?}: {replies:?}");
        assert!(rig.now - at < Span::from_millis(1_900), "{link:?}");
        if link == DriveLink::Can {
            rig.drive.live(at + Span::from_millis(600));
            assert_eq!(rig.drive.node.state(), DeviceState::Fault);
            assert!(rig.drive.is_at_rest());
        }
    }
}

/// The simulated EPOS2 has no writable object of that length, but it takes the whole transfer
/// before it aborts.
#[test]
fn long_objects_of_the_simulated_drive_are_readable_and_refuse_writes() {
    for link in LINKS {
        let mut rig = rig_with(link, SimulatedDriveConfig::default());
        rig.run(DriveCommand::Connect).unwrap();
        let mut read = |index, sub| match rig.run(DriveCommand::Read(Address::new(index, sub))) {
            Ok(CommandOutcome::Read { bytes, .. }) => bytes,
            other => panic!("{link:?}: {other:?}"),
        };
        assert_eq!(read(0x1008, 0), b"EPOS2");
        assert_eq!(
            read(0x2004, 0).len(),
            8,
            "{link:?}: a serial number of 64 bits"
        );
        assert_eq!(read(0x6041, 0).len(), 2);
        assert_eq!(read(0x6065, 0), 2_000_u32.to_le_bytes());
        for (index, len, expected) in [
            (0x20C1, 8, AbortCode::STATE),
            (0x20C1, 9, AbortCode::TOO_LONG),
            (0x20C1, 7, AbortCode::TOO_SHORT),
            (0x2004, 8, AbortCode::READ_ONLY),
            (0x5000, 8, AbortCode::NO_OBJECT),
        ] {
            let bytes = BoundedVec::from_slice(&vec![0x90; len]).unwrap();
            let address = Address::new(index, 0);
            let error = rig.run(DriveCommand::Write { address, bytes }).unwrap_err();
            assert!(
                matches!(error, DriveError::Refused { error, .. } if error == expected),
                "{link:?}: {error}"
            );
        }
        let bytes = BoundedVec::from_slice(&1_500_u32.to_le_bytes()).unwrap();
        let address = Address::new(0x6065, 0);
        rig.run(DriveCommand::Write { address, bytes }).unwrap();
        let Ok(CommandOutcome::Read { bytes, .. }) = rig.run(DriveCommand::Read(address)) else {
            panic!("{link:?}")
        };
        assert_eq!(bytes, 1_500_u32.to_le_bytes());
        let stats = rig.client.link_stats();
        assert_eq!((stats.lost, stats.unmatched), (0, 0), "{link:?}");
    }
}

/// A lagging servo arrives some hundredths of a second after its demand, at the end of the axis:
/// too late for an immediate check.
#[test]
fn a_lagging_servo_homes_and_arrives() {
    for (natural_millihertz, damping_permille) in [(15_000, 700), (15_000, 1_000), (8_000, 1_000)] {
        for link in LINKS {
            let servo = Servo::SecondOrder {
                natural_millihertz,
                damping_permille,
            };
            let config = SimulatedDriveConfig {
                servo: Some(servo),
                ..SimulatedDriveConfig::default()
            };
            let mut rig = rig_with(link, config);
            rig.run(DriveCommand::Connect).unwrap();
            let homed = rig.run(DriveCommand::Home);
            let Ok(CommandOutcome::Homed { angle, .. }) = homed else {
                panic!("{servo:?} {link:?}: {homed:?}")
            };
            // Within the limits and the arrival tolerance.
            assert!(angle.0 > -60.031, "{servo:?} {link:?}: {angle:?}");
            let swept = rig.run(DriveCommand::Sweep(to(-15.0)));
            let Ok(CommandOutcome::Arrived(arrived)) = swept else {
                panic!("{servo:?} {link:?}: {swept:?}")
            };
            assert!(arrived.position.0.abs_diff(-10_000) <= 20);
            let slept = rig.run(DriveCommand::Brake).unwrap();
            let CommandOutcome::Stopped(stopped) = slept else {
                panic!("{slept:?}")
            };
            assert!(!stopped.fault && stopped.position.0.abs_diff(-10_000) <= 1);
            assert_eq!(rig.drive.node.brake(), BrakeState::Closed);
        }
    }
}
