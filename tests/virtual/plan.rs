//! Plans against the truth: each chosen setting is captured in virtual time in a hollow sphere of
//! the requested distance, replayed and measured.

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

use analysis::density::{gaps, quantile};
use analysis::plan::{
    PlanLimits, PlanRow, PlannedPlace, PlannedRays, PlannedScan, StartedSweep, TiltSweep,
};
use engine::capture::scan_planner::{PlanReport, PlanRequest, ScanPlanner};
use engine::capture_request::CaptureRequest;
use engine::config::{Config, Device};
use engine::lidars;
use glam::DVec3;
use units::{DegPerS, DegPerS2, Span};
use velomotion_tests::capture::{Captured, Setting};
use velomotion_tests::random::Random;

/// Where the simulated axis is at power-on, degrees.
const REST_DEG: f64 = -11.25;

fn planner(at_m: f64, limits: PlanLimits) -> ScanPlanner {
    planner_of(&PlanRequest {
        limits,
        ..PlanRequest::new(at_m, &lidars::VLP_16, 600)
    })
}

fn planner_of(request: &PlanRequest) -> ScanPlanner {
    let request = PlanRequest {
        rest_deg: Some(REST_DEG),
        ..request.clone()
    };
    // A light head: ramps of which some hardly count.
    let device = Device {
        accel_deg_s2: 5_000.0,
        ..Device::simulator()
    };
    ScanPlanner::new(&Config::default(), ("sim", &device), request).unwrap()
}

fn plan(at_m: f64, limits: PlanLimits) -> PlanReport {
    planner(at_m, limits).plan().unwrap()
}

