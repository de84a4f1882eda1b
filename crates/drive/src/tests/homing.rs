//! Faults in homing: a switch that never comes, values that freeze, a wrong end.

use firmware_sim::epos2::SimulatedDriveConfig;
use protocol::epos2::AbortCode;
use protocol::epos2::message::SerialRequest;
use protocol::record::DriveLink;
use units::{Degrees, Span};

use super::faults::{is_read, is_write};
use super::rig::Rig;
use super::test_drive::{Fate, near_its_switch};
use crate::{AxisConfig, CommandOutcome, DriveCommand, DriveError};

#[test]
fn homing_that_never_ends_is_stopped() {
    let mut config = AxisConfig::default();
    config.homing.time_limit = Span::from_secs(5);
    // No switch ever comes.
    let drive = SimulatedDriveConfig {
        switches: [None; 4],
        ..near_its_switch()
    };
    let mut rig = Rig::with(DriveLink::Usb, config, drive);
    rig.run(DriveCommand::Connect).unwrap();
    assert!(matches!(
        rig.run(DriveCommand::Home),
        Err(DriveError::HomingTime { method: 17, .. })
    ));
    assert!(rig.made_safe().is_some());
}

#[test]
fn the_homing_error_bit_is_reported() {
    let mut rig = Rig::new(AxisConfig::default());
    rig.run(DriveCommand::Connect).unwrap();
    // The drive cannot home without acceleration.
    rig.drive.set(0x60C5, 0, 0);
    assert!(matches!(
        rig.run(DriveCommand::Home),
        Err(DriveError::Homing { method: 17, .. })
    ));
}

#[test]
fn a_home_outside_the_limits_is_refused() {
    let mut config = AxisConfig::default();
    config.homing.home_position = units::Degrees(-70.0);
    let mut rig = Rig::new(config);
    rig.run(DriveCommand::Connect).unwrap();
    assert!(matches!(
        rig.run(DriveCommand::Home),
        Err(DriveError::Outside { .. })
    ));
}

/// Connects and homes a rig whose requests have these fates from the start of homing.
fn home_with(
    drive: SimulatedDriveConfig,
    hand: impl FnMut(usize, &SerialRequest) -> Fate + 'static,
) -> Result<CommandOutcome, DriveError> {
    let mut rig = Rig::with(DriveLink::Usb, AxisConfig::default(), drive);
    rig.run(DriveCommand::Connect).unwrap();
    rig.drive.hand = Box::new(hand);
    rig.run(DriveCommand::Home)
}

/// A drive whose switch never comes.
fn without_switches() -> SimulatedDriveConfig {
    SimulatedDriveConfig {
        switches: [None; 4],
        ..near_its_switch()
    }
}

/// Every angle of the scan would be wrong by the difference.
#[test]
fn homing_that_ends_at_another_position_is_an_error() {
    let mut is_done = false;
    let ended = home_with(near_its_switch(), move |_, request| {
        is_done |= is_write(request, 0x6060, 1);
        match is_done && is_read(request, 0x6064) {
            true => Fate::Value((-36_667_i32).cast_unsigned()),
            false => Fate::Sent,
        }
    });
    let Err(DriveError::HomePosition { expected, got, .. }) = ended else {
        panic!("{ended:?}")
    };
    assert_eq!((expected, got.0.round()), (Degrees(-60.0), -55.0));
}

/// Neither value would show that the axis searches a dead switch for a minute.
#[test]
fn homing_whose_demand_and_position_freeze_is_stopped() {
    let ended = home_with(without_switches(), |_, request| {
        match is_read(request, 0x6062) || is_read(request, 0x6064) {
            true => Fate::Value(7),
            false => Fate::Sent,
        }
    });
    let Err(DriveError::HomingRest { waited, .. }) = ended else {
        panic!("{ended:?}")
    };
    assert!(waited < Span::from_millis(1_500), "{waited:?}");
    // They may freeze later, too.
    let ended = home_with(without_switches(), |n, request| {
        match n > 100 && (is_read(request, 0x6062) || is_read(request, 0x6064)) {
            true => Fate::Value(7),
            false => Fate::Sent,
        }
    });
    assert!(
        matches!(ended, Err(DriveError::HomingRest { .. })),
        "{ended:?}"
    );
}

/// It goes to the switch and returns to where it began.
#[test]
fn an_axis_at_its_home_position_can_be_homed_again() {
    let mut rig = Rig::homed();
    for _ in 0..8 {
        let ended = rig.run(DriveCommand::Home);
        assert!(
            matches!(ended, Ok(CommandOutcome::Homed { .. })),
            "{ended:?}"
        );
    }
}

#[test]
fn homing_of_a_drive_without_a_demand_is_watched_by_its_position() {
    let refused = |_: usize, request: &SerialRequest| match is_read(request, 0x6062) {
        true => Fate::Refused(AbortCode::NO_OBJECT),
        false => Fate::Sent,
    };
    let ended = home_with(near_its_switch(), refused);
    assert!(
        matches!(ended, Ok(CommandOutcome::Homed { .. })),
        "{ended:?}"
    );
    let beyond = home_with(without_switches(), refused);
    assert!(
        matches!(beyond, Err(DriveError::HomingTravel { .. })),
        "{beyond:?}"
    );
    let frozen = home_with(without_switches(), move |n, request| {
        match is_read(request, 0x6064) {
            true => Fate::Value(7),
            false => refused(n, request),
        }
    });
    assert!(
        matches!(frozen, Err(DriveError::HomingRest { .. })),
        "{frozen:?}"
    );
}
