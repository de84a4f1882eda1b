//! Plans against the truth: each chosen setting is captured in virtual time in a hollow sphere of
//! the requested distance, replayed and measured.

use analysis::density::{gaps, quantile};
use analysis::plan::{PlanLimits, PlanRow};
use engine::capture::scan_plan::{PlanReport, PlanRequest, ScanPlanner};
use engine::config::{Config, Device};
use glam::DVec3;
use protocol::vlp16::models;
use units::{DegPerS, DegPerS2, Span};
use velomotion_tests::capture::{Captured, Setting};
use velomotion_tests::random::Random;

/// Where the software axis is at power-on, degrees.
const REST_DEG: f64 = -11.25;

fn planner(at_m: f64, limits: PlanLimits) -> ScanPlanner {
    let request = PlanRequest {
        limits,
        rest_deg: Some(REST_DEG),
        ..PlanRequest::new(at_m, &models::VLP_16, 600)
    };
    let device = Device::simulator();
    ScanPlanner::new(&Config::default(), ("sim", &device), request).unwrap()
}

fn plan(at_m: f64, limits: PlanLimits) -> PlanReport {
    planner(at_m, limits).plan().unwrap()
}

/// What a capture measured.
#[derive(Debug)]
struct Truth {
    scan_s: f64,
    points: u64,
    /// Error that 95 % of points are within, millimetres.
    error_mm: f64,
    /// Root mean square of the column `sd`, millimetres.
    stated_mm: f64,
    p50_deg: f64,
    p99_deg: f64,
}

/// Captures a setting in a sphere, and measures.
fn measure(row: &PlanRow, at_m: f64, places: &[DVec3], seed: u64) -> Truth {
    let mut setting = Setting::default();
    setting.links.seed = 1_000 * seed + 7;
    // Other phases of polls and rotor.
    setting.start += Span::from_micros(137_731 * seed as i64);
    setting.sphere_m = Some(at_m);
    setting.sweep_request.speed = DegPerS(row.setting.speed_deg_s);
    setting.sweep_request.acceleration = DegPerS2(row.setting.accel_deg_s2);
    setting.sweep_request.sweeps = row.setting.sweeps;
    setting.sweep_request.both_ways = row.setting.sweeps > 1;
    let start = setting.start;
    let captured = Captured::new(setting);
    let cloud = captured.cloud();
    let (_, end) = captured.sweep_span();
    let truth = captured.truth();
    let (mut errors, mut squares) = (Vec::new(), 0.0);
    for point in cloud.iter().step_by(13) {
        let hit = truth
            .point(point.device_time.as_nanos(), point.laser)
            .unwrap();
        errors.push(1e3 * DVec3::from_array(hit).distance(DVec3::from_array(point.position_m)));
        squares += point.sd_m * point.sd_m;
    }
    let directions: Vec<DVec3> = cloud
        .positions()
        .map(|at| DVec3::from_array(at).normalize())
        .collect();
    let gaps = gaps(&directions, places).unwrap();
    let gap = |share: f64| quantile(&gaps, share).unwrap().to_degrees();
    Truth {
        scan_s: (end - start).as_secs_f64(),
        points: cloud.len() as u64,
        error_mm: quantile(&errors, 0.95).unwrap(),
        stated_mm: 1e3 * (squares / errors.len() as f64).sqrt(),
        p50_deg: gap(0.5),
        p99_deg: gap(0.99),
    }
}

/// Ten random requests: the chosen settings keep their limits, and the figures are those of the
/// plan.
#[test]
fn chosen_settings_keep_their_limits_when_measured() {
    let mut random = Random(20);
    let mut between = |low: f64, high: f64| {
        let share = random.below(1_000) as f64 / 999.0;
        low * (high / low).powf(share)
    };
    println!(
        "|at m|error mm|gap deg|capture|scan s|measured|error mm|measured|stated mm|measured|50 % gap|measured|99 % gap|measured|"
    );
    for seed in 0..10 {
        let at_m = between(5.0, 60.0);
        // The error in parts of 10 m, since it grows with the distance.
        let error_mm = between(2.5, 12.0) * (at_m / 10.0).max(1.0);
        let gap_deg = between(0.15, 2.0);
        let limits = PlanLimits {
            error_mm: Some(error_mm),
            gap_deg: Some(gap_deg),
            time_s: None,
        };
        let report = plan(at_m, limits);
        let chosen = report
            .chosen
            .unwrap_or_else(|| panic!("{limits:?}: {:?}", report.unmet));
        let row = &chosen.row;
        let planner = planner(at_m, limits);
        let truth = measure(row, at_m, planner.predictor().places(), seed);
        let command = chosen.command.trim_start_matches("velomotion capture ");
        let (error, gap) = (&row.error_mm, &row.gap_deg);
        println!(
            "|{at_m:.1}|{error_mm:.1}|{gap_deg:.2}|`{}`|{:.2}|{:.2}|{:.1}|{:.1}|{:.2}|{:.2}|{:.3}|{:.3}|{:.3}|{:.3}|",
            command.trim_end_matches(" --device sim"),
            row.scan_s,
            truth.scan_s,
            error.total,
            truth.error_mm,
            error.stated,
            truth.stated_mm,
            gap.p50,
            truth.p50_deg,
            gap.p99,
            truth.p99_deg,
        );
        assert!(truth.error_mm <= error_mm, "{chosen:?} {truth:?}");
        assert!(truth.p99_deg <= gap_deg, "{chosen:?} {truth:?}");
        assert!(
            (truth.scan_s / row.scan_s - 1.0).abs() < 0.05,
            "{chosen:?} {truth:?}"
        );
        assert!(
            (truth.points as f64 / row.points as f64 - 1.0).abs() < 0.02,
            "{chosen:?} {truth:?}"
        );
        assert!(
            (truth.stated_mm / error.stated - 1.0).abs() < 0.2,
            "{chosen:?} {truth:?}"
        );
        assert!(
            (truth.p50_deg / gap.p50 - 1.0).abs() < 0.1,
            "{chosen:?} {truth:?}"
        );
    }
}