/// Neighbours of some of the grid's choices are faster, and such a choice is found in exactly its
/// time.
#[test]
fn choices_are_refined_also_within_a_time() {
    let limits = |gap_deg, time_s| PlanLimits {
        gap_deg: Some(gap_deg),
        time_s,
        ..PlanLimits::default()
    };
    let refined = [0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
        .into_iter()
        .find_map(|gap_deg| {
            let row = plan(25.0, limits(gap_deg, None)).chosen.unwrap().row;
            let grid = planner(25.0, limits(gap_deg, None)).scans([1.02, 1.1]);
            let is_listed = grid.iter().any(|scan| scan.setting == row.setting);
            (!is_listed).then_some((gap_deg, row))
        });
    let (gap_deg, row) = refined.unwrap();
    let timed = plan(25.0, limits(gap_deg, Some(row.scan_s)))
        .chosen
        .unwrap();
    assert_eq!(timed.row.setting, row.setting);
    let late = plan(25.0, limits(gap_deg, Some(0.99 * row.scan_s)));
    assert!(late.chosen.is_none());
    assert_eq!(late.nearest.unwrap().row.setting, row.setting);
}

/// The last row reaches the least gap that there is: where few directions are in view, or where
/// just 1 % of them are out of reach of any scan, as of a VLP-32C, some of them show no difference.
#[test]
fn tables_go_on_to_the_least_gap() {
    for (lidar, to_deg) in [
        (&lidars::VLP_16, -45.0),
        (&lidars::VLP_16, -20.0),
        (&lidars::VLP_32C, -45.0),
    ] {
        let planner = planner_of(&PlanRequest {
            to_deg: Some(to_deg),
            ..PlanRequest::new(20.0, lidar, 600)
        });
        let rows = planner.plan().unwrap().rows;
        let last = rows.last().unwrap().row.gap_deg.p99;
        let scans = planner.scans([1.2, 2.0]);
        let gaps = scans
            .iter()
            .map(|scan| planner.predictor().brief_p99_deg(scan));
        let least = gaps.fold(f64::INFINITY, f64::min);
        println!(
            "{} {to_deg}: {} rows, {last} {least}",
            lidar.name,
            rows.len()
        );
        assert!(last <= 1.1 * least, "{rows:?}");
        assert!(rows.len() >= 8, "{rows:?}");
    }
}

/// At 0.5, 1, 2 and 4 deg of tilt per revolution the lines of a VLP-16, 2 deg apart, coincide. At 4
/// deg the widest gaps hide it.
#[test]
fn captures_whose_lines_coincide_are_warned_of() {
    let planner = planner(20.0, PlanLimits::default());
    let is_warned = |speed_deg_s: f64| {
        let request = CaptureRequest {
            speed_deg_s,
            accel_deg_s2: Some(500.0),
            ..CaptureRequest::default()
        };
        let row = planner.of_request(&request).unwrap();
        planner.resonance(&request, &row).is_some()
    };
    for speed_deg_s in [5.0, 10.0, 20.0, 40.0] {
        assert!(is_warned(speed_deg_s), "{speed_deg_s}");
    }
    for speed_deg_s in [8.0, 14.0, 30.0, 56.25, 75.0, 98.0] {
        assert!(!is_warned(speed_deg_s), "{speed_deg_s}");
    }
}

/// So many random directions in view of the whole sweep: others than the planner's.
fn directions(planner: &ScanPlanner, count: usize, seed: u64) -> Vec<DVec3> {
    let predictor = planner.predictor();
    let rays = PlannedRays::new(&predictor.lidar, 600.0, predictor.errors.range_m);
    let mut random = Random(seed);
    let mut uniform = || 2.0 * random.below(1 << 40) as f64 / (1_u64 << 40) as f64 - 1.0;
    let cube = std::iter::repeat_with(|| DVec3::new(uniform(), uniform(), uniform()));
    let ball = cube.filter(|place| (0.01..1.0).contains(&place.length_squared()));
    let sphere = ball.map(DVec3::normalize);
    let in_view = sphere.filter(|place| rays.is_in_view(*place, [0.0, -45.0]));
    in_view.take(count).collect()
}

/// A scan whose 99 % gap is within this part of the limit surely is a choice.
const KEPT: f64 = 0.98;

/// Directions of a measurement: where few have wide gaps, 99 % of 30,000 random ones vary by 4 %.
const DIRECTIONS: usize = 300_000;

/// What a capture measured.
#[derive(Debug)]
struct Truth {
    scan_s: f64,
    points: u64,
    /// Error that 95 % of points are within, millimetres.
    error_mm: f64,
    /// Root mean square of the column `sd`, millimetres.
    column_sd_mm: f64,
    p50_deg: f64,
    p99_deg: f64,
    worst_deg: f64,
}

/// Captures a setting in a sphere, and measures. `late` is the share of the least round trip, 0.6
/// ms, that the answers of the drive take: unless it is half, all positions are late or early
/// alike, which no scan reveals.
fn measure(row: &PlanRow, planner: &ScanPlanner, seed: u64, late: f64) -> Truth {
    let mut setting = Setting::default();
    setting.links.seed = 1_000 * seed + 7;
    let links = &mut setting.links;
    for (link, share) in [(&mut links.request, 1.0 - late), (&mut links.answer, late)] {
        let least = Span::from_secs_f64(2.0 * share * link.min.as_secs_f64());
        (link.min, link.max) = (least, link.max + (least - link.min));
    }
    // Other phases of polls and rotor.
    setting.start += Span::from_micros(137_731 * seed as i64);
    let errors = &planner.predictor().errors;
    setting.sphere_m = Some(errors.range_m);
    // The simulator's ranges have steps only.
    setting.range_sd_m = Some(errors.range_sd_m).filter(|sd_m| *sd_m > 0.001);
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
    let places = self::directions(planner, DIRECTIONS, seed);
    let gaps = gaps(&directions, &places).unwrap();
    let gap = |share: f64| quantile(&gaps, share).unwrap().to_degrees();
    Truth {
        scan_s: (end - start).as_secs_f64(),
        points: cloud.len() as u64,
        error_mm: quantile(&errors, 0.95).unwrap(),
        column_sd_mm: 1e3 * (squares / errors.len() as f64).sqrt(),
        p50_deg: gap(0.5),
        p99_deg: gap(0.99),
        worst_deg: gap(1.0),
    }
}

/// Ten random requests: distance, and limits of error and gap.
fn requests(seed: u64) -> Vec<(f64, PlanLimits)> {
    let mut random = Random(seed);
    let mut between = |low: f64, high: f64| {
        let share = random.below(1_000) as f64 / 999.0;
        low * (high / low).powf(share)
    };
    let request = |_| {
        let at_m = between(5.0, 60.0);
        let limits = PlanLimits {
            // In parts of 10 m, since the error grows with the distance.
            error_mm: Some(between(2.5, 12.0) * (at_m / 10.0).max(1.0)),
            gap_deg: Some(between(0.15, 2.0)),
            time_s: None,
        };
        (at_m, limits)
    };
    (0..10).map(request).collect()
}

/// The chosen settings keep their limits, and the figures are those of the plan. Of every other
/// request the ranges have noise.
#[test]
fn chosen_settings_keep_their_limits_when_measured() {
    println!(
        "|at m|error mm|gap deg|ranges mm|capture|scan s|measured|error mm|measured|sd mm|measured|50 % gap|measured|99 % gap|measured|worst|measured|"
    );
    for (seed, (at_m, limits)) in (0..).zip(requests(20)) {
        let (error_mm, gap_deg) = (limits.error_mm.unwrap(), limits.gap_deg.unwrap());
        let planner = planner_of(&PlanRequest {
            limits,
            range_sd_m: (seed % 2 == 1).then_some(error_mm / 3e3),
            ..PlanRequest::new(at_m, &lidars::VLP_16, 600)
        });
        let report = planner.plan().unwrap();
        let chosen = report
            .chosen
            .unwrap_or_else(|| panic!("{limits:?}: {:?}", report.unmet));
        let row = &chosen.row;
        let truth = measure(row, &planner, seed, 0.5);
        let command = chosen.command.as_deref().unwrap();
        let command = command.trim_start_matches("velomotion capture ");
        let (error, gap) = (&row.error_mm, &row.gap_deg);
        println!(
            "|{at_m:.1}|{error_mm:.1}|{gap_deg:.2}|{:.2}|`{}`|{:.2}|{:.2}|{:.1}|{:.1}|{:.2}|{:.2}|{:.3}|{:.3}|{:.3}|{:.3}|{:.2}|{:.2}|",
            1e3 * planner.predictor().errors.range_sd_m,
            command.trim_end_matches(" --device sim"),
            row.scan_s,
            truth.scan_s,
            error.total,
            truth.error_mm,
            error.column_sd,
            truth.column_sd_mm,
            gap.p50,
            truth.p50_deg,
            gap.p99,
            truth.p99_deg,
            gap.worst,
            truth.worst_deg,
        );
        assert!(truth.error_mm <= error_mm, "{chosen:?} {truth:?}");
        assert!(truth.worst_deg <= gap.worst, "{chosen:?} {truth:?}");
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
            (truth.column_sd_mm / error.column_sd - 1.0).abs() < 0.2,
            "{chosen:?} {truth:?}"
        );
        assert!(
            (truth.p50_deg / gap.p50 - 1.0).abs() < 0.1,
            "{chosen:?} {truth:?}"
        );
    }
}

