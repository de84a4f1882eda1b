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
        self.place(at_s).0
    }

    /// Speed at an instant, degrees per second.
    #[must_use]
    pub fn rate_deg_s(&self, at_s: f64) -> f64 {
        self.place(at_s).1
    }

    /// Angle and speed at an instant.
    pub(super) fn place(&self, at_s: f64) -> (f64, f64) {
        let since = at_s - self.start_s;
        let ramp = |since, length| Ramp::place(since, length, self.lag_s, self.inertia_s2);
        let up = ramp(since, self.ramp_up_s);
        let down = ramp(since - self.braking_s(), self.ramp_down_s);
        (
            self.from_deg + self.speed_deg_s * (up.0 - down.0),
            self.speed_deg_s * (up.1 - down.1),
        )
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

    /// Position and speed alone.
    fn place(since: f64, length: f64, lag: f64, inertia: f64) -> (f64, f64) {
        if since <= 0.0 {
            return (0.0, 0.0);
        }
        let demand = Self::demand(since, length);
        if lag <= 0.0 {
            return (demand.position, demand.rate);
        }
        if inertia > 0.0 {
            return swing::answer(&demand, since, length, lag, inertia);
        }
        let missing = Missing::rate(since, length, lag);
        (
            demand.position - lag * (demand.rate - missing),
            demand.rate - missing,
        )
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
            if self.w2 > 0.0 && self.a * t > OVER {
                return (0.0, self.lag * self.lag - self.inertia);
            }
            self.sums(&self.waves(t))
        }

        fn sums(&self, &Waves { c, s }: &Waves) -> (f64, f64) {
            let whole = self.lag * self.lag - self.inertia;
            let g = self.lag * c + (self.a * self.lag - 1.0) * s;
            (g, whole - (whole * c + (self.a * whole - self.lag) * s))
        }

        /// The same, and the integral's derivatives by lag and inertia: those of C and S by a and w2 are -t C, -t S, -t S / 2 and
        /// (t C - S) / (2 w2), and a and w2 are functions of both.
        fn behind_with_gradient(&self, t: f64) -> Behind {
            if t <= 0.0 {
                return Behind::default();
            }
            if self.w2 > 0.0 && self.a * t > OVER {
                return Behind {
                    g: 0.0,
                    sum: self.lag * self.lag - self.inertia,
                    by_lag: 2.0 * self.lag,
                    by_inertia: -1.0,
                };
            }
            let waves = self.waves(t);
            let (g, sum) = self.sums(&waves);
            let Waves { c, s } = waves;
            let Self {
                lag,
                inertia,
                a,
                w2,
            } = *self;
            let phase = w2 * t * t;
            let s_by_w2 = if phase.abs() < SMALL_PHASE {
                // The difference would lose its digits.
                f64::exp(-a * t) * t * t * t * (-1.0 / 6.0 + phase / 60.0 - phase * phase / 1680.0)
            } else {
                (t * c - s) / (2.0 * w2)
            };
            let whole = lag * lag - inertia;
            let by = |a_by: f64, w2_by: f64, whole_by: f64, lag_by: f64| {
                let c_by = -t * c * a_by - t / 2.0 * s * w2_by;
                let s_by = -t * s * a_by + s_by_w2 * w2_by;
                whole_by * (1.0 - c)
                    - whole * c_by
                    - (a_by * whole + a * whole_by - lag_by) * s
                    - (a * whole - lag) * s_by
            };
            let by_lag = by(0.5 / inertia, -a / inertia, 2.0 * lag, 1.0);
            let w2_by_inertia = (2.0 * a * a - 1.0 / inertia) / inertia;
            let by_inertia = by(-a / inertia, w2_by_inertia, -1.0, 0.0);
            Behind {
                g,
                sum,
                by_lag,
                by_inertia,
            }
        }
    }

    /// g, its integral, and that one's derivatives.
    #[derive(Clone, Copy, Debug, Default)]
    struct Behind {
        g: f64,
        sum: f64,
        by_lag: f64,
        by_inertia: f64,
    }

    /// When so many of its decay times have gone by, the answer is over: exp(-40) is nothing beside 1.
    const OVER: f64 = 40.0;
    /// Below it (t C - S) / (2 w2) is a series: three terms are good to 1e-11 there, the difference to as much above.
    const SMALL_PHASE: f64 = 1e-2;

    /// Position and speed behind a ramp of `length` seconds.
    pub(super) fn answer(
        demand: &Ramp,
        since: f64,
        length: f64,
        lag: f64,
        inertia: f64,
    ) -> (f64, f64) {
        let servo = Servo::new(lag, inertia);
        let (g, sum) = servo.behind(since);
        let (g_after, sum_after) = servo.behind(since - length);
        let acceleration = if since < length { 1.0 / length } else { 0.0 };
        (
            demand.position - lag * demand.rate + (sum - sum_after) / length,
            demand.rate - lag * acceleration + (g - g_after) / length,
        )
    }

    pub(super) fn behind(demand: Ramp, since: f64, length: f64, lag: f64, inertia: f64) -> Ramp {
        let servo = Servo::new(lag, inertia);
        let now = servo.behind_with_gradient(since);
        let after = servo.behind_with_gradient(since - length);
        let mean = (now.sum - after.sum) / length;
        let (acceleration, rate_by_ramp) = if since < length {
            (1.0 / length, -demand.rate / length)
        } else {
            (0.0, 0.0)
        };
        Ramp {
            position: demand.position - lag * demand.rate + mean,
            rate: demand.rate - lag * acceleration + (now.g - after.g) / length,
            by_ramp: demand.by_ramp - lag * rate_by_ramp + (after.g - mean) / length,
            by_lag: -demand.rate + (now.by_lag - after.by_lag) / length,
            by_inertia: (now.by_inertia - after.by_inertia) / length,
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
    /// The speed that is missing alone.
    fn rate(since: f64, length: f64, lag: f64) -> f64 {
        if since < length {
            since / length * mean_decay(since / lag)
        } else {
            f64::exp(-(since - length) / lag) * mean_decay(length / lag)
        }
    }

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

    /// The servo's own two, whose closed forms are the least obvious: underdamped, overdamped, and where both poles meet.
    #[test]
    fn derivatives_by_lag_and_inertia_are_differences() {
        for damping in [
            0.1, 0.4, 0.8, 0.999, 0.999_999, 1.0, 1.000_001, 1.001, 1.5, 4.0,
        ] {
            for hertz in [3.0, 15.0, 60.0] {
                let w = hertz * std::f64::consts::TAU;
                let profile = Profile {
                    lag_s: 2.0 * damping / w,
                    inertia_s2: 1.0 / (w * w),
                    ..card()
                };
                for ms in [
                    1, 5, 30, 80, 113, 120, 180, 400, 801, 850, 920, 1_000, 1_500,
                ] {
                    let at = profile.start_s + f64::from(ms) * 1e-3;
                    let (angle, [.., by_lag, by_inertia]) = profile.with_gradient(at);
                    assert!((angle - profile.angle_deg(at)).abs() < 1e-12);
                    let by = |change: fn(&mut Profile) -> &mut f64, step: f64| {
                        let angle = |step: f64| {
                            let mut moved = profile;
                            *change(&mut moved) += step;
                            moved.angle_deg(at)
                        };
                        (angle(step) - angle(-step)) / (2.0 * step)
                    };
                    let said = format!("damping {damping}, {hertz} Hz, {ms} ms");
                    let difference = by(|p| &mut p.lag_s, profile.lag_s * 1e-5);
                    let off = (by_lag - difference).abs();
                    assert!(
                        off < 1e-4 * profile.speed_deg_s.abs(),
                        "{said}: {by_lag} {difference}"
                    );
                    // As the fit has it, by the inertia's root: degrees a second, too.
                    let root = profile.inertia_s2.sqrt();
                    let difference = by(|p| &mut p.inertia_s2, profile.inertia_s2 * 1e-5);
                    let off = 2.0 * root * (by_inertia - difference).abs();
                    assert!(
                        off < 1e-4 * profile.speed_deg_s.abs(),
                        "{said}: {by_inertia} {difference}"
                    );
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
