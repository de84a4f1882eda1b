//! An axis without a brake that the drive holds: once enabled, its power never goes off.

use firmware_sim::epos2::SimulatedDriveConfig;
use protocol::epos2::cia402::DeviceState;
use protocol::record::DriveLink;
use units::{Degrees, Rpm, RpmPerS, Span};

use super::firmware::rig_with;
use super::rig::Rig;
use crate::client::DriveClient;
use crate::command::{DriveCommand, MoveCommand};
use crate::config::AxisConfig;
use crate::error::DriveError;
use crate::event::CommandOutcome;

fn config() -> AxisConfig {
    AxisConfig {
        brake: None,
        hold_without_brake: true,
        ..AxisConfig::default()
    }
}

fn is_powered(rig: &Rig) -> bool {
    matches!(
        rig.drive.node.state(),
        DeviceState::OperationEnabled | DeviceState::QuickStopActive
    )
}

/// Runs a command to its end; the axis must stay powered.
fn run_powered(rig: &mut Rig, command: DriveCommand) -> Result<CommandOutcome, DriveError> {
    rig.client.start(command)?;
    loop {
        assert!(is_powered(rig), "{command:?}");
        if let Some(end) = rig.step() {
            assert!(is_powered(rig), "{command:?}");
            return end;
        }
    }
}

fn goto(to: f64) -> DriveCommand {
    DriveCommand::Goto(MoveCommand {
        to: Degrees(to),
        speed: Rpm(400),
        acceleration: RpmPerS(10_000),
    })
}

/// A homed axis, at rest and held.
fn held_on(link: DriveLink) -> Rig {
    let mut rig = rig_with(link, SimulatedDriveConfig::default());
    rig.client = DriveClient::new(config(), link);
    for command in [DriveCommand::Connect, DriveCommand::Home] {
        rig.client.start(command).unwrap();
        while rig.step().is_none() {}
    }
    rig
}

#[test]
fn an_axis_without_a_brake_stays_powered_from_move_to_move() {
    for link in [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can] {
        let mut rig = held_on(link);
        let Ok(CommandOutcome::Stopped(rest)) = run_powered(&mut rig, DriveCommand::Brake) else {
            panic!("{link:?}: not at rest")
        };
        assert!(rest.held && !rest.brake, "{link:?}");
        // A stop in mid-move, then another program.
        rig.client.start(goto(-20.0)).unwrap();
        for _ in 0..2_000 {
            assert!(rig.step().is_none(), "{link:?}");
        }
        let stopped = run_powered(&mut rig, DriveCommand::Stop);
        assert!(matches!(stopped, Ok(CommandOutcome::Stopped(rest)) if rest.held));
        rig.client = DriveClient::new(config(), link);
        for command in [
            DriveCommand::Connect,
            goto(-40.0),
            DriveCommand::Home,
            DriveCommand::Brake,
        ] {
            let done = run_powered(&mut rig, command);
            assert!(done.is_ok(), "{link:?} {command:?}: {done:?}");
        }
    }
}

#[test]
fn a_held_axis_stays_powered_when_the_host_dies_on_can() {
    let mut rig = held_on(DriveLink::Can);
    rig.client.start(goto(-20.0)).unwrap();
    for _ in 0..2_000 {
        assert!(rig.step().is_none());
    }
    rig.drive.cut();
    let limit = rig.drive.node.time_us() + 500_000;
    while rig.drive.node.time_us() < limit {
        assert!(is_powered(&rig));
        if rig.step().is_some() {
            break;
        }
    }
    assert_eq!(rig.drive.node.state(), DeviceState::QuickStopActive);
}

/// The drive stops without a fault: the samples alone show an axis that is behind its plan.
#[test]
fn a_suspended_host_is_named_as_the_cause_of_a_stop_on_can() {
    let mut rig = held_on(DriveLink::Can);
    rig.client.start(goto(-20.0)).unwrap();
    for _ in 0..2_000 {
        assert!(rig.step().is_none());
    }
    let delay = Span::from_millis(1_000);
    rig.sleep(delay);
    rig.client.handle_host_delay(delay, rig.now);
    let error = rig.finish().unwrap_err();
    assert!(
        matches!(error, DriveError::HostSilent { silence } if silence >= delay),
        "{error}"
    );
    assert!(is_powered(&rig));
}

/// The samples before and after the delay spread far, though the axis has come to rest meanwhile.
#[test]
fn a_delay_of_the_host_in_a_stop_does_not_cost_the_power() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        let mut rig = held_on(link);
        rig.client.start(goto(-20.0)).unwrap();
        for _ in 0..2_000 {
            assert!(rig.step().is_none(), "{link:?}");
        }
        rig.client.start(DriveCommand::Stop).unwrap();
        assert!(rig.run_for(Span::from_millis(20)).is_none(), "{link:?}");
        let delay = Span::from_millis(900);
        rig.sleep(delay);
        rig.client.handle_host_delay(delay, rig.now);
        let stopped = loop {
            assert!(is_powered(&rig), "{link:?}");
            if let Some(end) = rig.step() {
                break end;
            }
        };
        assert!(
            matches!(&stopped, Ok(CommandOutcome::Stopped(rest)) if rest.held),
            "{link:?}: {stopped:?}"
        );
    }
}