/// Twelve requests that few settings keep: the limits are what a random setting gives. The choice
/// is as fast as that setting, and keeps the limits although answers of the drive take longer than
/// requests, or less long.
#[test]
fn tight_limits_are_kept_when_measured() {
    println!(
        "|at m|error mm|gap deg|of|scan s|capture|scan s|late|measured|error mm|measured|99 % gap|measured|"
    );
    let mut random = Random(77);
    for seed in 200..212 {
        let at_m = 5.0 + 0.05 * random.below(1_000) as f64;
        let free = planner(at_m, PlanLimits::default());
        let mut scans = free.scans([1.1, 1.5]);
        scans.retain(|scan| scan.scan_s < 12.0);
        let scan = &scans[random.below(scans.len() as u64) as usize];
        let drawn = free.predictor().row(scan);
        let limits = PlanLimits {
            error_mm: Some(drawn.error_mm.total),
            // So that the drawn setting keeps it with the margin of a choice.
            gap_deg: Some(drawn.gap_deg.p99 / KEPT),
            time_s: None,
        };
        let chosen = plan(at_m, limits)
            .chosen
            .unwrap_or_else(|| panic!("{drawn:?}"));
        let row = &chosen.row;
        let late = random.below(11) as f64 / 10.0;
        let truth = measure(row, &free, seed, late);
        println!(
            "|{at_m:.1}|{:.2}|{:.3}|{}, {}, {}|{:.2}|{}, {}, {}|{:.2}|{late}|{:.2}|{:.2}|{:.2}|{:.3}|{:.3}|",
            drawn.error_mm.total,
            drawn.gap_deg.p99 / KEPT,
            drawn.setting.speed_deg_s,
            drawn.setting.accel_deg_s2,
            drawn.setting.sweeps,
            drawn.scan_s,
            row.setting.speed_deg_s,
            row.setting.accel_deg_s2,
            row.setting.sweeps,
            row.scan_s,
            truth.scan_s,
            row.error_mm.total,
            truth.error_mm,
            row.gap_deg.p99,
            truth.p99_deg,
        );
        assert!(
            truth.error_mm <= drawn.error_mm.total && truth.p99_deg <= drawn.gap_deg.p99 / KEPT,
            "{chosen:?} {truth:?}"
        );
        // The search tries every 1 % of speed and 6 % of the ramps near the first that it finds.
        assert!(
            row.scan_s <= 1.05 * drawn.scan_s && truth.scan_s <= 1.05 * row.scan_s,
            "{drawn:?} {chosen:?} {truth:?}"
        );
    }
}

