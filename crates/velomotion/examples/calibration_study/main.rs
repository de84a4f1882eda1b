//! Errors of calibrations against the truth of simulated scanners, whose mounts, lasers and gears
//! differ from seed to seed. Prints the tables of docs/src/calibration.md.
//!
//! ```sh
//! cargo run --release -p velomotion --example calibration_study -- errors 20
//! ```
//!
//! Instead of `errors`: `known-scale`, `starts`, `places`, `recipe`, `verdicts`. A third word
//! chooses one scene.

mod scan;
mod scanner;
mod totals;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use ::scanner::config::MountConfig;
use cloud::Fields;
use engine::calibrate::{CalibrateProgress, CalibrateReport, CalibrateRequest, calibrate};

use crate::scan::{delay_us, points, simulate};
use crate::scanner::{StudyDraws, TrueScanner, mount_file};
use crate::totals::Totals;

type Outcome<T> = Result<T, Box<dyn Error>>;

const SCENES: [&str; 5] = ["hall", "parking", "room", "wavy-walls", "stairwell"];

/// Two sweeps, there and back.
fn motion(speed_deg_s: f64) -> String {
    format!(
        "[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -45\nspeed_deg_s = {speed_deg_s}\naccel_deg_s2 = 5000\n\
         count = 2\nboth_ways = true\n"
    )
}

/// A scanner's scene file.
fn text(objects: &str, speed_deg_s: f64, scanner: &TrueScanner, more: &str) -> String {
    format!(
        "{objects}\n{}{}{more}",
        motion(speed_deg_s),
        scanner.sections()
    )
}

fn shipped(scene: &str) -> String {
    format!("scene = \"{scene}\"")
}

/// Processor time of this process, seconds.
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = stat.rsplit(')').next().unwrap_or_default().split(' ');
    ticks
        .skip(12)
        .take(2)
        .filter_map(|ticks| ticks.parse::<f64>().ok())
        .sum::<f64>()
        / 100.0
}

/// A calibration, its shots and its processor time.
struct Run {
    made: Result<CalibrateReport, String>,
    shots: usize,
    seconds: f64,
}

fn run(logs: &[PathBuf], start: MountConfig, fixed: &[&str]) -> Run {
    let fixed: Vec<String> = fixed.iter().map(|name| (*name).to_owned()).collect();
    let interrupt = AtomicBool::new(false);
    let request = CalibrateRequest {
        logs,
        start: Some(start),
        fixed: &fixed,
        level_floor: false,
        interrupt: &interrupt,
    };
    let (mut shots, mut begun) = (0, 0.0);
    let made = calibrate(&request, &mut |step| {
        if let CalibrateProgress::Shots(all) = step {
            (shots, begun) = (all, processor_s());
        }
    });
    Run {
        seconds: processor_s() - begun,
        made: made
            .map(|made| CalibrateReport::new(&made))
            .map_err(|failure| failure.message),
        shots,
    }
}

fn main() -> Outcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |index: usize| words.get(index).map_or("", String::as_str);
    let seeds = word(1).parse().unwrap_or(2);
    let scenes: Vec<&str> = SCENES
        .into_iter()
        .filter(|scene| word(2).is_empty() || word(2) == *scene)
        .collect();
    let folder = std::env::temp_dir().join(format!("calibration-study-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    match word(0) {
        "errors" => errors(&scenes, seeds, &folder, &["play"])?,
        "known-scale" => errors(&scenes, seeds, &folder, &["play", "scale"])?,
        "recipe" => recipe(&scenes, seeds, &folder)?,
        "starts" => starts(&scenes, seeds, &folder)?,
        "places" => places(seeds, &folder)?,
        "verdicts" => verdicts(seeds, &folder)?,
        _ => {
            eprintln!(
                "expected errors, known-scale, recipe, starts, places or verdicts, and a number of seeds"
            )
        }
    }
    std::fs::remove_dir_all(folder)?;
    Ok(())
}

