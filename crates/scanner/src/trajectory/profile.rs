//! The motion that was commanded: a trapezoid of the speed, behind a servo that lags.
//!
//! Speed rises evenly over `ramp_up_s`, holds, and falls evenly over `ramp_down_s`; without a stretch of constant speed it is a
//! triangle. The servo answers as 1 / (1 + lag s + inertia s2): without inertia a shaft that is always nearing its demand, with it one that
//! may overshoot. In cruise it is behind by its lag. What is the same on both ramps and in cruise, a dead time, is in the start.
//!
//! Every function is written so that it stays exact where its parameters degenerate: a ramp of no length, a lag of none, a cruise of
//! a quarter of an hour. Left out: how the parameters are found, which is `profile_fit`.

/// A profile move of the shaft, in seconds after an origin and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// When it begins, seconds.
    pub start_s: f64,
    /// Speed of the cruise, degrees per second; of a triangle the greatest. Signed as the way is.
    pub speed_deg_s: f64,
    /// Duration of the acceleration, seconds.
    pub ramp_up_s: f64,
    /// Duration of the deceleration, seconds.
    pub ramp_down_s: f64,
    /// Angle where it begins, degrees.
    pub from_deg: f64,
    /// Its way, degrees; signed.
    pub way_deg: f64,
    /// Time constant of the servo, seconds; 0 where the shaft follows at once.
    pub lag_s: f64,
    /// Inertia of the servo, seconds squared: 1 / (2 pi f)2 of a natural frequency f, damped by lag / (2 sqrt(inertia)); 0 of a servo of
    /// first order.
    pub inertia_s2: f64,
}

/// Derivatives of an angle by start, speed, both ramps, beginning, way, lag and inertia, in this order.
pub(super) type Gradient = [f64; 8];

impl Profile {
    /// When the deceleration begins, seconds after the start.
    #[must_use]
    pub fn braking_s(&self) -> f64 {
        self.way_deg / self.speed_deg_s + (self.ramp_up_s - self.ramp_down_s) / 2.0
    }

    /// When the demand is at rest again, seconds after the start.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.braking_s() + self.ramp_down_s
    }

    /// Angle at an instant.
    #[must_use]
    pub fn angle_deg(&self, at_s: f64) -> f64 {
        let (up, down) = self.ramps(at_s);
        self.from_deg + self.speed_deg_s * (up.position - down.position)
    }

    /// Speed at an instant, degrees per second.
    #[must_use]
    pub fn rate_deg_s(&self, at_s: f64) -> f64 {
        let (up, down) = self.ramps(at_s);
        self.speed_deg_s * (up.rate - down.rate)
    }

    fn ramps(&self, at_s: f64) -> (Ramp, Ramp) {
        let since = at_s - self.start_s;
        (
            Ramp::new(since, self.ramp_up_s, self.lag_s, self.inertia_s2),
            Ramp::new(
                since - self.braking_s(),
                self.ramp_down_s,
                self.lag_s,
                self.inertia_s2,
            ),
        )
    }

    /// Angle at an instant, and how it changes with the parameters.
    pub(super) fn with_gradient(&self, at_s: f64) -> (f64, Gradient) {
        let (up, down) = self.ramps(at_s);
        let v = self.speed_deg_s;
        // The braking's start moves with way, speed and ramps.
        let later = v * down.rate;
        let angle = self.from_deg + v * (up.position - down.position);
        let gradient = [
            -v * (up.rate - down.rate),
            (up.position - down.position) - later * self.way_deg / (v * v),
            v * up.by_ramp + later / 2.0,
            -v * down.by_ramp - later / 2.0,
            1.0,
            later / v,
            v * (up.by_lag - down.by_lag),
            v * (up.by_inertia - down.by_inertia),
        ];
        (angle, gradient)
    }

    /// Instants at which the motion is of another form, seconds, in order.
    pub(super) fn corners_s(&self) -> [f64; 4] {
        let brake = self.braking_s();
        [0.0, self.ramp_up_s, brake, brake + self.ramp_down_s].map(|s| self.start_s + s)
    }
}

/// What a demand that goes over to unit speed has brought about: position in seconds, speed, and the position's derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ramp {
    position: f64,
    rate: f64,
    by_ramp: f64,
    by_lag: f64,
    by_inertia: f64,
}

impl Ramp {
    const REST: Self = Self {
        position: 0.0,
        rate: 0.0,
        by_ramp: 0.0,
        by_lag: 0.0,
        by_inertia: 0.0,
    };

