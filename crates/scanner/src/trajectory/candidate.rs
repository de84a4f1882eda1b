//! Error of a candidate by its residuals.

use units::{Host, Span, Stamp};

use super::bound::BOUND_SDS;
use super::choose::{Candidates, SweepFit};
use super::latch::{self, LatchEvidence, Residual};
use super::noise::seconds;
use super::pieces::{CubicPiece, PiecewiseCubic};
use super::{AngleSample, Method};
use crate::clock::Moment;

/// Residuals per batch mean.
const BATCH: usize = 16;
/// Standard deviations of the mean of a batch beyond which the curve misfits there.
const MISFIT_SDS: f64 = 4.0;
/// Greatest misfit in bounds of the residual autocorrelation, where a latch hides a part of it: of
/// ramps with limited jerk.
const HIDDEN: f64 = 1.5;
/// Batch means whose greatest square is below this multiple of the mean one, which in turn exceeds
/// their own variance by the other, are the ages of positions: polls in step with a latch.
const MAX_OF_AGES: f64 = 4.8;
const MIN_OF_AGES: f64 = 4.0;
/// Standard deviations of the samples beyond which a motion between two is not their error.
const UNSEEN_SDS: f64 = 4.0;

/// A candidate curve.
pub(super) struct Candidate {
    pub fit: SweepFit,
    pub pieces: PiecewiseCubic,
    /// Part of the residual that neighbouring samples share, degrees.
    pub systematic_residual_deg: f64,
    /// Predicted mean square of the residual of a sample that is left out of the fit, in variances
    /// of its poll (generalised cross-validation).
    pub prediction_error: f64,
    /// Number of free parameters.
    pub parameters: usize,
    pub latch: LatchEvidence,
    /// The curve before the shift by the delay that a latch shows.
    pub unshifted: PiecewiseCubic,
}

