//! The motion of one sweep.

/// A tilt from rest to rest with equal ramps at both ends: the trapezoid of motion profile type 0
/// of the drive (6086), or a triangle if the way is short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltSweep {
    /// Angle at the start, degrees.
    pub from_deg: f64,
    /// Angle at the end, degrees; another than at the start.
    pub to_deg: f64,
    /// Cruise speed, degrees per second; above 0.
    pub speed_deg_s: f64,
    /// Acceleration of the ramps, degrees per second squared; infinite for none.
    pub accel_deg_s2: f64,
}

impl TiltSweep {
    /// Angle of travel, degrees.
    #[must_use]
    pub fn way_deg(&self) -> f64 {
        (self.to_deg - self.from_deg).abs()
    }

    /// Highest speed reached, degrees per second.
    #[must_use]
    pub fn peak_deg_s(&self) -> f64 {
        self.speed_deg_s
            .min((self.way_deg() * self.accel_deg_s2).sqrt())
    }

    /// Duration from rest to rest, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let peak = self.peak_deg_s();
        self.way_deg() / peak + peak / self.accel_deg_s2
    }

    /// The tilt angle (gamma) `t_s` seconds after the start, degrees; that of the nearer end before
    /// and after.
    #[must_use]
    pub fn angle_deg(&self, t_s: f64) -> f64 {
        self.motion(0.0).angle_deg(t_s)
    }

    /// The sweep, for many angles and times, without the rays within an angle of its ends.
    pub(super) fn motion(&self, unseen_deg: f64) -> SweepMotion {
        let peak_deg_s = self.peak_deg_s();
        let whole_s = self.duration_s();
        let ramp_s = peak_deg_s / self.accel_deg_s2;
        let mut motion = SweepMotion {
            sweep: *self,
            way_deg: self.way_deg(),
            sign: 1.0_f64.copysign(self.to_deg - self.from_deg),
            peak_deg_s,
            s_per_deg: peak_deg_s.recip(),
            ramp_s,
            ramp_deg: 0.5 * peak_deg_s * ramp_s,
            s2_per_deg: 2.0 / self.accel_deg_s2,
            // Without ramps nothing is lacking: infinity times 0 is no number.
            ramp_deg_s2: if ramp_s > 0.0 {
                0.5 * self.accel_deg_s2
            } else {
                0.0
            },
            whole_s,
            seen_s: (0.0, whole_s),
        };
        let left_deg = unseen_deg.copysign(self.to_deg - self.from_deg);
        let from_s = motion.time_s(self.from_deg + left_deg);
        motion.seen_s = (from_s, whole_s - from_s);
        motion
    }
}

/// A sweep with what angles and times need.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepMotion {
    pub sweep: TiltSweep,
    way_deg: f64,
    /// Direction of its tilts: 1 or -1.
    sign: f64,
    pub peak_deg_s: f64,
    s_per_deg: f64,
    ramp_s: f64,
    ramp_deg: f64,
    /// Square of the time per way on a ramp.
    s2_per_deg: f64,
    /// Way per square of the time on a ramp.
    ramp_deg_s2: f64,
    /// Duration.
    whole_s: f64,
    /// From when until when the sweep has rays.
    pub seen_s: (f64, f64),
}

impl SweepMotion {
    /// [`Self::time_s`], or the nearest time with rays.
    pub(super) fn seen_time_s(&self, angle_deg: f64) -> f64 {
        let (from_s, until_s) = self.seen_s;
        self.time_s(angle_deg).max(from_s).min(until_s)
    }

    pub(super) fn is_seen(&self, t_s: f64) -> bool {
        let (from_s, until_s) = self.seen_s;
        (from_s..=until_s).contains(&t_s)
    }

