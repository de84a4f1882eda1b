//! Scan lines of a tilting multi-beam lidar, and the gaps between them. Computed, not measured.
//!
//! The lidar rotates at a constant rate around its own axis, while the platform tilts around Y (Eq.
//! 4-6 of "Analysis of 3D Scan Measurement Distribution with Application to a Multi-Beam Lidar on a
//! Rotating Platform", 2018) with a trapezoidal speed profile. A scan line is the path of one laser
//! in one revolution. The azimuth steps along a line are ignored.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::device::vertical_resolution_deg;

/// A tilt from 0 to `-way_deg` with equal ramps at both ends. A short way gives a triangular
/// profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltSweep {
    /// Angle of travel, degrees; above 0.
    pub way_deg: f64,
    /// Cruise speed, degrees per second; above 0.
    pub speed_deg_s: f64,
    /// Acceleration of the ramps, degrees per second squared; infinite for none.
    pub accel_deg_s2: f64,
}

impl TiltSweep {
    /// Highest speed reached, degrees per second.
    #[must_use]
    pub fn peak_deg_s(&self) -> f64 {
        self.speed_deg_s
            .min((self.way_deg * self.accel_deg_s2).sqrt())
    }

    /// Duration from rest to rest, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let peak = self.peak_deg_s();
        self.way_deg / peak + peak / self.accel_deg_s2
    }

    /// The tilt angle (gamma) `t_s` seconds after the start, degrees: 0 before, `-way_deg` after.
    #[must_use]
    pub fn angle_deg(&self, t_s: f64) -> f64 {
        let (peak, whole) = (self.peak_deg_s(), self.duration_s());
        let ramp = peak / self.accel_deg_s2;
        let t = t_s.clamp(0.0, whole);
        let rising = |t: f64| {
            if t < ramp {
                0.5 * self.accel_deg_s2 * t * t
            } else {
                peak * (t - 0.5 * ramp)
            }
        };
        let gone = if t <= whole / 2.0 {
            rising(t)
        } else {
            self.way_deg - rising(whole - t)
        };
        -gone
    }
}

/// The lidar on the platform.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternLidar {
    /// Elevations of its lasers, degrees, in any order; at least one.
    pub elevations_deg: Vec<f64>,
    /// Revolutions per second.
    pub revolutions_per_s: f64,
}

impl PatternLidar {
    /// The VLP-16: -15 to 15 degrees in steps of 2, at 10 revolutions per second.
    #[must_use]
    pub fn vlp_16() -> Self {
        Self {
            elevations_deg: (0..16).map(|i| f64::from(2 * i - 15)).collect(),
            revolutions_per_s: 10.0,
        }
    }

    /// Lowest and highest laser, degrees.
    fn ends_deg(&self) -> (f64, f64) {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        self.elevations_deg
            .iter()
            .fold(ends, |(low, high), w| (low.min(*w), high.max(*w)))
    }

    /// Revolutions of the lidar during a sweep.
    #[must_use]
    pub fn revolutions(&self, sweep: &TiltSweep) -> f64 {
        sweep.duration_s() * self.revolutions_per_s
    }

    /// Vertical field of view of a sweep across the tilt axis, degrees: that of the lidar plus the
    /// way.
    #[must_use]
    pub fn field_deg(&self, sweep: &TiltSweep) -> f64 {
        let (low, high) = self.ends_deg();
        high - low + sweep.way_deg
    }

    /// Mean vertical resolution in degrees, as in the paper and [`vertical_resolution_deg`]: the
    /// field of view divided by lasers and by the revolutions that the way takes at cruise speed.
    /// Ramps, in which lines are closer, are ignored. For 45 degrees at 56.25 deg/s it is 75 / (16
    /// x 8) = 0.586.
    #[must_use]
    pub fn mean_resolution_deg(&self, sweep: &TiltSweep) -> f64 {
        let revolutions = sweep.way_deg / sweep.speed_deg_s * self.revolutions_per_s;
        let lasers = u32::try_from(self.elevations_deg.len()).unwrap_or(u32::MAX);
        vertical_resolution_deg(self.field_deg(sweep), lasers, revolutions)
    }

