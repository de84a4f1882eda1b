//! Angles from directions to the nearest ray of planned sweeps, without making all rays.
//!
//! A laser passes a direction when the tilt has brought it to the direction's elevation
//! ([`PlannedPlace`]). Of each laser only the revolutions before and after that instant are
//! compared, of all lasers those at the ends of the sweep and where the elevation turns: between
//! them the elevation is monotonic. Of such a revolution the firing nearest in azimuth counts. A
//! ray of another revolution may be nearer by a part of a step of azimuth.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use glam::DVec3;

use super::place::{AxisRay, ElevationPath, LaserPass, PlannedPlace, SweepEnd, azimuth, local};
use super::sweep::SweepMotion;
use super::{PlanLidar, TiltSweep};

/// A sweep and the azimuth of the lidar at its start.
#[derive(Clone, Copy, Debug)]
pub struct StartedSweep {
    motion: SweepMotion,
    start: f64,
}

impl StartedSweep {
    /// A sweep with the lidar at an azimuth of 0..1 revolutions at its start, without the rays
    /// within an angle of its ends.
    #[must_use]
    pub fn new(sweep: &TiltSweep, start: f64, unseen_deg: f64) -> Self {
        Self {
            motion: sweep.motion(unseen_deg),
            start,
        }
    }
}

/// Rays of a lidar that end at one distance from the origin of the base.
#[derive(Clone, Debug)]
pub struct PlannedRays {
    /// By elevation.
    lasers: Vec<AxisRay>,
    period_s: f64,
    /// Its reciprocal.
    firings_per_s: f64,
    revolutions_per_s: f64,
    /// Its reciprocal.
    revolution_s: f64,
    /// Greatest of the lasers' offsets, revolutions.
    most_offset: f64,
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

    /// Signed distance to the nearest azimuth inside, revolutions; 0 inside.
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
        let offsets = lasers.iter().map(|laser| laser.offset.abs());
        Self {
            most_offset: offsets.fold(0.0, f64::max),
            lasers,
            period_s: lidar.firing_period_s,
            firings_per_s: lidar.firing_period_s.recip(),
            revolutions_per_s: rpm / 60.0,
            revolution_s: 60.0 / rpm,
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

    /// A direction for sweeps between two tilts. Rays at other rates of the lidar pass it alike.
    #[must_use]
    pub fn place(&self, direction: DVec3, tilts_deg: [f64; 2]) -> PlannedPlace {
        PlannedPlace::new(&self.lasers, direction, tilts_deg)
    }

    /// The angle from a direction to the nearest ray of any of the sweeps, degrees; infinite
    /// without rays. The sweeps are between the tilts of the place.
    #[must_use]
    pub fn gap_deg(&self, sweeps: &[StartedSweep], place: &PlannedPlace) -> f64 {
        let mut nearest = f64::INFINITY;
        for sweep in sweeps {
            self.compare(sweep, place, 0.0, &mut nearest);
        }
        match nearest.is_finite() {
            true => (2.0 * (0.5 * nearest.sqrt()).min(1.0).asin()).to_degrees(),
            false => nearest,
        }
    }

    /// The gap where it is wider than `least_deg`, else `least_deg`: several times as fast where
    /// most gaps are narrower.
    #[must_use]
    pub fn gap_beyond_deg(
        &self,
        sweeps: &[StartedSweep],
        place: &PlannedPlace,
        least_deg: f64,
    ) -> f64 {
        match self.is_within(sweeps, place, least_deg) {
            true => least_deg,
            false => self.gap_deg(sweeps, place),
        }
    }

    /// Whether a direction has a ray of any of the sweeps within an angle; several times as fast as
    /// the angle itself.
    #[must_use]
    pub fn is_within(&self, sweeps: &[StartedSweep], place: &PlannedPlace, gap_deg: f64) -> bool {
        let chord = 2.0 * (0.5 * gap_deg.to_radians()).sin();
        let enough = chord * chord;
        // Rays that are not near enough are none.
        let mut nearest = enough.next_up();
        let mut sweeps = sweeps.iter();
        sweeps.any(|sweep| {
            self.compare(sweep, place, enough, &mut nearest);
            nearest <= enough
        })
    }

    /// Lessens a squared chord to that of the nearest ray of a sweep, or of one that is near
    /// enough.
    fn compare(
        &self,
        started: &StartedSweep,
        place: &PlannedPlace,
        enough: f64,
        nearest: &mut f64,
    ) {
        let motion = &started.motion;
        let lines_deg = motion.peak_deg_s * self.revolution_s;
        let firings_deg = 360.0 * self.period_s * self.revolutions_per_s;
        let pass = SweepPass {
            rays: self,
            place,
            motion,
            start: started.start,
            lines_deg,
            more: u8::from(lines_deg < 2.0 * firings_deg),
            moved_rad: (motion.peak_deg_s * self.period_s).to_radians(),
        };
        pass.compare(enough, nearest);
    }
}

/// One sweep past a direction.
struct SweepPass<'a> {
    rays: &'a PlannedRays,
    place: &'a PlannedPlace,
    motion: &'a SweepMotion,
    start: f64,
    /// Greatest tilt per revolution.
    lines_deg: f64,
    /// Lines on each side to compare besides the next one: where lines are closer than firings, one
    /// of them may have a firing nearer by.
    more: u8,
    /// Greatest tilt between two firings.
    moved_rad: f64,
}

