//! CPU seconds of the ways to the K function: `cargo bench -p velomotion-analysis --bench k [--
//! WHAT...]`.
//!
//! WHAT is `exact:FRAMES`, `avx2:FRAMES`, `least:FRAMES`, `two:FRAMES` (two threads),
//! `turned:FRAMES` or `sampled:FRAMES` for an RMBL of FRAMES frames of 14,416 points. Times are CPU
//! times of the process; if another process uses the second hardware thread of the core, they are
//! up to twice as long.

#![expect(
    clippy::disallowed_methods,
    clippy::expect_used,
    reason = "a benchmark reads clocks, and stops where it cannot go on"
)]

use std::num::NonZeroUsize;
use std::time::Instant;

use analysis::k::{self, Edges, Estimate, KError, PairCounts, Registers};
use glam::DVec3;

#[allow(dead_code, reason = "the tests' patterns, of which one is wanted here")]
#[path = "../../crates/analysis/src/k/tests/patterns.rs"]
mod patterns;

const USUAL: [&str; 11] = [
    "exact:1",
    "exact:30",
    "exact:72",
    "avx2:1",
    "avx2:30",
    "least:1",
    "two:30",
    "turned:72",
    "turned:788",
    "sampled:30",
    "sampled:72",
];

/// CPU seconds of this process, including ended threads.
fn cpu_s() -> f64 {
    let alone = std::fs::read_to_string("/proc/self/schedstat").ok();
    let ns = alone.and_then(|line| line.split(' ').next()?.parse::<f64>().ok());
    ns.unwrap_or(f64::NAN) * 1e-9
}

/// CPU seconds of all threads, in ticks of 10 ms.
fn all_cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let behind = stat.rsplit(')').next().unwrap_or_default();
    let ticks = behind.split_whitespace().skip(11).take(2);
    ticks
        .filter_map(|ticks| ticks.parse::<f64>().ok())
        .sum::<f64>()
        * 0.01
}

enum Found {
    PairCounts(PairCounts),
    Estimate(Estimate),
}

fn run(what: &str, points: &[DVec3], frames: usize, edges: &Edges) -> Result<Found, KError> {
    let one = NonZeroUsize::MIN;
    let counts = match what {
        "exact" => k::exact(points, edges, one),
        "avx2" => k::exact_by(Registers::Avx2, points, edges, one),
        "least" => k::exact_by(Registers::Least, points, edges, one),
        "two" => k::exact(points, edges, one.saturating_add(1)),
        "sampled" => {
            return k::sampled(points, edges, &k::Sampling::default()).map(Found::Estimate);
        }
        _ => {
            let step_rad = std::f64::consts::PI / frames as f64;
            let rotation = k::FrameRotation {
                axis: DVec3::Y,
                step_rad,
                frames,
            };
            k::turned(points, &rotation, edges, one)
        }
    };
    counts.map(Found::PairCounts)
}

fn main() {
    let edges = Edges::equal(151).expect("151 bins are few");
    let mut patterns: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word.contains(':'))
        .collect();
    if patterns.is_empty() {
        patterns.extend(USUAL.map(str::to_owned));
    }
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    println!("load {load}");
    for words in patterns {
        let Some((what, frames)) = words.split_once(':') else {
            continue;
        };
        let frames: u32 = frames.parse().expect("a number of frames");
        let points = patterns::rmbl(frames);
        let (cpu, all, wall) = (cpu_s(), all_cpu_s(), Instant::now());
        let found = run(what, &points, frames as usize, &edges).expect("an RMBL has directions");
        let (mut cpu, wall) = (cpu_s() - cpu, wall.elapsed().as_secs_f64());
        if what == "two" {
            cpu = all_cpu_s() - all;
        }
        match found {
            Found::PairCounts(counts) => println!(
                "{words}: {} points, {cpu:.3} CPU s, {wall:.3} s; bins 1, 2, 151: {} {} {}",
                points.len(),
                counts.counts[0],
                counts.counts[1],
                counts.counts[150],
            ),
            Found::Estimate(of) => {
                let step_rad = std::f64::consts::PI / f64::from(frames);
                let rotation = k::FrameRotation {
                    axis: DVec3::Y,
                    step_rad,
                    frames: frames as usize,
                };
                let exact: Estimate = k::turned(&points, &rotation, &edges, NonZeroUsize::MIN)
                    .expect("an RMBL is turned")
                    .into();
                let off = of
                    .shares
                    .iter()
                    .zip(&exact.shares)
                    .map(|(a, b)| (a - b).abs());
                println!(
                    "{words}: {} points, {cpu:.3} CPU s, {wall:.3} s; bound {:.2e}, off {:.2e}",
                    points.len(),
                    of.largest_bound(),
                    off.fold(0.0, f64::max),
                );
            }
        }
    }
}