    /// `since` seconds after its beginning, of a ramp of `length` seconds behind a lag.
    fn new(since: f64, length: f64, lag: f64, inertia: f64) -> Self {
        if since <= 0.0 {
            return Self::REST;
        }
        let demand = Self::demand(since, length);
        if lag <= 0.0 {
            // The limit of the shaft's answer as the lag goes to zero: it is behind by speed times lag.
            return Self {
                by_lag: -demand.rate,
                ..demand
            };
        }
        if inertia > 0.0 {
            return swing::behind(demand, since, length, lag, inertia);
        }
        demand.behind(since, length, lag)
    }

    fn demand(since: f64, length: f64) -> Self {
        if since < length {
            let part = since / length;
            Self {
                position: since * part / 2.0,
                rate: part,
                by_ramp: -part * part / 2.0,
                by_lag: 0.0,
                by_inertia: 0.0,
            }
        } else {
            Self {
                position: since - length / 2.0,
                rate: 1.0,
                by_ramp: -0.5,
                by_lag: 0.0,
                by_inertia: 0.0,
            }
        }
    }

    /// The shaft's answer to this demand: less lag x (its speed - m), where m is how much of the speed is still missing. With
    /// x = time / lag and f(x) = (1 - exp(-x)) / x, m is part x f(x) on the ramp and exp(-x after it) x f(length / lag) behind it.
    fn behind(self, since: f64, length: f64, lag: f64) -> Self {
        let missing = if since < length {
            Missing::on_the_ramp(since, length, lag)
        } else {
            Missing::after_it(since, length, lag)
        };
        let rate_by_ramp = if since < length {
            -self.rate / length
        } else {
            0.0
        };
        Self {
            position: self.position - lag * (self.rate - missing.rate),
            rate: self.rate - missing.rate,
            by_ramp: self.by_ramp - lag * (rate_by_ramp - missing.by_ramp),
            by_lag: missing.rate - self.rate + lag * missing.by_lag,
            by_inertia: 0.0,
        }
    }
}

/// The answer of a servo with inertia.
mod swing {
    use super::Ramp;

    /// A servo 1 / (1 + b1 s + b2 s2): a demand of unit speed from 0 on it follows as t - b1 + g(t), where g is the solution of
    /// b2 g" + b1 g' + g = 0 with g(0) = b1 and g'(0) = -1. With C and S the cosine and the sine over w, a = b1 / (2 b2) and
    /// w2 = 1/b2 - a2, which may be negative, g = exp(-a t) (b1 C + (a b1 - 1) S).
    struct Servo {
        lag: f64,
        inertia: f64,
        a: f64,
        w2: f64,
    }

    /// exp(-a t) times C and S.
    struct Waves {
        c: f64,
        s: f64,
    }

    impl Servo {
        fn new(lag: f64, inertia: f64) -> Self {
            let a = lag / (2.0 * inertia);
            Self {
                lag,
                inertia,
                a,
                w2: 1.0 / inertia - a * a,
            }
        }

        fn waves(&self, t: f64) -> Waves {
            let decay = f64::exp(-self.a * t);
            let phase = self.w2 * t * t;
            if phase.abs() < 1e-6 {
                return Waves {
                    c: decay * (1.0 - phase / 2.0),
                    s: decay * t * (1.0 - phase / 6.0),
                };
            }
            let w = self.w2.abs().sqrt();
            if self.w2 > 0.0 {
                let (sin, cos) = (w * t).sin_cos();
                return Waves {
                    c: decay * cos,
                    s: decay * sin / w,
                };
            }
            // Two poles: the slow one's rate is the product, 1/b2, over the quick one's, so that no digits are lost.
            let quick = self.a + w;
            let slow = 1.0 / self.inertia / quick;
            let (quick, slow) = (f64::exp(-quick * t), f64::exp(-slow * t));
            Waves {
                c: (slow + quick) / 2.0,
                s: (slow - quick) / (2.0 * w),
            }
        }

        /// g, and its integral from 0 on.
        fn behind(&self, t: f64) -> (f64, f64) {
            if t <= 0.0 {
                return (0.0, 0.0);
            }
            let Waves { c, s } = self.waves(t);
            let whole = self.lag * self.lag - self.inertia;
            let g = self.lag * c + (self.a * self.lag - 1.0) * s;
            (g, whole - (whole * c + (self.a * whole - self.lag) * s))
        }

        /// Position and speed behind a ramp of `length` seconds.
        fn answer(&self, demand: &Ramp, since: f64, length: f64) -> (f64, f64) {
            let (g, sum) = self.behind(since);
            let (g_after, sum_after) = self.behind(since - length);
            let acceleration = if since < length { 1.0 / length } else { 0.0 };
            (
                demand.position - self.lag * demand.rate + (sum - sum_after) / length,
                demand.rate - self.lag * acceleration + (g - g_after) / length,
            )
        }
    }

