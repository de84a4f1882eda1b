//! Choice of as few effects as a tolerance allows.

use std::time::Instant;

use serde::Serialize;
use sim::effect_models::EffectTolerance;
use utoipa::ToSchema;

use super::Sampler;
use crate::failure::{Failure, Kind};

/// Instructions of an effect relative to the simulation without effects, percent
/// (benches/effect_costs.rs). Measured times would make the choice, and the log, depend on the
/// machine.
const COST_PERCENT: [(&str, f64); 6] = [
    ("divergence", 483.0),
    ("weather", 126.0),
    ("moving_objects", 40.0),
    ("range_noise", 33.0),
    ("reflectance", 33.0),
    ("lidar_clock", 5.0),
];
/// All others.
const SMALL_COST_PERCENT: f64 = 1.0;

/// Effects chosen by a tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectChoice {
    /// The tolerance.
    pub tolerance: EffectTolerance,
    /// Whether the scene file states it.
    pub is_of_scene: bool,
    /// Effects that are on.
    pub on: Vec<&'static str>,
    /// Effects that are off, though the file or a fact of the scene calls for them.
    pub off: Vec<LeftOut>,
    /// Points of the sample that are missing, added or displaced by more than the tolerance,
    /// compared with all effects, percent.
    pub left_percent: f64,
    /// Seconds of the scene that were sampled, if it is longer: what happens later may differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled_s: Option<f64>,
    /// Computing time of the sample over that with all effects.
    pub time_ratio: f64,
    /// Computing time of the choice, seconds.
    pub took_s: f64,
}

/// An effect that a tolerance leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct LeftOut {
    /// Its name.
    pub effect: &'static str,
    /// Points that it alone adds, removes or displaces by more than the tolerance, percent.
    pub percent: f64,
}

impl Sampler<'_> {
    /// Chooses as few of these effects as keep the cloud within the tolerance of that with all of
    /// them, without those that are forced. Effects are left out in the order of their size over
    /// their cost, as long as the cloud stays close.
    ///
    /// # Errors
    /// [`Failure`] for a scene that gives no cloud, and for a share that the sample cannot show.
    pub fn choose(
        &self,
        tolerance: EffectTolerance,
        all: &[&'static str],
        is_of_scene: bool,
    ) -> Result<EffectChoice, Failure> {
        let began = Instant::now();
        let reference = self.cloud(all)?;
        // No event in n trials is below a share of 3 / n with a confidence of 95 %.
        let points = reference.points.len();
        let least_percent = 300.0 / points.max(1) as f64;
        if tolerance.percent < least_percent {
            if points == 0 {
                let message = "tolerance: the sample has no points to compare";
                return Err(Failure::new(Kind::BadInput, message)
                    .help("see what the lidar can reach: objects, range, and the axis's angle"));
            }
            let stated_percent = (100.0 * least_percent).ceil() / 100.0;
            let message = format!(
                "tolerance: expected a share from {stated_percent} % up to below 100 %, which {points} sampled points can show, got {} %",
                tolerance.percent
            );
            return Err(Failure::new(Kind::Usage, message).help(format!(
                "state {}mm,{stated_percent}% or more; any length above 0 mm can be met",
                tolerance.displaced_mm,
            )));
        }
        let compared = |names: &[&'static str]| {
            let cloud = self.cloud(names)?;
            let percent = reference
                .difference(&cloud)
                .beyond_percent(tolerance.displaced_mm);
            Ok((percent, cloud.took_s))
        };
        let except = |names: &[&'static str], out: &str| -> Vec<&'static str> {
            names.iter().copied().filter(|name| *name != out).collect()
        };
        let mut small = Vec::new();
        for effect in all
            .iter()
            .copied()
            .filter(|name| !self.scene.is_forced(name))
        {
            let (percent, _) = compared(&except(all, effect))?;
            if percent <= tolerance.percent {
                small.push(LeftOut { effect, percent });
            }
        }
        small.sort_by(|a, b| a.per_cost().total_cmp(&b.per_cost()));
        let mut choice = EffectChoice {
            tolerance,
            is_of_scene,
            on: all.to_vec(),
            off: Vec::new(),
            left_percent: 0.0,
            sampled_s: self.beginning_s(),
            time_ratio: 1.0,
            took_s: 0.0,
        };
        let mut chosen_s = None;
        for out in small {
            let fewer = except(&choice.on, out.effect);
            let (percent, took_s) = compared(&fewer)?;
            if percent <= tolerance.percent {
                choice.on = fewer;
                choice.off.push(out);
                choice.left_percent = percent;
                chosen_s = Some(took_s);
            }
        }
        if let Some(chosen_s) = chosen_s {
            // Not the first run, which examines where the scene is plain.
            choice.time_ratio = chosen_s / self.cloud(all)?.took_s;
        }
        choice.took_s = began.elapsed().as_secs_f64();
        Ok(choice)
    }
}

impl LeftOut {
    fn per_cost(&self) -> f64 {
        let cost = COST_PERCENT.iter().find(|(name, _)| *name == self.effect);
        self.percent / cost.map_or(SMALL_COST_PERCENT, |(_, percent)| *percent)
    }
}

impl EffectChoice {
    /// One paragraph of the report. `run_s` is the computing time of the simulation.
    #[must_use]
    pub fn text(&self, run_s: f64) -> String {
        let off: Vec<String> = (self.off.iter())
            .map(|out| format!("{} ({:.3} %)", out.effect, out.percent))
            .collect();
        let off = match off.is_empty() {
            true => "nothing is left out".to_owned(),
            false => format!("left out, with their sizes: {}", off.join(", ")),
        };
        let whose = if self.is_of_scene {
            " of the scene file"
        } else {
            ""
        };
        let saved_s = run_s / self.time_ratio - run_s;
        let worth = match self.took_s > saved_s.max(0.0) {
            true => "; it takes longer than it saves in this run",
            false => "",
        };
        let beginning = self.sampled_s.map_or(String::new(), |seconds| {
            format!(" of the first {seconds} s")
        });
        format!(
            "{} mm, {} %{whose}: {off}; together {:.3} % of the sampled points{beginning} are missing, added or displaced by more than {} mm, compared with all effects that are not switched off; \
             {:.0} % of their time; choosing took {:.1} s{worth}",
            self.tolerance.displaced_mm,
            self.tolerance.percent,
            self.left_percent,
            self.tolerance.displaced_mm,
            100.0 * self.time_ratio,
            self.took_s,
        )
    }
}
