//! Firings of a VLP-16 in scenes of the simulator: origins and directions of rays, and the
//! surroundings.
//!
//! An effect without influence collects them from the simulation.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

use analysis::tradeoff::StudyError;
use protocol::vlp16::models::VLP_16;
use sim::effects::{BeamEffect, Effect, Effects, FiringEffectSet};
use sim::firing::{Echoes, SimulatedFiring, Surroundings};
use sim::scene_file::SceneFile;
use sim::scenery::shipped;
use sim::sensor::ReturnMode;
use sim::simulate::{SimulationEvent, SimulationSink};

/// Consecutive firings per group; they are cast together.
const TOGETHER: u64 = 8;

/// The view of a sensor in a scene.
pub(crate) struct SampledFirings {
    /// Seed of the scene.
    pub seed: u64,
    /// The surroundings.
    pub surroundings: Surroundings,
    /// Firings, and the echoes of the centres of their beams.
    pub firings: Vec<(SimulatedFiring, Echoes)>,
}

impl SampledFirings {
    /// About `firings` of the sweep in a scene of the simulator, in groups that are spread evenly
    /// over it.
    pub fn of(name: &str, firings: usize) -> Result<Self, StudyError> {
        let text = shipped(name)
            .ok_or_else(|| StudyError::workload(format!("there is no scene {name}")))?;
        let scene = SceneFile::parse(text, None, None).map_err(StudyError::workload)?;
        let mut simulation = scene.simulation;
        simulation.returns = ReturnMode::Dual;
        let all = simulation.motion.end_s * 1e9 / f64::from(VLP_16.firing_period_ns);
        let taken = Arc::new(Mutex::new(CollectedFirings::default()));
        let take = FiringCollector {
            every: ((all / firings.max(1) as f64) as u64).max(1),
            taken: Arc::clone(&taken),
        };
        let firings = FiringEffectSet {
            objects: (),
            view: (),
            beam: take,
            surface: (),
            clock: (),
        };
        let mut effects = Effects {
            firings,
            mechanism: (),
            encoder: (),
            link: (),
        };
        simulation
            .run(&mut effects, NonZeroUsize::MIN, &mut NoSink)
            .map_err(StudyError::workload)?;
        let mut taken = taken.lock().unwrap_or_else(PoisonError::into_inner);
        let surroundings = taken.surroundings.take();
        Ok(Self {
            seed: scene.seed,
            surroundings: surroundings
                .ok_or_else(|| StudyError::workload("a scene without firings"))?,
            firings: std::mem::take(&mut taken.firings),
        })
    }

    /// Number of lasers that fire in them.
    pub fn count(&self) -> usize {
        let alive = self
            .firings
            .iter()
            .map(|(firing, _)| firing.alive().count());
        alive.sum()
    }
}

/// The firings collected so far.
#[derive(Debug, Default)]
struct CollectedFirings {
    surroundings: Option<Surroundings>,
    firings: Vec<(SimulatedFiring, Echoes)>,
}

/// An effect that collects one group of firings out of `every`.
#[derive(Clone, Debug)]
struct FiringCollector {
    every: u64,
    taken: Arc<Mutex<CollectedFirings>>,
}

impl Effect for FiringCollector {
    fn name(&self) -> &'static str {
        "take"
    }
}

impl BeamEffect for FiringCollector {
    fn receive(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        if (firing.number / TOGETHER).is_multiple_of(self.every) {
            let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
            let taken = &mut *taken;
            taken
                .surroundings
                .get_or_insert_with(|| surroundings.clone());
            taken.firings.push((firing.clone(), echoes.clone()));
        }
        0
    }
}

/// An output that ignores packets.
struct NoSink;

impl SimulationSink for NoSink {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shots_are_spread_over_the_sweep_and_hit_their_targets() {
        let shots = SampledFirings::of("hall", 100).unwrap();
        let numbers: Vec<u64> = shots.firings.iter().map(|(f, _)| f.number).collect();
        assert!((90..130).contains(&numbers.len()), "{}", numbers.len());
        assert_eq!(numbers[..9], [0, 1, 2, 3, 4, 5, 6, 7, numbers[8]]);
        assert!(numbers[8] > 1_000 && numbers[numbers.len() - 1] > 12_000);
        assert_eq!(shots.count(), 16 * numbers.len());
        for (firing, echoes) in &shots.firings {
            for laser in firing.alive() {
                let (from, way) = (firing.origins_m[laser], firing.directions[laser]);
                let met = shots.surroundings.meet(from, way).unwrap();
                let off_m = met.range_m - echoes.strongest[laser].range_m;
                assert!(off_m.abs() < 1e-9, "{off_m}");
                assert!(!echoes.other[laser].is_present());
            }
        }
        assert!(SampledFirings::of("nowhere", 1).is_err());
    }
}