impl Candidates<'_> {
    /// Generalised cross-validation (Craven and Wahba 1979) of a curve with so many parameters. The
    /// renewals of a latch are two more, phase and drift.
    fn prediction_error(&self, pieces: &PiecewiseCubic, parameters: usize) -> f64 {
        let squares: f64 = self
            .samples
            .iter()
            .zip(&self.unit_deg)
            .filter_map(|(sample, unit_deg)| {
                let off = sample.angle.0 - pieces.angle(Moment::at(sample.host))?.0;
                Some((off / unit_deg).powi(2))
            })
            .sum();
        let n = self.observed.len() as f64;
        let parameters = parameters + if self.renewed > 0 { 2 } else { 0 };
        let left = (1.0 - parameters as f64 / n).max(1.0 / n);
        squares / n / (left * left)
    }

    /// Motion between two samples that their neighbours do not predict, beyond what errors of the
    /// samples explain, and the greatest error of a curve between them.
    fn unseen_motion(&self) -> impl Iterator<Item = ((Stamp<Host>, Stamp<Host>), f64)> {
        self.samples.windows(4).filter_map(|window| {
            let [a, b, c, d] = window else { return None };
            let rate = |a: &AngleSample, b: &AngleSample| (b.angle.0 - a.angle.0) / seconds(a, b);
            let (before, after) = (rate(a, b), rate(c, d));
            let jump = c.angle.0 - b.angle.0 - 0.5 * (before + after) * seconds(b, c);
            let off = jump.abs().max((after - before).abs() * seconds(b, c) / 4.0);
            let fastest = f64::max(before.abs(), after.abs());
            let sd = [b, c].map(|sample| self.noise.sd_deg(sample, fastest));
            (off > UNSEEN_SDS * sd[0].hypot(sd[1])).then_some(((b.host, c.host), off))
        })
    }

    /// The pieces with the error by the drift of the clock that renews the positions.
    fn with_drift(&self, pieces: PiecewiseCubic) -> Option<PiecewiseCubic> {
        let Some(renewals) = &self.renewals else {
            return Some(pieces);
        };
        let with_sd = pieces.as_slice().iter().map(|piece| {
            let at_s = piece.from.saturating_since(self.origin).as_secs_f64();
            let rate_deg_s = piece.rate(0.0).abs() * 1e9;
            piece.with_sd(piece.sd_deg.hypot(renewals.sd_s(at_s) * rate_deg_s))
        });
        PiecewiseCubic::new(with_sd.collect(), pieces.span().1)
    }

    /// Residuals of the samples within the sweep.
    pub(super) fn residuals(
        &self,
        samples: &[AngleSample],
        pieces: &PiecewiseCubic,
    ) -> Vec<Residual> {
        let inside = |host: Stamp<Host>| self.sweep.start <= host && host <= self.sweep.end;
        samples
            .iter()
            .filter(|s| inside(s.host))
            .filter_map(|s| {
                let at = Moment::at(s.host);
                let piece = pieces.piece(at)?;
                let ns = piece.since(at);
                Some(Residual {
                    at_s: s.host.saturating_since(self.origin).as_secs_f64(),
                    off_deg: s.angle.0 - piece.at(ns),
                    rate_deg_s: piece.rate(ns) * 1e9,
                    bound_s: s.bound.as_secs_f64(),
                    curve_sd_deg: piece.sd_deg,
                })
            })
            .collect()
    }

    /// Error of a curve by its residuals.
    pub(super) fn evaluated(
        &self,
        method: Method,
        pieces: PiecewiseCubic,
        parameters: usize,
    ) -> Option<Candidate> {
        let prediction_error = self.prediction_error(&pieces, parameters);
        let off = self.residuals(&self.samples, &pieces);
        let mean_square = |xs: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = xs.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
            if n > 0.0 { sum / n } else { 0.0 }
        };
        let rms_deg = mean_square(&mut off.iter().map(|o| o.off_deg)).sqrt();
        let autocorrelation = Autocorrelation::of(&off);
        let systematic_residual_deg = autocorrelation.rms_deg;
        let scatter = mean_square(
            &mut pieces
                .within(self.sweep.start, self.sweep.end)
                .map(|(piece, _)| piece.sd_deg),
        );
        // A spline may follow the saw of a latch.
        let latch = match method {
            _ if self.renewed > 0 => LatchEvidence::Present,
            Method::Spline => LatchEvidence::Unknown,
            _ => latch::evidence(&off, self.noise.angle_sd_deg),
        };
        let pieces = self.with_drift(pieces)?;
        let mut polled = match self.renewed {
            0 => off.clone(),
            _ => self.residuals(self.polled, &pieces),
        };
        // A misfit moves the instants at which the curve has the samples' angles.
        let misfits = match autocorrelation.is_of_ages {
            true => Vec::new(),
            false => misfits(&off),
        };
        // Both are in order of time.
        let mut ahead = misfits.as_slice();
        for residual in &mut polled {
            while let [first, rest @ ..] = ahead
                && first.to_s < residual.at_s
            {
                ahead = rest;
            }
            let begun = ahead.iter().take_while(|m| m.from_s <= residual.at_s);
            let sds = begun.map(Misfit::sd_deg);
            residual.curve_sd_deg = sds.fold(residual.curve_sd_deg, f64::max);
        }
        // The ages of a latch hide a part of it, and limit the delay sharply.
        let is_hidden = latch == LatchEvidence::Present && !autocorrelation.is_of_ages;
        let (shared_sd_deg, curve_sd_deg) = match is_hidden {
            true => {
                let misfit_deg = HIDDEN * systematic_residual_deg;
                let unseen_deg = misfit_deg.hypot(autocorrelation.error_deg);
                (misfit_deg, scatter.sqrt().hypot(unseen_deg))
            }
            false => (systematic_residual_deg, scatter.sqrt()),
        };
        let (shift, delay) = latch::delay(&polled, latch, self.noise.angle_sd_deg, curve_sd_deg);
        let fit = SweepFit {
            method,
            rms_deg,
            sd_deg: (scatter + systematic_residual_deg * systematic_residual_deg).sqrt(),
            delay,
            profile: None,
            condition: None,
            remarks: Vec::new(),
        };
        // Residual autocorrelation is an error of every point of the sweep.
        let sd = |piece: &CubicPiece| f64::hypot(piece.sd_deg, shared_sd_deg);
        let with_sd = pieces.as_slice().iter().map(|p| p.with_sd(sd(p))).collect();
        let mut pieces = PiecewiseCubic::new(with_sd, pieces.span().1)?;
        for misfit in &misfits {
            let [from, to] = [misfit.from_s, misfit.to_s]
                .map(|at_s| self.origin.saturating_add(Span::from_secs_f64(at_s)));
            pieces.raise_sd((from, to), misfit.sd_deg());
        }
        if method == Method::Spline {
            for (span, off) in self.unseen_motion() {
                pieces.raise_sd(span, off / BOUND_SDS);
            }
        }
        let unshifted = pieces.clone();
        pieces.shift(shift);
        Some(Candidate {
            fit,
            pieces,
            unshifted,
            latch,
            systematic_residual_deg,
            prediction_error,
            parameters,
        })
    }
}

/// A part of the sweep in which the samples deviate together from the curve.
#[derive(Clone, Copy, Debug)]
struct Misfit {
    /// Seconds after the origin.
    from_s: f64,
    to_s: f64,
    mean_deg: f64,
}

impl Misfit {
    /// The standard deviation within whose bound the curve's greatest error is, if the misfit is
    /// half a sine.
    fn sd_deg(&self) -> f64 {
        self.mean_deg.abs() * std::f64::consts::FRAC_PI_2 / BOUND_SDS
    }
}

