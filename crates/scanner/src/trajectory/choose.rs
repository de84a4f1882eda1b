//! Chooses the curve with the smallest error through a sweep's samples.
//!
//! The commanded motion has few parameters and averages over hundreds of samples, but it is right
//! only if the axis followed the command. The autocorrelation of its residuals shows how far it did
//! not. A spline follows any motion and averages over fewer samples; a spline through the
//! residuals of the best profile follows a short disturbance. All compete on one scale, the
//! predicted error of a sample that is left out (generalised cross-validation), which does not
//! depend on a candidate's own scatter. The samples limit the rest: with independent errors of
//! standard deviation s, a parameter that n samples determine has at least s / sqrt(n)
//! (Cramer-Rao), and a motion between two samples leaves no trace in them.

use units::{Degrees, Host, Span, Stamp};

use super::bound::BOUND_SDS;
use super::latch::{self, LatchEvidence, Residual};
use super::noise::{Noise, rates, seconds};
use super::pieces::{CubicPiece, PiecewiseCubic};
use super::profile::Profile;
use super::profile_fit::{self, Observed, ProfileFit, ServoModel};
use super::{AngleSample, Method, Remark, kinks, spline};
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
/// Residuals per batch mean.
const BATCH: usize = 16;
/// A motion is not the commanded one if the residual autocorrelation exceeds both this multiple of
/// the error and this angle.
const MAX_AUTOCORRELATION: f64 = 4.0;
const MAX_AUTOCORRELATION_DEG: f64 = 0.01;
/// Settling time of a head's servo after a ramp, seconds.
const SETTLED_S: f64 = 0.1;
/// Observations of the cruise in a profile's fit, at most.
const MAX_CRUISE_OBSERVATIONS: usize = 100;
/// Limit of pieces for one servo's response.
const MAX_PIECES: usize = 4_000;
/// Ratio of a spline's error to its scatter: with the best spacing bias and scatter are about
/// equal, sqrt(2).
const SPLINE_BIAS: f64 = 1.4;

/// Standard deviations of the samples beyond which a motion between two is not their error.
const UNSEEN_SDS: f64 = 4.0;

/// Candidate curves for one sweep.
pub(super) struct Candidates<'a> {
    sweep: &'a Sweep,
    /// Samples of the sweep and of the rest around it, in strictly increasing time.
    samples: &'a [AngleSample],
    origin: Stamp<Host>,
    noise: Noise,
    observed: Vec<Observed>,
}

