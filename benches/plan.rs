//! Time of a plan, for requests of which few settings keep the limits.
//!
//! `cargo bench -p velomotion-tests --bench plan` prints the least, the middle and the greatest of
//! five runs.

use std::time::Instant;

use analysis::plan::PlanLimits;
use engine::capture::scan_planner::{PlanRequest, ScanPlanner};
use engine::config::{Config, Device};
use engine::lidars::{self, LidarSheet};

/// Request for a plan with a lidar: distance in metres, error in millimetres, gap in degrees.
struct Request {
    lidar: &'static LidarSheet,
    rpm: &'static [u32],
    limits: (f64, f64, f64),
}

const fn vlp_16(at_m: f64, error_mm: f64, gap_deg: f64) -> Request {
    Request {
        lidar: &lidars::VLP_16,
        rpm: &[600],
        limits: (at_m, error_mm, gap_deg),
    }
}

const REQUESTS: [Request; 12] = [
    vlp_16(20.0, 25.0, 0.8),
    vlp_16(5.6, 11.2, 0.564),
    vlp_16(9.9, 7.0, 0.700),
    vlp_16(7.5, 3.6, 0.225),
    vlp_16(13.2, 4.9, 0.172),
    vlp_16(16.5, 16.0, 0.841),
    vlp_16(25.0, 25.4, 0.724),
    vlp_16(50.0, 13.0, 1.017),
    // Three rates of the lidar, more lasers, others, and a gap that no scan keeps.
    Request {
        rpm: &[300, 600, 1200],
        ..vlp_16(20.0, 25.0, 0.5)
    },
    Request {
        lidar: &lidars::HDL_64E,
        ..vlp_16(20.0, 60.0, 0.15)
    },
    Request {
        lidar: &lidars::VLP_32C,
        ..vlp_16(20.0, 60.0, 0.8)
    },
    vlp_16(20.0, 25.0, 0.01),
];
const RUNS: usize = 5;

fn main() {
    println!("| lidar | rpm | at, m | error, mm | gap, deg | setting | scan, s | plan, s |");
    println!("|---|---|--:|--:|--:|---|--:|---|");
    for Request { lidar, rpm, limits } in REQUESTS {
        let (at_m, error_mm, gap_deg) = limits;
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
                rpm: rpm.to_vec(),
                ..PlanRequest::new(at_m, lidar, 600)
            };
            let begin = Instant::now();
            let device = ("sim", &Device::simulator());
            let planner = ScanPlanner::new(&Config::default(), device, request).unwrap();
            let plan = planner.plan().unwrap();
            times_s.push(begin.elapsed().as_secs_f64());
            chosen = plan.chosen.map_or("none | -".to_owned(), |chosen| {
                let setting = chosen.row.setting;
                format!(
                    "{:.2} deg/s, {:.0} deg/s2, {:.0} rpm, {} sweeps | {:.2}",
                    setting.speed_deg_s,
                    setting.accel_deg_s2,
                    setting.rpm,
                    setting.sweeps,
                    chosen.row.scan_s
                )
            });
        }
        times_s.sort_by(f64::total_cmp);
        let [least, middle, most] = [0, RUNS / 2, RUNS - 1].map(|place| times_s[place]);
        println!(
            "| {} | {rpm:?} | {at_m} | {error_mm} | {gap_deg} | {chosen} | {least:.2}, {middle:.2}, {most:.2} |",
            lidar.name
        );
    }
}
