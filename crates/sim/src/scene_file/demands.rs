//! Effects that the facts of a scene call for: its materials, motions, sensor and drive.
//!
//! A demand says that an effect may matter, and why. How much it matters is measured with the
//! effect and without it (`velomotion simulate --explain`).

use serde::Serialize;
use utoipa::ToSchema;

use crate::effect_models::{Divergence, EffectsConfig, MovingObjects};
use crate::scenery::Material;

/// A fact of a scene that calls for an effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectDemand {
    /// Name of the effect.
    pub effect: &'static str,
    /// The fact.
    pub reason: String,
    /// The line of the scene file that states it, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
}

/// What demands follow from.
pub(super) struct SceneFacts<'a> {
    /// Whether the sensor is free of its own errors by request.
    pub is_ideal: bool,
    /// The materials that objects have, each with its line in the file.
    pub materials: Vec<(&'a Material, Option<usize>)>,
    pub objects: usize,
    /// Number of moving objects, and the line of the first.
    pub movers: (usize, Option<usize>),
    /// Whether a drive moves the axis and is polled.
    pub has_drive: bool,
}

/// Standard deviation of ranges, metres: a third of the VLP-16's accuracy ("up to 3 cm, typical",
/// data sheet 63-9229).
const RANGE_SD_M: f64 = 0.01;

impl SceneFacts<'_> {
    /// The demands, in the order in which effects act.
    pub fn demands(&self) -> Vec<EffectDemand> {
        let mut demands = Vec::new();
        let mut demand = |effect, reason: String, line| {
            demands.push(EffectDemand {
                effect,
                reason,
                line,
            });
        };
        let (movers, line) = self.movers;
        if movers > 0 {
            let reason = format!("{movers} object(s) move or rotate");
            demand(MovingObjects::NAME, reason, line);
        }
        if self.is_ideal {
            return demands;
        }
        let objects = self.objects;
        if objects > 0 {
            let reason = format!("footprints of beams cross the edges of {objects} object(s)");
            demand(Divergence::NAME, reason, None);
        }
        if let Some((reason, line)) = self.faint() {
            demand("reflectance", reason, line);
        }
        let reason = "the data sheet's accuracy of 3 cm, as three standard deviations";
        demand("range_noise", reason.to_owned(), None);
        if self.has_drive {
            let reason = "the drive reports whole counts of 500 lines behind a gear of 120:1";
            demand("encoder_quantisation", reason.to_owned(), None);
        }
        let links = match self.has_drive {
            true => "packets and answers are delayed on their way",
            false => "packets are delayed on their way",
        };
        demand("link_jitter", links.to_owned(), None);
        demands
    }

    /// The material whose returns are lost first, and why.
    fn faint(&self) -> Option<(String, Option<usize>)> {
        let returning = || (self.materials.iter()).filter(|(material, _)| !material.absorbing);
        let mirrors = returning().filter(|(material, _)| material.specular > 0.0);
        if let Some((material, line)) =
            mirrors.max_by(|(a, _), (b, _)| a.specular.total_cmp(&b.specular))
        {
            let percent = 100.0 * material.specular;
            let name = &material.name;
            return Some((
                format!("material {name:?} mirrors {percent:.0} % of the light"),
                *line,
            ));
        }
        let (darkest, line) = returning().min_by_key(|(material, _)| material.reflectivity)?;
        let (name, percent) = (&darkest.name, darkest.reflectivity);
        let reason = match name.is_empty() {
            true => format!("surfaces return {percent} % of the light"),
            false => format!("material {name:?} returns {percent} % of the light"),
        };
        Some((reason, *line))
    }
}

impl EffectsConfig {
    /// Configures the effect of a demand with usual values, if it is not configured.
    pub(super) fn add_usual(&mut self, effect: &str) {
        match effect {
            "divergence" => _ = self.divergence.get_or_insert_default(),
            "reflectance" => _ = self.reflectance.get_or_insert_default(),
            "encoder_quantisation" => _ = self.encoder_quantisation.get_or_insert_default(),
            "link_jitter" => _ = self.link_jitter.get_or_insert_default(),
            "moving_objects" => _ = self.moving_objects.get_or_insert_default(),
            "range_noise" => {
                self.range_noise.get_or_insert(
                    crate::effect_models::range_noise::RangeNoiseSettings { sd_m: RANGE_SD_M },
                );
            }
            _ => {}
        }
    }
}
