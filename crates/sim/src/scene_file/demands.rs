//! Effects that the facts of a scene call for: its materials, motions, weather, sensor, drive and
//! links.
//!
//! A demand has the fact and an estimate of its size, from a thousand trial shots or a bound.
//! How much an effect matters is measured with it and without it (`velomotion simulate --explain`).

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use super::facts::StatedFact;
use super::trial_shots::{MaterialTrials, SHOTS, TrialShots};
use crate::cast::{Object, Surface};
use crate::effect_models::{EffectsConfig, Mover, Weather};
use crate::simulate::Simulation;

/// A fact of a scene that calls for an effect.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectDemand {
    /// Name of the effect.
    pub effect: &'static str,
    /// The fact.
    pub reason: String,
    /// The material or object that it is about, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// The line of the scene file that states it, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Estimate of the share of points that the effect adds, removes or displaces, percent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub percent: Option<f64>,
    /// About the greatest displacement, millimetres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displaced_mm: Option<f64>,
}

/// A moving object: its name and its line.
pub(super) type MoverName = (String, usize);

/// Results of the trial shots at a moving object and its copies.
#[derive(Default)]
struct MovingSurvey {
    count: u32,
    hits: u32,
    farthest_m: f64,
}

/// Facts from which demands follow.
pub(super) struct SceneFacts<'a> {
    /// Whether the sensor is free of its own errors by request.
    pub is_ideal: bool,
    pub simulation: &'a Simulation,
    /// Moving objects, and the names of those that are not boxes of the effect.
    pub movers: &'a [Mover],
    pub mover_names: &'a [MoverName],
    /// The line of the effect's own boxes.
    pub boxes_line: Option<usize>,
    /// Lines of materials.
    pub material_lines: &'a BTreeMap<String, usize>,
    /// The line of objects that are those of another scene.
    pub scene_line: Option<usize>,
    /// Sections that state facts.
    pub stated: &'a [StatedFact],
    /// Settings of all effects that are or may be called for.
    pub config: &'a EffectsConfig,
}

impl EffectDemand {
    fn new(effect: &'static str, reason: impl Into<String>) -> Self {
        Self {
            effect,
            reason: reason.into(),
            object: None,
            line: None,
            percent: None,
            displaced_mm: None,
        }
    }

    fn at(self, line: Option<usize>) -> Self {
        Self { line, ..self }
    }

    fn of(self, object: &str) -> Self {
        let object = (!object.is_empty()).then(|| object.to_owned());
        Self { object, ..self }
    }

    fn percent(self, percent: f64) -> Self {
        Self {
            percent: Some(percent),
            ..self
        }
    }

    fn displaced(self, displaced_m: f64) -> Self {
        Self {
            displaced_mm: Some(1e3 * displaced_m),
            ..self
        }
    }

    /// The estimate in words, if there is one.
    #[must_use]
    pub fn estimate(&self) -> Option<String> {
        let percent = self
            .percent
            .map(|percent| format!("{percent:.1} % of the points"));
        let mm = self.displaced_mm.map(|mm| match mm {
            mm if mm >= 10.0 => format!("{mm:.0} mm"),
            mm => format!("{mm:.2} mm"),
        });
        match (percent, mm) {
            (Some(percent), Some(mm)) => Some(format!("about {percent}, up to {mm}")),
            (Some(percent), None) => Some(format!("about {percent}")),
            (None, mm) => mm.map(|mm| format!("up to {mm}")),
        }
    }

    /// The fact with its line.
    #[must_use]
    pub fn reason_and_line(&self) -> String {
        match self.line {
            Some(line) => format!("{} (line {line})", self.reason),
            None => self.reason.clone(),
        }
    }
}