/// A candidate curve.
struct Candidate {
    fit: SweepFit,
    pieces: PiecewiseCubic,
    /// Part of the residual that neighbouring samples share, degrees.
    systematic_residual_deg: f64,
    /// Predicted mean square of the residual of a sample that is left out of the fit, in variances
    /// of the sample (generalised cross-validation).
    prediction_error: f64,
    /// Number of free parameters.
    parameters: usize,
    latch: LatchEvidence,
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
        Some(Self {
            sweep,
            samples,
            origin,
            noise: *noise,
            observed: observed(samples, noise, origin),
        })
    }

    /// The candidate with the smallest error, or that of `method`. `None` without one.
    pub(super) fn best(&self, method: Option<Method>) -> Option<(SweepFit, PiecewiseCubic)> {
        let servo = |method: Method| match method {
            Method::Profile => Some(ServoModel::None),
            Method::ProfileServo => Some(ServoModel::Lag),
            Method::ProfileServo2 => Some(ServoModel::Swing),
            _ => None,
        };
        let mut candidates: Vec<Candidate> = match method {
            Some(Method::Spline) => self.splines(None),
            Some(method) => self.profile(servo(method)?, method).into_iter().collect(),
            None => {
                let mut all = self.profiles();
                let best = least(&all).and_then(|best| all.get(best));
                // Ages of a latch are errors that neighbours share, up to the way of half a cycle:
                // a spline would follow them. Greater errors are motion.
                let age_deg = 0.5 * latch::CYCLE_S * self.sweep.cruise.0.abs();
                let is_aged = |best: &Candidate| {
                    best.latch == LatchEvidence::Present && best.systematic_residual_deg < age_deg
                };
                if best.is_none_or(|best| !is_aged(best)) {
                    let splines = self.splines(best);
                    all.extend(splines);
                }
                all
            }
        };
        if std::env::var_os("DBG").is_some() {
            for c in &candidates {
                eprintln!(
                    "DBG {:?} gcv {:.4} n {} par {} sys {:.5} rms {:.5} sd {:.5} latch {:?} delay {:?} noise {:?} {:?}",
                    c.fit.method,
                    c.prediction_error,
                    self.observed.len(),
                    c.parameters,
                    c.systematic_residual_deg,
                    c.fit.rms_deg,
                    c.fit.sd_deg,
                    c.latch,
                    c.fit.delay,
                    self.noise,
                    c.fit.profile
                );
            }
        }
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

    /// The commanded motion behind each servo that may be there.
    fn profiles(&self) -> Vec<Candidate> {
        let mut all = Vec::new();
        let Some(guess) = self.guess() else {
            return all;
        };
        let observed = condensed(&self.observed, &guess);
        let fit = |servo| profile_fit::fit(&observed, guess, servo);
        let lag = fit(ServoModel::Lag);
        let swing = profile_fit::fit_swing(&observed, guess, lag.as_ref());
        for (fit, method) in [
            (fit(ServoModel::None), Method::Profile),
            (lag, Method::ProfileServo),
            (swing, Method::ProfileServo2),
        ] {
            all.extend(fit.and_then(|fit| self.candidate(fit, method)));
        }
        all
    }

    fn profile(&self, servo: ServoModel, method: Method) -> Option<Candidate> {
        let guess = self.guess()?;
        let observed = condensed(&self.observed, &guess);
        let fit = profile_fit::fit(&observed, guess, servo)?;
        self.candidate(fit, method)
    }

    fn candidate(&self, fit: ProfileFit, method: Method) -> Option<Candidate> {
        let end_s = self.observed.last()?.at_s;
        let pieces = pieces(&fit, self.origin, end_s)?;
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
    /// kinks of the motion.
    fn splines(&self, profile: Option<&Candidate>) -> Vec<Candidate> {
        let found = kinks::find(&self.observed);
        let mut all: Vec<Candidate> = self.spline(&[]).into_iter().collect();
        all.extend(profile.and_then(|profile| self.corrected(profile, &[])));
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
            let at = Moment {
                host: sample.host,
                rest_ns: 0.0,
            };
            Some(Observed {
                angle_deg: o.angle_deg - profile.pieces.angle(at)?.0,
                ..*o
            })
        });
        let residuals: Vec<Observed> = residuals.collect::<Option<_>>()?;
        let end_s = residuals.last()?.at_s;
        let fit = spline::fit(&residuals, self.origin, (0.0, end_s), kinks_s)?;
        let pieces = profile.pieces.corrected(&fit.pieces)?;
        let parameters = profile.parameters + fit.parameters + kinks_s.len();
        self.evaluated(Method::Spline, pieces, parameters)
    }

    /// The commanded motion, completed by the sweep's ends.
    fn guess(&self) -> Option<Profile> {
        let sweep = self.sweep;
        let way_deg = sweep.to.0 - sweep.from.0;
        let duration_s = sweep.end.saturating_since(sweep.start).as_secs_f64();
        let commanded = sweep.commanded;
        let speed = match commanded.speed.0.abs() {
            speed if speed > 0.0 => speed,
            _ => sweep.cruise.0.abs(),
        };
        let speed = if speed > 0.0 {
            speed
        } else {
            way_deg.abs() / duration_s
        };
        let measured = (duration_s - way_deg.abs() / speed).max(duration_s * 1e-3);
        let ramp = |rate: f64| if rate > 0.0 { speed / rate } else { measured };
        let (mut up, mut down) = (
            ramp(commanded.acceleration.0),
            ramp(commanded.deceleration.0),
        );
        let mut speed_deg_s = speed.copysign(way_deg);
        // Too short for the cruise: both ramps shrink alike, and with them the speed.
        let part = (way_deg / speed_deg_s) / ((up + down) / 2.0);
        if part < 1.0 {
            (up, down, speed_deg_s) = (
                up * part.sqrt(),
                down * part.sqrt(),
                speed_deg_s * part.sqrt(),
            );
            // Just enough to count as a triangle.
            speed_deg_s *= 1.0 + 1e-9;
        }
        let is_motion = way_deg != 0.0 && [up, down, speed_deg_s].iter().all(|x| x.is_finite());
        is_motion.then_some(Profile {
            start_s: sweep.start.saturating_since(self.origin).as_secs_f64(),
            speed_deg_s,
            ramp_up_s: up,
            ramp_down_s: down,
            from_deg: sweep.from.0,
            way_deg,
            lag_s: 0.0,
            inertia_s2: 0.0,
        })
    }

    /// Generalised cross-validation (Craven and Wahba 1979) of a curve with so many parameters.
    fn prediction_error(&self, pieces: &PiecewiseCubic, parameters: usize) -> f64 {
        let squares: f64 = self
            .samples
            .iter()
            .zip(&self.observed)
            .filter_map(|(sample, observed)| {
                let at = Moment {
                    host: sample.host,
                    rest_ns: 0.0,
                };
                let off = observed.angle_deg - pieces.angle(at)?.0;
                Some((off / observed.sd_deg).powi(2))
            })
            .sum();
        let n = self.observed.len() as f64;
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

    /// Error of a curve by its residuals.
    fn evaluated(
        &self,
        method: Method,
        pieces: PiecewiseCubic,
        parameters: usize,
    ) -> Option<Candidate> {
        let prediction_error = self.prediction_error(&pieces, parameters);
        let inside = |host: Stamp<Host>| self.sweep.start <= host && host <= self.sweep.end;
        let off: Vec<Residual> = self
            .samples
            .iter()
            .filter(|s| inside(s.host))
            .filter_map(|s| {
                let at = Moment {
                    host: s.host,
                    rest_ns: 0.0,
                };
                let piece = pieces.piece(at)?;
                let ns = piece.since(at);
                Some(Residual {
                    at_s: s.host.saturating_since(self.origin).as_secs_f64(),
                    off_deg: s.angle.0 - piece.at(ns),
                    rate_deg_s: piece.rate(ns) * 1e9,
                    bound_s: s.bound.as_secs_f64(),
                })
            })
            .collect();
        let mean_square = |xs: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = xs.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
            if n > 0.0 { sum / n } else { 0.0 }
        };
        let rms_deg = mean_square(&mut off.iter().map(|o| o.off_deg)).sqrt();
        let systematic_residual_deg = residual_autocorrelation(&off);
        let all = pieces.as_slice();
        let scatter = mean_square(
            // The piece that contains the beginning counts too.
            &mut all
                .iter()
                .skip(
                    all.partition_point(|p| p.from <= self.sweep.start)
                        .saturating_sub(1),
                )
                .take_while(|p| p.from <= self.sweep.end)
                .map(|p| p.sd_deg),
        );
        // A spline may follow the saw of a latch.
        let latch = if method == Method::Spline {
            LatchEvidence::Unknown
        } else {
            latch::evidence(&off, self.noise.angle_sd_deg)
        };
        let (shift, delay) = latch::delay(&off, latch, self.noise.angle_sd_deg, scatter.sqrt());
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
        pieces.shift(shift);
        Some(Candidate {
            fit,
            pieces,
            latch,
            systematic_residual_deg,
            prediction_error,
            parameters,
        })
    }
}