/// Adds a run to a table and logs it.
fn add(totals: &mut Totals, name: &str, seed: u64, run: &Run, truth: &[(String, f64)]) {
    totals.shots += run.shots;
    totals.seconds += run.seconds;
    match &run.made {
        Ok(report) => {
            let (pooled, worst, of) = totals.add(truth, report);
            let (loops, chi2, patches) = (report.loops, report.chi2, report.patches);
            eprintln!(
                "{name} {seed}: base {:?}, error / sd {pooled:.2}, worst {worst:.1} {of}, {loops} loops, chi2 {chi2:.3}, {patches} elements",
                report.bases
            );
        }
        Err(message) => {
            totals.refused += 1;
            eprintln!("{name} {seed}: {message}");
        }
    }
}

/// One fast log: play and delay are one parameter at one speed, so play stays 0. Where the scale is
/// known too, elevations are known better, whose slope it resembles.
fn errors(scenes: &[&str], seeds: u64, folder: &Path, fixed: &[&str]) -> Outcome<()> {
    println!("{}", Totals::HEAD);
    for scene in scenes {
        let mut totals = Totals::default();
        for seed in 0..seeds {
            let scanner = TrueScanner::new(seed);
            let text = text(&shipped(scene), 56.25, &scanner, "");
            let log = folder.join("scan.pcapng");
            simulate(&text, seed, &log)?;
            let truth = scanner.values(delay_us(&text, seed, &log, scanner.ripple())?);
            let run = run(&[log], MountConfig::upright(0.06), fixed);
            add(&mut totals, scene, seed, &run, &truth);
        }
        println!("{}", totals.row(scene));
    }
    Ok(())
}

/// Two logs, at 56.25 and at 10 deg/s, of a gear with 20 mdeg of play.
fn recipe(scenes: &[&str], seeds: u64, folder: &Path) -> Outcome<()> {
    println!("{}", Totals::HEAD);
    for scene in scenes {
        let mut totals = Totals::default();
        for seed in 0..seeds {
            let scanner = TrueScanner {
                play_deg: 0.02,
                ..TrueScanner::new(seed)
            };
            let logs = ["fast.pcapng", "slow.pcapng"].map(|name| folder.join(name));
            let texts = [56.25, 10.0].map(|speed| text(&shipped(scene), speed, &scanner, ""));
            for (text, log) in texts.iter().zip(&logs) {
                simulate(text, seed, log)?;
            }
            // Delays are of links that are the same.
            let same = TrueScanner::new(seed);
            let one = text(&shipped(scene), 56.25, &same, "");
            let log = folder.join("scan.pcapng");
            simulate(&one, seed, &log)?;
            let truth = scanner.values(delay_us(&one, seed, &log, scanner.ripple())?);
            let run = run(&logs, MountConfig::upright(0.06), &[]);
            add(&mut totals, scene, seed, &run, &truth);
        }
        println!("{}", totals.row(scene));
    }
    Ok(())
}

/// Starts that are off by 5 deg, 50 mm and 2 ms.
fn starts(scenes: &[&str], seeds: u64, folder: &Path) -> Outcome<()> {
    println!("{}", Totals::HEAD);
    let mut totals = Totals::default();
    for seed in 0..seeds {
        let mut draws = StudyDraws(5_000 + seed);
        let mut side = |off: f64| if draws.uniform(1.0) < 0.0 { -off } else { off };
        let scanner = TrueScanner {
            packets_late_us: 2_040.0,
            ..TrueScanner::new(seed)
        };
        let start = MountConfig {
            position_m: [scanner.position_m[0] + side(0.05), 0.0, 0.0],
            rotation_deg: [
                scanner.rotation_deg[0] + side(5.0),
                0.0,
                scanner.rotation_deg[1] + side(5.0),
            ],
            ..MountConfig::upright(scanner.position_m[1] + side(0.05))
        };
        let scene = scenes[seed as usize % scenes.len()];
        let text = text(&shipped(scene), 56.25, &scanner, "");
        let log = folder.join("scan.pcapng");
        simulate(&text, seed, &log)?;
        let truth = scanner.values(delay_us(&text, seed, &log, scanner.ripple())?);
        let run = run(&[log], start, &["play"]);
        add(&mut totals, scene, seed, &run, &truth);
    }
    println!("{}", totals.row("starts off"));
    Ok(())
}

