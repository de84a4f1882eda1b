//! Cost that each effect of the simulator adds to a sweep through the hall, alone and combined.
//!
//! `cargo bench -p velomotion-tests --bench effect_costs` prints the table of docs/src/effects.md.
//! Instructions are counted by valgrind's callgrind and are reproducible; times are the minimum of
//! `-- --rounds N` (9) on one thread, alternating. Other scenes are not included: the cost of an
//! effect depends on how often it acts.

use std::env;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use sim::HeadRotation;
use sim::Scene;
use sim::effect_models::EffectsConfig;
use sim::effects::{ConfiguredEffects, Effects, FiringEffectSet};
use sim::motion::{AxisMotion, Sweeps};
use sim::sensor::{LidarMount, LidarSensor, ReturnMode};
use sim::simulate::{Polls, Simulation, SimulationEvent, SimulationSink};
use units::{Gearing, Stamp};

/// First argument of the process that callgrind watches.
const ONE: &str = "--one";

/// Typical settings of every effect.
const TABLES: [(&str, &str); 21] = [
    ("limited_field_of_view", "from_deg = 30.0\nto_deg = 330.0"),
    (
        "own_shadow",
        "sectors = [{ azimuth_from_deg = 170.0, azimuth_to_deg = 190.0 }]\nbelow_deg = -50.0",
    ),
    (
        "base_drift",
        "velocity_m_s = [0.02, 0.0, 0.0]\nturn_deg_s = [0.0, 0.1, 0.0]",
    ),
    (
        "moving_objects",
        "boxes = [{ at_m = [3.0, 4.0, 0.0], size_m = [0.6, 0.6, 1.8], velocity_m_s = [-1.5, 0.0, 0.0] }]",
    ),
    ("divergence", ""),
    ("weather", "visibility_m = 200.0"),
    ("reflectance", ""),
    (
        "laser_errors",
        "range_sd_m = 0.01\nelevation_sd_deg = 0.05\nazimuth_sd_deg = 0.05",
    ),
    ("range_noise", "sd_m = 0.01"),
    ("lidar_clock", "drift_ppm = 12.0\nwander_us = 5.0"),
    ("servo_lag", "frequency_hz = 20.0\ndamping = 0.7"),
    ("tilt_limits", "from_deg = -44.0\nto_deg = 1.0"),
    ("gear_ripple", "amplitude_deg = 0.003"),
    ("eccentricity", "amplitude_deg = 0.02"),
    ("backlash", "play_deg = 0.02"),
    ("encoder_quantisation", ""),
    ("duplicate", "share = 0.01"),
    ("loss", "lidar_share = 0.01\ndrive_share = 0.01"),
    ("link_jitter", ""),
    ("reorder", "share = 0.01"),
    ("batching", ""),
];

/// A sink that discards everything.
struct Nowhere;

impl SimulationSink for Nowhere {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        std::hint::black_box(event);
        ControlFlow::Continue(())
    }
}

/// The rig's sweep at full speed.
fn sweep() -> Simulation {
    let motion = AxisMotion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 56.25,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.1,
    });
    Simulation {
        scene: Arc::new(Scene::hall()),
        sensor: LidarSensor::vlp16(),
        returns: ReturnMode::Strongest,
        rotation: HeadRotation {
            rpm: 600,
            start_deg: 0.0,
        },
        mount: LidarMount::above(0.06),
        motion: motion.expect("a sweep"),
        polls: Some(Polls {
            period_ns: 2_500_000,
            answer_ns: 1_000_000,
            gearing: Gearing::new(500, 120, 1).expect("a gearing"),
        }),
        start: Stamp::from_nanos(1_795_226_733_000_000_000),
        clock_at_start_us: 0,
    }
}

/// The tables of an effect, of `all`, or of `none`.
fn config(name: &str) -> EffectsConfig {
    let effects = TABLES
        .iter()
        .filter(|(other, _)| name == "all" || *other == name);
    let text: String = effects
        .map(|(name, table)| format!("[{name}]\n{table}\n"))
        .collect();
    toml::from_str(&text).expect("valid tables")
}

/// Runs the sweep. Returns how often effects acted.
fn run(simulation: &Simulation, name: &str) -> ConfiguredEffects {
    let mut effects = config(name).build(1, None).expect("valid settings");
    let one = NonZeroUsize::MIN;
    let ran = match name {
        // The engine compiled without effects, as for a scene without effects.
        "none" => simulation.run(
            &mut Effects::<FiringEffectSet>::default(),
            one,
            &mut Nowhere,
        ),
        _ => simulation.run(&mut effects, one, &mut Nowhere),
    };
    ran.expect("a run");
    effects
}

fn instructions(name: &str) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env::current_exe().ok()?)
        .args([ONE, name])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let counted = text.lines().find_map(|line| line.split_once("Collected :"));
    counted?.1.trim().parse().ok()
}

fn main() {
    let arguments: Vec<String> = env::args().collect();
    let after = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1).cloned()
    };
    let simulation = sweep();
    if let Some(name) = after(ONE) {
        run(&simulation, &name);
        return;
    }
    let rounds = after("--rounds")
        .and_then(|rounds| rounds.parse().ok())
        .unwrap_or(9);
    let mut names = vec!["none"];
    names.extend(TABLES.iter().map(|(name, _)| *name));
    names.push("all");
    let mut times = vec![Duration::MAX; names.len()];
    for _ in 0..rounds {
        for (name, least) in names.iter().zip(&mut times) {
            let start = Instant::now();
            run(&simulation, name);
            *least = start.elapsed().min(*least);
        }
    }
    let counts: Vec<Option<u64>> = names.iter().map(|name| instructions(name)).collect();
    println!("| effect | acted in | instructions | time |\n|---|---|---|---|");
    for ((name, time), count) in names.iter().zip(&times).zip(&counts) {
        let acted = match *name {
            "none" | "all" => String::new(),
            name => run(&simulation, name)
                .usage()
                .iter()
                .fold(String::new(), |_, used| {
                    let share = 100.0 * used.counts.acted as f64 / used.counts.calls.max(1) as f64;
                    format!("{share:.1} % of {}", used.each)
                }),
        };
        let base = counts.first().copied().flatten();
        let counted = match (count, base) {
            (Some(count), Some(_)) if *name == "none" => {
                format!("{:.1} million", *count as f64 * 1e-6)
            }
            (Some(count), Some(base)) => {
                format!("{:+.2} %", 100.0 * (*count as f64 / base as f64 - 1.0))
            }
            _ => "not counted".to_owned(),
        };
        let took = match *name {
            "none" => format!("{:.1} ms", time.as_secs_f64() * 1e3),
            _ => {
                let more = time.as_secs_f64() / times[0].as_secs_f64() - 1.0;
                format!("{:+.0} %", 100.0 * more)
            }
        };
        println!("| `{name}` | {acted} | {counted} | {took} |");
    }
}
