//! The commanded motion: a trapezoidal speed, behind a servo.
//!
//! Speed rises evenly over `ramp_up_s`, holds, and falls evenly over `ramp_down_s`; without a
//! cruise it is a triangle. The servo's response is 1 / (1 + lag s + inertia s^2): first order
//! without inertia, with inertia it may overshoot. In the cruise the shaft is behind by the lag. A
//! dead time is part of the start.
//!
//! Every function is exact for degenerate parameters: no ramp, no lag, a cruise of a quarter of an
//! hour. `profile_fit` finds the parameters.

mod swing;

/// A profile move of the shaft, in seconds after an origin and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Profile {
    /// Start, seconds.
    pub start_s: f64,
    /// Speed of the cruise, degrees per second; of a triangle the greatest. Signed as the way.
    pub speed_deg_s: f64,
    /// Duration of the acceleration, seconds.
    pub ramp_up_s: f64,
    /// Duration of the deceleration, seconds.
    pub ramp_down_s: f64,
    /// Angle at the start, degrees.
    pub from_deg: f64,
    /// Way, degrees; signed.
    pub way_deg: f64,
    /// Time constant of the servo, seconds; 0 if the shaft follows at once.
    pub lag_s: f64,
    /// Inertia of the servo, seconds squared: 1 / (2 pi f)^2 for a natural frequency f, with
    /// damping lag / (2 sqrt(inertia)); 0 for a servo of first order.
    pub inertia_s2: f64,
}

/// Derivatives of an angle by start, speed, both ramps, beginning, way, lag and inertia, in this
/// order.
pub(super) type Gradient = [f64; 8];

impl Profile {
    /// Time at which the deceleration begins, seconds after the start.
    #[must_use]
    pub fn braking_s(&self) -> f64 {
        self.way_deg / self.speed_deg_s + (self.ramp_up_s - self.ramp_down_s) / 2.0
    }

    /// End of the demand, seconds after the start.
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

    /// Angle at an instant, and its derivatives by the parameters.
    pub(super) fn with_gradient(&self, at_s: f64) -> (f64, Gradient) {
        let (up, down) = self.ramps(at_s);
        let v = self.speed_deg_s;
        // The start of the deceleration moves with way, speed and ramps.
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

    /// Instants at which the form of the demand changes, seconds, in order.
    pub(super) fn corners_s(&self) -> [f64; 4] {
        let brake = self.braking_s();
        [0.0, self.ramp_up_s, brake, brake + self.ramp_down_s].map(|s| self.start_s + s)
    }
}

/// Response to a demand that ramps to unit speed: position in seconds, speed, and derivatives of
/// the position.
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

    /// Response `since` seconds after the beginning of a ramp of `length` seconds, behind a servo.
    fn new(since: f64, length: f64, lag: f64, inertia: f64) -> Self {
        if since <= 0.0 {
            return Self::REST;
        }
        let demand = Self::demand(since, length);
        if lag <= 0.0 {
            // The limit for a vanishing lag: the shaft is behind by speed times lag.
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

    /// The shaft's answer to this demand: less lag x (its speed - m), where m is how much of the
    /// speed is still missing. With x = time / lag and f(x) = (1 - exp(-x)) / x, m is part x f(x)
    /// on the ramp and exp(-x after it) x f(length / lag) behind it.
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

/// Speed still missing behind a lag, and its derivatives.
struct Missing {
    rate: f64,
    by_ramp: f64,
    by_lag: f64,
}

impl Missing {
    /// The missing speed alone.
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
mod tests;