/// Directions that examine scans.
struct Examination {
    rays: PlannedRays,
    places: Vec<PlannedPlace>,
}

impl Examination {
    fn new(planner: &ScanPlanner, rpm: f64, count: usize, seed: u64) -> Self {
        let predictor = planner.predictor();
        let rays = PlannedRays::new(&predictor.lidar, rpm, predictor.errors.range_m);
        let directions = directions(planner, count, seed).into_iter();
        Self {
            places: directions
                .map(|direction| rays.place(direction, [0.0, -45.0]))
                .collect(),
            rays,
        }
    }

    /// The share of so many of the directions without a ray within a gap, with the lidar at these
    /// azimuths at the starts of the sweeps, revolutions. There are no rays within two counts of
    /// the ends.
    fn unseen(&self, count: usize, sweeps: &[TiltSweep], starts: &[f64], gap_deg: f64) -> f64 {
        let started = sweeps.iter().zip(starts);
        let started: Vec<StartedSweep> = started
            .map(|(sweep, start)| StartedSweep::new(sweep, *start, 0.003))
            .collect();
        let places = self.places.iter().take(count);
        let count = places.len();
        let unseen = places.filter(|place| !self.rays.is_within(&started, place, gap_deg));
        unseen.count() as f64 / count as f64
    }
}

/// With the lidar at other azimuths at the starts, and in other directions: choices of one sweep of
/// few revolutions and of many, and of two sweeps whose rays coincide at few pairs of azimuths.
#[test]
fn choices_keep_their_gap_at_any_azimuth() {
    let mut most_sweeps = 0;
    for (seed, number) in [(5, 9), (6, 1), (6, 2), (8, 0)] {
        let (at_m, limits) = requests(seed)[number];
        let planner = planner(at_m, limits);
        let chosen = planner.plan().unwrap().chosen.unwrap();
        let (setting, gap_deg) = (chosen.row.setting, limits.gap_deg.unwrap());
        let sweep = |number: u32| TiltSweep {
            from_deg: [0.0, -45.0][(number % 2) as usize],
            to_deg: [-45.0, 0.0][(number % 2) as usize],
            speed_deg_s: setting.speed_deg_s,
            accel_deg_s2: setting.accel_deg_s2,
        };
        let sweeps: Vec<TiltSweep> = (0..setting.sweeps).map(sweep).collect();
        let count = 100_000;
        let examination = Examination::new(&planner, setting.rpm, count, seed);
        let mut random = Random(seed);
        let most = (0..if sweeps.len() > 1 { 60 } else { 20 }).fold(0.0, |most: f64, _| {
            let starts = [0, 1].map(|_| random.below(1_000) as f64 / 1e3);
            most.max(examination.unseen(count, &sweeps, &starts, gap_deg))
        });
        println!(
            "{at_m:.1} m, {gap_deg:.3} deg: {setting:?}, {:.3} %",
            100.0 * most
        );
        // Two standard deviations of these directions.
        assert!(most <= 0.0106, "{most} {chosen:?}");
        most_sweeps = most_sweeps.max(setting.sweeps);
    }
    assert_eq!(most_sweeps, 2);
}

