//! Angles from directions to the nearest ray of planned sweeps, without making all rays.
//!
//! A laser passes a direction when the tilt has brought it to the direction's elevation. Only the
//! revolutions before and after that instant, the ends of the sweep, and the tilt where the
//! elevation turns are compared: between them the elevation is monotonic. Of such a revolution the
//! firing nearest in azimuth counts, of the two lasers nearest in elevation. A ray of another
//! revolution may be nearer by a part of a step of azimuth.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{PlanLidar, TiltSweep};

/// A sweep and the azimuth of the lidar at its start, revolutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartedSweep {
    /// The sweep.
    pub sweep: TiltSweep,
    /// The azimuth, 0..1.
    pub start: f64,
}

/// A laser seen from the tilt axis.
#[derive(Clone, Copy, Debug)]
struct AxisRay {
    /// Elevation of its points at the given distance, seen from the origin of the base, with sine
    /// and cosine.
    elevation_rad: f64,
    sin: f64,
    cos: f64,
    /// Revolutions added to the azimuth.
    offset: f64,
    delay_s: f64,
}

/// Rays of a lidar that end at one distance from the origin of the base.
#[derive(Clone, Debug)]
pub struct PlannedRays {
    /// By elevation.
    lasers: Vec<AxisRay>,
    period_s: f64,
    revolutions_per_s: f64,
    /// Azimuths that the lidar sees; `None` for all around.
    aperture: Option<Aperture>,
}

/// Part of a revolution that a planar scanner sees, revolutions.
#[derive(Clone, Copy, Debug)]
struct Aperture {
    middle: f64,
    half: f64,
}

impl Aperture {
    /// Distance of an azimuth from the middle, within half a revolution.
    fn off(&self, azimuth: f64) -> f64 {
        let off = azimuth - self.middle;
        off - off.round()
    }

    /// What leads to the nearest azimuth inside; 0 inside.
    fn inwards(&self, azimuth: f64) -> f64 {
        let off = self.off(azimuth);
        off.clamp(-self.half, self.half) - off
    }
}

impl PlannedRays {
    /// The rays of a lidar at a rotation rate, at a distance from the origin of the base.
    #[must_use]
    pub fn new(lidar: &PlanLidar, rpm: f64, range_m: f64) -> Self {
        let ray = |laser: &super::PlanLaser| {
            let (w, d) = (laser.elevation_deg.to_radians(), lidar.d_m + laser.height_m);
            // Eq. 9 solved for the range along the ray.
            let e = (d / range_m).clamp(-1.0, 1.0);
            let along = (1.0 - (e * w.cos()).powi(2)).max(0.0).sqrt() - e * w.sin();
            let sin = (e + along * w.sin()).clamp(-1.0, 1.0);
            AxisRay {
                elevation_rad: sin.asin(),
                sin,
                cos: (1.0 - sin * sin).sqrt(),
                offset: laser.azimuth_deg / 360.0,
                delay_s: laser.delay_s,
            }
        };
        let mut lasers: Vec<AxisRay> = lidar.lasers.iter().map(ray).collect();
        lasers.sort_by(|a, b| a.elevation_rad.total_cmp(&b.elevation_rad));
        Self {
            lasers,
            period_s: lidar.firing_period_s,
            revolutions_per_s: rpm / 60.0,
            aperture: lidar.azimuths_deg.map(|[first, last]| Aperture {
                middle: 0.5 * (first + last) / 360.0,
                half: 0.5 * (last - first) / 360.0,
            }),
        }
    }

