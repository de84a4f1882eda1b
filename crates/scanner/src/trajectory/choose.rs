//! Chooses the curve with the smallest error through a sweep's samples.
//!
//! The commanded motion has few parameters and averages over hundreds of samples, but it is right
//! only if the axis followed the command. The autocorrelation of its residuals shows how far it did
//! not. A spline follows any motion and averages over fewer samples; a spline through the
//! residuals of the best profile follows a short disturbance. All compete on one scale, the
//! predicted error of a sample that is left out (generalised cross-validation) in variances of its
//! poll, which does not depend on a candidate's own scatter, nor on whether its samples were moved
//! to the renewals of a latch. The samples limit the rest: with independent errors of
//! standard deviation s, a parameter that n samples determine has at least s / sqrt(n)
//! (Cramer-Rao), and a motion between two samples leaves no trace in them.

use std::borrow::Cow;

use units::{Degrees, Host, Span, Stamp};

use super::candidate::Candidate;
use super::latch::{self, LatchEvidence};
use super::noise::Noise;
use super::observations::{condensed, observed};
use super::pieces::PiecewiseCubic;
use super::profile::Profile;
use super::profile_fit::{self, Observed, ProfileFit, ServoModel};
use super::renewals::Renewals;
use super::{AngleSample, Method, Remark, kinks, profile_pieces, spline};
use crate::clock::Moment;
use crate::sweeps::Sweep;

/// A curve through a sweep.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SweepFit {
    /// The method.
    pub method: Method,
    /// Root mean square residual of the samples over the sweep, degrees.
    pub rms_deg: f64,
    /// Error by scatter of the samples and residual autocorrelation, one standard deviation,
    /// degrees.
    pub sd_deg: f64,
    /// Limits of a delay common to all samples, as each was taken between its request and its
    /// answer.
    pub delay: (Span, Span),
    /// The fitted motion; `None` if another curve was taken.
    pub profile: Option<Profile>,
    /// Condition number of the fit.
    pub condition: Option<f64>,
    /// Remarks on the sweep.
    pub remarks: Vec<Remark>,
}

impl SweepFit {
    /// Greatest magnitude of a delay common to all samples, seconds.
    pub(super) fn shared_s(&self) -> f64 {
        let (early, late) = self.delay;
        early.as_secs_f64().abs().max(late.as_secs_f64().abs())
    }
}

/// Samples of rest before and after the sweep that enter a fit.
const REST_MARGIN: Span = Span::from_millis(60);
/// A motion is not the commanded one if the residual autocorrelation exceeds both this multiple of
/// the error and this angle.
const MAX_AUTOCORRELATION: f64 = 4.0;
const MAX_AUTOCORRELATION_DEG: f64 = 0.01;
/// Ratio of a spline's error to its scatter: with the best spacing bias and scatter are about
/// equal, sqrt(2).
const SPLINE_BIAS: f64 = 1.4;

/// Candidate curves for one sweep.
pub(super) struct Candidates<'a> {
    pub sweep: &'a Sweep,
    /// Samples of the sweep and of the rest around it, in strictly increasing time, for the curves.
    pub samples: Cow<'a, [AngleSample]>,
    /// The same by their polls.
    pub polled: &'a [AngleSample],
    /// Standard deviations of the polls of `samples`, degrees: the unit of their residuals, alike
    /// for all candidates.
    pub unit_deg: Vec<f64>,
    /// Number of times that the curves' samples were moved to the renewals of a latch.
    pub renewed: usize,
    pub renewals: Option<Renewals>,
    pub origin: Stamp<Host>,
    pub noise: Noise,
    pub observed: Vec<Observed>,
}

impl<'a> Candidates<'a> {
    /// Candidates of `sweep` among `samples` within `limits`.
    pub(super) fn new(
        sweep: &'a Sweep,
        samples: &'a [AngleSample],
        noise: &Noise,
        limits: (Stamp<Host>, Stamp<Host>),
    ) -> Option<Self> {
        let from = sweep.start.saturating_add(-REST_MARGIN).max(limits.0);
        let to = sweep.end.saturating_add(REST_MARGIN).min(limits.1);
        let low = samples.partition_point(|s| s.host < from);
        let high = samples.partition_point(|s| s.host <= to);
        let samples = samples.get(low..high)?;
        let origin = samples.first()?.host;
        let observed = observed(samples, noise, origin);
        Some(Self {
            sweep,
            samples: Cow::Borrowed(samples),
            polled: samples,
            unit_deg: observed.iter().map(|o| o.sd_deg).collect(),
            renewed: 0,
            renewals: None,
            origin,
            noise: *noise,
            observed,
        })
    }

    /// The candidate with the smallest error, or that of `method`. `None` without one.
    pub(super) fn best(&self, method: Option<Method>) -> Option<(SweepFit, PiecewiseCubic)> {
        let mut candidates = self.all(method);
        let least_autocorrelation = candidates
            .iter()
            .filter(|c| c.fit.method != Method::Spline)
            .map(|c| c.systematic_residual_deg)
            .min_by(f64::total_cmp);
        let best = least(&candidates)?;
        let mut best = candidates.swap_remove(best);
        let is_excessive =
            |off: f64| off > MAX_AUTOCORRELATION_DEG && off > MAX_AUTOCORRELATION * best.fit.sd_deg;
        let off = least_autocorrelation.filter(|off| is_excessive(*off));
        if let (Method::Spline, None, Some(off)) = (best.fit.method, method, off) {
            let remark = Remark::NotAsCommanded { off: Degrees(off) };
            best.fit.remarks.push(remark);
        }
        Some((best.fit, best.pieces))
    }