/// Calibrated in one scene, judged by the points of another at 25 to 50 m: the same shots, placed
/// by the calibration and by the truth, after a turn about the tilt axis.
fn places(seeds: u64, folder: &Path) -> Outcome<()> {
    println!("| calibrated in | before, mm | after, mm | worst seed, mm |\n|---|---|---|---|");
    for scene in SCENES.into_iter().filter(|scene| *scene != "parking") {
        let (mut sums, mut worst, mut made) = ([0.0; 2], 0.0_f64, 0.0);
        for seed in 0..seeds {
            let scanner = TrueScanner::new(seed);
            let [log, other] = ["scan.pcapng", "other.pcapng"].map(|name| folder.join(name));
            let here = text(&shipped(scene), 56.25, &scanner, "");
            simulate(&here, seed, &log)?;
            let there = text(&shipped("parking"), 56.25, &scanner, "");
            simulate(&there, seed + 500, &other)?;
            let delay = delay_us(&there, seed + 500, &other, scanner.ripple())?;
            let truth = scanner.values(delay);
            let run = run(&[log], MountConfig::upright(0.06), &["play"]);
            let report = match run.made {
                Ok(report) => report,
                Err(message) => {
                    eprintln!("{scene} {seed}: {message}");
                    continue;
                }
            };
            let of_truth = |name: &str| {
                truth
                    .iter()
                    .find(|(known, _)| known == name)
                    .map_or(0.0, |(_, value)| *value)
            };
            let found = |name: &str| {
                report
                    .parameters
                    .iter()
                    .find(|p| p.name == name)
                    .map_or(0.0, |p| p.value)
            };
            let nominal = |name: &str| {
                if name == "mount_position_z_m" {
                    0.06
                } else {
                    0.0
                }
            };
            let [exact, before, after] =
                [&of_truth as &dyn Fn(&str) -> f64, &nominal, &found].map(|value| {
                    let file = folder.join("mount.toml");
                    std::fs::write(&file, mount_file(value))?;
                    let fields = Fields::DEVICE_TIME.union(Fields::LASER);
                    points(&other, Some(&file), fields)
                });
            let exact = exact?;
            let [before_mm, after_mm] = [before?, after?].map(|points| apart_mm(&exact, &points));
            eprintln!("{scene} {seed}: {before_mm:.1} mm before, {after_mm:.2} mm after");
            sums[0] += before_mm * before_mm;
            sums[1] += after_mm * after_mm;
            worst = worst.max(after_mm);
            made += 1.0;
        }
        let [before, after] = sums.map(|sum| f64::sqrt(sum / f64::max(made, 1.0)));
        println!("| {scene} | {before:.0} | {after:.1} | {worst:.1} |");
    }
    Ok(())
}

/// Root mean square distance of points at 25 to 50 m after the best turn about the tilt axis,
/// millimetres.
fn apart_mm(exact: &cloud::Points, points: &cloud::Points) -> f64 {
    let pairs = || {
        let far =
            |p: &[f64; 3]| (25.0..50.0).contains(&p.iter().map(|x| x * x).sum::<f64>().sqrt());
        exact
            .positions()
            .zip(points.positions())
            .filter(move |(p, _)| far(p))
    };
    let (mut along, mut squares) = (0.0, 0.0);
    for (p, q) in pairs() {
        along += p[2] * (q[0] - p[0]) - p[0] * (q[2] - p[2]);
        squares += p[0] * p[0] + p[2] * p[2];
    }
    let turn = along / squares;
    let (mut sum, mut count) = (0.0, 0.0);
    for (p, q) in pairs() {
        let off = [
            q[0] - p[0] - turn * p[2],
            q[1] - p[1],
            q[2] - p[2] + turn * p[0],
        ];
        sum += off.iter().map(|x| x * x).sum::<f64>();
        count += 1.0;
    }
    1e3 * f64::sqrt(sum / f64::max(count, 1.0))
}

