mod independence;

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::*;
use crate::effects::testing::line;
use crate::effects::{Effects, OnFirings};
use crate::motion::{Motion, Sweeps};
use crate::scenes;
use crate::sensor::{ReturnMode, Sensor};
use crate::simulate::{Event, Mount, Out, Polls, Simulation, Spin, TruePoint};
use units::{Gearing, Stamp};

/// A table of each effect, so that it acts in the hall.
const TABLES: [(&str, &str); 18] = [
    ("limited_field_of_view", "from_deg = 30.0\nto_deg = 200.0"),
    (
        "own_shadow",
        "sectors = [{ azimuth_from_deg = 170.0, azimuth_to_deg = 190.0 }]\nbelow_deg = -50.0",
    ),
    (
        "moving_objects",
        "boxes = [{ at_m = [3.0, 4.0, 0.0], size_m = [0.6, 0.6, 1.8], velocity_m_s = [-1.5, 0.0, 0.0] }]",
    ),
    ("divergence", ""),
    ("weather", "visibility_m = 60.0\nrain_mm_h = 10.0"),
    ("reflectance", "half_range_m = 8.0\nincidence = false"),
    ("range_noise", "sd_m = 0.02"),
    (
        "lidar_clock",
        "drift_ppm = 12.0\nwander_us = 5.0\nwander_period_s = 0.01",
    ),
    ("servo_lag", "frequency_hz = 20.0\ndamping = 0.7"),
    ("tilt_limits", "from_deg = -30.0\nto_deg = 30.0"),
    ("gear_ripple", "amplitude_deg = 0.01\nphase_deg = 90"),
    ("backlash", "play_deg = 0.05"),
    ("encoder_quantisation", "encoder_lines = 100"),
    ("duplicate", "share = 0.1"),
    ("loss", "lidar_share = 0.05\ndrive_share = 0.05"),
    ("link_jitter", ""),
    ("reorder", "share = 0.1"),
    ("batching", ""),
];

fn wishes(names: &[&str]) -> Wishes {
    wishes_of(&TABLES, names)
}

fn wishes_of(tables: &[(&str, &str)], names: &[&str]) -> Wishes {
    let tables = tables.iter().filter(|(name, _)| names.contains(name));
    let text: String = tables
        .map(|(name, table)| format!("[{name}]\n{table}\n"))
        .collect();
    toml::from_str(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn asked(names: &[&str]) -> Asked {
    wishes(names).make(7, None).unwrap()
}

#[derive(Default)]
struct Taken {
    packets: Vec<Vec<u8>>,
    all: Vec<(i64, Vec<u8>)>,
    points: Vec<TruePoint>,
}

impl Out for Taken {
    fn event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        let (at, bytes) = match event {
            Event::Datagram { at, port, payload } => {
                if *port == crate::DATA_PORT {
                    self.packets.push(payload.to_vec());
                }
                (at, payload.to_vec())
            }
            Event::Request { at, .. } => (at, b"?".to_vec()),
            Event::Answer {
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
    let motion = Motion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 300.0,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.01,
    });
    Simulation {
        scene: Arc::new(scenes::hall()),
        sensor: Sensor::vlp16(),
        returns: ReturnMode::Dual,
        spin: Spin {
            rpm: 600,
            start_deg: 20.0,
        },
        mount: Mount::above(0.06),
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

fn run(asked: &mut Asked, threads: usize) -> Taken {
    run_of(&hall(), asked, threads)
}

fn run_of(simulation: &Simulation, asked: &mut Asked, threads: usize) -> Taken {
    let mut taken = Taken::default();
    let threads = NonZeroUsize::new(threads).unwrap();
    simulation.run(asked, threads, &mut taken).unwrap();
    taken
}

#[test]
fn every_effect_has_a_table_here_and_goes_by_its_name() {
    let names = TABLES.map(|(name, _)| name);
    assert_eq!(names, Wishes::NAMES);
    for name in names {
        let used: Vec<_> = asked(&[name]).used().iter().map(|used| used.name).collect();
        assert_eq!(used, [name]);
        assert_eq!(wishes(&[name]).asked_for()[0].name, name);
        let wrong = format!("[{name}]\nno_such_setting = 1\n");
        let error = toml::from_str::<Wishes>(&wrong).unwrap_err();
        assert!(error.span().is_some(), "{error}");
    }
    assert!(toml::from_str::<Wishes>("[fog]\n").is_err());
    assert!(wishes(&[]).make(1, None).unwrap().used().is_empty());
}

#[test]
fn what_cannot_be_is_told_with_its_place() {
    let text = "[backlash]\nplay_deg = 0.1\n[range_noise]\nsd_m = -1.0\n";
    let wishes: Wishes = toml::from_str(text).unwrap();
    let wrong = wishes.make(1, None).unwrap_err();
    assert_eq!(wrong.unfit.effect, "range_noise");
    assert_eq!(text[wrong.offset(text)..].trim_end(), "sd_m = -1.0");
    assert_eq!(line(text, wrong.at.start), 3);
    let inline = "range_noise = { sd_m = -1.0 }\nloss = {}\n";
    let wishes: Wishes = toml::from_str(inline).unwrap();
    let wrong = wishes.make(1, None).unwrap_err();
    assert_eq!(line(inline, wrong.offset(inline)), 1);
}

#[test]
fn every_effect_acts_and_all_together_give_the_same_on_any_number_of_threads() {
    let names = TABLES.map(|(name, _)| name);
    let mut one = asked(&names);
    let alone = run(&mut one, 1);
    for used in one.used() {
        assert!(used.usage.acted > 0, "{used:?}");
        assert!(used.usage.acted <= used.usage.asked && used.usage.acted <= used.usage.changed);
    }
    for threads in [2, 5] {
        let mut more = asked(&names);
        let taken = run(&mut more, threads);
        assert!(taken.all == alone.all, "{threads} threads");
        assert!(taken.points == alone.points, "{threads} threads");
        assert_eq!(more.used(), one.used());
    }
}

/// Each effect alone, on other threads than one, and without effects against an empty list.
#[test]
fn one_seed_one_result() {
    let nothing = run(&mut Asked::default(), 2);
    let mut absent = Taken::default();
    let one = NonZeroUsize::new(1).unwrap();
    hall()
        .run(&mut Effects::<OnFirings>::default(), one, &mut absent)
        .unwrap();
    assert!(nothing.all == absent.all && nothing.points == absent.points);
    for (name, _) in TABLES {
        let (a, b) = (run(&mut asked(&[name]), 1), run(&mut asked(&[name]), 3));
        assert!(a.all == b.all && a.points == b.points, "{name}");
        assert!(a.all != nothing.all, "{name} changes nothing");
    }
}
