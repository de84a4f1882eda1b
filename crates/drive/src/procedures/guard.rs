//! Comparison of the moving axis with its plan.
//!
//! The drive generates the profile from its own counts. A wrong encoder polarity, a slipping
//! coupling, a frozen position or a defective drive shows only in the samples, so every sample is
//! compared with the plan. The time of a sample and the start of the profile are known as ranges;
//! the expected positions are those of all times in these ranges. The times are those of a clock
//! that never steps.

use units::{Degrees, Host, Span, Stamp};

use crate::config::AxisConfig;
use crate::error::{Deviation, DriveError};
use crate::event::ShaftSample;
use crate::plan::MovePlan;

/// Time of a reply up to which a deviation is confirmed by a second one: the stop leaves within
/// 50 ms of the sample that shows it.
const CONFIRMATION: Span = Span::from_millis(40);
/// Longest time from the receipt of the command to the start of the profile: some control cycles.
const START_DELAY: Span = Span::from_millis(10);
/// Share by which the drive's clock may differ from the host's, in progress of the move.
const CLOCK_SHARE: f64 = 0.002;

/// Compares samples with the plan of a move.
pub(super) struct MotionGuard {
    plan: MovePlan,
    /// The profile starts between these times.
    sent: Stamp<Host>,
    acknowledged: Stamp<Host>,
    behind: f64,
    ahead: f64,
    lowest: f64,
    highest: f64,
    /// Whether the latest sample and the one before it deviated.
    deviated: [bool; 2],
    /// Lag of the latest sample behind the plan.
    pub lag: Degrees,
}

impl MotionGuard {
    /// A guard of a move whose command was sent and acknowledged at these times.
    pub fn new(
        config: &AxisConfig,
        plan: MovePlan,
        sent: Stamp<Host>,
        acknowledged: Stamp<Host>,
    ) -> Self {
        let guard = &config.guard;
        let dither = config.standstill_spread.0;
        Self {
            plan,
            sent,
            acknowledged: acknowledged.saturating_add(START_DELAY),
            behind: guard.behind.0 + plan.cruise.0 * guard.servo_lag.as_secs_f64() + dither,
            ahead: guard.ahead.0 + dither,
            // A move may begin beyond a limit, where homing or a person has left the axis.
            lowest: config.limits.min.0.min(plan.from.0) - guard.beyond_limits.0 - dither,
            highest: config.limits.max.0.max(plan.from.0) + guard.beyond_limits.0 + dither,
            deviated: [false; 2],
            lag: Degrees(0.0),
        }
    }

    /// The plan of the move.
    pub fn plan(&self) -> &MovePlan {
        &self.plan
    }

    /// Compares a sample at an angle with the plan.
    ///
    /// # Errors
    /// [`DriveError::OffPlan`] at the second deviating sample of three: a single one may be a
    /// damaged reply. Where replies take longer than [`CONFIRMATION`], at the first.
    pub fn check(&mut self, sample: &ShaftSample, angle: Degrees) -> Result<(), DriveError> {
        let since_start = sample.answer.saturating_since(self.sent);
        let lag = self.plan.travelled(since_start).0 - self.progress(angle.0);
        self.lag = Degrees(lag.clamp(0.0, self.behind));
        let deviation = self.deviation(sample, angle.0);
        let is_slow = sample.answer.saturating_since(sample.request) > CONFIRMATION;
        let is_confirmed = is_slow || self.deviated != [false; 2];
        self.deviated = [deviation.is_some(), self.deviated[0]];
        match deviation {
            Some((deviation, expected)) if is_confirmed => Err(DriveError::OffPlan {
                deviation,
                expected: Degrees(expected),
                got: angle,
            }),
            _ => Ok(()),
        }
    }

    /// Whether the latest sample deviated: the next one must follow at once.
    pub const fn is_suspicious(&self) -> bool {
        self.deviated[0]
    }