/// Scans that calibrate refuses, and unusual ones that it accepts.
fn verdicts(seeds: u64, folder: &Path) -> Outcome<()> {
    println!("| scan | right verdicts | of |\n|---|---|---|");
    let hall = || shipped("hall");
    let sphere = "[[objects]]\nsphere = { radius_m = 8 }".to_owned();
    let far = "[[objects]]\nposition_m = [0, 6, 0]\nbox = { size_m = [1.2, 0.2, 1.2] }".to_owned();
    let corridor =
        "[[objects]]\nbox = { from_m = [-1.1, -30, -1.2], to_m = [1.3, 25, 1.5] }".to_owned();
    let floor = "[[objects]]\nposition_m = [0, 0, -1.2]\nplane = {}".to_owned();
    /// Name, whether it is accepted, its objects, and its effects by seed.
    type Case = (&'static str, bool, String, fn(u64) -> String);
    let cases: [Case; 7] = [
        ("at the centre of a sphere", false, sphere, |_| {
            String::new()
        }),
        ("a base that moves at 5 mm/s", false, hall(), |seed| {
            let mut draws = StudyDraws(9_000 + seed);
            let way = [0; 3].map(|_| draws.normal(1.0));
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            let velocity = way.map(|x| 0.005 * x / length);
            format!("[effects.base_drift]\nvelocity_m_s = {velocity:?}\n")
        }),
        ("a board in the open", false, far, |_| String::new()),
        (
            "a loose platform that swings by 0.2 deg",
            false,
            hall(),
            |_| {
                // Replaces the gear of the scanner: a ripple that is not in the model.
                "per_motor_turn = 3\n".to_owned()
            },
        ),
        ("a corridor", true, corridor, |_| String::new()),
        ("a bare floor", true, floor, |_| String::new()),
        ("forty walkers in the hall", true, hall(), |seed| {
            let mut draws = StudyDraws(7_000 + seed);
            let mut boxes = String::from("[effects.moving_objects]\nboxes = [\n");
            for _ in 0..40 {
                let (x, y) = (draws.uniform(13.0), draws.uniform(8.5));
                let (vx, vy) = (draws.uniform(1.5), draws.uniform(1.5));
                boxes += &format!(
                    "{{ at_m = [{x}, {y}, -0.35], size_m = [0.5, 0.4, 1.7], velocity_m_s = [{vx}, {vy}, 0.0] }},\n"
                );
            }
            boxes + "]\n"
        }),
    ];
    for (name, accepted, objects, more) in cases {
        let mut right = 0;
        for seed in 0..seeds {
            let scanner = TrueScanner::new(seed);
            let mut file = text(&objects, 56.25, &scanner, "");
            let more = more(seed);
            file = if more.starts_with("per_motor") {
                file.replace(
                    "amplitude_deg = 0.003",
                    &format!("amplitude_deg = 0.2\n{}", more.trim_end()),
                )
            } else {
                file + &more
            };
            let log = folder.join("scan.pcapng");
            simulate(&file, seed, &log)?;
            let delay = delay_us(&file, seed, &log, scanner.ripple()).unwrap_or(0.0);
            let truth = scanner.values(delay);
            let run = run(&[log], MountConfig::upright(0.06), &["play"]);
            let is_right = match &run.made {
                Ok(_) => accepted,
                Err(message) => !accepted && (!name.contains("moves") || message.contains("moved")),
            };
            right += u64::from(is_right);
            add(&mut Totals::default(), name, seed, &run, &truth);
        }
        println!(
            "| {name}, to be {} | {right} | {seeds} |",
            if accepted { "accepted" } else { "refused" }
        );
    }
    Ok(())
}
