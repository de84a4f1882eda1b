//! The age of samples: a drive may copy its encoder's counter into the position (6064) once per
//! control cycle. No manual says whether it does.
//!
//! Then the instants at which the fitted curve has the samples' angles lie on a grid of the cycle,
//! while the polls do not. Where the polls lie near such a grid too, positions that lack the jitter
//! of the polls, or ages that jump by a cycle, still show it. Where none does, or where a cycle is
//! less than an encoder count, the samples cannot show it, and the age is unknown from zero to a
//! cycle.

use units::Span;

use super::bound::BOUND_SDS;
/// Control cycle of an EPOS2, and greatest age of a position.
pub(super) const CYCLE_S: f64 = 1e-3;
/// Samples per window: short, as the drive's clock drifts.
pub(super) const WINDOW: usize = 48;
/// Mean resultant lengths above which instants lie on a grid, and below which they do not.
const ON_GRID: f64 = 0.7;
const OFF_GRID: f64 = 0.45;
/// Ages explain the residuals, or the residuals exclude them, by this ratio of variances.
const DECISIVE: f64 = 3.0;
/// Error of instants by the drive's own timing, seconds.
const UNCERTAINTY_S: f64 = 20e-6;
pub(super) const RENEWAL_BOUND: Span = Span::from_micros(20);
/// Samples whose bound exceeds the median by this factor are left out: their instant is unknown.
const MAX_BOUND: f64 = 1.5;
/// Instants lie on a grid about which polls scatter, if the circular variance of polls is greater
/// by this ratio.
const SHARPER: f64 = 8.0;
/// Least circular variance of polls that scatter: by 7 us.
const MIN_SCATTER: f64 = 1e-3;
/// Greatest duration of an encoder count at which a grid is visible.
pub(super) const MAX_COUNT_S: f64 = 0.3e-3;

/// Greatest shift of the angles to the middle of the possible ages, where the samples cannot show a
/// latch, encoder counts.
const MAX_SHIFT_COUNTS: f64 = 2.0;

/// Residual of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    pub at_s: f64,
    pub off_deg: f64,
    pub rate_deg_s: f64,
    pub bound_s: f64,
    /// Standard deviation of the curve there.
    pub curve_sd_deg: f64,
}

impl Residual {
    /// From the sample to the instant at which the curve has its angle, seconds.
    pub fn late_s(&self) -> f64 {
        self.off_deg / self.rate_deg_s
    }
}

/// Evidence of a latch in samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LatchEvidence {
    /// Positions are renewed once per cycle.
    Present,
    /// Positions are those of the instant of sampling.
    Absent,
    /// The samples do not show it.
    Unknown,
}

/// Residuals in the faster half of a sweep: at rest an angle has no instant.
fn quick(residuals: &[Residual]) -> Vec<Residual> {
    let rate = |r: &Residual| r.rate_deg_s.abs();
    let fastest = residuals.iter().map(rate).fold(0.0, f64::max);
    let quick = residuals.iter().filter(|r| rate(r) > fastest / 2.0);
    quick.copied().collect()
}

/// Evidence of a latch in `residuals` of a curve of few parameters.
pub(super) fn evidence(residuals: &[Residual], angle_sd_deg: f64) -> LatchEvidence {
    let quick = quick(residuals);
    let fastest = quick.iter().map(|r| r.rate_deg_s.abs()).fold(0.0, f64::max);
    let count_s = angle_sd_deg * f64::sqrt(12.0) / fastest;
    if quick.len() < WINDOW || count_s > MAX_COUNT_S {
        return LatchEvidence::Unknown;
    }
    // Requests at a multiple of the cycle, or answers, put the instants on a grid without a latch.
    let polls = [-1.0, 0.0, 1.0]
        .map(|end| resultant(&quick, |r| r.at_s + end * r.bound_s))
        .into_iter()
        .fold(0.0, f64::max);
    let instants = resultant(&quick, |r| r.at_s + r.late_s());
    if instants > ON_GRID && (1.0 - instants).max(MIN_SCATTER) * SHARPER < 1.0 - polls {
        LatchEvidence::Present
    } else if polls > OFF_GRID {
        evidence_of_ages(&quick, count_s)
    } else if instants > ON_GRID {
        LatchEvidence::Present
    } else if instants < OFF_GRID {
        LatchEvidence::Absent
    } else {
        LatchEvidence::Unknown
    }
}

