mod independence;

use super::EffectsConfig;
use crate::effects::{ConfiguredEffects, Effects, FiringEffectSet};
use crate::packet_maker::{HeadRotation, TruePoint};
use crate::sensor::{LidarMount, LidarSensor, ReturnMode};
use crate::simulate::{Polls, Simulation, SimulationEvent, SimulationSink};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::motion::{AxisMotion, Sweeps};
use crate::scene::Scene;
use units::{Gearing, Stamp};

/// For each effect a table of settings with which it acts in the hall.
const TABLES: [(&str, &str); 21] = [
    ("limited_field_of_view", "from_deg = 30.0\nto_deg = 200.0"),
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
    ("weather", "visibility_m = 60.0\nrain_mm_h = 10.0"),
    ("reflectance", "half_range_m = 8.0\nincidence = false"),
    (
        "laser_errors",
        "range_sd_m = 0.01\nelevation_sd_deg = 0.05\nazimuth_sd_deg = 0.05",
    ),
    ("range_noise", "sd_m = 0.02"),
    (
        "lidar_clock",
        "drift_ppm = 12.0\nwander_us = 5.0\nwander_period_s = 0.01",
    ),
    ("servo_lag", "frequency_hz = 20.0\ndamping = 0.7"),
    ("tilt_limits", "from_deg = -30.0\nto_deg = 30.0"),
    ("gear_ripple", "amplitude_deg = 0.01\nphase_deg = 90"),
    ("eccentricity", "amplitude_deg = 0.02"),
    ("backlash", "play_deg = 0.05"),
    ("encoder_quantisation", "encoder_lines = 100"),
    ("duplicate", "share = 0.1"),
    ("loss", "lidar_share = 0.05\ndrive_share = 0.05"),
    ("link_jitter", ""),
    ("reorder", "share = 0.1"),
    ("batching", ""),
];

fn config(names: &[&str]) -> EffectsConfig {
    config_of(&TABLES, names)
}

fn config_of(tables: &[(&str, &str)], names: &[&str]) -> EffectsConfig {
    let tables = tables.iter().filter(|(name, _)| names.contains(name));
    let text: String = tables
        .map(|(name, table)| format!("[{name}]\n{table}\n"))
        .collect();
    toml::from_str(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn configured(names: &[&str]) -> ConfiguredEffects {
    config(names).build(7, None).unwrap()
}

#[derive(Default)]
struct Taken {
    packets: Vec<Vec<u8>>,
    all: Vec<(i64, Vec<u8>)>,
    points: Vec<TruePoint>,
}

impl SimulationSink for Taken {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        let (at, bytes) = match event {
            SimulationEvent::Datagram { at, port, payload } => {
                if *port == crate::DATA_PORT {
                    self.packets.push(payload.to_vec());
                }
                (at, payload.to_vec())
            }
            SimulationEvent::Request { at, .. } => (at, b"?".to_vec()),
            SimulationEvent::Answer {
                at, position_qc, ..
            } => (at, position_qc.to_le_bytes().to_vec()),
        };
        self.all.push((at.as_nanos(), bytes));
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.points.extend_from_slice(points);
        ControlFlow::Continue(())
    }
}

fn hall() -> Simulation {
    let motion = AxisMotion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 300.0,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.01,
    });
    Simulation {
        scene: Arc::new(Scene::hall()),
        sensor: LidarSensor::vlp16(),
        returns: ReturnMode::Dual,
        rotation: HeadRotation {
            rpm: 600,
            start_deg: 20.0,
        },
        mount: LidarMount::above(0.06),
        motion: motion.unwrap(),
        polls: Some(Polls {
            period_ns: 2_500_000,
            answer_ns: 1_000_000,
            gearing: Gearing::new(500, 120, 1).unwrap(),
        }),
        start: Stamp::from_nanos(1_795_226_733_000_000_000),
        clock_at_start_us: 3_599_900_000,
    }
}

fn run(effects: &mut ConfiguredEffects, threads: usize) -> Taken {
    run_of(&hall(), effects, threads)
}

fn run_of(simulation: &Simulation, effects: &mut ConfiguredEffects, threads: usize) -> Taken {
    let mut taken = Taken::default();
    let threads = NonZeroUsize::new(threads).unwrap();
    simulation.run(effects, threads, &mut taken).unwrap();
    taken
}

#[test]
fn every_effect_is_tested_here_under_its_name() {
    let names = TABLES.map(|(name, _)| name);
    assert_eq!(names, EffectsConfig::NAMES);
    for name in names {
        let used: Vec<_> = configured(&[name])
            .usage()
            .iter()
            .map(|used| used.name)
            .collect();
        assert_eq!(used, [name]);
        assert_eq!(config(&[name]).configured().next(), Some(name));
        let wrong = format!("[{name}]\nno_such_setting = 1\n");
        let error = toml::from_str::<EffectsConfig>(&wrong).unwrap_err();
        assert!(error.span().is_some(), "{error}");
    }
    assert!(toml::from_str::<EffectsConfig>("[fog]\n").is_err());
    assert!(config(&[]).build(1, None).unwrap().usage().is_empty());
}

#[test]
fn the_first_invalid_setting_is_reported() {
    let text = "[backlash]\nplay_deg = 0.1\n[range_noise]\nsd_m = -1.0\n";
    let config: EffectsConfig = toml::from_str(text).unwrap();
    let error = config.build(1, None).unwrap_err();
    assert_eq!((error.effect, error.setting), ("range_noise", "sd_m"));
}

#[test]
fn every_effect_acts_and_threads_do_not_change_the_result() {
    let names = TABLES.map(|(name, _)| name);
    let mut one = configured(&names);
    let alone = run(&mut one, 1);
    for used in one.usage() {
        assert!(used.counts.acted > 0, "{used:?}");
        assert!(used.counts.acted <= used.counts.calls && used.counts.acted <= used.counts.changed);
    }
    for threads in [2, 5] {
        let mut more = configured(&names);
        let taken = run(&mut more, threads);
        assert!(taken.all == alone.all, "{threads} threads");
        assert!(taken.points == alone.points, "{threads} threads");
        assert_eq!(more.usage(), one.usage());
    }
}

/// Each effect alone on different numbers of threads, and no effects against an empty list.
#[test]
fn equal_seeds_give_equal_results() {
    let nothing = run(&mut ConfiguredEffects::default(), 2);
    let mut absent = Taken::default();
    let one = NonZeroUsize::new(1).unwrap();
    hall()
        .run(&mut Effects::<FiringEffectSet>::default(), one, &mut absent)
        .unwrap();
    assert!(nothing.all == absent.all && nothing.points == absent.points);
    for (name, _) in TABLES {
        let (a, b) = (
            run(&mut configured(&[name]), 1),
            run(&mut configured(&[name]), 3),
        );
        assert!(a.all == b.all && a.points == b.points, "{name}");
        assert!(a.all != nothing.all, "{name} changes nothing");
    }
}