/// The candidate that predicts samples best.
fn least(candidates: &[Candidate]) -> Option<usize> {
    let errors = candidates.iter().map(|c| c.prediction_error).enumerate();
    errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}

/// Observations for a fit. A run of equal samples at rest weighs as one.
fn observed(samples: &[AngleSample], noise: &Noise, origin: Stamp<Host>) -> Vec<Observed> {
    let rates = rates(samples);
    let mut observed: Vec<Observed> = samples
        .iter()
        .zip(rates)
        .map(|(s, rate)| Observed {
            at_s: s.host.saturating_since(origin).as_secs_f64(),
            angle_deg: s.angle.0,
            sd_deg: noise.sd_deg(s, rate).max(f64::EPSILON),
        })
        .collect();
    for run in observed.chunk_by_mut(is_alike) {
        let count = run.len() as f64;
        for o in run {
            o.sd_deg *= count.sqrt();
        }
    }
    observed
}

/// Merges neighbours of the cruise if there are many: parts of a straight line carry no more
/// information.
fn condensed(observed: &[Observed], guess: &Profile) -> Vec<Observed> {
    let [start, up, brake, end] = guess.corners_s();
    // The guess may be off, and the servo settles later.
    let margin_s = SETTLED_S + 0.5 * (up - start).max(end - brake);
    let is_straight = |o: &Observed| o.at_s > up + margin_s && o.at_s < brake - margin_s;
    let first = observed.partition_point(|o| !is_straight(o) && o.at_s < brake);
    let last = observed
        .partition_point(|o| o.at_s < brake - margin_s)
        .max(first);
    let (before, rest) = observed.split_at_checked(first).unwrap_or((observed, &[]));
    let (straight, after) = rest.split_at_checked(last - first).unwrap_or((rest, &[]));
    let group = straight.len() / MAX_CRUISE_OBSERVATIONS + 1;
    let few = straight.chunks(group).filter_map(merged);
    let few: Vec<Observed> = few.collect();
    [before, &few, after].concat()
}

