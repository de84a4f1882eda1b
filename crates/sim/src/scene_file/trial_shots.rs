//! Trial shots of a sensor at a scene, cast at the surfaces of their instant.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::cast::Placement;
use crate::effect_models::{Mover, ReflectanceSettings, Weather};
use crate::scene::Scene;
use crate::scenery::{Material, MaterialAssignment};
use crate::simulate::Simulation;

/// Number of trial shots. A share below 3 / 1000 may be missed (95 %).
pub(super) const SHOTS: u32 = 1_000;
/// Azimuth from shot to shot, degrees: the golden angle, which is evenly spread for any number.
const GOLDEN_DEG: f64 = 137.507_764;
/// Half the divergence of a VLP-16's beam, along and across the scan (63-9243, appendix F).
const HALF_BEAM: [f64; 2] = [1.5e-3, 0.75e-3];
/// Parts of a footprint about its middle, in pairs opposite to each other: the columns and rows of
/// the effect `divergence`.
const FOOTPRINT: [[f64; 2]; 14] = [
    [1.0, 1.0],
    [-1.0, -1.0],
    [1.0, -1.0],
    [-1.0, 1.0],
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.5, 1.0],
    [-0.5, -1.0],
    [0.5, -1.0],
    [-0.5, 1.0],
    [0.5, 0.0],
    [-0.5, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
];
/// Smallest deviation from a plane that counts as an edge, metres: the noise of a range exceeds it.
const EDGE_M: f64 = 0.005;
/// Surfaces closer than this make one return, metres (63-9243, section 6.2).
const SEPARATION_M: f64 = 1.0;

/// Shots at a scene, and what they meet.
#[derive(Debug, Default)]
pub(super) struct TrialShots {
    /// Shots that meet a returning surface within the sensor's range.
    pub returned: u32,
    /// Shots among `returned` at moving objects, by the object's number.
    pub moving: Vec<u32>,
    /// Shots among `returned` whose footprint crosses an edge.
    pub edges: u32,
    /// The greatest difference of depth within a footprint whose surfaces make one return, metres.
    pub mixed_m: f64,
    /// Shots among `returned` that the weather makes too faint.
    pub dimmed: u32,
    /// Shots at the sky that the air returns.
    pub in_air: u32,
    /// The farthest surface, metres.
    pub farthest_m: f64,
    /// The materials that objects have, and shots at them.
    pub materials: BTreeMap<String, MaterialTrials>,
}

/// A material, and shots at it.
#[derive(Debug)]
pub(super) struct MaterialTrials {
    pub material: Material,
    pub returned: u32,
    /// Shots among `returned` whose light is below the threshold of detection.
    pub lost: u32,
    /// Shots among `returned` whose footprint crosses an edge.
    pub edges: u32,
}

/// A surface that a shot meets.
struct SurveyedSurface<'a> {
    range_m: f64,
    material: &'a Material,
    cosine: f64,
    /// The moving object's number.
    mover: Option<usize>,
}

impl TrialShots {
    /// Shots spread evenly over lasers, azimuths and the time of the simulation.
    pub fn new(
        simulation: &Simulation,
        movers: &[Mover],
        detection: &ReflectanceSettings,
        weather: Option<&Weather>,
    ) -> Self {
        let mut trial = Self {
            moving: vec![0; movers.len()],
            ..Self::default()
        };
        for scene in movers
            .iter()
            .map(|mover| &mover.scene)
            .chain([&simulation.scene])
        {
            trial.list(scene);
        }
        let sensor = &simulation.sensor;
        let lasers: Vec<usize> = (0..sensor.beams.len())
            .filter(|laser| sensor.used >> laser & 1 == 1)
            .collect();
        for shot in 0..SHOTS {
            let share = (f64::from(shot) + 0.5) / f64::from(SHOTS);
            let time_s = share * simulation.motion.end_s;
            let Some(laser) = lasers.get(shot as usize % lasers.len().max(1)) else {
                return trial;
            };
            let tilt_deg = simulation.motion.at(time_s).angle_deg;
            let azimuth_deg = (f64::from(shot) * GOLDEN_DEG).rem_euclid(360.0);
            if !sensor.sees(azimuth_deg) {
                continue;
            }
            let ray = sensor.ray(*laser, azimuth_deg, tilt_deg, &simulation.mount);
            let Some((origin_m, direction)) = ray else {
                continue;
            };
            let surfaces = Surfaces {
                simulation,
                // Of thousands of moving objects trial shots would take longer than the simulation.
                movers: (movers.iter().enumerate().take(100))
                    .filter_map(|(n, mover)| Some((n, mover, mover.travel.at(time_s).ok()?)))
                    .collect(),
            };
            trial.shoot(&surfaces, shot, [origin_m, direction], detection, weather);
        }
        trial
    }

