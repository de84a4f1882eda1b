//! Timing of alternatives in rounds: they run in turns, and each round starts with another one, so
//! that other load on the machine affects all of them.

use serde::Serialize;
use units::{Host, Span, Stamp};
use utoipa::ToSchema;

use super::StudyError;

/// Median and extremes of repeated measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct TimingSpread {
    /// Median; of an even number the mean of the two in the middle.
    pub median: f64,
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
    /// Number of measurements.
    pub runs: usize,
}

impl TimingSpread {
    /// The spread of measurements in any order; NaN without any.
    #[must_use]
    pub fn of(mut measured: Vec<f64>) -> Self {
        measured.sort_by(f64::total_cmp);
        let runs = measured.len();
        let at = |i: usize| measured.get(i).copied().unwrap_or(f64::NAN);
        Self {
            median: f64::midpoint(at(runs.saturating_sub(1) / 2), at(runs / 2)),
            min: at(0),
            max: at(runs.saturating_sub(1)),
            runs,
        }
    }

    /// All values multiplied by `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            median: self.median * factor,
            min: self.min * factor,
            max: self.max * factor,
            runs: self.runs,
        }
    }
}

/// The work of one alternative.
pub type Work<'a> = Box<dyn FnMut() -> Result<(), StudyError> + 'a>;

/// Rounds and length of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimingPlan {
    /// Measurements of each alternative.
    pub rounds: usize,
    /// Smallest duration of a measurement; shorter work is repeated.
    pub least: Span,
}

/// The largest number of repetitions.
const MOST_REPEATS: i64 = 100_000;

/// Seconds of each work. Each runs once beforehand, to warm up and to determine the number of
/// repetitions.
///
/// # Errors
/// The first error of any work.
pub fn in_rounds(
    clock: &mut dyn FnMut() -> Stamp<Host>,
    plan: TimingPlan,
    work: &mut [Work<'_>],
) -> Result<Vec<TimingSpread>, StudyError> {
    let mut repeats = Vec::with_capacity(work.len());
    for work in work.iter_mut() {
        let took = time(clock, 1, work)?.as_nanos().max(1);
        repeats.push((plan.least.as_nanos() / took).clamp(1, MOST_REPEATS));
    }
    let mut measured = vec![Vec::with_capacity(plan.rounds); work.len()];
    for round in 0..plan.rounds {
        for turn in 0..work.len() {
            let i = (round + turn) % work.len();
            if let (Some(work), Some(&repeats), Some(measured)) =
                (work.get_mut(i), repeats.get(i), measured.get_mut(i))
            {
                let took = time(clock, repeats, work)?;
                measured.push(took.as_nanos() as f64 * 1e-9 / repeats as f64);
            }
        }
    }
    Ok(measured.into_iter().map(TimingSpread::of).collect())
}

fn time(
    clock: &mut dyn FnMut() -> Stamp<Host>,
    repeats: i64,
    work: &mut Work<'_>,
) -> Result<Span, StudyError> {
    let start = clock();
    for _ in 0..repeats {
        work()?;
    }
    Ok(clock().saturating_since(start))
}

#[cfg(test)]
mod tests {
    use std::cell::{Cell, RefCell};

    use super::*;

    #[test]
    fn timings_have_median_minimum_and_maximum() {
        let odd = TimingSpread::of(vec![3.0, 1.0, 2.0]);
        assert_eq!((odd.median, odd.min, odd.max, odd.runs), (2.0, 1.0, 3.0, 3));
        let even = TimingSpread::of(vec![4.0, 1.0, 2.0, 9.0]).times(10.0);
        assert_eq!((even.median, even.min, even.max), (30.0, 10.0, 90.0));
        assert!(TimingSpread::of(Vec::new()).median.is_nan());
    }

    /// Two tasks that advance the clock by 3 us and 1 ms.
    #[test]
    fn short_work_is_repeated_and_rounds_rotate_their_order() {
        let now = Cell::new(0_i64);
        let log = RefCell::new(Vec::new());
        let work = |name: char, ns: i64| -> Work<'_> {
            let (now, log) = (&now, &log);
            Box::new(move || {
                now.set(now.get() + ns);
                log.borrow_mut().push(name);
                Ok(())
            })
        };
        let plan = TimingPlan {
            rounds: 4,
            least: Span::from_micros(12),
        };
        let mut clock = || Stamp::from_nanos(now.get());
        let mut works = [work('a', 3_000), work('b', 1_000_000)];
        let spreads = in_rounds(&mut clock, plan, &mut works).unwrap();
        assert!((spreads[0].median - 3e-6).abs() < 1e-15);
        assert!((spreads[1].max - 1e-3).abs() < 1e-12);
        assert_eq!((spreads[0].runs, spreads[1].runs), (4, 4));
        let log: String = log.borrow().iter().collect();
        assert_eq!(log, "ab aaaab baaaa aaaab baaaa".replace(' ', ""));
    }

    #[test]
    fn failing_work_ends_the_measurement() {
        let mut calls = 0;
        let mut works: [Work<'_>; 1] = [Box::new(|| {
            calls += 1;
            Err(StudyError::workload("broken"))
        })];
        let plan = TimingPlan {
            rounds: 3,
            least: Span::ZERO,
        };
        let error = in_rounds(&mut || Stamp::from_nanos(0), plan, &mut works);
        assert_eq!(error.unwrap_err().to_string(), "workload: broken");
        drop(works);
        assert_eq!(calls, 1);
    }
}
