//! Response of a servo of second order.

use super::Ramp;

/// A servo 1 / (1 + b1 s + b2 s^2). It follows a demand of unit speed from 0 on as t - b1 + g(t),
/// where g solves b2 g" + b1 g' + g = 0 with g(0) = b1 and g'(0) = -1. With C and S the cosine and
/// the sine over w, a = b1 / (2 b2) and w2 = 1/b2 - a^2, which may be negative, g = exp(-a t) (b1 C
/// + (a b1 - 1) S).
struct SecondOrderServo {
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

impl SecondOrderServo {
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
        // Two poles: the slow one's rate is the product, 1/b2, over the fast one's, which avoids
        // cancellation.
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

    /// g, its integral, and the integral's derivatives by lag and inertia. Those of C and S by a
    /// and w2 are -t C, -t S, -t S / 2 and (t C - S) / (2 w2), and a and w2 are functions of both.
    fn behind_with_gradient(&self, t: f64) -> LagResponse {
        if t <= 0.0 {
            return LagResponse::default();
        }
        if self.w2 > 0.0 && self.a * t > OVER {
            return LagResponse {
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
            // Series, as the difference would cancel.
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
        LagResponse {
            g,
            sum,
            by_lag,
            by_inertia,
        }
    }
}

/// g, its integral, and the integral's derivatives.
#[derive(Clone, Copy, Debug, Default)]
struct LagResponse {
    g: f64,
    sum: f64,
    by_lag: f64,
    by_inertia: f64,
}

/// Decay times after which the response is over: exp(-40) is negligible.
const OVER: f64 = 40.0;
/// Below it (t C - S) / (2 w2) is a series: three terms are good to 1e-11 there, as is the
/// difference above.
const SMALL_PHASE: f64 = 1e-2;

/// Position and speed behind a ramp of `length` seconds.
pub(super) fn answer(demand: &Ramp, since: f64, length: f64, lag: f64, inertia: f64) -> (f64, f64) {
    let servo = SecondOrderServo::new(lag, inertia);
    let (g, sum) = servo.behind(since);
    let (g_after, sum_after) = servo.behind(since - length);
    let acceleration = if since < length { 1.0 / length } else { 0.0 };
    (
        demand.position - lag * demand.rate + (sum - sum_after) / length,
        demand.rate - lag * acceleration + (g - g_after) / length,
    )
}

pub(super) fn behind(demand: Ramp, since: f64, length: f64, lag: f64, inertia: f64) -> Ramp {
    let servo = SecondOrderServo::new(lag, inertia);
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