    /// Whether a direction is between the lowest and the highest laser at some tilt between two; of
    /// a lidar that does not see all around, whether a laser passes it.
    #[must_use]
    pub fn is_in_view(&self, place: DVec3, [a_deg, b_deg]: [f64; 2]) -> bool {
        let (Some(low), Some(high)) = (self.lasers.first(), self.lasers.last()) else {
            return false;
        };
        let path = ElevationPath::new(place, [a_deg.min(b_deg), a_deg.max(b_deg)]);
        if let Some(aperture) = &self.aperture {
            let tilts = self.lasers.iter().flat_map(|laser| path.at_deg(laser.sin));
            let mut azimuths = tilts.map(|tilt_deg| azimuth(local(place, tilt_deg), 0.0));
            return azimuths.any(|azimuth| aperture.off(azimuth).abs() <= aperture.half);
        }
        let turns = path.turning_deg();
        let ups = [a_deg, b_deg].into_iter().chain(turns);
        let ups = ups.map(|tilt_deg| local(place, tilt_deg).z);
        let (least, most) = ups.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), up| {
            (a.min(up), b.max(up))
        });
        least <= high.sin && most >= low.sin
    }

    /// The angle from a direction to the nearest ray of any of the sweeps, degrees; infinite
    /// without rays.
    #[must_use]
    pub fn gap_deg(&self, sweeps: &[StartedSweep], place: DVec3) -> f64 {
        let chords2 = sweeps.iter().map(|sweep| self.chord2(sweep, place, 0.0));
        match chords2.fold(f64::INFINITY, f64::min) {
            found if found.is_finite() => (2.0 * (0.5 * found.sqrt()).min(1.0).asin()).to_degrees(),
            none => none,
        }
    }

    /// Whether a direction has a ray of any of the sweeps within an angle; several times as fast as
    /// the angle itself.
    #[must_use]
    pub fn is_within(&self, sweeps: &[StartedSweep], place: DVec3, gap_deg: f64) -> bool {
        let chord = 2.0 * (0.5 * gap_deg.to_radians()).sin();
        let enough = chord * chord;
        let mut sweeps = sweeps.iter();
        sweeps.any(|sweep| self.chord2(sweep, place, enough) <= enough)
    }

    /// Squared chord to the nearest ray of a sweep, or to one that is near enough.
    fn chord2(&self, started: &StartedSweep, place: DVec3, enough: f64) -> f64 {
        let sweep = &started.sweep;
        let whole_s = sweep.duration_s();
        let middle = local(place, 0.5 * (sweep.from_deg + sweep.to_deg));
        let near = azimuth(middle, 0.0);
        let mut nearest = f64::INFINITY;
        let passes = whole_s * self.revolutions_per_s;
        // As many as the instants below would give.
        if passes <= 2.0 * self.lasers.len() as f64 {
            let first = started.start.floor() as i64 - 1;
            for pass in first..=first + passes as i64 + 4 {
                self.look_at(started, near, place, pass, &mut nearest);
                if nearest <= enough {
                    break;
                }
            }
            return nearest;
        }
        let ends = [sweep.from_deg, sweep.to_deg];
        let path = ElevationPath::new(place, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
        let crossings = self.lasers.iter().flat_map(|laser| path.at_deg(laser.sin));
        let tilts = crossings.chain(path.turning_deg()).chain(ends);
        // Where lines are closer than firings, one of the next lines may have a firing nearer by.
        let lines_deg = sweep.speed_deg_s / self.revolutions_per_s;
        let firings_deg = 360.0 * self.period_s * self.revolutions_per_s;
        let more = i64::from(lines_deg < 2.0 * firings_deg);
        for tilt_deg in tilts {
            let at = local(place, tilt_deg);
            let turned = started.start + sweep.time_s(tilt_deg) * self.revolutions_per_s;
            let before = (turned - azimuth(at, near)).floor() as i64;
            for pass in before - more..=before + 1 + more {
                self.look_at(started, near, place, pass, &mut nearest);
            }
            if nearest <= enough {
                break;
            }
        }
        nearest
    }

    /// Compares the rays of one revolution; `near` is the azimuth of the direction in the middle of
    /// the sweep.
    fn look_at(
        &self,
        started: &StartedSweep,
        near: f64,
        place: DVec3,
        pass: i64,
        nearest: &mut f64,
    ) {
        let StartedSweep { sweep, start } = started;
        // The time of the pass depends slightly on the tilt, and the tilt on the time.
        let mut t = (pass as f64 + near - start) / self.revolutions_per_s;
        let mut seen = local(place, sweep.angle_deg(t));
        for _ in 0..2 {
            t = (pass as f64 + azimuth(seen, near) - start) / self.revolutions_per_s;
            seen = local(place, sweep.angle_deg(t));
        }
        let elevation = seen.z.clamp(-1.0, 1.0).asin();
        let above = self
            .lasers
            .partition_point(|laser| laser.elevation_rad < elevation);
        // Before the start and after the end a laser that is ahead in azimuth may be the nearest.
        let (first, count) = match (0.0..=sweep.duration_s()).contains(&t) {
            true => (above.saturating_sub(1), 2),
            false => (0, self.lasers.len()),
        };
        for laser in self.lasers.iter().skip(first).take(count) {
            // A chord is at least so long as that of the elevations, which is shorter than the arc
            // by less than a tenth below 90 degrees. The tilt moves on until the laser fires.
            let until_s = laser.offset.abs() / self.revolutions_per_s + self.period_s;
            let moved = (sweep.speed_deg_s * until_s).to_radians();
            let apart = 0.9 * (laser.elevation_rad - elevation).abs() - moved;
            if apart > 0.0 && apart * apart > *nearest {
                continue;
            }
            let fires_s = t - laser.offset / self.revolutions_per_s - laser.delay_s;
            // Before the start and after the end the first and the last firing are the nearest.
            let firings = ((sweep.duration_s() - laser.delay_s) / self.period_s).floor();
            let azimuth_of =
                |t: f64| start + (t + laser.delay_s) * self.revolutions_per_s + laser.offset;
            let mut firing = (fires_s / self.period_s).round();
            if let Some(aperture) = &self.aperture {
                let inwards = aperture.inwards(azimuth_of(firing * self.period_s));
                let steps = inwards / (self.revolutions_per_s * self.period_s);
                // Onto a firing inside.
                firing += steps.abs().ceil().copysign(steps);
            }
            let firing = firing.clamp(0.0, firings.max(0.0));
            let t = firing * self.period_s + laser.delay_s;
            let turned = azimuth_of(firing * self.period_s);
            if let Some(aperture) = &self.aperture
                && aperture.off(turned).abs() > aperture.half * (1.0 + 1e-9)
            {
                // The sweep begins or ends while the lidar looks away.
                continue;
            }
            let (sin, cos) = (turned * TAU).sin_cos();
            let ray = DVec3::new(laser.cos * sin, laser.cos * cos, laser.sin);
            let chord2 = ray.distance_squared(local(place, sweep.angle_deg(t)));
            *nearest = nearest.min(chord2);
        }
    }
}

