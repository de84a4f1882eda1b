//! The age of samples: a drive may copy its encoder's counter into the position (6064) once per
//! control cycle. No manual says whether it does.
//!
//! Then the instants at which the fitted curve has the samples' angles lie on a grid of the cycle,
//! while the polls do not. Where the polls lie on such a grid too, or where a cycle is less than an
//! encoder count, the samples cannot show it, and the age is unknown from zero to a cycle.

use units::Span;

/// Control cycle of an EPOS2, and greatest age of a position.
pub(super) const CYCLE_S: f64 = 1e-3;
/// Samples per window: short, as the drive's clock drifts.
const WINDOW: usize = 48;
/// Mean resultant lengths above which instants lie on a grid, and below which they do not.
const ON_GRID: f64 = 0.7;
const OFF_GRID: f64 = 0.45;
/// Greatest duration of an encoder count at which a grid is visible.
const MAX_COUNT_S: f64 = 0.3e-3;

/// Residual of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    pub at_s: f64,
    pub off_deg: f64,
    pub rate_deg_s: f64,
    pub bound_s: f64,
}

impl Residual {
    /// From the sample to the instant at which the curve has its angle, seconds.
    fn late_s(&self) -> f64 {
        self.off_deg / self.rate_deg_s
    }
}

/// What samples show of a latch.
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

/// What `residuals` of a curve of few parameters show.
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
    if polls > OFF_GRID {
        LatchEvidence::Unknown
    } else if instants > ON_GRID {
        LatchEvidence::Present
    } else if instants < OFF_GRID {
        LatchEvidence::Absent
    } else {
        LatchEvidence::Unknown
    }
}

/// Mean resultant length (Rayleigh) of instants in the cycle, over windows: 1 on a grid.
fn resultant(residuals: &[Residual], instant: impl Fn(&Residual) -> f64) -> f64 {
    let windows = residuals.chunks_exact(WINDOW);
    let count = windows.len() as f64;
    let lengths = windows.map(|window| {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for residual in window {
            let phase = (instant(residual) / CYCLE_S).fract() * std::f64::consts::TAU;
            cosine += phase.cos();
            sine += phase.sin();
        }
        f64::hypot(cosine, sine) / WINDOW as f64
    });
    lengths.sum::<f64>() / count
}

/// A shift of the curve, and limits of the delay that remains common to all samples. Each was taken
/// within its bound and is at most a cycle old; its residual shows when the axis was at its angle.
pub(super) fn delay(residuals: &[Residual], latch: LatchEvidence) -> (Span, (Span, Span)) {
    let quick = quick(residuals);
    // Samples without a bound are the truth.
    let is_bounded = quick.iter().any(|r| r.bound_s > 0.0);
    let age_s = if is_bounded && latch != LatchEvidence::Absent {
        CYCLE_S
    } else {
        0.0
    };
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for residual in &quick {
        low = low.max(-residual.bound_s - age_s - residual.late_s());
        high = high.min(residual.bound_s - residual.late_s());
    }
    if !low.is_finite() || !high.is_finite() {
        return (Span::ZERO, (Span::ZERO, Span::ZERO));
    }
    // In conflict, no sample can be believed more than its own bound, and the conflict is an error.
    if high < low {
        let conflict = low - high;
        let mut bounds: Vec<f64> = quick.iter().map(|r| r.bound_s).collect();
        bounds.sort_by(f64::total_cmp);
        let bound = bounds.get(bounds.len() / 2).copied().unwrap_or_default();
        (low, high) = (-bound - age_s - conflict, bound + conflict);
    }
    let shift = if latch == LatchEvidence::Present {
        f64::midpoint(low, high)
    } else {
        0.0
    };
    let limits = (
        Span::from_secs_f64((low - shift).min(0.0)),
        Span::from_secs_f64((high - shift).max(0.0)),
    );
    (Span::from_secs_f64(shift), limits)
}
