//! Time of a plan, for requests of which few settings keep the limits.
//!
//! `cargo bench -p velomotion-tests --bench plan` prints the least, the middle and the greatest of
//! five runs.

use std::time::Instant;

use analysis::plan::PlanLimits;
use engine::capture::scan_plan::{PlanRequest, ScanPlanner};
use engine::config::{Config, Device};
use engine::lidars;

/// Distance in metres, error in millimetres, gap in degrees.
const REQUESTS: [(f64, f64, f64); 8] = [
    (20.0, 25.0, 0.8),
    (5.6, 11.2, 0.564),
    (9.9, 7.0, 0.700),
    (7.5, 3.6, 0.225),
    (13.2, 4.9, 0.172),
    (16.5, 16.0, 0.841),
    (25.0, 25.4, 0.724),
    (50.0, 13.0, 1.017),
];
const RUNS: usize = 5;

fn main() {
    println!("| at, m | error, mm | gap, deg | setting | scan, s | plan, s |");
    println!("|--:|--:|--:|---|--:|---|");
    for (at_m, error_mm, gap_deg) in REQUESTS {
        let limits = PlanLimits {
            error_mm: Some(error_mm),
            gap_deg: Some(gap_deg),
            time_s: None,
        };
        let mut times_s = Vec::new();
        let mut chosen = String::new();
        for _ in 0..RUNS {
            let request = PlanRequest {
                limits,
                ..PlanRequest::new(at_m, &lidars::VLP_16, 600)
            };
            let begin = Instant::now();
            let device = ("sim", &Device::simulator());
            let planner = ScanPlanner::new(&Config::default(), device, request).unwrap();
            let row = planner.plan().unwrap().chosen.unwrap().row;
            times_s.push(begin.elapsed().as_secs_f64());
            let setting = row.setting;
            chosen = format!(
                "{:.2} deg/s, {:.0} deg/s2, {} sweeps | {:.2}",
                setting.speed_deg_s, setting.accel_deg_s2, setting.sweeps, row.scan_s
            );
        }
        times_s.sort_by(f64::total_cmp);
        let [least, middle, most] = [0, RUNS / 2, RUNS - 1].map(|place| times_s[place]);
        println!(
            "| {at_m} | {error_mm} | {gap_deg} | {chosen} | {least:.2}, {middle:.2}, {most:.2} |"
        );
    }
}