    /// Distance from the start in the direction of the move, degrees.
    fn progress(&self, angle: f64) -> f64 {
        let plan = &self.plan;
        (angle - plan.from.0) * if plan.to.0 < plan.from.0 { -1.0 } else { 1.0 }
    }

    /// The deviation of a sample, with the angle expected.
    fn deviation(&self, sample: &ShaftSample, angle: f64) -> Option<(Deviation, f64)> {
        let plan = &self.plan;
        let direction = if plan.to.0 < plan.from.0 { -1.0 } else { 1.0 };
        let at = |travelled: f64| plan.from.0 + direction * travelled;
        let progress = self.progress(angle);
        let most = plan.travelled(sample.answer.saturating_since(self.sent)).0;
        let least = plan
            .travelled(sample.request.saturating_since(self.acknowledged))
            .0;
        if angle < self.lowest {
            Some((Deviation::BeyondLimits, self.lowest))
        } else if angle > self.highest {
            Some((Deviation::BeyondLimits, self.highest))
        } else if progress < -self.ahead {
            Some((Deviation::WrongWay, at(least)))
        } else if progress > most * (1.0 + CLOCK_SHARE) + self.ahead {
            Some((Deviation::Ahead, at(most)))
        } else if progress < least * (1.0 - CLOCK_SHARE) - self.behind {
            Some((Deviation::Behind, at(least)))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event::SampleTrigger;
    use units::{DegPerS, DegPerS2, Quadcounts};

    /// 45 deg at 56.25 deg/s from time zero.
    fn guard(from: f64, to: f64) -> MotionGuard {
        let config = AxisConfig::default();
        let plan = config
            .plan(Degrees(from), Degrees(to), DegPerS(56.25), DegPerS2(500.0))
            .unwrap();
        let at = Stamp::from_nanos(0);
        MotionGuard::new(&config, plan, at, at)
    }

    /// A sample of this time; the guard is given its angle.
    fn sample_at(at: Stamp<Host>) -> ShaftSample {
        ShaftSample {
            request: at,
            answer: at,
            position: Quadcounts(0),
            trigger: SampleTrigger::Request,
            drive_us: None,
        }
    }

    /// Checks two samples of this angle, a millisecond apart.
    fn deviation(guard: &mut MotionGuard, ms: i64, angle: f64) -> Option<Deviation> {
        let mut result = Ok(());
        for ms in [ms, ms + 1] {
            let at = Stamp::from_nanos(ms * 1_000_000);
            let sample = sample_at(at);
            result = guard.check(&sample, Degrees(angle));
        }
        match result {
            Err(DriveError::OffPlan { deviation, .. }) => Some(deviation),
            _ => None,
        }
    }

    #[test]
    fn an_axis_on_its_plan_passes() {
        // Exactly, behind a servo that lags by 40 ms, and with an overshoot of 0.3 deg.
        for (lag_ms, overshoot) in [(0, 0.0), (40, 0.0), (0, 0.3)] {
            let mut guard = guard(-45.0, 0.0);
            for ms in 0..2_000 {
                let travelled = guard.plan.travelled(Span::from_millis(ms - lag_ms)).0;
                let angle = -45.0 + travelled + overshoot;
                assert_eq!(deviation(&mut guard, ms, angle), None, "{ms} ms");
            }
        }
    }

    #[test]
    fn each_deviation_is_found_in_both_directions() {
        for sign in [1.0, -1.0] {
            let mut guard = guard(-45.0 * sign, 0.0);
            let on_plan = -45.0 + guard.plan.travelled(Span::from_millis(401)).0;
            let mut found = |ms, angle: f64| deviation(&mut guard, ms, angle * sign);
            assert_eq!(found(100, -45.6), Some(Deviation::WrongWay));
            assert_eq!(found(900, 0.7), Some(Deviation::Ahead));
            assert_eq!(found(400, -20.0), Some(Deviation::Ahead), "it jumps");
            assert_eq!(
                found(400, on_plan + 1.5),
                Some(Deviation::Ahead),
                "it slips"
            );
            assert_eq!(
                found(400, -45.0),
                Some(Deviation::Behind),
                "it stands still"
            );
            assert_eq!(found(900, 60.2), Some(Deviation::BeyondLimits));
        }
    }

    /// Gaps between samples do not hide an axis that stands.
    #[test]
    fn an_axis_that_stands_is_found_behind_gaps() {
        let mut guard = guard(-45.0, 0.0);
        let found = (0..40).find(|n| {
            let at = Stamp::from_nanos(n * 25_000_000);
            let sample = sample_at(at);
            let angle = -45.0 + guard.plan.travelled(Span::from_millis((n * 25).min(400))).0;
            guard.check(&sample, Degrees(angle)).is_err()
        });
        // 3.3 deg at 56.25 deg/s are 60 ms.
        assert!(found.is_some_and(|n| n * 25 < 550), "{found:?}");
    }

    /// On a CAN bus a SYNC may be sent before the answer to the previous one is received, and late
    /// answers are received together.
    #[test]
    fn an_axis_that_stands_is_found_though_samples_overlap() {
        for (late_ms, burst_ms) in [(3, 1), (0, 5)] {
            let mut guard = guard(-45.0, 0.0);
            let found = (0..1_000).find(|ms| {
                let angle = -45.0 + guard.plan.travelled(Span::from_millis(*ms.min(&400))).0;
                let received = (ms + late_ms + burst_ms - 1) / burst_ms * burst_ms;
                let sample = ShaftSample {
                    answer: Stamp::from_nanos(received * 1_000_000 + ms * 1_000),
                    ..sample_at(Stamp::from_nanos(ms * 1_000_000))
                };
                guard.check(&sample, Degrees(angle)).is_err()
            });
            // 3.3 deg at 56.25 deg/s are 60 ms, and the profile may start 10 ms late.
            assert!(found.is_some_and(|ms| ms < 475), "{found:?}");
        }
    }

    #[test]
    fn a_single_deviating_sample_is_ignored() {
        let mut guard = guard(-45.0, 0.0);
        let sample = |ms: i64| sample_at(Stamp::from_nanos(ms * 1_000_000));
        let on_plan = Degrees(-45.0 + guard.plan.travelled(Span::from_millis(300)).0);
        for (ms, angle) in [
            (300, Degrees(40.0)),
            (301, on_plan),
            (302, on_plan),
            (303, Degrees(-60.0)),
            (304, on_plan),
        ] {
            assert_eq!(guard.check(&sample(ms), angle), Ok(()), "{ms} ms");
        }
        // A position that jumps to and fro.
        assert!(guard.check(&sample(305), Degrees(40.0)).is_err());
    }

    #[test]
    fn a_deviation_in_a_slow_reply_needs_no_second_one() {
        let mut guard = guard(-45.0, 0.0);
        let sample = ShaftSample {
            answer: Stamp::from_nanos(350_000_000),
            ..sample_at(Stamp::from_nanos(300_000_000))
        };
        assert!(guard.check(&sample, Degrees(-60.0)).is_err());
    }

    #[test]
    fn a_late_answer_widens_the_expected_range() {
        let mut guard = guard(-45.0, 0.0);
        let sample = ShaftSample {
            request: Stamp::from_nanos(300_000_000),
            answer: Stamp::from_nanos(500_000_000),
            position: Quadcounts(0),
            trigger: SampleTrigger::Request,
            drive_us: None,
        };
        for ms in [300, 400, 500] {
            let angle = Degrees(-45.0 + guard.plan.travelled(Span::from_millis(ms)).0);
            for _ in 0..2 {
                assert_eq!(guard.check(&sample, angle), Ok(()), "{ms} ms");
            }
        }
    }
}
