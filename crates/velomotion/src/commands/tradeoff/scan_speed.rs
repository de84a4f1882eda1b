//! Study of the scan: time, gaps and error at a distance, with the planner of `plan`. Computed, not
//! timed.

use analysis::plan::{PlanLimits, PlanRow};
use analysis::tradeoff::{
    Bench, Measurement, Row, Study, StudyError, StudyFindings, StudyRows, Trade,
};
use engine::capture::scan_planner::{PlanRequest, ScanPlanner, USUAL_M};
use engine::capture_request::CaptureRequest;
use engine::config::{Config, Device};
use engine::lidars;

/// The study.
pub(super) const SCAN_SPEED: Study = Study {
    name: "scan-speed",
    title: "How fast to scan",
    choice: "speed, ramps",
    columns: &[
        ("scan_time_s", "scan time, s"),
        ("mean_resolution_deg", "mean resolution, deg"),
        ("gap_deg", "gap of 99 %, deg"),
        ("widest_gap_deg", "widest gap, deg"),
        ("error_without_ranges_mm", "error without ranges, mm"),
        ("error_mm", "error of 95 %, mm"),
    ],
    trades: &[
        Trade::new(0, 2).joined(),
        Trade::new(0, 3).joined(),
        Trade::new(0, 4).joined(),
    ],
    finding,
    measure,
};

/// Speeds of the drive: 1 rpm of the motor is 0.05 deg/s.
const SPEEDS_DEG_S: [f64; 13] = [
    0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 19.0, 20.0, 30.0, 40.0, 56.25,
];
/// Revolutions of the lidar per minute.
const RPM: u32 = 600;
/// The drive's factory ramps, and gentler ones.
const RAMPS: [(f64, &str); 2] = [
    (500.0, "ramps of 500 deg/s2"),
    (125.0, "ramps of 125 deg/s2"),
];
/// Gaps for which a setting is recommended, degrees.
const GAPS_DEG: [f64; 3] = [1.0, 0.3, 0.1];

fn planner(gap_deg: Option<f64>) -> Result<ScanPlanner, StudyError> {
    let request = PlanRequest {
        limits: PlanLimits {
            gap_deg,
            ..PlanLimits::default()
        },
        ..PlanRequest::new(USUAL_M, &lidars::VLP_16, RPM)
    };
    ScanPlanner::new(&Config::default(), ("auto", &Device::found()), request)
        .map_err(|failure| StudyError::workload(failure.message))
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let every = bench.pick(3, 1);
    (bench.say)(&format!(
        "{} settings, computed",
        SPEEDS_DEG_S.len().div_ceil(every) * RAMPS.len()
    ));
    let planner = planner(None)?;
    let mut rows = Vec::new();
    for (accel_deg_s2, group) in RAMPS {
        for speed_deg_s in SPEEDS_DEG_S.into_iter().rev().step_by(every) {
            let request = CaptureRequest {
                speed_deg_s,
                accel_deg_s2: Some(accel_deg_s2),
                ..CaptureRequest::default()
            };
            let row = planner
                .of_request(&request)
                .map_err(|failure| StudyError::workload(failure.message))?;
            rows.push(Row::new(
                format!("{speed_deg_s} deg/s, {accel_deg_s2} deg/s2"),
                speed_deg_s.to_string(),
                group,
                values(&row),
            ));
        }
    }
    Ok((about(bench.pick(1, GAPS_DEG.len()))?, rows))
}

/// The fastest and the slowest scan.
fn finding(findings: &StudyFindings) -> String {
    let value =
        |row: &Row, column: usize| row.values.get(column).map_or(f64::NAN, Measurement::middle);
    let mut rows: Vec<&Row> = findings.rows.iter().collect();
    rows.sort_by(|a, b| value(a, 0).total_cmp(&value(b, 0)));
    let (Some(fast), Some(slow)) = (rows.first(), rows.last()) else {
        return findings.study.title.to_owned();
    };
    format!(
        "{:.0} s give gaps of {:.2} deg, {:.0} s {:.2} deg; the error without ranges falls from {:.1} to {:.1} mm",
        value(fast, 0),
        value(fast, 2),
        value(slow, 0),
        value(slow, 2),
        value(fast, 4),
        value(slow, 4),
    )
}

fn values(row: &PlanRow) -> [f64; 6] {
    let error = &row.error_mm;
    [
        row.scan_s,
        row.resolution_deg,
        row.gap_deg.p99,
        row.gap_deg.worst,
        error.without_ranges(),
        error.total,
    ]
}

/// The recommendation and what the columns are.
fn about(recommended: usize) -> Result<Vec<String>, StudyError> {
    let mut advice = Vec::new();
    for gap_deg in GAPS_DEG.into_iter().take(recommended) {
        let plan = planner(Some(gap_deg))?.plan();
        let plan = plan.map_err(|failure| StudyError::workload(failure.message))?;
        if let Some(chosen) = plan.chosen {
            let command = chosen.command.unwrap_or_default();
            advice.push(format!(
                "{gap_deg} deg: {command} ({:.1} s, {:.1} million points)",
                chosen.row.scan_s,
                chosen.row.points as f64 * 1e-6
            ));
        }
    }
    Ok(vec![
        format!(
            "Choose the speed by the gap: a slower scan has more points, not better ones. At any speed 95 % of a VLP-16's \
             points (range sd 10 mm) are within 20 to 26 mm at {USUAL_M} m. The fastest scans by the gap of 99 % of directions \
             follow. {}. For other limits and devices use velomotion plan --at 20m --gap 0.3deg --error 25mm, with --range-sd, \
             --rpm and --time.",
            advice.join(". ")
        ),
        format!(
            "45 degrees, one sweep, a VLP-16 at {RPM} rpm, USB, homing included. Gaps are angles from directions in view to \
             the nearest ray: of 99 % of directions, and the widest found. They are the worst of four azimuths of the lidar at \
             the start (12 to 40 for the commands above). Lines of gentle ramps are closer together. At 20 deg/s lines \
             coincide: 19 deg/s sees more."
        ),
        "Errors hold for 95 % of points, across the tilt axis, with and without ranges. The other terms are azimuth, tilt \
         angle, clock, and the delay of positions that no scan reveals (velomotion help plan). The mount counts as exact."
            .to_owned(),
    ])
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::{Effort, StudyFindings};
    use units::Stamp;

    use super::*;

    #[test]
    fn slower_scans_are_denser_and_the_advice_names_commands() {
        let mut clock = || Stamp::from_nanos(0);
        let mut bench = Bench {
            clock: &mut clock,
            effort: Effort::Quick,
            say: &mut |_| {},
        };
        let (about, rows) = measure(&mut bench).unwrap();
        assert!(
            about[0].contains("1 deg: velomotion capture --speed "),
            "{about:?}"
        );
        let findings = StudyFindings {
            study: SCAN_SPEED,
            about,
            rows,
        };
        let value = |name: &str, column: usize| {
            let row = findings
                .rows
                .iter()
                .find(|row| row.name.starts_with(name))
                .unwrap();
            row.values[column].middle()
        };
        let finding = finding(&findings);
        assert!(finding.starts_with("6 s give gaps of 0.9"), "{finding}");
        // 75 degrees over 16 lasers in 8 revolutions.
        assert!((value("56.25 deg/s", 1) - 0.5859).abs() < 1e-4);
        assert!(value("56.25 deg/s", 2) > 4.0 * value("3 deg/s", 2));
        assert!(value("56.25 deg/s", 4) > 4.0 * value("3 deg/s", 4));
    }
}