/// The place of the first scan that is good, sought by two threads.
fn first_of(scans: &[PlannedScan], is_good: impl Fn(&PlannedScan) -> bool + Sync) -> Option<usize> {
    let (next, first) = (AtomicUsize::new(0), AtomicUsize::new(scans.len()));
    let seek = || {
        loop {
            let place = next.fetch_add(1, Relaxed);
            if place >= first.load(Relaxed) {
                return;
            }
            if is_good(&scans[place]) {
                first.fetch_min(place, Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(seek);
        seek();
    });
    Some(first.into_inner()).filter(|place| *place < scans.len())
}

/// Ten other requests, against a slow search by the planner's rays, but without its choice of
/// directions, azimuths and scans: speeds 5 % and ramps 20 % apart in the order of scan time, the
/// share of 200,000 directions in view without a ray within the gap, and the worst of 48 azimuths
/// at the start of one sweep, which nothing controls, or of 144 pairs at the starts of two. The
/// choice is captured and measured.
#[test]
#[ignore = "takes three minutes"]
fn choices_are_within_five_percent_of_the_best_by_brute_force() {
    println!(
        "|at m|error mm|gap deg|capture|scan s|best by brute force|scan s|99 % gap of it|settings tried|error mm|99 % gap|"
    );
    let mut slower = Vec::new();
    for (seed, (at_m, limits)) in (300..).zip(requests(2_026)) {
        let (error_mm, gap_deg) = (limits.error_mm.unwrap(), limits.gap_deg.unwrap());
        let planner = planner(at_m, limits);
        let predictor = planner.predictor();
        let examination = Examination::new(&planner, 600.0, 200_000, 7 * seed);
        let mut scans = planner.scans([1.05, 1.2]);
        scans.sort_by(|a, b| a.scan_s.total_cmp(&b.scan_s));
        let keeps_gap = |scan: &PlannedScan| {
            // Few directions and azimuths refuse most; of few revolutions the gap depends on every
            // 15 degrees. Of 10,000 directions, 1.4 % lack a ray where 1 % of all lack one in 1 of
            // 10,000 draws.
            let is_double = scan.setting.sweeps > 1;
            let azimuths = if is_double { 12 } else { 48 };
            let checks = [
                (10_000, 0.014, 4),
                (10_000, 0.014, azimuths),
                (200_000, 0.01, azimuths),
            ];
            checks.into_iter().all(|(directions, most, count)| {
                let others = if is_double { count } else { 1 };
                let part = |number: u32| f64::from(number) / f64::from(count);
                let starts = (0..count)
                    .flat_map(|first| (0..others).map(move |other| [part(first), part(other)]));
                let mut unseen = starts
                    .map(|starts| examination.unseen(directions, &scan.sweeps, &starts, gap_deg));
                unseen.all(|unseen| unseen <= most)
            })
        };
        let best = first_of(&scans, |scan| {
            let budget = predictor.errors.budget(&predictor.lidar, &scan.sweeps);
            budget.total <= error_mm && keeps_gap(scan)
        });
        let chosen = planner.plan().unwrap().chosen;
        let (Some(tried), Some(chosen)) = (best, &chosen) else {
            assert!(
                best.is_none() && chosen.is_none(),
                "{limits:?} {best:?} {chosen:?}"
            );
            continue;
        };
        let best = &scans[tried];
        let row = &chosen.row;
        let truth = measure(row, &planner, seed, 0.5);
        let command = chosen.command.as_deref().unwrap();
        println!(
            "|{at_m:.1}|{error_mm:.1}|{gap_deg:.3}|`{}`|{:.2}|{:.2}, {:.1}, {}|{:.2}|{:.3}|{}|{:.1}|{:.3}|",
            command
                .trim_start_matches("velomotion capture ")
                .trim_end_matches(" --device sim"),
            row.scan_s,
            best.setting.speed_deg_s,
            best.setting.accel_deg_s2,
            best.setting.sweeps,
            best.scan_s,
            predictor.row(best).gap_deg.p99,
            tried + 1,
            truth.error_mm,
            truth.p99_deg,
        );
        assert!(
            truth.error_mm <= error_mm && truth.p99_deg <= gap_deg,
            "{chosen:?} {truth:?}"
        );
        if row.scan_s > 1.05 * best.scan_s {
            slower.push((row.setting, best.clone()));
        }
    }
    assert!(slower.is_empty(), "{slower:?}");
}