    /// The widest gaps between neighbouring scan lines in the plane across the tilt axis, at the
    /// worst of `phases` evenly spaced initial azimuths.
    ///
    /// In that plane a laser is at elevation w - gamma whenever the lidar points along it, once per
    /// revolution.
    #[must_use]
    pub fn gaps(&self, sweep: &TiltSweep, phases: u32) -> LineGaps {
        let none = LineGaps {
            field_deg: 0.0,
            middle_deg: 0.0,
        };
        (0..phases).fold(none, |worst, i| {
            let gaps = self.gaps_at(sweep, f64::from(i) / f64::from(phases));
            LineGaps {
                field_deg: worst.field_deg.max(gaps.field_deg),
                middle_deg: worst.middle_deg.max(gaps.middle_deg),
            }
        })
    }

    fn gaps_at(&self, sweep: &TiltSweep, phase: f64) -> LineGaps {
        let (low, high) = self.ends_deg();
        let revolutions = self.revolutions(sweep);
        let passes: Vec<f64> = (0..)
            .map(|k| f64::from(k) + phase)
            .take_while(|revolution| *revolution <= revolutions)
            .map(|revolution| -sweep.angle_deg(revolution / self.revolutions_per_s))
            .collect();
        let own = self.elevations_deg.iter();
        let mut lines: Vec<f64> = own
            .flat_map(|w| passes.iter().map(move |tilted| w + tilted))
            .chain([low, high + sweep.way_deg])
            .collect();
        // The lines of each laser are in order, which a stable sort exploits.
        lines.sort_by(f64::total_cmp);
        let mut gaps = LineGaps {
            field_deg: 0.0,
            middle_deg: 0.0,
        };
        for (a, b) in lines.iter().zip(lines.iter().skip(1)) {
            gaps.field_deg = gaps.field_deg.max(b - a);
            if *b > high && *a < low + sweep.way_deg {
                gaps.middle_deg = gaps.middle_deg.max(b - a);
            }
        }
        gaps
    }

    /// Diameter in degrees of the widest unseen circle: twice the largest distance of any direction
    /// in the field of view from the nearest scan line. Directions are on a grid of `step_deg`
    /// around the tilt axis that includes the poles. The field of view is everything between the
    /// lowest and the highest laser at some tilt of the sweep.
    ///
    /// The distance of a direction from a line is its elevation when the lidar points towards it,
    /// less that of the laser.
    #[must_use]
    pub fn widest_circle_deg(&self, sweep: &TiltSweep, step_deg: f64) -> f64 {
        let revolutions = self.revolutions(sweep).floor().clamp(0.0, 1e9) as u64 + 1;
        let mut worst: f64 = 0.0;
        for direction in grid(step_deg) {
            if !self.may_see(sweep, direction) {
                continue;
            }
            let mut nearest = f64::INFINITY;
            for revolution in strided(revolutions) {
                let Some(off) = self.off_line_deg(sweep, direction, revolution) else {
                    continue;
                };
                nearest = nearest.min(off);
                if nearest <= worst {
                    break;
                }
            }
            if nearest.is_finite() {
                worst = worst.max(nearest);
            }
        }
        2.0 * worst
    }

    /// Whether a direction is between the lowest and the highest laser at some tilt of a sweep.
    fn may_see(&self, sweep: &TiltSweep, [x, _, z]: [f64; 3]) -> bool {
        let up = |gamma_deg: f64| {
            let (sin, cos) = gamma_deg.to_radians().sin_cos();
            x * sin + z * cos
        };
        // Extremes are where the derivative is zero: gamma = atan(x / z), and 180 degrees on.
        let turning = x.atan2(z).to_degrees();
        let turning = [turning - 180.0, turning, turning + 180.0];
        let inside = turning
            .into_iter()
            .filter(|g| (-sweep.way_deg..=0.0).contains(g));
        let ups = [0.0, -sweep.way_deg].into_iter().chain(inside).map(up);
        let (least, most) = ups.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), u| {
            (a.min(u), b.max(u))
        });
        let (low, high) = self.ends_deg();
        least <= high.to_radians().sin() && most >= low.to_radians().sin()
    }

    /// Distance of a direction from the nearest line of a revolution, degrees; `None` if the sweep
    /// ends before the lidar points there.
    fn off_line_deg(&self, sweep: &TiltSweep, [x, y, z]: [f64; 3], revolution: u64) -> Option<f64> {
        let whole = sweep.duration_s();
        let mut t = revolution as f64 / self.revolutions_per_s;
        let mut up = z;
        // The time at which the lidar points there depends slightly on the tilt, and the tilt on
        // the time.
        for _ in 0..3 {
            let (sin, cos) = sweep.angle_deg(t).to_radians().sin_cos();
            let across = x * cos - z * sin;
            up = x * sin + z * cos;
            let azimuth = across.atan2(y).rem_euclid(TAU) / TAU;
            t = (revolution as f64 + azimuth) / self.revolutions_per_s;
        }
        if t > whole {
            return None;
        }
        let elevation = up.clamp(-1.0, 1.0).asin().to_degrees();
        let away = self.elevations_deg.iter().map(|w| (elevation - w).abs());
        Some(away.fold(f64::INFINITY, f64::min))
    }
}