    /// Lists the materials of a scene's objects.
    fn list(&mut self, scene: &Scene) {
        let placed = scene.placed();
        let numbers = placed.assignments.iter().flat_map(|assignment| {
            let numbers: &[u32] = match assignment {
                MaterialAssignment::One(number) => core::slice::from_ref(number),
                MaterialAssignment::Faces(numbers) => numbers,
            };
            numbers.iter()
        });
        for material in numbers.filter_map(|number| placed.materials.get(*number as usize)) {
            if !self.materials.contains_key(&material.name) {
                let seen = MaterialTrials {
                    material: material.clone(),
                    returned: 0,
                    lost: 0,
                    edges: 0,
                };
                self.materials.insert(material.name.clone(), seen);
            }
        }
    }

    fn shoot(
        &mut self,
        surfaces: &Surfaces<'_>,
        shot: u32,
        [origin_m, direction]: [DVec3; 2],
        detection: &ReflectanceSettings,
        weather: Option<&Weather>,
    ) {
        let Some(met) = surfaces.first(origin_m, direction) else {
            // A pole before the sky that the middle of the beam misses.
            self.edges += u32::from(surfaces.edge(origin_m, direction, f64::INFINITY).is_some());
            let reach = surfaces.simulation.sensor.range();
            let light = weather.map_or(0.0, |weather| {
                weather.in_air([reach.min_m.max(0.1), reach.max_m], shot.into())
            });
            self.in_air += u32::from(detection.over_threshold(light) >= 1.0);
            return;
        };
        self.returned += 1;
        if let Some(hits) = met.mover.and_then(|mover| self.moving.get_mut(mover)) {
            *hits += 1;
        }
        self.farthest_m = self.farthest_m.max(met.range_m);
        let material = met.material;
        let light = detection.detection(
            material.reflectivity,
            material.specular,
            met.cosine,
            met.range_m,
        );
        if let Some(seen) = self.materials.get_mut(&material.name) {
            seen.returned += 1;
            seen.lost += u32::from(light < 1.0);
        }
        let left = weather.map_or(1.0, |weather| weather.left(met.range_m));
        self.dimmed += u32::from(light >= 1.0 && light * left < 1.0);
        if let Some(depth_m) = surfaces.edge(origin_m, direction, met.range_m) {
            self.edges += 1;
            if let Some(seen) = self.materials.get_mut(&material.name) {
                seen.edges += 1;
            }
            if depth_m <= SEPARATION_M {
                self.mixed_m = self.mixed_m.max(depth_m);
            }
        }
    }
}

/// The surfaces of an instant.
struct Surfaces<'a> {
    simulation: &'a Simulation,
    movers: Vec<(usize, &'a Mover, Placement)>,
}

impl<'a> Surfaces<'a> {
    /// The first surface along a ray, if it returns.
    fn first(&self, origin_m: DVec3, direction: DVec3) -> Option<SurveyedSurface<'a>> {
        let reach = self.simulation.sensor.range();
        let of_scene = |scene: &'a Scene, origin_m, direction, mover| {
            let hit = scene.nearest(origin_m, direction, reach.max_m)?;
            let normal = (scene.caster()).normal(&hit, origin_m + hit.range_m * direction);
            Some(SurveyedSurface {
                range_m: hit.range_m,
                material: scene.material(&hit)?,
                cosine: normal.dot(direction).abs(),
                mover,
            })
        };
        let fixed = of_scene(&self.simulation.scene, origin_m, direction, None);
        let moving = self.movers.iter().filter_map(|(number, mover, placement)| {
            let origin_m = placement.own_point(origin_m);
            of_scene(
                &mover.scene,
                origin_m,
                placement.own_direction(direction),
                Some(*number),
            )
        });
        let first = moving.chain(fixed);
        let first = first.min_by(|a, b| a.range_m.total_cmp(&b.range_m))?;
        (first.range_m >= reach.min_m && !first.material.absorbing).then_some(first)
    }

    /// The difference of depth of an edge within the footprint about a ray, metres; infinite at an
    /// edge against the sky.
    fn edge(&self, origin_m: DVec3, direction: DVec3, range_m: f64) -> Option<f64> {
        let across = direction
            .cross(DVec3::Z)
            .try_normalize()
            .unwrap_or(DVec3::X);
        let up = across.cross(direction);
        let ranges_m = FOOTPRINT.map(|[x, y]| {
            let [x, y] = [x * HALF_BEAM[0], y * HALF_BEAM[1]];
            let part = (direction + x * across + y * up).normalize();
            self.first(origin_m, part)
                .map_or(f64::INFINITY, |met| met.range_m)
        });
        if range_m.is_infinite() {
            let returns = ranges_m.iter().any(|part_m| part_m.is_finite());
            return returns.then_some(f64::INFINITY);
        }
        // Over a plane, one over the range is linear in the direction.
        let is_edge = ranges_m.as_chunks::<2>().0.iter().any(|[a, b]| {
            let bent = 0.5 * (1.0 / a + 1.0 / b) - 1.0 / range_m;
            bent.abs() * range_m * range_m > EDGE_M
        });
        let depths_m = ranges_m.iter().map(|part_m| (part_m - range_m).abs());
        is_edge.then(|| depths_m.fold(0.0, f64::max))
    }
}