/// Observations of a straight line as one.
fn merged(some: &[Observed]) -> Option<Observed> {
    let first = some.first()?;
    let (mut weight, mut late, mut ahead) = (0.0, 0.0, 0.0);
    for o in some {
        let w = 1.0 / (o.sd_deg * o.sd_deg);
        weight += w;
        late += w * (o.at_s - first.at_s);
        ahead += w * (o.angle_deg - first.angle_deg);
    }
    Some(Observed {
        at_s: first.at_s + late / weight,
        angle_deg: first.angle_deg + ahead / weight,
        sd_deg: 1.0 / weight.sqrt(),
    })
}

fn is_alike(a: &Observed, b: &Observed) -> bool {
    (a.angle_deg - b.angle_deg).abs() < f64::EPSILON * 64.0
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

/// A profile as cubics from the origin until `end_s`: its corners, and steps behind them that grow
/// as the servo's response decays.
fn pieces(fit: &ProfileFit, origin: Stamp<Host>, end_s: f64) -> Option<PiecewiseCubic> {
    let profile = &fit.profile;
    let mut at = vec![0.0, end_s];
    let corners = profile.corners_s();
    for corner in corners {
        at.push(corner);
        let inertia = profile.inertia_s2;
        let (mut since, lag) = (0.0, profile.lag_s);
        // Time constant of the response, and its duration.
        let quick = if inertia > 0.0 {
            lag.min(inertia.sqrt())
        } else {
            lag
        };
        let over = if lag > 0.0 {
            lag.max(2.0 * inertia / lag)
        } else {
            0.0
        };
        // Hermite's error is (step / time constant)^4 / 384 of the response: below 1e-6 degrees for
        // any servo.
        while quick > 0.0 && since < 20.0 * over && at.len() < MAX_PIECES {
            since += quick / 8.0 * f64::exp((since / over / 4.0).min(3.0));
            at.push(corner + since);
        }
    }
    // The standard deviation varies along the cruise.
    let [_, up, brake, _] = corners;
    at.extend((1..32).map(|k| up + (brake - up) * f64::from(k) / 32.0));
    at.retain(|s| (0.0..=end_s).contains(s));
    at.sort_by(f64::total_cmp);
    let stamps: Vec<Stamp<Host>> = at
        .iter()
        .map(|s| origin.saturating_add(Span::from_secs_f64(*s)))
        .collect();
    let pieces = stamps.windows(2).filter_map(|pair| match pair {
        [a, b] if a < b => {
            let [from_s, to_s] = [a, b].map(|s| s.saturating_since(origin).as_secs_f64());
            let ns = b.saturating_since(*a).as_nanos() as f64;
            // At a corner of a profile without lag the acceleration jumps, but not the speed.
            let ends = [from_s, to_s].map(|s| {
                let (angle_deg, rate_deg_s) = profile.place(s);
                [angle_deg, rate_deg_s * 1e-9]
            });
            let sd = fit.sd_deg(0.5 * (from_s + to_s));
            Some(CubicPiece::hermite(*a, ns, ends[0], ends[1]).with_sd(sd))
        }
        _ => None,
    });
    PiecewiseCubic::new(pieces.collect(), *stamps.last()?)
}
