//! The bring-up in virtual time: with a healthy drive, and with defects that it must find.

use std::sync::Arc;

use drive::config::AxisConfig;
use engine::bring_up::{BringUp, BringUpResult, Judgement, Operator, STEPS};
use engine::config::AxisSettings;
use engine::devices::drive_port::OpenPort;
use engine::devices::{profile, simulated};
use firmware_sim::epos2::AxisLoad;
use scanner::ScanConfig;
use sim::{Attachment, Rig};
use units::{DegPerS2, Degrees, Gearing, Host, Stamp};
use velomotion_tests::capture::link;
use velomotion_tests::port::{Links, VirtualPort};

/// Presses no switch.
struct Absent;

impl Operator for Absent {
    fn has_done(&mut self, _: &str) -> bool {
        false
    }
}

/// Runs every step; returns what they measured.
fn bring_up(
    attached: Attachment,
    change: impl FnOnce(&mut AxisConfig, &mut sim::RigConfig),
) -> Vec<BringUpResult> {
    let start = Stamp::<Host>::from_nanos(1_700_000_000_000_000_000);
    let mut axis = profile::axis(&AxisSettings::default()).unwrap();
    let mut rig = simulated::rig(&axis, &ScanConfig::default(), start);
    rig.attached = attached;
    change(&mut axis, &mut rig);
    let port = VirtualPort::new(Rig::new(rig), start, Links::usual(attached, 1));
    let mut opened = OpenPort {
        guardian: None,
        port: Box::new(port),
        link: link(attached),
        rs232_baud: None,
        warning: None,
    };
    let mut bring_up = BringUp::new(axis, DegPerS2(5_000.0), &mut opened, Arc::default());
    let reports = STEPS.map(|step| step.run(&mut bring_up, &mut Absent));
    assert!(reports.iter().all(|report| !report.measurements.is_empty()));
    let measured = reports.into_iter().flat_map(|report| report.measurements);
    measured.collect()
}

fn problems(found: &[BringUpResult]) -> Vec<(&str, &str)> {
    found
        .iter()
        .filter(|found| found.judgement == Judgement::Problem)
        .map(|found| {
            (
                found.name.as_str(),
                found.advice.as_deref().unwrap_or_default(),
            )
        })
        .collect()
}

#[test]
fn a_healthy_drive_has_no_problem_on_any_link() {
    for attached in [Attachment::Usb, Attachment::Rs232, Attachment::Can] {
        let found = bring_up(attached, |_, _| {});
        assert_eq!(problems(&found), [], "{attached:?}");
        let value = |name: &str| &found.iter().find(|found| found.name == name).unwrap().value;
        assert!(value("onto the other switch").starts_with("method 17"));
        assert!(value("in a move").starts_with("at rest after 0."));
        assert!(value("ready to switch on").starts_with("at rest after 0.000"));
        assert!(value("dither with the power on").starts_with("0 qc"));
        assert!(value("time of reading an object").starts_with("median "));
        let by = match attached {
            Attachment::Can => "positions by SYNC at rest",
            _ => "positions by polls at rest",
        };
        assert!(value(by).ends_with(" per second"));
    }
}

/// The encoder dithers under power alone.
#[test]
fn a_position_controller_that_dithers_is_a_problem() {
    let found = bring_up(Attachment::Usb, |_, rig| rig.drive.dither_qc = 60);
    let problems = problems(&found);
    let dither = problems.first();
    assert!(
        dither.is_some_and(|dither| dither.0 == "dither with the power on"),
        "{problems:?}"
    );
}

#[test]
fn a_head_that_falls_is_a_problem() {
    let found = bring_up(Attachment::Usb, |_, rig| {
        rig.drive.load = Some(AxisLoad {
            gravity_rpm_s: 400,
            friction_rpm_s: 0,
            brake: None,
        });
    });
    let problems = problems(&found);
    let drop = problems
        .iter()
        .find(|(name, _)| *name == "drop in 2 s with the power off");
    assert!(
        drop.is_some_and(|drop| drop.1.contains("fit a brake")),
        "{problems:?}"
    );
}

#[test]
fn a_home_offset_onto_the_switch_is_a_problem() {
    let found = bring_up(Attachment::Usb, |axis, _| {
        axis.homing.offset = Degrees(-axis.homing.offset.0);
    });
    let problems = problems(&found);
    assert!(!problems.is_empty());
    assert!(
        problems
            .iter()
            .any(|(_, advice)| advice.contains("[axis.homing]")),
        "{problems:?}"
    );
}

/// The motor turns twice as far as the configured encoder says.
#[test]
fn a_wrong_gear_is_a_problem() {
    let found = bring_up(Attachment::Usb, |axis, _| {
        axis.gearing = Gearing::new(500, 240, 1).unwrap();
    });
    let problems = problems(&found);
    let is_range = |(name, advice): &(&str, &str)| {
        *name == "onto the other switch" && advice.contains("check gear")
    };
    assert!(problems.iter().any(is_range), "{problems:?}");
}