impl SceneFacts<'_> {
    /// The demands, in the order in which effects act, and the largest of an effect first.
    pub fn demands(&self) -> Vec<EffectDemand> {
        let detection = self.config.reflectance.settings().copied();
        let weather = self.config.weather.settings();
        let weather = weather.and_then(|weather| {
            let weather = weather.detected_by(detection);
            Weather::new(&weather, 0).ok()
        });
        let trial = match self.is_ideal && self.movers.is_empty() && weather.is_none() {
            true => TrialShots::default(),
            false => TrialShots::new(
                self.simulation,
                self.movers,
                &detection.unwrap_or_default(),
                weather.as_ref(),
            ),
        };
        let mut demands = self.moving(&trial);
        for fact in self.stated {
            demands.push(self.stated_demand(fact.effect, &trial).at(Some(fact.line)));
        }
        if !self.is_ideal {
            demands.extend(self.edges(&trial));
            demands.extend(self.materials(&trial));
            // Without packets times and angles are exact.
            let (has_packets, polls) = (self.has_packets(), self.simulation.polls);
            let of_packets = ["lidar_clock", "link_jitter"].into_iter();
            let of_drive = polls.map(|_| "encoder_quantisation");
            let usual = of_packets.chain(of_drive).filter(|_| has_packets);
            let usual = ["range_noise"].into_iter().chain(usual);
            for effect in usual.filter(|name| self.stated.iter().all(|fact| fact.effect != *name)) {
                demands.push(self.stated_demand(effect, &trial));
            }
        }
        let rank = |name: &str| EffectsConfig::NAMES.iter().position(|known| *known == name);
        demands.sort_by_key(|demand| rank(demand.effect));
        demands
    }

    const fn has_packets(&self) -> bool {
        self.simulation.sensor.packets.is_some()
    }

    /// A demand for each object that moves, its copies together, the farthest first.
    fn moving(&self, trial: &TrialShots) -> Vec<EffectDemand> {
        // Boxes of the effect itself come first and have no names.
        let unnamed = self.movers.len().saturating_sub(self.mover_names.len());
        let mut objects: BTreeMap<(&str, Option<usize>), MovingSurvey> = BTreeMap::new();
        for (number, mover) in self.movers.iter().enumerate() {
            let named = number.checked_sub(unnamed);
            let named = named.and_then(|number| self.mover_names.get(number));
            let key = named.map_or(("", self.boxes_line), |(name, line)| (name, Some(*line)));
            let object = objects.entry(key).or_default();
            object.count += 1;
            object.hits += trial.moving.get(number).copied().unwrap_or(0);
            object.farthest_m = object.farthest_m.max(self.path_m(mover));
        }
        let demand = |((name, line), object): ((&str, Option<usize>), MovingSurvey)| {
            let (what, verbs) = match object.count {
                1 => ("object".to_owned(), "moves or rotates"),
                count => (format!("{count} objects"), "move or rotate"),
            };
            let subject = match name {
                "" => what,
                name => format!("{what} {name:?}"),
            };
            EffectDemand::new("moving_objects", format!("{subject} {verbs}"))
                .of(name)
                .at(self.scene_line.or(line))
                .percent(trial.percent(object.hits))
                .displaced(object.farthest_m)
        };
        let mut demands: Vec<EffectDemand> = objects.into_iter().map(demand).collect();
        let path_mm = |demand: &EffectDemand| demand.displaced_mm.unwrap_or(0.0);
        demands.sort_by(|a, b| path_mm(b).total_cmp(&path_mm(a)));
        demands
    }

    /// Greatest displacement of a point of a moving object, metres.
    fn path_m(&self, mover: &Mover) -> f64 {
        let end_s = self.simulation.motion.end_s;
        let travel = &mover.travel;
        let objects = mover.scene.caster().objects().iter();
        let lines = objects.filter_map(Object::middle_line);
        let arms = lines.flat_map(|(ends, half_m)| ends.map(|end| end.length() + half_m));
        let arm_m = arms.fold(0.0, f64::max);
        // No point of a turning object is farther off than across its circle.
        let turned_m = travel.turn_deg_s.length().to_radians() * end_s * arm_m;
        travel.velocity_m_s.length() * end_s + turned_m.min(2.0 * arm_m)
    }

    /// Edges within footprints, with the material that most of them are of.
    fn edges(&self, trial: &TrialShots) -> Option<EffectDemand> {
        let about = "edges lie within footprints of beams";
        let most = trial.materials.values().max_by_key(|seen| seen.edges);
        let name = most.filter(|seen| seen.edges > 0);
        let name = name.map_or("", |seen| &seen.material.name);
        let reason = match name {
            "" => about.to_owned(),
            name => format!("{about}, most of material {name:?}"),
        };
        let demand = EffectDemand::new("divergence", reason)
            .of(name)
            .at(self.line_of_material(name));
        match trial.edges {
            0 if !self.may_have_edges() => None,
            0 => Some(demand.percent(trial.unseen_percent())),
            edges => Some(
                demand
                    .percent(trial.percent(edges))
                    .displaced(trial.mixed_m),
            ),
        }
    }

    /// Whether there may be edges: a single plane or sphere has none.
    fn may_have_edges(&self) -> bool {
        let mut fixed = self.simulation.scene.placed().objects.iter();
        match (fixed.next(), fixed.next(), self.movers.is_empty()) {
            (None, _, true) => false,
            (Some(only), None, true) => {
                !matches!(only.surface, Surface::Plane | Surface::Sphere(_))
            }
            _ => true,
        }
    }

    /// The line of a material, or of the built-in scene that has it.
    fn line_of_material(&self, name: &str) -> Option<usize> {
        match name {
            "" => None,
            name => (self.scene_line).or(self.material_lines.get(name).copied()),
        }
    }

    /// Materials whose light differs from that of a white wall, the most lost shots first.
    fn materials(&self, trial: &TrialShots) -> Vec<EffectDemand> {
        let mut seen: Vec<&MaterialTrials> = trial.materials.values().collect();
        seen.retain(|seen| !seen.material.absorbing);
        seen.sort_by_key(|seen| std::cmp::Reverse(seen.lost));
        let detection = self
            .config
            .reflectance
            .settings()
            .copied()
            .unwrap_or_default();
        let reason = |seen: &MaterialTrials| {
            let material = &seen.material;
            let (name, reflectivity) = (&material.name, material.reflectivity);
            let subject = match name.is_empty() {
                true => "objects without a material".to_owned(),
                false => format!("material {name:?}"),
            };
            if material.specular > 0.0 {
                let percent = 100.0 * material.specular;
                return Some(format!("{subject} mirrors {percent:.0} % of the light"));
            }
            if reflectivity > 100 {
                return Some(format!("{subject} is retroreflecting ({reflectivity})"));
            }
            let share = f64::from(reflectivity) / detection.half_reflectivity;
            let half_m = detection.half_range_m * share.sqrt();
            (seen.lost > 0).then(|| {
                format!(
                    "{subject} returns {reflectivity} % of the light, enough half the time at {half_m:.0} m head-on"
                )
            })
        };
        let demand = |seen: &&MaterialTrials| {
            let name = &seen.material.name;
            let line = self.scene_line.or(self.material_lines.get(name).copied());
            let demand = EffectDemand::new("reflectance", reason(seen)?)
                .of(name)
                .at(line);
            Some(match seen.returned {
                0 => demand.percent(trial.unseen_percent()),
                _ => demand.percent(trial.percent(seen.lost)),
            })
        };
        let mut demands: Vec<EffectDemand> = seen.iter().filter_map(demand).collect();
        if demands.is_empty() && !seen.is_empty() {
            let reason = "reported reflectivity falls with the incidence";
            demands.push(EffectDemand::new("reflectance", reason).percent(0.0));
        }
        demands
    }

    /// The demand for an effect by its settings.
    fn stated_demand(&self, effect: &'static str, trial: &TrialShots) -> EffectDemand {
        let config = self.config;
        let motion = &self.simulation.motion;
        let arm_m = trial.farthest_m + self.simulation.mount.position_m.length();
        let speeds = motion.moves.iter().map(|next| next.cruise_deg_s.abs());
        let speed_deg_s = speeds.fold(0.0, f64::max);
        let by_angle = |deg: f64| deg.to_radians() * arm_m;
        let by_delay = |us: f64| by_angle(1e-6 * us * speed_deg_s);
        let demand = |reason: String| EffectDemand::new(effect, reason);
        let stated = match effect {
            "own_shadow" => config.own_shadow.settings().map(|shadow| {
                let hidden_deg: f64 = (shadow.sectors.iter())
                    .map(|sector| sector.width_deg())
                    .sum();
                let frame = (!shadow.sectors.is_empty())
                    .then(|| format!("the frame hides {hidden_deg} deg of azimuth"));
                let tripod = (shadow.below_deg)
                    .map(|deg| format!("the tripod hides what is below {deg} deg"));
                let reason: Vec<String> = frame.into_iter().chain(tripod).collect();
                demand(reason.join(", ")).percent(hidden_deg / 3.6)
            }),
            "base_drift" => config.base_drift.settings().map(|drift| {
                let length = |three: [f64; 3]| three.iter().map(|x| x * x).sum::<f64>().sqrt();
                let rate = length(drift.velocity_m_s) + by_angle(length(drift.turn_deg_s));
                demand("the base moves or turns".to_owned()).displaced(rate * motion.end_s)
            }),
            "weather" => config.weather.settings().map(|weather| {
                let fog = weather.visibility_m.map(|m| format!("visibility of {m} m"));
                let rain = weather.rain_mm_h.map(|mm_h| format!("rain of {mm_h} mm/h"));
                let reason: Vec<String> = fog.into_iter().chain(rain).collect();
                let (changed, air) = (trial.dimmed + trial.in_air, trial.in_air);
                let points = f64::from((trial.returned + air).max(1));
                demand(reason.join(", ")).percent(100.0 * f64::from(changed) / points)
            }),
            "range_noise" => config.range_noise.settings().map(|noise| {
                let mm = (1e4 * noise.sd_m).round() / 10.0;
                // One in a hundred is farther than 2.576 standard deviations.
                demand(format!("ranges have a standard deviation of {mm} mm"))
                    .displaced(2.576 * noise.sd_m)
            }),
            "lidar_clock" => config.lidar_clock.settings().map(|clock| {
                let us = clock.drift_ppm.abs() * motion.end_s + clock.wander_us;
                demand(format!(
                    "the lidar's clock runs free, {} ppm fast",
                    clock.drift_ppm
                ))
                .displaced(by_delay(us))
            }),
            "servo_lag" => config.servo_lag.settings().map(|servo| {
                let corner = std::f64::consts::TAU * servo.frequency_hz;
                let lag_s = servo.damping.map_or(1.0, |damping| 2.0 * damping) / corner;
                demand(format!("the servo follows at {} Hz", servo.frequency_hz))
                    .displaced(by_delay(1e6 * lag_s))
            }),
            "tilt_limits" => config.tilt_limits.settings().map(|limits| {
                let (from, to) = (limits.from_deg, limits.to_deg);
                let moves = motion.moves.iter();
                let ends = moves.flat_map(|next| [next.from_deg, next.to_deg]);
                let ends = ends.chain([motion.at(0.0).angle_deg]);
                let over = ends
                    .map(|deg| (from - deg).max(deg - to))
                    .fold(0.0, f64::max);
                demand(format!("stops at {from} and {to} deg")).displaced(by_angle(over))
            }),
            "gear_ripple" => config.gear_ripple.settings().map(|ripple| {
                demand(format!("the gear deviates by {} deg", ripple.amplitude_deg))
                    .displaced(by_angle(ripple.amplitude_deg.abs()))
            }),
            "eccentricity" => config.eccentricity.settings().map(|wheel| {
                demand(format!(
                    "the output wheel is off centre by {} deg",
                    wheel.amplitude_deg
                ))
                .displaced(by_angle(wheel.amplitude_deg.abs()))
            }),
            "backlash" => config.backlash.settings().map(|backlash| {
                demand(format!("the gear has a play of {} deg", backlash.play_deg))
                    .displaced(by_angle(backlash.play_deg))
            }),
            "encoder_quantisation" => config.encoder_quantisation.settings().map(|encoder| {
                let [motor, axis] = encoder.gear.map(f64::from);
                let count_deg = 90.0 / f64::from(encoder.encoder_lines) * axis / motor;
                let (lines, [motor, axis]) = (encoder.encoder_lines, encoder.gear);
                demand(format!(
                    "whole counts of {lines} lines behind a gear of {motor}:{axis}"
                ))
                .displaced(by_angle(count_deg))
            }),
            "duplicate" => config.duplicate.settings().map(|copies| {
                let percent = 100.0 * copies.share;
                demand(format!("{percent} % of the packets arrive twice")).percent(percent)
            }),
            "loss" => config.loss.settings().map(|loss| {
                let [lidar, drive] =
                    [loss.lidar_share, loss.drive_share].map(|share| 100.0 * share);
                demand(format!(
                    "{lidar} % of the packets and {drive} % of the answers are lost"
                ))
                .percent(lidar)
            }),
            "link_jitter" => config.link_jitter.settings().map(|link| {
                let us = link.lidar_jitter_us + link.drive_jitter_us;
                demand(format!("delays of messages vary by {us} us")).displaced(by_delay(us))
            }),
            "reorder" => config.reorder.settings().map(|late| {
                let percent = 100.0 * late.share;
                demand(format!("{percent} % of the packets are overtaken")).percent(0.0)
            }),
            "batching" => config.batching.settings().map(|host| {
                demand(format!(
                    "the host reads packets every {} ms",
                    host.period_ms
                ))
                .displaced(by_delay(1e3 * host.period_ms))
            }),
            _ => None,
        };
        stated.unwrap_or_else(|| demand("the scene states it".to_owned()))
    }
}

impl TrialShots {
    fn percent(&self, part: u32) -> f64 {
        100.0 * f64::from(part) / f64::from(self.returned.max(1))
    }

    /// The most that what n shots did not see may be, percent: 3 / n (95 %).
    fn unseen_percent(&self) -> f64 {
        let shots = if self.returned == 0 {
            SHOTS
        } else {
            self.returned.max(3)
        };
        300.0 / f64::from(shots)
    }
}
