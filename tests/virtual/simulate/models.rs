//! Every model and return mode: the decoder reads what the simulator wrote.

use std::sync::Arc;

use scanner::TiltSource;
use sim::effects::{BeamEffect, Effect, MeteredEffect};
use sim::firing::{Echo, Echoes, SimulatedFiring, Surroundings};
use sim::scene_file::EffectLine;

use super::{Simulated, replayed};

/// Millimetres per unit of distance.
const MODELS: [(&str, &str, f64); 5] = [
    ("vlp16", "VLP-16", 2.0),
    ("hi-res", "Puck Hi-Res", 2.0),
    ("hdl32e", "HDL-32E", 2.0),
    ("vlp32c", "VLP-32C", 4.0),
    ("single-beam", "VLP-16", 2.0),
];

/// A pane half way to everything: a second return, weaker and nearer.
#[derive(Debug)]
struct Pane;

impl Effect for Pane {
    fn name(&self) -> &'static str {
        "pane"
    }
}

impl BeamEffect for Pane {
    fn receive(&self, firing: &SimulatedFiring, _: &Surroundings, echoes: &mut Echoes) -> u32 {
        let both = echoes.strongest.iter().zip(&mut echoes.other);
        for (strongest, other) in both.take(firing.lasers) {
            if strongest.is_present() {
                *other = Echo {
                    range_m: 0.5 * strongest.range_m,
                    true_range_m: 0.5 * strongest.range_m,
                    reflectivity: 7.0,
                    ..*strongest
                };
            }
        }
        1
    }
}

fn scene(model: &str, returns: &str) -> String {
    format!(
        "scene = \"hall\"\nlidar_clock_us = 3_599_990_000\n[sensor]\nmodel = \"{model}\"\nreturns = \"{returns}\"\nstart_deg = 77.7\n\
         [effects]\nall = false\n[motion]\nkind = \"fixed\"\nduration_s = 0.06\n"
    )
}

/// Half a unit of range, and half a hundredth of a degree of azimuth, or three quarters in the last
/// packet, whose rate is extrapolated.
fn bound_m(range_m: f64, unit_mm: f64) -> f64 {
    let across = range_m * 0.0076_f64.to_radians();
    (0.5e-3 * unit_mm).hypot(across) + 1e-6
}

/// A new model of the decoder needs a simulated sensor and a row above.
#[test]
fn every_model_of_the_decoder_is_simulated() {
    for model in protocol::vlp16::models::ALL {
        let is_named = MODELS.iter().any(|(_, name, _)| *name == model.name);
        assert!(is_named, "{}", model.name);
    }
}

#[test]
fn every_model_round_trips() {
    for (model, name, unit_mm) in MODELS {
        for returns in ["strongest", "last", "dual"] {
            let scene = Simulated::new(&scene(model, returns), |_| {});
            let (scan, cloud) = replayed(&scene.log(), TiltSource::None);
            let what = format!("{model} {returns}: {:?}", scan.contents);
            assert!(what.contains(name), "{what}");
            assert_eq!(scan.contents.lost_packets, 0, "{what}");
            // One return each: equal pairs count once.
            assert_eq!(cloud.len() as u64, scene.report.returns, "{what}");
            assert_eq!(scene.report.returned, scene.report.returns, "{what}");
            assert!(cloud.len() > 900, "{what}");
            for (error_m, range_m) in scene.errors(&cloud) {
                assert!(
                    error_m <= bound_m(range_m, unit_mm),
                    "{error_m} at {range_m}: {what}"
                );
            }
        }
    }
}

#[test]
fn both_returns_of_a_pulse_are_decoded() {
    for (model, name, unit_mm) in MODELS {
        let scene = Simulated::new(&scene(model, "dual"), |scene| {
            let listed = MeteredEffect::new(Arc::new(Pane) as Arc<_>, None);
            scene.effects.effects.firings.beam.push(listed);
            let (name, line) = ("pane", 1);
            scene.effects.lines.push(EffectLine {
                name,
                line: Some(line),
            });
        });
        let (_, cloud) = replayed(&scene.log(), TiltSource::None);
        assert_eq!(cloud.len() as u64, scene.report.returns, "{name}");
        assert_eq!(scene.report.returns, 2 * scene.report.returned, "{name}");
        assert!(scene.truth.values().all(|points| points.len() == 2));
        for (error_m, range_m) in scene.errors(&cloud) {
            assert!(
                error_m <= bound_m(range_m, unit_mm),
                "{error_m} at {range_m}: {name}"
            );
        }
        let panes = cloud
            .intensity()
            .iter()
            .filter(|&&intensity| intensity == 7);
        assert_eq!(2 * panes.count(), cloud.len(), "{name}");
    }
}
