//! An axis with weight: gravity, a holding brake with its delays, encoder dither, coasting.

use firmware_sim::epos2::{AxisLoad, HoldingBrake};

use super::*;

/// Falls at 1500 deg/s2 less a tenth for friction; the brake takes 10 ms either way, as configured.
const LOAD: AxisLoad = AxisLoad {
    gravity_rpm_s: -30_000,
    friction_rpm_s: 3_000,
    brake: Some(HoldingBrake {
        opening_ms: 10,
        closing_ms: 10,
        holding_rpm_s: 330_000,
    }),
};
/// World position of the lower hard stop, 5 degrees below the limit switch.
const STOP: i32 = -46_667;

fn loaded(load: AxisLoad) -> SimulatedDriveConfig {
    SimulatedDriveConfig {
        load: Some(load),
        dither_qc: 2,
        hard_stops: [Some(STOP), Some(-STOP)],
        ..SimulatedDriveConfig::default()
    }
}

/// The end of a sweep to -15 degrees with the brake: its report, the shaft's position in the
/// drive's counts a second later, and the drop that the client reports, degrees.
fn sweep_and_brake(
    link: DriveLink,
    load: AxisLoad,
) -> (Result<StopReport, DriveError>, f64, Option<f64>) {
    let mut rig = rig_with(link, loaded(load));
    rig.run(DriveCommand::Connect).unwrap();
    rig.run(DriveCommand::Home).unwrap();
    let swept = rig.run(DriveCommand::Sweep(to(-15.0)));
    let Ok(CommandOutcome::Arrived(arrived)) = swept else {
        panic!("{link:?}: {swept:?}")
    };
    assert!(arrived.position.0.abs_diff(-10_000) <= 2, "{arrived:?}");
    let target = rig.drive.world_qc(rig.now);
    let stopped = rig.run(DriveCommand::Brake).map(|outcome| match outcome {
        CommandOutcome::Stopped(report) => report,
        other => panic!("{link:?}: {other:?}"),
    });
    assert_eq!(rig.run_for(Span::from_secs(1)), None);
    let fallen = rig.drive.world_qc(rig.now) - target;
    let dropped = rig.events.iter().find_map(|event| match event {
        DriveEvent::Progress(CommandProgress::MovedAfterPowerOff(moved)) => Some(moved.0),
        _ => None,
    });
    (stopped, fallen, dropped)
}

#[test]
fn an_axis_with_weight_arrives_and_stays_on_its_brake() {
    for link in LINKS {
        let (stopped, fallen, dropped) = sweep_and_brake(link, LOAD);
        let stopped = stopped.unwrap();
        assert!(!stopped.fault && stopped.validity == PositionValidity::Valid);
        // The power goes at once, so the axis falls for the 10 ms of the brake: 45 qc, and 4 until
        // it has stopped: 0.075 degrees.
        assert!((-50.0..=-48.0).contains(&fallen), "{link:?}: {fallen}");
        let reported = f64::from(stopped.position.0 + 10_000);
        assert!((reported - fallen).abs() <= 12.0, "{link:?}: {reported}");
        assert_eq!(dropped, None, "{link:?}");
    }
}

/// The report waits for the end of the fall.
#[test]
fn an_axis_without_a_brake_is_reported_where_it_falls_to() {
    for link in LINKS {
        let load = AxisLoad {
            brake: None,
            ..LOAD
        };
        let (stopped, fallen, dropped) = sweep_and_brake(link, load);
        assert!(dropped.unwrap() < -45.0, "{link:?}: {dropped:?}");
        // It lies on the hard stop.
        assert!(fallen < -30_000.0, "{link:?}: {fallen}");
        let report = stopped.unwrap();
        let reported = f64::from(report.position.0 + 10_000);
        assert!((reported - fallen).abs() <= 12.0, "{link:?}: {report:?}");
    }
}
