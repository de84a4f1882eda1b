//! Effects draw independently: each effect that draws, with every other, on any number of threads.
//!
//! The scanner is at the centre of a sphere, so that tilt and time change no distance: returns that
//! another effect does not change must be the same as without it.

use crate::effect_models::testing::arrivals;
use crate::effects::{ClockEffect, MessageKind};
use crate::packet_maker::HeadRotation;
use crate::sensor::LidarMount;
use crate::simulate::Simulation;
use std::collections::BTreeMap;

use super::*;
use crate::cast::{Object, Sphere};
use crate::scene::Scene;

/// Effects that draw per firing.
const PER_FIRING: [&str; 3] = ["weather", "reflectance", "range_noise"];
/// Effects that draw per message.
const PER_MESSAGE: [&str; 4] = ["duplicate", "loss", "link_jitter", "reorder"];
/// The largest normal draw of `range_noise` (2 cm), in steps of 2 mm.
const NOISE: u16 = 90;

/// A sphere at which `reflectance` of [`TABLES`] detects half of all shots.
fn sphere() -> Simulation {
    let motion = AxisMotion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -5.0,
        speed_deg_s: 300.0,
        accel_deg_s2: Some(50_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.005,
    });
    Simulation {
        scene: Arc::new(
            Scene::new()
                .with(Object::new(Sphere { radius_m: 8.0 }), 10)
                .unwrap(),
        ),
        rotation: HeadRotation {
            rpm: 600,
            start_deg: 120.0,
        },
        mount: LidarMount::above(0.0),
        motion: motion.unwrap(),
        ..hall()
    }
}

/// Distances of both returns of each shot, 0 for none, by azimuth and channel. The run is shorter
/// than a revolution.
type Shots = BTreeMap<(u16, usize), [u16; 2]>;

fn shots(names: &[&str], weather: &'static str, threads: usize) -> Shots {
    let tables = TABLES.map(|(name, table)| match name {
        "weather" => (name, weather),
        _ => (name, table),
    });
    let mut effects = config_of(&tables, names).build(7, None).unwrap();
    let taken = run_of(&sphere(), &mut effects, threads);
    let mut shots = Shots::new();
    for packet in &taken.packets {
        for (number, block) in packet[..1_200].chunks(100).enumerate() {
            let azimuth = u16::from_le_bytes([block[2], block[3]]);
            for (channel, raw) in block[4..].chunks(3).enumerate() {
                let distance = u16::from_le_bytes([raw[0], raw[1]]);
                shots.entry((azimuth, channel)).or_default()[number % 2] = distance;
            }
        }
    }
    shots
}

fn near(a: u16, b: u16, within: u16) -> bool {
    a.abs_diff(b) <= within
}

/// Whether all returns of a shot are among those of another.
fn is_subset(returns: [u16; 2], others: [u16; 2], within: u16) -> bool {
    returns
        .iter()
        .all(|a| *a == 0 || others.iter().any(|b| *b > 0 && near(*a, *b, within)))
}

#[test]
fn another_effect_does_not_change_random_draws_per_shot() {
    // Fog that is dense enough to return, and fog that only dims.
    let weather = TABLES.iter().find(|(name, _)| *name == "weather");
    let (dense, thin) = (weather.expect("weather").1, "visibility_m = 1000.0");
    let nothing = shots(&[], thin, 1);
    assert!(nothing.len() > 4_000);
    let others = TABLES.map(|(name, _)| (name, shots(&[name], thin, 2)));
    for effect in PER_FIRING {
        let weather = if effect == "weather" { dense } else { thin };
        let alone = shots(&[effect], weather, 1);
        assert_ne!(alone, nothing, "{effect}");
        for (other, without) in others.iter().filter(|(other, _)| *other != effect) {
            let within = match *other {
                "range_noise" | "laser_errors" => NOISE,
                // 2 mm in the tenth of a second.
                "base_drift" => 1,
                _ => 0,
            };
            let both = shots(&[effect, other], weather, 3);
            let mut seen = 0;
            for (key, was) in &nothing {
                let (Some(without), Some(alone), Some(both)) =
                    (without.get(key), alone.get(key), both.get(key))
                else {
                    continue;
                };
                // Changes by the other effect alone do not count.
                let left_alone = without.iter().zip(was).all(|(a, b)| near(*a, *b, within));
                if !left_alone {
                    continue;
                }
                seen += 1;
                let same = match (effect, *other) {
                    // Less light: no new detections.
                    ("reflectance", "weather") | ("weather", "reflectance") => {
                        is_subset(*both, *alone, 0)
                    }
                    _ => {
                        let there = |returns: &[u16; 2]| returns.map(|distance| distance > 0);
                        is_subset(*both, *alone, within) && there(both) == there(alone)
                    }
                };
                assert!(same, "{effect} beside {other}: {key:?} {alone:?} {both:?}");
            }
            assert!(seen > 500, "{effect} beside {other}: {seen}");
        }
    }
}

#[test]
fn another_effect_does_not_change_the_clock() {
    let clock = |names: &[&str]| {
        let clocks = configured(names).firings.clock;
        (0..1_000)
            .map(|step| clocks.host_ns(step * 313_000_007))
            .collect::<Vec<_>>()
    };
    let alone = clock(&["lidar_clock"]);
    assert_ne!(alone, clock(&[]));
    for (other, _) in TABLES {
        assert_eq!(clock(&["lidar_clock", other]), alone, "{other}");
    }
}

/// Delays of messages by number: none, one or several.
fn delays(names: &[&str], kind: MessageKind) -> Vec<Vec<i64>> {
    let sent: Vec<i64> = (0..2_000).map(|number| number * 1_327_104).collect();
    let mut delays = vec![Vec::new(); sent.len()];
    for message in arrivals(&mut configured(names).link, kind, &sent) {
        let number = message.number as usize;
        delays[number].push(message.time_ns - sent[number]);
    }
    delays
}

/// Consecutive links: each acts on a message as it does alone.
#[test]
fn another_effect_does_not_change_random_draws_per_message() {
    for kind in [
        MessageKind::Data,
        MessageKind::Position,
        MessageKind::Answer,
    ] {
        for effect in PER_MESSAGE {
            let alone = delays(&[effect], kind);
            let acts = alone.iter().any(|delays| delays[..] != [0]);
            let on_lidar_only = ["duplicate", "reorder"].contains(&effect);
            assert_eq!(acts, kind.is_from_lidar() || !on_lidar_only, "{effect}");
            for (other, _) in TABLES.iter().filter(|(other, _)| *other != effect) {
                let both = delays(&[effect, other], kind);
                // It waits for a tick, independently of the arrival.
                if *other == "batching" && kind.is_from_lidar() {
                    for ((number, both), alone) in (0..).zip(&both).zip(&alone) {
                        let tick = |delay: &i64| {
                            let at = number * 1_327_104 + delay;
                            delay + (-at).rem_euclid(15_625_000)
                        };
                        assert_eq!(*both, alone.iter().map(tick).collect::<Vec<_>>());
                    }
                    continue;
                }
                let without = delays(&[other], kind);
                for (number, both) in both.iter().enumerate() {
                    let sums = alone[number]
                        .iter()
                        .flat_map(|a| without[number].iter().map(move |b| a + b));
                    let mut sums: Vec<i64> = sums.collect();
                    sums.sort_unstable();
                    let mut both = both.clone();
                    both.sort_unstable();
                    assert_eq!(both, sums, "{effect} beside {other}: {number}");
                }
            }
        }
    }
}
