//! Cost of the best angles in a replay: the same log with straight lines between samples and with
//! the most accurate curve of each sweep.
//!
//! `cargo bench -p velomotion-tests --bench replay_methods [-- --runs N]`
//!
//! Each run is a whole replay like `velomotion replay LOG -o CLOUD.ply`: the log is read twice from
//! its file, clocks and angles are fitted, every point is placed and written. The logs are captures
//! in virtual time of the default scan, 45 degrees at 56.25 deg/s, with an ideal drive and with one
//! whose servo lags and whose gear ripples. The two methods alternate, with another one first in
//! each round; the result is the ratio within a round, so that other load affects both. On Linux
//! CPU time is measured, which depends least on other load. Logs and clouds are in the temporary
//! folder, which may be in memory.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cloud::Fields;
use engine::output::Target;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use firmware_sim::epos2::Servo;
use scanner::trajectory::Method;
use scanner::{Accuracy, TiltSource};
use sim::Attachment;
use sim::GearRipple;
use units::{DegPerS2, Degrees};
use velomotion_tests::capture::{Captured, Setting};

/// Default number of pairs.
const RUNS: usize = 41;

fn main() {
    let argument = std::env::args().skip_while(|word| word != "--runs").nth(1);
    let runs = argument.and_then(|n| n.parse().ok()).unwrap_or(RUNS).max(1);
    println!("{runs} rounds; medians, quartiles in brackets");
    println!(
        "{:<24}{:>10}{:>16}{:>10}{:>10}  best / linear",
        "", "points", "best by", "linear", "best"
    );
    for attached in [Attachment::Usb, Attachment::Can] {
        for real in [false, true] {
            let captured = Captured::new(setting(attached, real));
            let name = if real { "real drive" } else { "ideal drive" };
            compare(&format!("{attached:?}, {name}"), &captured, runs);
        }
    }
}

fn setting(attached: Attachment, real: bool) -> Setting {
    let mut setting = Setting::over(attached);
    setting.sweep_request.acceleration = DegPerS2(500.0);
    if real {
        setting.servo = Some(Servo::SecondOrder {
            natural_millihertz: 15_000,
            damping_permille: 700,
        });
        setting.ripple = Some(GearRipple {
            amplitude: Degrees(0.003),
            per_motor_turn: 1,
            phase: Degrees(0.0),
        });
    }
    setting
}

fn compare(name: &str, captured: &Captured, runs: usize) {
    let folder = tempfile::tempdir().unwrap();
    let cloud = folder.path().join("cloud.ply");
    let log = captured.log();
    let run = |accuracy| {
        let start = now_s();
        let scan = replayed(&log, accuracy, &cloud);
        let took = now_s() - start;
        fs::remove_file(&cloud).unwrap();
        (took, scan)
    };
    let ways = [Accuracy::By(Method::Linear), Accuracy::Best];
    let [_, (points, method)] = ways.map(|way| run(way).1);
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    for round in 0..runs {
        let mut took = [0.0; 2];
        for turn in 0..2 {
            let way = (round + turn) % 2;
            took[way] = run(ways[way]).0;
        }
        times[0].push(took[0]);
        times[1].push(took[1]);
        times[2].push(took[1] / took[0]);
    }
    let [linear, best, ratio] = times.map(Quartiles::of);
    println!(
        "{name:<24}{points:>10}{method:>16}{:>7.1} ms{:>7.1} ms  {:.3} ({:.3}..{:.3})",
        linear.median * 1e3,
        best.median * 1e3,
        ratio.median,
        ratio.low,
        ratio.high
    );
}

/// CPU seconds of this thread where known, else elapsed seconds.
fn now_s() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let known = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ns: Option<f64> = known.and_then(|text| text.split(' ').next()?.parse().ok());
    ns.map_or_else(|| START.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// Points and the method of their angles.
fn replayed(log: &Path, accuracy: Accuracy, cloud: &Path) -> (u64, String) {
    let request = Reconstruction {
        recording: &Source::open(log, None).unwrap(),
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: engine::reconstruct::replay::TimeReference::Host,
        accuracy,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt: &AtomicBool::new(false),
    };
    let target = Target::open(cloud, Fields::FILE, false).unwrap();
    let scan = replay::make(&request, target).unwrap();
    (scan.points, scan.sync.angle_method)
}

struct Quartiles {
    low: f64,
    median: f64,
    high: f64,
}

impl Quartiles {
    fn of(mut measured: Vec<f64>) -> Self {
        measured.sort_by(f64::total_cmp);
        let at = |part: f64| measured[((measured.len() - 1) as f64 * part).round() as usize];
        Self {
            low: at(0.25),
            median: at(0.5),
            high: at(0.75),
        }
    }
}