/// A direction of the base in the tilted frame of the lidar (Eq. 4-6 backwards).
fn local(place: DVec3, tilt_deg: f64) -> DVec3 {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    DVec3::new(
        place.x * cos - place.z * sin,
        place.y,
        place.x * sin + place.z * cos,
    )
}

/// Azimuth of a direction in the lidar's frame, revolutions within half a one of another azimuth,
/// so that it does not jump where it changes with the tilt.
fn azimuth(seen: DVec3, near: f64) -> f64 {
    let turned = seen.x.atan2(seen.y) / TAU;
    turned - (turned - near).round()
}

/// The height of a direction above the tilted plane, against the tilt: across x cos(tilt - ahead).
struct ElevationPath {
    across: f64,
    ahead_rad: f64,
    /// Least and greatest tilt.
    tilts_deg: [f64; 2],
}

impl ElevationPath {
    fn new(place: DVec3, tilts_deg: [f64; 2]) -> Self {
        Self {
            across: place.x.hypot(place.z),
            ahead_rad: place.x.atan2(place.z),
            tilts_deg,
        }
    }

    /// Tilts at which the height is `up`.
    fn at_deg(&self, up: f64) -> impl Iterator<Item = f64> {
        let cos = up / self.across;
        let off = (cos.abs() <= 1.0).then(|| cos.acos());
        let tilts = off.map(|off| [self.ahead_rad - off, self.ahead_rad + off]);
        self.inside(tilts.into_iter().flatten())
    }

    /// Tilts at which the height is least or greatest.
    fn turning_deg(&self) -> impl Iterator<Item = f64> {
        self.inside([self.ahead_rad, self.ahead_rad + PI].into_iter())
    }

