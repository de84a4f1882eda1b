//! Comparison of a stopping axis with the ramp of its quick stop.
//!
//! The speed at the stop is measured, as the axis may move otherwise than planned.

use units::{Degrees, Quadcounts, Span};

use crate::config::AxisConfig;
use crate::event::ShaftSample;

/// Time over which the speed is measured.
const SPEED_SPAN: Span = Span::from_millis(12);
/// Share of the overshoot at the end of a move (`ahead`) that a stop may have: a servo overshoots
/// less than the tolerance for deviations from a whole move.
const OVERSHOOT_SHARE: f64 = 0.2;

/// Compares the samples after a quick stop with its ramp.
pub(super) struct QuickStopRamp {
    deg_per_qc: f64,
    /// Deceleration, deg/s2.
    deceleration: f64,
    /// Greatest distance of the axis beyond the ramp, degrees.
    tolerance: f64,
    first: Option<ShaftSample>,
    /// Speed at the first sample, deg/s.
    speed: Option<f64>,
    /// The previous sample was beyond the ramp.
    is_suspicious: bool,
}

impl QuickStopRamp {
    /// The ramp of an axis that lagged behind its demand; by default as far as allowed.
    pub fn new(config: &AxisConfig, lag: Option<Degrees>) -> Self {
        let (gearing, guard) = (config.gearing, config.guard);
        let max_speed = gearing.rate(config.max_speed).0;
        let lag = lag.map_or(max_speed * guard.servo_lag.as_secs_f64(), |lag| lag.0);
        let rate = max_speed / f64::from(config.max_speed.0);
        Self {
            deg_per_qc: gearing.angle(Quadcounts(1)).0,
            deceleration: rate * f64::from(config.quick_stop.0),
            tolerance: OVERSHOOT_SHARE * guard.ahead.0 + config.standstill_spread.0 + lag,
            first: None,
            speed: None,
            is_suspicious: false,
        }
    }

    /// Whether the sample and the one before are beyond the ramp. A single one may be a damaged
    /// reply.
    pub fn is_left_by(&mut self, sample: &ShaftSample) -> bool {
        let Some(first) = self.first else {
            self.first = Some(*sample);
            return false;
        };
        let counts = f64::from(sample.position.0) - f64::from(first.position.0);
        let moved = counts.abs() * self.deg_per_qc;
        // The drive takes each sample at about the same time between request and answer. Where one
        // of them was delayed, the time between the samples is a range.
        let since_request = sample.request.saturating_since(first.request);
        let since_answer = sample.answer.saturating_since(first.answer);
        let least = since_request.min(since_answer).as_secs_f64();
        let seconds = since_request.max(since_answer).as_secs_f64();
        if least < SPEED_SPAN.as_secs_f64() {
            return false;
        }
        // The ramp may already have begun.
        let speed = *self
            .speed
            .get_or_insert(moved / least + self.deceleration * seconds / 2.0);
        let on_ramp = seconds.min(speed / self.deceleration);
        let most = on_ramp * (speed - self.deceleration * on_ramp / 2.0);
        let is_beyond = moved > most + self.tolerance;
        std::mem::replace(&mut self.is_suspicious, is_beyond) && is_beyond
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event::SampleTrigger;
    use units::{RpmPerS, Stamp};

    /// Milliseconds and degrees at which an axis with 56.25 deg/s leaves its ramp of 500 deg/s2,
    /// polled every `period_ms`.
    fn left_at(period_ms: i64, angle: impl Fn(f64) -> f64) -> Option<(i64, f64)> {
        let config = AxisConfig {
            quick_stop: RpmPerS(10_000),
            ..AxisConfig::default()
        };
        let mut ramp = QuickStopRamp::new(&config, Some(Degrees(0.0)));
        let mut polls = (0..2_000).step_by(period_ms as usize);
        polls.find_map(|ms| {
            let at = Stamp::from_nanos(ms * 1_000_000);
            let angle = angle(ms as f64 / 1e3);
            ramp.is_left_by(&ShaftSample {
                request: at,
                answer: at,
                position: Quadcounts((angle / 0.0015).round() as i32),
                trigger: SampleTrigger::Request,
                drive_us: None,
            })
            .then_some((ms, angle))
        })
    }

    fn braking(t: f64) -> f64 {
        let t = t.clamp(0.0, 56.25 / 500.0);
        56.25 * t - 250.0 * t * t
    }

    #[test]
    fn an_axis_on_its_ramp_passes() {
        for period_ms in [1, 3, 15] {
            for delay in [0.0, 0.005] {
                let angle = |t: f64| 56.25 * t.min(delay) + braking(t - delay);
                assert_eq!(left_at(period_ms, angle), None, "{period_ms} ms, {delay} s");
                assert_eq!(left_at(period_ms, |t| -angle(t)), None);
            }
        }
    }

    #[test]
    fn an_axis_that_moves_on_is_found_within_3_deg() {
        for period_ms in [1, 3, 8] {
            let (ms, angle) = left_at(period_ms, |t| 56.25 * t).unwrap();
            assert!(
                ms <= 64 && angle <= 3.6,
                "{period_ms} ms: {ms} ms, {angle} deg"
            );
        }
    }

    #[test]
    fn creeping_is_found() {
        let (ms, _) = left_at(1, |t| braking(t) + 2.0 * t).unwrap();
        assert!(ms < 400, "{ms} ms");
    }

    #[test]
    fn an_axis_at_rest_passes() {
        assert_eq!(left_at(1, |t| 0.012 * (t * 700.0).sin()), None);
    }
}