/// Unit vectors around the Y axis, including both poles.
fn grid(step_deg: f64) -> impl Iterator<Item = [f64; 3]> {
    let rows = (180.0 / step_deg).ceil().max(1.0) as u32;
    (0..=rows).flat_map(move |row| {
        let latitude = -FRAC_PI_2 + f64::from(row) / f64::from(rows) * (TAU / 2.0);
        let (y, radius) = latitude.sin_cos();
        let around = (radius * 360.0 / step_deg).ceil().max(1.0) as u32;
        (0..around).map(move |i| {
            let (sin, cos) = (f64::from(i) / f64::from(around) * TAU).sin_cos();
            [radius * sin, y, radius * cos]
        })
    })
}

/// Largest angles between neighbouring scan lines across the tilt axis, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LineGaps {
    /// In the whole field of view, whose ends count as lines.
    pub field_deg: f64,
    /// In its middle, which every laser passes: from the highest laser at the start to the lowest
    /// at the end. 0 if the way is too short.
    pub middle_deg: f64,
}

/// All numbers below `n` in large strides, so that a line near a direction is found early.
fn strided(n: u64) -> impl Iterator<Item = u64> {
    let stride = n.isqrt();
    (0..stride).flat_map(move |first| (first..n).step_by(stride as usize))
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};
    use proptest::prelude::*;

    use super::*;

    const fn sweep(speed_deg_s: f64, accel_deg_s2: f64) -> TiltSweep {
        TiltSweep {
            way_deg: 45.0,
            speed_deg_s,
            accel_deg_s2,
        }
    }

    fn close(a: f64, b: f64, within: f64) -> bool {
        (a - b).abs() <= within
    }

    /// The paper's figures, with 0.80 s for 45 degrees and no ramps.
    #[test]
    fn resolutions_match_the_paper() {
        let vlp = PatternLidar::vlp_16();
        let fast = sweep(56.25, f64::INFINITY);
        assert!(close(fast.duration_s(), 0.8, 1e-12));
        assert!(close(vlp.revolutions(&fast), 8.0, 1e-12));
        assert!(close(vlp.field_deg(&fast), 75.0, 1e-12));
        assert!(close(vlp.mean_resolution_deg(&fast), 0.5859, 5e-5));
        // Independent of the ramps.
        assert_eq!(
            vlp.mean_resolution_deg(&fast),
            vlp.mean_resolution_deg(&sweep(56.25, 500.0))
        );
        // The paper's 5.2e-3 for its slowest scan is that of 0.5 deg/s; 0.05 deg/s gives a tenth of
        // it.
        let slow = vlp.mean_resolution_deg(&sweep(0.5, f64::INFINITY));
        assert!(close(slow, 5.208e-3, 5e-7), "{slow}");
        let slowest = vlp.mean_resolution_deg(&sweep(0.05, f64::INFINITY));
        assert!(close(slowest, 5.208e-4, 5e-8), "{slowest}");
    }

    /// With the drive's default ramps of 500 deg/s2 the same sweep takes 0.8 s plus 112.5 ms.
    #[test]
    fn ramps_lengthen_the_sweep_and_short_sweeps_are_triangular() {
        let fast = sweep(56.25, 500.0);
        assert!(close(fast.duration_s(), 0.9125, 1e-12));
        assert!(close(fast.angle_deg(0.1125), -0.5 * 56.25 * 0.1125, 1e-12));
        assert!(close(fast.angle_deg(0.45625), -22.5, 1e-12));
        assert_eq!((fast.angle_deg(-1.0), fast.angle_deg(2.0)), (0.0, -45.0));
        let short = TiltSweep {
            way_deg: 1.0,
            ..fast
        };
        assert!(close(short.peak_deg_s(), 500_f64.sqrt(), 1e-12));
        assert!(close(short.duration_s(), 2.0 / 500_f64.sqrt(), 1e-12));
        // 0.05 deg/s: a quarter of an hour.
        assert!(close(sweep(0.05, 500.0).duration_s(), 900.0001, 1e-9));
    }

    /// Near its ends only the outermost laser sees the field, and lines are the tilt of one
    /// revolution apart. In the middle sixteen lasers fill each other's gaps, unless their 2
    /// degrees are a multiple of the tilt per revolution: then their lines coincide.
    #[test]
    fn gaps_are_the_tilt_of_one_revolution_unless_lasers_fill_them() {
        let vlp = PatternLidar::vlp_16();
        for (speed, field, middle) in [
            (1.0, 0.1, 0.1),
            (10.0, 1.0, 1.0),
            (20.0, 2.0, 2.0),
            // 0.7 degrees per revolution: 2 is twice 0.7 plus 0.6, so lines of neighbouring lasers
            // are 0.1 apart.
            (7.0, 0.7, 0.1),
            // 5.625: eight revolutions make 45 degrees, and 2 has remainders of 1.625, 1.25, 0.875,
            // 0.5 and 0.125.
            (56.25, 2.0, 0.5),
        ] {
            let gaps = vlp.gaps(&sweep(speed, f64::INFINITY), 1);
            assert!(close(gaps.field_deg, field, 1e-9), "{speed}: {gaps:?}");
            assert!(close(gaps.middle_deg, middle, 1e-9), "{speed}: {gaps:?}");
        }
        let short = TiltSweep {
            way_deg: 20.0,
            ..sweep(1.0, 500.0)
        };
        assert_eq!(vlp.gaps(&short, 2).middle_deg, 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Searches for a line from every elevation of a fine grid.
        #[test]
        fn gaps_agree_with_a_search_on_a_fine_grid(speed_deg_s in 3.0..60.0_f64, phase in 0.0..1.0_f64) {
            let (vlp, sweep) = (PatternLidar::vlp_16(), sweep(speed_deg_s, 500.0));
            let gaps = vlp.gaps_at(&sweep, phase);
            let passes = (0..).map(|k| (f64::from(k) + phase) / 10.0);
            let tilts = passes.take_while(|t| *t <= sweep.duration_s()).map(|t| sweep.angle_deg(t));
            let mut lines: Vec<f64> = tilts.flat_map(|g| vlp.elevations_deg.iter().map(move |w| w - g)).collect();
            lines.extend([-15.0, 60.0]);
            let width = |at: f64| {
                let above = lines.iter().copied().filter(|l| *l > at).fold(f64::INFINITY, f64::min);
                let below = lines.iter().copied().filter(|l| *l <= at).fold(f64::NEG_INFINITY, f64::max);
                above - below
            };
            let widest = |from: f64, to: f64| {
                let steps = 4_000;
                let places = (0..steps).map(|i| from + (to - from) * (f64::from(i) + 0.5) / f64::from(steps));
                // A gap may reach into the range by less than a step.
                places.chain([from, to.next_down()]).map(width).fold(0.0, f64::max)
            };
            prop_assert!(close(gaps.field_deg, widest(-15.0, 60.0), 1e-9));
            prop_assert!(close(gaps.middle_deg, widest(15.0, 30.0), 1e-9));
        }
    }

    /// At any speed, the area between the lasers at -1 and +1 degrees around the tilt axis stays
    /// unseen.
    #[test]
    fn the_poles_stay_blind_at_any_speed() {
        let vlp = PatternLidar::vlp_16();
        for speed in [0.5, 5.0] {
            let circle = vlp.widest_circle_deg(&sweep(speed, 500.0), 2.0);
            assert!(close(circle, 2.0, 1e-9), "{speed}: {circle}");
        }
        let one = PatternLidar {
            elevations_deg: vec![0.0],
            revolutions_per_s: 10.0,
        };
        // A single laser at elevation 0 sees the pole and, if slow enough, everything it passes:
        // 0.1 degrees per revolution, at an end up to twice that.
        let circle = one.widest_circle_deg(&sweep(1.0, 500.0), 2.0);
        assert!(circle < 0.21, "{circle}");
    }

    /// Every direction against every revolution, with rotation matrices and no early exit.
    fn slow_circle_deg(lidar: &PatternLidar, sweep: &TiltSweep, step_deg: f64) -> f64 {
        let revolutions = lidar.revolutions(sweep).floor() as u32 + 1;
        let mut worst: f64 = 0.0;
        for direction in grid(step_deg) {
            let local = |gamma_deg: f64| {
                DMat3::from_rotation_y(-gamma_deg.to_radians()) * DVec3::from_array(direction)
            };
            let elevation = |v: DVec3| v.z.clamp(-1.0, 1.0).asin().to_degrees();
            let (low, high) = lidar.ends_deg();
            let steps = 4_500;
            let tilts = (0..=steps).map(|i| -sweep.way_deg * f64::from(i) / f64::from(steps));
            let elevations: Vec<f64> = tilts.map(|g| elevation(local(g))).collect();
            let least = elevations.iter().copied().fold(f64::INFINITY, f64::min);
            let most = elevations.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if least > high || most < low {
                continue;
            }
            let mut nearest = f64::INFINITY;
            for revolution in 0..revolutions {
                let mut t = f64::from(revolution) / lidar.revolutions_per_s;
                let mut seen = DVec3::ZERO;
                for _ in 0..20 {
                    seen = local(sweep.angle_deg(t));
                    let azimuth = (FRAC_PI_2 - seen.y.atan2(seen.x)).rem_euclid(TAU);
                    t = (f64::from(revolution) + azimuth / TAU) / lidar.revolutions_per_s;
                }
                if t <= sweep.duration_s() {
                    for w in &lidar.elevations_deg {
                        nearest = nearest.min((elevation(seen) - w).abs());
                    }
                }
            }
            if nearest.is_finite() {
                worst = worst.max(nearest);
            }
        }
        2.0 * worst
    }

    #[test]
    fn the_widest_circle_agrees_with_an_exhaustive_search() {
        for speed in [56.25, 7.0] {
            let (vlp, sweep) = (PatternLidar::vlp_16(), sweep(speed, 500.0));
            let fast = vlp.widest_circle_deg(&sweep, 10.0);
            let slow = slow_circle_deg(&vlp, &sweep, 10.0);
            assert!(close(fast, slow, 1e-2), "{speed}: {fast} {slow}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_distance_is_the_area_under_the_speed(
            way_deg in 0.1..90.0_f64, speed_deg_s in 0.05..90.0_f64, accel_deg_s2 in 1.0..5_000.0_f64,
        ) {
            let sweep = TiltSweep { way_deg, speed_deg_s, accel_deg_s2 };
            let whole = sweep.duration_s();
            let angle = |part: f64| sweep.angle_deg(part * whole);
            prop_assert!(close(angle(1.0), -way_deg, 1e-9 * way_deg));
            prop_assert!(close(angle(0.5), -way_deg / 2.0, 1e-9 * way_deg));
            let steps = 1_000;
            for i in 0..steps {
                let gone = angle(f64::from(i) / f64::from(steps)) - angle(f64::from(i + 1) / f64::from(steps));
                prop_assert!(gone >= -1e-9);
                prop_assert!(gone <= sweep.peak_deg_s() * whole / f64::from(steps) * (1.0 + 1e-6) + 1e-9);
            }
        }

        #[test]
        fn the_stride_order_visits_every_index(n in 1..2_000_u64) {
            let mut seen = vec![false; n as usize];
            for i in strided(n) {
                seen[i as usize] = true;
            }
            prop_assert!(seen.into_iter().all(|s| s));
        }
    }
}