    /// Steps of the differences by lag and inertia, as a part of them.
    const STEP: f64 = 1e-5;

    pub(super) fn behind(demand: Ramp, since: f64, length: f64, lag: f64, inertia: f64) -> Ramp {
        let servo = Servo::new(lag, inertia);
        let (position, rate) = servo.answer(&demand, since, length);
        let by = |low: Servo, high: Servo, step: f64| {
            let [low, high] = [low, high].map(|servo| servo.answer(&demand, since, length).0);
            (high - low) / (2.0 * step)
        };
        let (g_after, sum_after) = servo.behind(since - length);
        let mean = (servo.behind(since).1 - sum_after) / length;
        let rate_by_ramp = if since < length {
            -demand.rate / length
        } else {
            0.0
        };
        Ramp {
            position,
            rate,
            by_ramp: demand.by_ramp - lag * rate_by_ramp + (g_after - mean) / length,
            by_lag: by(
                Servo::new(lag * (1.0 - STEP), inertia),
                Servo::new(lag * (1.0 + STEP), inertia),
                lag * STEP,
            ),
            by_inertia: by(
                Servo::new(lag, inertia * (1.0 - STEP)),
                Servo::new(lag, inertia * (1.0 + STEP)),
                inertia * STEP,
            ),
        }
    }
}

/// What a lag leaves missing of a demanded speed, and its derivatives.
struct Missing {
    rate: f64,
    by_ramp: f64,
    by_lag: f64,
}

impl Missing {
    fn on_the_ramp(since: f64, length: f64, lag: f64) -> Self {
        let (part, x) = (since / length, since / lag);
        let f = mean_decay(x);
        Self {
            rate: part * f,
            by_ramp: -part * f / length,
            by_lag: part * (f - f64::exp(-x)) / lag,
        }
    }

    fn after_it(since: f64, length: f64, lag: f64) -> Self {
        let (after, x) = ((since - length) / lag, length / lag);
        let (left, f) = (f64::exp(-after), mean_decay(x));
        Self {
            rate: left * f,
            by_ramp: if x > SHORT {
                left * (1.0 - f) / length
            } else {
                left / (2.0 * lag)
            },
            by_lag: left / lag * (after * f + f - f64::exp(-x)),
        }
    }
}

/// Below this the difference 1 - f(x) has fewer digits than the first term of its series, x / 2.
const SHORT: f64 = 1e-7;