    /// [`TiltSweep::angle_deg`].
    pub(super) fn angle_deg(&self, t_s: f64) -> f64 {
        let t = t_s.clamp(0.0, self.whole_s);
        // What the ramps lack of the motion at the peak speed.
        let starts_s = (self.ramp_s - t).max(0.0);
        let stops_s = (t - (self.whole_s - self.ramp_s)).max(0.0);
        let lacks_deg = self.ramp_deg_s2 * (starts_s - stops_s) * (starts_s + stops_s);
        let gone = self.peak_deg_s * (t - 0.5 * self.ramp_s) + lacks_deg;
        self.sweep.from_deg + self.sign * gone
    }

    /// Time from the start at which the tilt reaches an angle between its ends, seconds.
    pub(super) fn time_s(&self, angle_deg: f64) -> f64 {
        let gone = (angle_deg - self.sweep.from_deg).abs().min(self.way_deg);
        let left = self.way_deg - gone;
        let nearest = gone.min(left);
        let time_s = match nearest < self.ramp_deg {
            true => (nearest * self.s2_per_deg).sqrt(),
            false => nearest * self.s_per_deg + 0.5 * self.ramp_s,
        };
        match gone <= left {
            true => time_s,
            false => self.whole_s - time_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const fn sweep(speed_deg_s: f64, accel_deg_s2: f64) -> TiltSweep {
        TiltSweep {
            from_deg: 0.0,
            to_deg: -45.0,
            speed_deg_s,
            accel_deg_s2,
        }
    }

    fn close(a: f64, b: f64, within: f64) -> bool {
        (a - b).abs() <= within
    }

    /// With the drive's default ramps of 500 deg/s2 the same sweep takes 0.8 s plus 112.5 ms.
    #[test]
    fn ramps_lengthen_the_sweep_and_short_sweeps_are_triangular() {
        let fast = sweep(56.25, 500.0);
        assert!(close(sweep(56.25, f64::INFINITY).duration_s(), 0.8, 1e-12));
        assert!(close(fast.duration_s(), 0.9125, 1e-12));
        assert!(close(fast.angle_deg(0.1125), -0.5 * 56.25 * 0.1125, 1e-12));
        assert!(close(fast.angle_deg(0.45625), -22.5, 1e-12));
        assert!(close(fast.angle_deg(-1.0), 0.0, 1e-12));
        assert!(close(fast.angle_deg(2.0), -45.0, 1e-12));
        let short = TiltSweep {
            to_deg: -1.0,
            ..fast
        };
        assert!(close(short.peak_deg_s(), 500_f64.sqrt(), 1e-12));
        assert!(close(short.duration_s(), 2.0 / 500_f64.sqrt(), 1e-12));
        // 0.05 deg/s: a quarter of an hour.
        assert!(close(sweep(0.05, 500.0).duration_s(), 900.0001, 1e-9));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_distance_is_the_area_under_the_speed(
            to_deg in prop_oneof![-90.0..-0.1_f64, 0.1..90.0_f64],
            speed_deg_s in 0.05..90.0_f64, accel_deg_s2 in 1.0..5_000.0_f64,
        ) {
            let sweep = TiltSweep { from_deg: 0.0, to_deg, speed_deg_s, accel_deg_s2 };
            let (whole, way) = (sweep.duration_s(), sweep.way_deg());
            let angle = |part: f64| sweep.angle_deg(part * whole);
            prop_assert!(close(angle(1.0), to_deg, 1e-9 * way));
            prop_assert!(close(angle(0.5), to_deg / 2.0, 1e-9 * way));
            let steps = 1_000;
            for i in 0..steps {
                let part = f64::from(i) / f64::from(steps);
                let gone = (angle(part) - angle(f64::from(i + 1) / f64::from(steps))).abs();
                prop_assert!(gone <= sweep.peak_deg_s() * whole / f64::from(steps) * (1.0 + 1e-6) + 1e-9);
                let time_s = sweep.motion(0.0).time_s(angle(part));
                prop_assert!(close(sweep.angle_deg(time_s), angle(part), 1e-6 * way));
            }
        }
    }
}