/// Evidence of a latch in residuals if the instants of sampling are known to less than a cycle.
/// Residuals of a latch are the ages of the samples, up to the phase of the cycle.
fn evidence_of_ages(residuals: &[Residual], count_s: f64) -> LatchEvidence {
    let unseen = (count_s * count_s / 12.0 + UNCERTAINTY_S * UNCERTAINTY_S) * WINDOW as f64;
    let (mut plain, mut aged) = (0.0, 0.0);
    for window in residuals.chunks_exact(WINDOW) {
        let bound_s = MAX_BOUND * median_bound_s(window);
        let sharp: Vec<&Residual> = window.iter().filter(|r| r.bound_s <= bound_s).collect();
        plain += unseen + square_deviations(sharp.iter().map(|r| r.late_s()));
        // Between two samples every phase is alike.
        let beginning_at = |phase: &&Residual| {
            let age = |r: &Residual| {
                let cycles = (r.at_s - phase.at_s) / CYCLE_S;
                (cycles - cycles.floor()) * CYCLE_S
            };
            square_deviations(sharp.iter().map(|r| r.late_s() + age(r)))
        };
        aged += unseen + sharp.iter().map(beginning_at).fold(f64::INFINITY, f64::min);
    }
    if aged * DECISIVE < plain {
        LatchEvidence::Present
    } else if plain * DECISIVE < aged {
        LatchEvidence::Absent
    } else {
        LatchEvidence::Unknown
    }
}

fn median_bound_s(residuals: &[Residual]) -> f64 {
    let mut bounds: Vec<f64> = residuals.iter().map(|r| r.bound_s).collect();
    bounds.sort_by(f64::total_cmp);
    bounds.get(bounds.len() / 2).copied().unwrap_or_default()
}

/// Sum of the squared deviations from the mean.
fn square_deviations(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    values.map(|value| (value - mean).powi(2)).sum()
}

/// Mean resultant length (Rayleigh) of instants in the cycle, over windows: 1 on a grid.
fn resultant(residuals: &[Residual], instant: impl Fn(&Residual) -> f64) -> f64 {
    let windows = residuals.chunks_exact(WINDOW);
    let count = windows.len() as f64;
    let lengths = windows.map(|window| {
        let (cosine, sine) = mean_direction(window, &instant);
        f64::hypot(cosine, sine) / WINDOW as f64
    });
    lengths.sum::<f64>() / count
}

/// Sums of the directions of instants in the cycle.
pub(super) fn mean_direction(
    window: &[Residual],
    instant: impl Fn(&Residual) -> f64,
) -> (f64, f64) {
    window.iter().fold((0.0, 0.0), |(cosine, sine), residual| {
        let phase = (instant(residual) / CYCLE_S).fract() * std::f64::consts::TAU;
        (cosine + phase.cos(), sine + phase.sin())
    })
}