/// (1 - exp(-x)) / x, the mean of exp from -x to 0.
fn mean_decay(x: f64) -> f64 {
    if x > 0.0 { -f64::exp_m1(-x) / x } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn card() -> Profile {
        Profile {
            start_s: 0.1,
            speed_deg_s: -56.25,
            ramp_up_s: 0.1125,
            ramp_down_s: 0.1125,
            from_deg: 0.0,
            way_deg: -45.0,
            lag_s: 0.0,
            inertia_s2: 0.0,
        }
    }

    #[test]
    fn the_cards_sweep_takes_its_time_and_its_way() {
        let card = card();
        assert!((card.duration_s() - 0.9125).abs() < 1e-12);
        assert_eq!(card.angle_deg(0.0), 0.0);
        assert!((card.angle_deg(2.0) + 45.0).abs() < 1e-12);
        assert!((card.angle_deg(0.1 + 0.9125 / 2.0) + 22.5).abs() < 1e-12);
        // In cruise a lag is a delay.
        let slow = Profile {
            lag_s: 0.0106,
            ..card
        };
        assert!((slow.angle_deg(0.5) - card.angle_deg(0.5 - 0.0106)).abs() < 1e-3);
    }

    /// A second way: the demand's speed by cases, the servo's differential equation by small steps.
    fn stepped(profile: &Profile, until_s: f64) -> f64 {
        let speed = |t: f64| {
            let t = t - profile.start_s;
            let (up, brake) = (profile.ramp_up_s, profile.braking_s());
            let end = brake + profile.ramp_down_s;
            let part = if t <= 0.0 || t >= end {
                0.0
            } else if t < up.min(brake) {
                t / up
            } else if t < brake {
                1.0
            } else {
                (end - t) / profile.ramp_down_s
            };
            profile.speed_deg_s * part
        };
        let step = 1e-6;
        let (mut demand, mut shaft, mut rate) = (profile.from_deg, profile.from_deg, 0.0);
        for k in 0..(until_s / step).round() as i64 {
            let before = demand;
            demand += speed((k as f64 + 0.5) * step) * step;
            if profile.inertia_s2 > 0.0 {
                rate += (0.5 * (before + demand) - shaft - profile.lag_s * rate)
                    / profile.inertia_s2
                    * step;
                shaft += rate * step;
            } else if profile.lag_s > 0.0 {
                shaft += (0.5 * (before + demand) - shaft) * -f64::exp_m1(-step / profile.lag_s);
            } else {
                shaft = demand;
            }
        }
        shaft
    }

    #[test]
    fn the_closed_form_is_the_servo_stepped_through() {
        for lag_s in [0.0, 1e-3, 0.0106, 0.08] {
            for ramp_up_s in [0.02, 0.1125] {
                let profile = Profile {
                    lag_s,
                    ramp_up_s,
                    ramp_down_s: 0.2,
                    ..card()
                };
                for until in [0.11, 0.15, 0.3, 0.85, 0.95, 1.2] {
                    let off = profile.angle_deg(until) - stepped(&profile, until);
                    assert!(off.abs() < 2e-4, "{profile:?} at {until}: {off}");
                }
            }
        }
    }

    prop_compose! {
        fn any_profile()(
            start_s in -1.0..1.0f64,
            speed_deg_s in prop_oneof![0.05..100.0f64, -100.0..-0.05f64],
            ramp_up_s in prop_oneof![1e-6..1e-3f64, 1e-3..0.5f64],
            ramp_down_s in prop_oneof![1e-6..1e-3f64, 1e-3..0.5f64],
            from_deg in -180.0..180.0f64,
            cruise_s in 1e-3..900.0f64,
            lag_s in prop_oneof![Just(0.0), 1e-5..0.1f64],
            swings in prop_oneof![Just(0.0), 0.3..3.0f64],
        ) -> Profile {
            let way_deg = speed_deg_s * (cruise_s + (ramp_up_s + ramp_down_s) / 2.0);
            Profile { start_s, speed_deg_s, ramp_up_s, ramp_down_s, from_deg, way_deg, lag_s, inertia_s2: (swings * lag_s).powi(2) }
        }
    }

    proptest! {
        #[test]
        fn derivatives_are_differences(profile in any_profile(), part in -0.05..1.2f64) {
            // Away from the corners, where a difference reaches over.
            let at = profile.start_s + part * profile.duration_s();
            let near = profile.corners_s().iter().any(|corner| (corner - at).abs() < 1e-5);
            prop_assume!(!near && profile.ramp_up_s > 1e-4 && profile.ramp_down_s > 1e-4);
            let (angle, gradient) = profile.with_gradient(at);
            prop_assert_eq!(angle, profile.angle_deg(at));
            let h = 1e-6;
            let moved = |change: fn(&mut Profile) -> &mut f64, i: usize| {
                let [mut low, mut high] = [profile; 2];
                *change(&mut low) -= h;
                *change(&mut high) += h;
                let difference = (high.angle_deg(at) - low.angle_deg(at)) / (2.0 * h);
                let off = (difference - gradient[i]).abs();
                off <= 1e-4 * (1.0 + gradient[i].abs() + profile.speed_deg_s.abs() / profile.ramp_up_s.min(profile.ramp_down_s).min(profile.lag_s.max(1e-3)) * 0.1)
            };
            prop_assert!(moved(|p| &mut p.start_s, 0));
            prop_assert!(moved(|p| &mut p.ramp_up_s, 2));
            prop_assert!(moved(|p| &mut p.ramp_down_s, 3));
            prop_assert!(moved(|p| &mut p.from_deg, 4));
            prop_assert!(moved(|p| &mut p.way_deg, 5));
            if profile.lag_s > 1e-5 {
                prop_assert!(profile.inertia_s2 > 0.0 || moved(|p| &mut p.lag_s, 6));
            }
            if at - profile.start_s < 20.0 {
                prop_assert!(moved(|p| &mut p.speed_deg_s, 1));
            }
        }

        #[test]
        fn rest_before_and_the_whole_way_after(profile in any_profile()) {
            prop_assert_eq!(profile.angle_deg(profile.start_s - 1.0), profile.from_deg);
            let after = profile.start_s + profile.duration_s() + 40.0 * profile.lag_s.max(20.0 * profile.inertia_s2 / profile.lag_s.max(1e-9)) + 1e-9;
            let end = profile.from_deg + profile.way_deg;
            prop_assert!((profile.angle_deg(after) - end).abs() < 1e-9 + 1e-13 * profile.way_deg.abs());
        }
    }
}