    /// Angles modulo 360 degrees within the tilts.
    fn inside(&self, angles_rad: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
        let [low, high] = self.tilts_deg;
        angles_rad
            .map(move |angle| low + (angle.to_degrees() - low).rem_euclid(360.0))
            .filter(move |tilt| *tilt <= high)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::super::lidar::tests::vlp_16;
    use super::*;
    use crate::density::{Icosahedron, gaps};

    /// Every ray of the sweeps as a direction from the origin of the base, by the equations of the
    /// mount.
    fn rays(lidar: &PlanLidar, rpm: f64, range_m: f64, sweeps: &[StartedSweep]) -> Vec<DVec3> {
        let mut found = Vec::new();
        for StartedSweep { sweep, start } in sweeps {
            for firing in 0.. {
                let begin_s = f64::from(firing) * lidar.firing_period_s;
                if begin_s > sweep.duration_s() {
                    break;
                }
                for laser in &lidar.lasers {
                    let t = begin_s + laser.delay_s;
                    if t > sweep.duration_s() {
                        continue;
                    }
                    let a = (start + t * rpm / 60.0) * TAU + laser.azimuth_deg.to_radians();
                    let is_seen = |[first, last]: [f64; 2]| {
                        (a.to_degrees() - first).rem_euclid(360.0) <= last - first
                    };
                    if !lidar.azimuths_deg.is_none_or(is_seen) {
                        continue;
                    }
                    let (sin_w, cos_w) = laser.elevation_deg.to_radians().sin_cos();
                    let d = lidar.d_m + laser.height_m;
                    // Eq. 9.
                    let up = d * sin_w;
                    let r = (range_m * range_m - d * d + up * up).sqrt() - up;
                    let mount = cloud::mount::Mount::new(units::Metres(d));
                    let at = [r * cos_w * a.sin(), r * cos_w * a.cos(), r * sin_w];
                    let tilt = cloud::mount::Tilt::new(units::Degrees(sweep.angle_deg(t)));
                    found.push(DVec3::from_array(mount.place(at, tilt)).normalize());
                }
            }
        }
        found
    }

    fn places() -> Vec<DVec3> {
        let bins = Icosahedron::new(3).unwrap();
        bins.bins().iter().map(|bin| bin.centre).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: RngSeed::Fixed(1),
            ..ProptestConfig::with_cases(12)
        })]

        /// Against the density analysis of all rays: fast sweeps with few revolutions and slow ones
        /// with many, both ways, with ramps of all lengths.
        #[test]
        fn gaps_agree_with_the_analysis_of_all_rays(
            speed_deg_s in prop_oneof![3.0..8.0_f64, 20.0..98.0_f64],
            accel_deg_s2 in prop_oneof![Just(f64::INFINITY), 50.0..5_000.0_f64],
            to_deg in prop_oneof![-45.0..-10.0_f64, 100.0..180.0_f64],
            rpm in prop_oneof![Just(300.0), Just(600.0), Just(1_200.0)],
            starts in [0.0..1.0_f64, 0.0..1.0_f64],
            both_ways: bool,
        ) {
            let mut lidar = vlp_16();
            lidar.d_m = 0.5;
            lidar.lasers[3].azimuth_deg = 4.2;
            lidar.lasers[5].height_m = 0.05;
            let sweep = TiltSweep { from_deg: 0.0, to_deg, speed_deg_s, accel_deg_s2 };
            let back = TiltSweep { from_deg: to_deg, to_deg: 0.0, ..sweep };
            let sweeps = [sweep, back].into_iter().zip(starts);
            let sweeps: Vec<_> = sweeps.map(|(sweep, start)| StartedSweep { sweep, start }).collect();
            let sweeps = if both_ways { &sweeps[..] } else { &sweeps[..1] };
            let planned = PlannedRays::new(&lidar, rpm, 10.0);
            let places: Vec<DVec3> = places().into_iter().filter(|p| planned.is_in_view(*p, [0.0, to_deg])).collect();
            let mut sum = 0.0;
            let slow = gaps(&rays(&lidar, rpm, 10.0, sweeps), &places).unwrap();
            for (place, slow) in places.iter().zip(slow) {
                let fast = planned.gap_deg(sweeps, *place);
                let slow = slow.to_degrees();
                // No ray is nearer than the nearest; one of another revolution may be nearer by a
                // part of a step of azimuth.
                let step_deg = rpm * 6.0 * lidar.firing_period_s;
                for (share, within) in [(0.999, false), (1.001, true)] {
                    prop_assert_eq!(planned.is_within(sweeps, *place, share * fast), within);
                }
                prop_assert!(fast >= slow - 1e-6 && fast <= 1.01 * slow + 0.25 * step_deg, "{place}: {fast} {slow}");
                sum += (fast - slow) / (slow + step_deg) / places.len() as f64;
            }
            prop_assert!(sum < 0.01, "{sum}");
        }
    }

    /// A UTM-30LX: one level laser that sees 270 degrees in steps of 0.25.
    fn planar(front_deg: f64) -> PlanLidar {
        let mut lidar = vlp_16();
        lidar.lasers.truncate(1);
        lidar.lasers[0].elevation_deg = 0.0;
        lidar.firing_period_s = 1.0 / 57_600.0;
        lidar.azimuths_deg = Some([front_deg - 135.0, front_deg + 135.0]);
        lidar
    }

    #[test]
    fn gaps_of_planar_scanners_agree_with_the_analysis_of_all_rays() {
        for (front_deg, speed_deg_s, accel_deg_s2, start) in [
            (-90.0, 45.0, 500.0, 0.3),
            (-90.0, 8.0, f64::INFINITY, 0.8),
            (0.0, 20.0, 5_000.0, 0.1),
        ] {
            let lidar = planar(front_deg);
            let sweep = TiltSweep {
                from_deg: 0.0,
                to_deg: -45.0,
                speed_deg_s,
                accel_deg_s2,
            };
            let sweeps = [StartedSweep { sweep, start }];
            let planned = PlannedRays::new(&lidar, 2_400.0, 10.0);
            let in_view = |place: &DVec3| planned.is_in_view(*place, [0.0, -45.0]);
            let (seen, unseen): (Vec<DVec3>, Vec<DVec3>) = places().into_iter().partition(in_view);
            let rays = rays(&lidar, 2_400.0, 10.0, &sweeps);
            let slow = gaps(&rays, &seen).unwrap();
            let mut sum = 0.0;
            for (place, slow) in seen.iter().zip(slow) {
                let (fast, slow) = (planned.gap_deg(&sweeps, *place), slow.to_degrees());
                assert!(
                    fast >= slow - 1e-6 && fast <= 1.02 * slow + 0.15,
                    "{place}: {fast} {slow}"
                );
                sum += (fast - slow) / seen.len() as f64;
            }
            assert!(sum < 0.003, "{sum}");
            // The lines of a revolution of the lidar are 1.1 deg apart at 45 deg/s; what is not in
            // view is farther from them than a line from its neighbour.
            let line_deg = speed_deg_s / 40.0;
            let blind = gaps(&rays, &unseen).unwrap();
            let near = blind
                .iter()
                .filter(|gap| gap.to_degrees() < 0.3 * line_deg)
                .count();
            assert!(near * 50 < unseen.len(), "{near} of {}", unseen.len());
        }
    }

    #[test]
    fn the_view_ends_at_the_outermost_rays() {
        let lidar = vlp_16();
        let rays_at_10_m = PlannedRays::new(&lidar, 600.0, 10.0);
        let sweep = TiltSweep {
            from_deg: 0.0,
            to_deg: -45.0,
            speed_deg_s: 56.25,
            accel_deg_s2: 500.0,
        };
        let started = StartedSweep { sweep, start: 0.3 };
        for ray in rays(&lidar, 600.0, 10.0, &[started]).iter().step_by(97) {
            let inwards = (*ray * (1.0 - 1e-9)).normalize();
            assert!(rays_at_10_m.is_in_view(inwards, [0.0, -45.0]) || ray.z.abs() > 0.2);
        }
        assert!(!rays_at_10_m.is_in_view(DVec3::Z, [0.0, -45.0]));
        assert!(rays_at_10_m.is_in_view(DVec3::Y, [0.0, -45.0]));
    }
}