/// The batches, which overlap by half, whose mean exceeds its own error. The last one ends with the
/// residuals.
fn misfits(off: &[Residual]) -> Vec<Misfit> {
    let last = off.len().saturating_sub(BATCH);
    let starts = (0..last).step_by(BATCH / 2).chain([last]);
    let found = starts.filter_map(|start| {
        let row = off.get(start..start + BATCH)?;
        let (mean_deg, variance) = mean(row);
        (mean_deg.abs() > MISFIT_SDS * variance.sqrt()).then_some(Misfit {
            from_s: row.first()?.at_s,
            to_s: row.last()?.at_s,
            mean_deg,
        })
    });
    found.collect()
}

/// Mean of neighbouring residuals and its variance: their scatter by differences of neighbours (von
/// Neumann 1941), which a slope does not affect.
fn mean(row: &[Residual]) -> (f64, f64) {
    let n = row.len() as f64;
    let mean = row.iter().map(|o| o.off_deg).sum::<f64>() / n;
    let differences: f64 = row
        .windows(2)
        .map(|pair| match pair {
            [a, b] => (b.off_deg - a.off_deg).powi(2) / 2.0,
            _ => 0.0,
        })
        .sum();
    (mean, differences / (n - 1.0) / n)
}

/// Residual autocorrelation by batch means.
struct Autocorrelation {
    /// Root mean square, degrees: the mean square of the means over batches of residuals, less its
    /// expectation for independent residuals.
    rms_deg: f64,
    /// Error of that, degrees, if it is zero.
    error_deg: f64,
    is_of_ages: bool,
}

impl Autocorrelation {
    fn of(off: &[Residual]) -> Self {
        let batches = off.chunks(BATCH).filter(|row| row.len() > BATCH / 2);
        let (mut count, mut sum, mut most, mut expected, mut error) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (mean, variance) in batches.map(mean) {
            count += 1.0;
            sum += mean * mean;
            most = f64::max(most, mean * mean);
            expected += variance;
            error += 2.0 * variance * variance;
        }
        let count = f64::max(count, 1.0);
        Self {
            rms_deg: f64::max((sum - expected) / count, 0.0).sqrt(),
            error_deg: (error.sqrt() / count).sqrt(),
            is_of_ages: sum > MIN_OF_AGES * expected && most < MAX_OF_AGES * sum / count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals every 2.5 ms for a second, of positions in steps of 0.0015 deg.
    fn residuals(misfit: impl Fn(f64) -> f64) -> Vec<Residual> {
        let residual = |i: i32| {
            let drawn = (f64::from(i) * 0.618_033_988_749_895).fract() - 0.5;
            let at_s = f64::from(i) * 2.5e-3;
            Residual {
                at_s,
                off_deg: 0.0015 * drawn + misfit(at_s),
                rate_deg_s: 50.0,
                bound_s: 0.2e-3,
                curve_sd_deg: 0.0,
            }
        };
        (0..400).map(residual).collect()
    }

    /// Polls at 1 kHz beside a latch of 1 ms: their ages rise slowly and fall by a cycle.
    #[test]
    fn ages_that_change_slowly_are_no_misfit() {
        let ages = |at_s: f64| 0.05 * ((at_s * 4.7).fract() - 0.5);
        assert!(Autocorrelation::of(&residuals(ages)).is_of_ages);
        assert!(!Autocorrelation::of(&residuals(|_| 0.0)).is_of_ages);
    }

    /// Misfit as where the acceleration rises evenly, but the fitted motion has a corner. The
    /// residual autocorrelation, a mean over the sweep, does not show how great it is.
    #[test]
    fn a_misfit_of_a_ramp_is_bounded_there() {
        assert!(misfits(&residuals(|_| 0.0)).is_empty());
        let bump = |at_s: f64| match (0.3..0.35).contains(&at_s) {
            true => 0.004 * (std::f64::consts::PI * (at_s - 0.3) / 0.05).sin(),
            false => 0.0,
        };
        let off = residuals(bump);
        let autocorrelation = Autocorrelation::of(&off);
        assert!(BOUND_SDS * autocorrelation.rms_deg < 0.003);
        assert!(!autocorrelation.is_of_ages);
        let found = misfits(&off);
        let here = found
            .iter()
            .filter(|misfit| (misfit.from_s..=misfit.to_s).contains(&0.325));
        let bound_deg = BOUND_SDS * here.map(Misfit::sd_deg).fold(0.0, f64::max);
        assert!((0.004..0.007).contains(&bound_deg), "{bound_deg} deg");
        let elsewhere = |misfit: &&Misfit| misfit.to_s < 0.3 || misfit.from_s > 0.35;
        assert_eq!(found.iter().filter(elsewhere).count(), 0, "{found:?}");
    }
}
