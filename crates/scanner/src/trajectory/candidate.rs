//! Error of a candidate by its residuals.

use units::{Host, Stamp};

use super::bound::BOUND_SDS;
use super::choose::{Candidates, SweepFit};
use super::latch::{self, LatchEvidence, Residual};
use super::noise::seconds;
use super::pieces::{CubicPiece, PiecewiseCubic};
use super::{AngleSample, Method};
use crate::clock::Moment;

/// Residuals per batch mean.
const BATCH: usize = 16;
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
        let systematic_residual_deg = residual_autocorrelation(&off);
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
        let polled = match self.renewed {
            0 => off,
            _ => self.residuals(self.polled, &pieces),
        };
        let (shift, delay) = latch::delay(&polled, latch, self.noise.angle_sd_deg, scatter.sqrt());
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
        let sd = |piece: &CubicPiece| f64::hypot(piece.sd_deg, systematic_residual_deg);
        let with_sd = pieces.as_slice().iter().map(|p| p.with_sd(sd(p))).collect();
        let mut pieces = PiecewiseCubic::new(with_sd, pieces.span().1)?;
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

/// Residual autocorrelation by batch means, root mean square, degrees: the mean square of the means
/// over batches of residuals, less its expectation for independent residuals.
fn residual_autocorrelation(off: &[Residual]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in off.chunks(BATCH).filter(|row| row.len() > BATCH / 2) {
        let n = row.len() as f64;
        let mean = row.iter().map(|o| o.off_deg).sum::<f64>() / n;
        // Scatter by differences of neighbours (von Neumann 1941), which a slope within the batch
        // does not affect.
        let differences: f64 = row
            .windows(2)
            .map(|pair| match pair {
                [a, b] => (b.off_deg - a.off_deg).powi(2) / 2.0,
                _ => 0.0,
            })
            .sum();
        sum += mean * mean - differences / (n - 1.0) / n;
        count += 1.0;
    }
    if count > 0.0 {
        f64::max(sum / count, 0.0).sqrt()
    } else {
        0.0
    }
}