/// A shift of the curve, and limits of the delay that remains common to all samples. Each was taken
/// within its bound and is at most a cycle old; its residual shows when the axis was at its angle,
/// within half an encoder count and the error of the curve.
pub(super) fn delay(
    residuals: &[Residual],
    latch: LatchEvidence,
    angle_sd_deg: f64,
    curve_sd_deg: f64,
) -> (Span, (Span, Span)) {
    let quick = quick(residuals);
    let half_count_deg = angle_sd_deg * f64::sqrt(3.0);
    // Samples without a bound are the truth.
    let is_bounded = quick.iter().any(|r| r.bound_s > 0.0);
    let age_s = if is_bounded && latch != LatchEvidence::Absent {
        CYCLE_S
    } else {
        0.0
    };
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for residual in &quick {
        let curve_sd_deg = curve_sd_deg.max(residual.curve_sd_deg);
        let slack_deg = half_count_deg + BOUND_SDS * curve_sd_deg;
        let reach_s = residual.bound_s + slack_deg / residual.rate_deg_s.abs();
        low = low.max(-reach_s - age_s - residual.late_s());
        high = high.min(reach_s - residual.late_s());
    }
    if !low.is_finite() || !high.is_finite() {
        return (Span::ZERO, (Span::ZERO, Span::ZERO));
    }
    // In conflict, no sample can be believed more than its own bound, and the conflict is an error.
    if high < low {
        let conflict = low - high;
        let bound = median_bound_s(&quick);
        (low, high) = (-bound - age_s - conflict, bound + conflict);
    }
    let fastest = quick.iter().map(|r| r.rate_deg_s.abs()).fold(0.0, f64::max);
    let is_small = 0.5 * age_s * fastest <= MAX_SHIFT_COUNTS * 2.0 * half_count_deg;
    let shift = match latch {
        LatchEvidence::Present => f64::midpoint(low, high),
        LatchEvidence::Unknown if is_small => f64::midpoint(low, high),
        LatchEvidence::Unknown | LatchEvidence::Absent => 0.0,
    };
    let limits = (
        Span::from_secs_f64((low - shift).min(0.0)),
        Span::from_secs_f64((high - shift).max(0.0)),
    );
    (Span::from_secs_f64(shift), limits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals of a drive that renews its position at a phase of the cycle, if it does, polled at
    /// instants with that jitter, at 50 deg/s.
    fn residuals(period_s: f64, jitter_s: f64, latch_phase: Option<f64>) -> Vec<Residual> {
        let polled = (0..960).map(|i| {
            // Numbers that look drawn at random: the golden ratio's multiples.
            let drawn = (f64::from(i) * 0.618_033_988_749_895).fract();
            let at_s = f64::from(i) * period_s + jitter_s * drawn;
            let age_s = latch_phase.map_or(0.0, |phase| (at_s - phase).rem_euclid(CYCLE_S));
            Residual {
                at_s,
                off_deg: 50.0 * (0.4e-3 - age_s),
                rate_deg_s: 50.0,
                bound_s: 0.2e-3,
                curve_sd_deg: 0.0,
            }
        });
        polled.collect()
    }

    #[test]
    fn polls_of_any_phase_show_whether_positions_are_latched() {
        let seen = |latch| evidence(&residuals(2.513e-3, 0.1e-3, latch), 0.0004);
        assert_eq!(seen(Some(0.2e-3)), LatchEvidence::Present);
        assert_eq!(seen(None), LatchEvidence::Absent);
    }

    /// Polls as by SYNCs of 1 kHz: their ages jump by a cycle if their jitter crosses its end.
    /// Where it does not, positions lack their jitter.
    #[test]
    fn polls_in_step_with_the_cycle_show_a_latch_by_their_jitter() {
        let seen = |latch| evidence(&residuals(1e-3, 0.1e-3, latch), 0.0004);
        assert_eq!(seen(Some(0.05e-3)), LatchEvidence::Present);
        assert_eq!(seen(Some(0.5e-3)), LatchEvidence::Present);
        assert_eq!(seen(None), LatchEvidence::Unknown);
        // Without jitter nothing shows it.
        let regular = residuals(1e-3, 0.0, Some(0.5e-3));
        assert_eq!(evidence(&regular, 0.0004), LatchEvidence::Unknown);
    }

    /// Polls that scatter about the end of a cycle, and whose midpoints are as uncertain: the order
    /// of their ages is unknown, but the instants of the positions are a cycle apart.
    #[test]
    fn instants_on_a_grid_about_which_polls_scatter_show_a_latch() {
        let seen = |is_latched: bool| {
            let mut samples = residuals(1e-3, 0.0, None);
            for (i, sample) in (0..).zip(&mut samples) {
                let drawn = |factor: f64| (f64::from(i) * factor).fract() - 0.5;
                let (taken, midpoint) = (drawn(0.618_033_99), drawn(0.414_213_56));
                let taken_s = 0.2e-3 * taken;
                let age_s = match is_latched {
                    true => taken_s.rem_euclid(CYCLE_S),
                    false => 0.0,
                };
                let midpoint_s = taken_s + 0.1e-3 * midpoint;
                sample.at_s += midpoint_s;
                sample.off_deg = 50.0 * (taken_s - age_s - midpoint_s);
                sample.bound_s = 0.15e-3;
            }
            evidence(&samples, 0.0004)
        };
        assert_eq!(seen(true), LatchEvidence::Present);
        assert_ne!(seen(false), LatchEvidence::Present);
    }

    /// A quantised position says when the axis passed it only to within a count.
    #[test]
    fn the_limits_contain_a_delay_at_their_end_however_slow_the_axis_is() {
        let count_deg = 0.0015;
        for rate_deg_s in [0.5, 7.0, 50.0] {
            for delay_s in [-0.2e-3, 0.2e-3] {
                let mut samples = residuals(2.5e-3, 0.0, None);
                for (i, sample) in (0..).zip(&mut samples) {
                    let drawn = (f64::from(i) * 0.618_033_99).fract() - 0.5;
                    sample.off_deg = count_deg * drawn;
                    sample.rate_deg_s = rate_deg_s;
                    // All were taken as early, or as late, as their bounds allow.
                    sample.bound_s = 0.2e-3;
                }
                let sd = count_deg / f64::sqrt(12.0);
                let (_, (low, high)) = delay(&samples, LatchEvidence::Absent, sd, 0.0);
                let (low, high) = (low.as_secs_f64(), high.as_secs_f64());
                let what = format!("{rate_deg_s} deg/s: {low} to {high}");
                assert!((low - 1e-6..=high + 1e-6).contains(&delay_s), "{what}");
                // Quantisation is no conflict: it does not widen them.
                assert!(low > -0.3e-3 && high < 0.3e-3, "{what}");
            }
        }
    }

    /// A curve that deviates from the samples in a part of the sweep, by as much as its error says:
    /// those samples exclude no delay that the others allow.
    #[test]
    fn the_limits_contain_each_possible_delay_though_the_curve_misfits() {
        for sign in [-1.0, 1.0] {
            let mut samples = residuals(2.513e-3, 0.1e-3, Some(0.3e-3));
            for (i, sample) in samples.iter_mut().enumerate() {
                sample.off_deg += if i % 240 < 40 { sign * 0.01 } else { 0.0 };
            }
            // All were taken as early, or as late, as their bounds allow.
            let contains = |curve_sd_deg: f64| {
                let (shift, (low, high)) =
                    delay(&samples, LatchEvidence::Present, 0.0, curve_sd_deg);
                let delays = [-0.6e-3, -0.2e-3].map(|delay| delay - shift.as_secs_f64());
                let is_inside = |delay: f64| {
                    low.as_secs_f64() - 20e-6 <= delay && delay <= high.as_secs_f64() + 20e-6
                };
                delays.into_iter().all(is_inside)
            };
            assert!(contains(0.01 / BOUND_SDS) && !contains(0.0), "{sign}");
        }
    }

    /// Samples whose instants exclude each other give wider limits than each of them does.
    #[test]
    fn conflicting_evidence_widens_the_limits() {
        let mut samples = residuals(2.513e-3, 0.1e-3, None);
        for sample in &mut samples {
            sample.off_deg = 0.0;
        }
        let limits = |samples: &[Residual]| {
            let (_, (low, high)) = delay(samples, LatchEvidence::Absent, 0.0, 0.0);
            [low, high].map(Span::as_secs_f64)
        };
        let [low, high] = limits(&samples);
        assert!((low + 0.2e-3).abs() < 1e-6 && (high - 0.2e-3).abs() < 1e-6);
        // Every second one comes 1 ms later than the bounds of all allow.
        for sample in samples.iter_mut().step_by(2) {
            sample.off_deg = 50.0 * 1e-3;
        }
        let [low, high] = limits(&samples);
        assert!(low <= -0.8e-3 && high >= 0.8e-3, "{low} to {high}");
    }
}