    /// All candidates, or those of `method`: through the polls and, if these show a latch, through
    /// its renewals.
    fn all(&self, method: Option<Method>) -> Vec<Candidate> {
        let mut all = self.profiles(method);
        let best = least(&all).and_then(|best| all.get(best));
        let renewed = best.and_then(|best| self.at_renewals(best));
        // Ages of a latch are errors that neighbours share, up to the way of half a cycle: a spline
        // would follow them. Greater errors are motion.
        let age_deg = 0.5 * latch::CYCLE_S * self.sweep.cruise.0.abs();
        let is_aged = |best: &Candidate| {
            best.latch == LatchEvidence::Present && best.systematic_residual_deg < age_deg
        };
        let splines = match method {
            Some(Method::Spline) => self.splines(None),
            None if !best.is_some_and(is_aged) => self.splines(best),
            _ => Vec::new(),
        };
        all.extend(splines);
        all.extend(renewed.into_iter().flat_map(|renewed| renewed.all(method)));
        all
    }

    /// The commanded motion behind each servo that may be there, or behind that of `method`.
    fn profiles(&self, method: Option<Method>) -> Vec<Candidate> {
        let Some(guess) = self.guess().filter(|_| method != Some(Method::Spline)) else {
            return Vec::new();
        };
        let observed = condensed(&self.observed, &guess);
        let if_wanted = |of: Method, fit: &dyn Fn() -> Option<ProfileFit>| {
            method.is_none_or(|only| only == of).then(fit).flatten()
        };
        let fit = |servo| profile_fit::fit(&observed, guess, servo);
        let lag = if_wanted(Method::ProfileServo, &|| fit(ServoModel::Lag));
        let swing = if_wanted(Method::ProfileServo2, &|| {
            profile_fit::fit_swing(&observed, guess, lag.as_ref())
        });
        let plain = if_wanted(Method::Profile, &|| fit(ServoModel::None));
        let fits = [
            (plain, Method::Profile),
            (lag, Method::ProfileServo),
            (swing, Method::ProfileServo2),
        ];
        let fits = fits.into_iter();
        fits.filter_map(|(fit, method)| self.candidate(fit?, method))
            .collect()
    }

    fn candidate(&self, fit: ProfileFit, method: Method) -> Option<Candidate> {
        let end_s = self.observed.last()?.at_s;
        let pieces = profile_pieces::of_profile(&fit, self.origin, end_s)?;
        // Parameters that trade off against each other leave the curve as it is.
        let count_deg = self.noise.angle_sd_deg * f64::sqrt(12.0);
        let worst_sd_deg = pieces
            .as_slice()
            .iter()
            .map(|p| p.sd_deg)
            .fold(0.0, f64::max);
        let is_undetermined = fit.regularised.any() && worst_sd_deg > count_deg;
        let remarks = is_undetermined.then_some(Remark::Regularised(fit.regularised));
        let mut candidate = self.evaluated(method, pieces, fit.parameters())?;
        candidate.fit.profile = Some(fit.profile);
        candidate.fit.condition = Some(fit.condition);
        candidate.fit.remarks.extend(remarks);
        Some(candidate)
    }

    /// Splines through the samples and through the residuals of `profile`, with and without the
    /// kinks of the motion. If the residuals are by chance, as no window of any size shows a motion
    /// in them, the one through them competes alone: the others only have more parameters.
    fn splines(&self, profile: Option<&Candidate>) -> Vec<Candidate> {
        let mut all: Vec<Candidate> = Vec::new();
        if let Some(profile) = profile {
            all.extend(self.corrected(profile, &[]));
            let by_chance = profile.parameters + spline::FEWEST_PARAMETERS;
            if all.first().is_some_and(|one| one.parameters == by_chance) {
                return all;
            }
        }
        let found = kinks::find(&self.observed);
        all.extend(self.spline(&[]));
        if !found.is_empty() {
            all.extend(self.spline(&found));
            all.extend(profile.and_then(|profile| self.corrected(profile, &found)));
        }
        all
    }

    fn spline(&self, kinks_s: &[f64]) -> Option<Candidate> {
        let end_s = self.observed.last()?.at_s;
        let fit = spline::fit(&self.observed, self.origin, (0.0, end_s), kinks_s)?;
        // The instant of a kink is a parameter too.
        let parameters = fit.parameters + kinks_s.len();
        let mut candidate = self.evaluated(Method::Spline, fit.pieces, parameters)?;
        candidate.fit.sd_deg *= SPLINE_BIAS;
        Some(candidate)
    }

    /// A profile and a spline through its residuals: the commanded motion with a disturbance in
    /// part of it.
    fn corrected(&self, profile: &Candidate, kinks_s: &[f64]) -> Option<Candidate> {
        let residuals = self.samples.iter().zip(&self.observed).map(|(sample, o)| {
            Some(Observed {
                angle_deg: o.angle_deg - profile.unshifted.angle(Moment::at(sample.host))?.0,
                ..*o
            })
        });
        let residuals: Vec<Observed> = residuals.collect::<Option<_>>()?;
        let end_s = residuals.last()?.at_s;
        let fit = spline::fit(&residuals, self.origin, (0.0, end_s), kinks_s)?;
        let pieces = profile.unshifted.corrected(&fit.pieces)?;
        let parameters = profile.parameters + fit.parameters + kinks_s.len();
        self.evaluated(Method::Spline, pieces, parameters)
    }
}

/// The candidate that predicts samples best.
fn least(candidates: &[Candidate]) -> Option<usize> {
    let errors = candidates.iter().map(|c| c.prediction_error).enumerate();
    errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}