/// Part of a linear estimate of an elevation that is certain.
const CERTAIN: f64 = 0.97;
/// Ratio that is possible.
const POSSIBLE: f64 = 1.0 / CERTAIN;
/// Squared chord of 5 deg: within it, linear estimates bound an angle from above, too.
const SHORT_CHORD2: f64 = 0.0076;
/// Part of the cosine of an elevation below 45 deg that is certain within a short chord.
const STEEP: f64 = 0.9;

/// The nearest whole number, of numbers below 2^51, without the call that `round` is on processors
/// that may lack SSE 4.1.
const fn nearest_whole(number: f64) -> f64 {
    const WHOLE: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52: numbers as large are whole.
    (number + WHOLE) - WHOLE
}

/// The whole number below a number, of those below 2^51.
const fn whole_below(number: f64) -> f64 {
    let nearest = nearest_whole(number);
    match nearest > number {
        true => nearest - 1.0,
        false => nearest,
    }
}

impl SweepPass<'_> {
    fn compare(&self, enough: f64, nearest: &mut f64) {
        let (rays, motion) = (self.rays, self.motion);
        let sweep = &motion.sweep;
        let low = sweep.from_deg.min(sweep.to_deg);
        let high = sweep.from_deg.max(sweep.to_deg);
        let revolution_s = rays.revolution_s;
        for laser in self.place.passes() {
            if laser.tilt_deg < low || laser.tilt_deg > high {
                continue;
            }
            let crosses_s = motion.seen_time_s(laser.tilt_deg);
            let turned = self.start + crosses_s * rays.revolutions_per_s - laser.azimuth;
            let after = turned - whole_below(turned);
            for (next, outwards) in [(-after, -1.0), (1.0 - after, 1.0)] {
                for line in 0..=self.more {
                    let t = crosses_s + (next + outwards * f64::from(line)) * revolution_s;
                    // Lines farther out are farther away.
                    if !motion.is_seen(t) || !self.compare_laser(laser, t, enough, nearest) {
                        break;
                    }
                }
            }
            if *nearest <= enough {
                return;
            }
        }
        let more = i64::from(self.more);
        for end in self.place.ends() {
            let turned = self.start + motion.seen_time_s(end.tilt_deg) * rays.revolutions_per_s;
            let before = (turned - end.azimuth).floor() as i64;
            for number in before - more..=before + 1 + more {
                self.compare_lasers(end, number, nearest);
            }
            if *nearest <= enough {
                return;
            }
        }
    }

    /// Compares the firing of a laser in a revolution that passes near the time, unless it is too
    /// far in elevation.
    fn compare_laser(&self, laser: &LaserPass, t: f64, enough: f64, nearest: &mut f64) -> bool {
        let (rays, motion) = (self.rays, self.motion);
        let past_deg = motion.angle_deg(t) - laser.tilt_deg;
        // The azimuth changes with the tilt, and the time of the pass with the azimuth.
        let turns = laser.azimuth_per_deg.abs() * self.lines_deg;
        let certain = CERTAIN * (1.0 - turns);
        let past_rad = past_deg.to_radians();
        let bend = 0.6 * self.place.across() * past_rad * past_rad;
        let apart = certain * (laser.up_per_rad * past_rad).abs() - bend - self.moved_rad;
        if apart > 0.0 && apart * apart > *nearest {
            return false;
        }
        let Some(ray) = rays.lasers.get(laser.number) else {
            return false;
        };
        let t = t + laser.azimuth_per_deg * past_deg * rays.revolution_s;
        // The firing nearest to the pass is off in azimuth, too.
        let firings = (t - ray.delay_s) * rays.firings_per_s;
        let off = (firings - nearest_whole(firings)) * rays.period_s * rays.revolutions_per_s;
        let off = TAU * off.abs() * ray.cos;
        let aside = (CERTAIN * off - past_rad * past_rad).max(0.0);
        if apart.max(0.0).powi(2) + aside * aside > *nearest {
            return true;
        }
        // Until the firing the tilt may move on by a part of the turn.
        let past_most = (1.0 + turns) * past_rad.abs();
        let square = past_most * past_most;
        let most = laser.up_per_rad.abs() * past_most * POSSIBLE
            + 0.6 * self.place.across() * square
            + self.moved_rad;
        let turned = turns * TAU * (laser.azimuth_per_deg * past_deg).abs() * ray.cos;
        let (most, most_aside) = (most / (STEEP * ray.cos), (off + turned) * POSSIBLE + square);
        let most = most * most + most_aside * most_aside;
        let is_level = ray.cos >= FRAC_1_SQRT_2;
        let is_inside = motion.is_seen(t - rays.period_s)
            && motion.is_seen(t + rays.period_s)
            && rays.aperture.is_none();
        if most <= enough.min(SHORT_CHORD2) && is_level && is_inside {
            *nearest = most.min(*nearest);
            return true;
        }
        let turned = self.start + t * rays.revolutions_per_s + ray.offset;
        let seen = local(self.place.direction(), motion.angle_deg(t));
        let ahead = azimuth(seen, turned) - turned;
        self.compare_ray(ray, t + ahead * rays.revolution_s, nearest);
        true
    }

    /// Compares the lasers of one revolution near a tilt.
    fn compare_lasers(&self, end: &SweepEnd, number: i64, nearest: &mut f64) {
        let (rays, motion) = (self.rays, self.motion);
        let place = self.place.direction();
        let time_of =
            |azimuth: f64| (number as f64 + azimuth - self.start) / rays.revolutions_per_s;
        let mut t = time_of(end.azimuth);
        let past_deg = motion.angle_deg(t) - end.tilt_deg;
        let until_s = rays.most_offset / rays.revolutions_per_s + rays.period_s;
        let moved = (motion.peak_deg_s * until_s).to_radians();
        let apart = end.apart - self.place.across() * past_deg.abs().to_radians() / CERTAIN - moved;
        if apart > 0.0 && apart * apart > *nearest {
            return;
        }
        // The time of the pass depends slightly on the tilt, and the tilt on the time.
        let mut seen = local(place, motion.angle_deg(t));
        for _ in 0..2 {
            t = time_of(azimuth(seen, end.azimuth));
            seen = local(place, motion.angle_deg(t));
        }
        let elevation = seen.z.clamp(-1.0, 1.0).asin();
        let above = rays
            .lasers
            .partition_point(|laser| laser.elevation_rad < elevation);
        // Before the start and after the end a laser that is ahead in azimuth may be the nearest.
        let (first, count) = match motion.is_seen(t) {
            true => (above.saturating_sub(1), 2),
            false => (0, rays.lasers.len()),
        };
        for laser in rays.lasers.iter().skip(first).take(count) {
            // A chord is at least so long as that of the elevations, which is shorter than the arc
            // by less than a tenth below 90 degrees. The tilt moves on until the laser fires.
            let until_s = laser.offset.abs() / rays.revolutions_per_s + rays.period_s;
            let moved = (motion.peak_deg_s * until_s).to_radians();
            let apart = 0.9 * (laser.elevation_rad - elevation).abs() - moved;
            if apart > 0.0 && apart * apart > *nearest {
                continue;
            }
            self.compare_ray(laser, t - laser.offset / rays.revolutions_per_s, nearest);
        }
    }

    /// Compares the firing of a laser that is nearest to a time.
    fn compare_ray(&self, laser: &AxisRay, t: f64, nearest: &mut f64) {
        let (rays, motion) = (self.rays, self.motion);
        // Before the start and after the end the first and the last firing are the nearest.
        let (from_s, until_s) = motion.seen_s;
        let first = ((from_s - laser.delay_s) / rays.period_s).ceil().max(0.0);
        let last = ((until_s - laser.delay_s) / rays.period_s).floor();
        let azimuth_of = |firing: f64| {
            let t = firing * rays.period_s + laser.delay_s;
            self.start + t * rays.revolutions_per_s + laser.offset
        };
        let mut firing = nearest_whole((t - laser.delay_s) * rays.firings_per_s);
        if let Some(aperture) = &rays.aperture {
            let inwards = aperture.inwards(azimuth_of(firing));
            let steps = inwards / (rays.revolutions_per_s * rays.period_s);
            // Onto a firing inside.
            firing += steps.abs().ceil().copysign(steps);
        }
        if last < first {
            return;
        }
        let firing = firing.clamp(first, last);
        let turned = azimuth_of(firing);
        if let Some(aperture) = &rays.aperture
            && aperture.off(turned).abs() > aperture.half * (1.0 + 1e-9)
        {
            // The sweep begins or ends while the lidar looks away.
            return;
        }
        let (sin, cos) = (turned * TAU).sin_cos();
        let ray = DVec3::new(laser.cos * sin, laser.cos * cos, laser.sin);
        let tilt_deg = motion.angle_deg(firing * rays.period_s + laser.delay_s);
        let chord2 = ray.distance_squared(local(self.place.direction(), tilt_deg));
        *nearest = nearest.min(chord2);
    }
}

#[cfg(test)]
mod tests;
