//! Which curve through a sweep's samples is the truest: judged by what its residuals show beyond
//! the scatter of single samples.
//!
//! The commanded motion has few parameters, so it averages over hundreds of samples; but it is
//! right only if the axis did what it was told. Residuals of many samples in a row that do not
//! cancel say how far it did not. A spline follows anything and averages over fewer samples. Each
//! has an error that can be told from the samples: what they scatter it by, and what is left in a
//! row. The one with the least is taken.

use units::{Degrees, Host, Span, Stamp};

use super::noise::{Noise, rates};
use super::pieces::{CubicPiece, PiecewiseCubic};
use super::profile::Profile;
use super::profile_fit::{self, Observed, ProfileFit, Servo};
use super::{AngleSample, Method, Remark, spline};
use crate::clock::Moment;
use crate::sweeps::Sweep;

/// A curve through a sweep.
#[derive(Clone, Debug)]
pub struct SweepFit {
    /// How the angle between its samples is known.
    pub method: Method,
    /// Root mean square of samples against it, degrees, over the sweep.
    pub rms_deg: f64,
    /// How far it may be off by what the samples scatter and what is left of them in a row, one
    /// standard deviation, degrees.
    pub sd_deg: f64,
    /// A delay that all samples of it share lies between these, as each was taken between its
    /// request and its answer.
    pub delay: (Span, Span),
    /// The motion that was found; `None` where none was looked for or it is not the one taken.
    pub profile: Option<Profile>,
    /// Condition number of the fit.
    pub condition: Option<f64>,
    /// What is to be said of it.
    pub remarks: Vec<Remark>,
}

impl SweepFit {
    /// The longest delay that all samples may share either way, seconds.
    pub(super) fn shared_s(&self) -> f64 {
        let (early, late) = self.delay;
        early.as_secs_f64().abs().max(late.as_secs_f64().abs())
    }
}

/// Samples of rest that a fit gets on either side of the sweep.
const BESIDE: Span = Span::from_millis(60);
/// So many residuals in a row are taken together.
const ROW: usize = 16;
/// A motion is not the commanded one if residuals in a row show this many times what samples
/// scatter it by, and this much.
const STRANGE: f64 = 4.0;
const STRANGE_DEG: f64 = 0.01;
/// So long after a ramp a servo that moves a head has settled, seconds.
const SETTLED_S: f64 = 0.1;
/// Observations of the cruise that are left for a profile's fit.
const MOST_STRAIGHT: usize = 100;
/// No servo's answer takes more pieces than this.
const MOST_PIECES: usize = 4_000;
/// The bias of a spline with the best spacing is about its scatter.
const SPLINE_BIAS: f64 = 1.4;

/// Candidates for one sweep, from one window of samples.
pub(super) struct Candidates<'a> {
    sweep: &'a Sweep,
    /// Samples of the sweep and of the rest beside it, in strictly increasing time.
    samples: &'a [AngleSample],
    origin: Stamp<Host>,
    observed: Vec<Observed>,
}

/// One of them.
struct Candidate {
    fit: SweepFit,
    pieces: PiecewiseCubic,
    /// What is left in a row, degrees.
    strange_deg: f64,
    /// It is of few observations: a look at what a fit comes to.
    is_look: bool,
}

impl Candidate {
    /// Whether what is left in a row is less than a part of its error.
    fn leaves_less_than(&self, part: f64) -> bool {
        self.strange_deg < part * self.fit.sd_deg
    }
}

impl<'a> Candidates<'a> {
    /// Those of `sweep` among `samples`, not reaching beyond `limits`.
    pub(super) fn new(
        sweep: &'a Sweep,
        samples: &'a [AngleSample],
        noise: &Noise,
        limits: (Stamp<Host>, Stamp<Host>),
    ) -> Option<Self> {
        let from = sweep.start.saturating_add(-BESIDE).max(limits.0);
        let to = sweep.end.saturating_add(BESIDE).min(limits.1);
        let low = samples.partition_point(|s| s.host < from);
        let high = samples.partition_point(|s| s.host <= to);
        let samples = samples.get(low..high)?;
        let origin = samples.first()?.host;
        Some(Self {
            sweep,
            samples,
            origin,
            observed: observed(samples, noise, origin),
        })
    }

    /// The truest of them, with its pieces; of `method` alone where one is asked for. `None` where
    /// there is none.
    pub(super) fn best(&self, method: Option<Method>) -> Option<(SweepFit, PiecewiseCubic)> {
        let servo = |method: Method| match method {
            Method::Profile => Some(Servo::None),
            Method::ProfileServo => Some(Servo::Lag),
            Method::ProfileSwing => Some(Servo::Swing),
            _ => None,
        };
        let mut candidates: Vec<Candidate> = match method {
            Some(Method::Spline) => self.spline().into_iter().collect(),
            Some(method) => {
                let fit = self.profile(servo(method)?, method, None);
                fit.into_iter().collect()
            }
            None => {
                let mut all: Vec<Candidate> = Vec::new();
                for method in [Method::Profile, Method::ProfileServo, Method::ProfileSwing] {
                    let Some(mut one) = servo(method).and_then(|servo| self.look(servo, method))
                    else {
                        continue;
                    };
                    // The motion alone is quickly fitted, and mostly it is that; where a look
                    // leaves as much as that, it is not.
                    let doubtful = if method == Method::Profile { 1.0 } else { 0.25 };
                    if one.leaves_less_than(doubtful) {
                        self.look_closer(&mut one, servo(method));
                    }
                    // Of a motion that leaves nothing more would be fitted to scatter.
                    let is_it = one.leaves_less_than(0.25);
                    all.push(one);
                    if is_it {
                        break;
                    }
                }
                // Looks tell which it is, and where its fit is to begin.
                if let Some(best) = least(&all).and_then(|best| all.get_mut(best)) {
                    let method = best.fit.method;
                    self.look_closer(best, servo(method));
                }
                let settled = all.iter().any(|c| c.leaves_less_than(0.5));
                if !settled {
                    all.extend(self.spline());
                }
                all
            }
        };
        let strange = candidates
            .iter()
            .filter(|c| c.fit.method != Method::Spline)
            .map(|c| c.strange_deg)
            .min_by(f64::total_cmp);
        let best = least(&candidates)?;
        let mut best = candidates.swap_remove(best);
        let is_strange = |off: f64| off > STRANGE_DEG && off > STRANGE * best.fit.sd_deg;
        let off = strange.filter(|off| is_strange(*off));
        if let (Method::Spline, None, Some(off)) = (best.fit.method, method, off) {
            let remark = Remark::NotAsCommanded { off: Degrees(off) };
            best.fit.remarks.push(remark);
        }
        Some((best.fit, best.pieces))
    }

    /// What a fit comes to, by few observations; by all of them where they are few.
    fn look(&self, servo: Servo, method: Method) -> Option<Candidate> {
        let guess = self.guess()?;
        let observed = condensed(&self.observed, &guess);
        let Some(fit) = profile_fit::look(&observed, guess, servo) else {
            return self.profile(servo, method, None);
        };
        let mut look = self.candidate(fit, method)?;
        look.is_look = true;
        Some(look)
    }

    /// Makes a fit to all observations of a look, if that is what it is and there is one.
    fn look_closer(&self, look: &mut Candidate, servo: Option<Servo>) {
        if let (true, Some(servo)) = (look.is_look, servo)
            && let Some(fit) = self.profile(servo, look.fit.method, look.fit.profile.as_ref())
        {
            *look = fit;
        }
    }

    fn profile(&self, servo: Servo, method: Method, begin: Option<&Profile>) -> Option<Candidate> {
        let guess = self.guess()?;
        let observed = condensed(&self.observed, &guess);
        let fit = profile_fit::fit(&observed, guess, servo, begin)?;
        self.candidate(fit, method)
    }

    fn candidate(&self, fit: ProfileFit, method: Method) -> Option<Candidate> {
        let end_s = self.observed.last()?.at_s;
        let pieces = pieces(&fit, self.origin, end_s)?;
        let remarks = fit.held.any().then_some(Remark::Regularised(fit.held));
        let mut candidate = self.judged(method, pieces)?;
        candidate.fit.profile = Some(fit.profile);
        candidate.fit.condition = Some(fit.condition);
        candidate.fit.remarks.extend(remarks);
        Some(candidate)
    }

    fn spline(&self) -> Option<Candidate> {
        let end_s = self.observed.last()?.at_s;
        let fit = spline::fit(&self.observed, self.origin, 0.0, end_s)?;
        let mut candidate = self.judged(Method::Spline, fit.pieces)?;
        candidate.fit.sd_deg *= SPLINE_BIAS;
        Some(candidate)
    }

    /// The motion as it was commanded, or as the sweep's ends tell it.
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
        // A way too short for the cruise: both ramps shrink alike, and with them the speed.
        let part = (way_deg / speed_deg_s) / ((up + down) / 2.0);
        if part < 1.0 {
            (up, down, speed_deg_s) = (
                up * part.sqrt(),
                down * part.sqrt(),
                speed_deg_s * part.sqrt(),
            );
            // Just so much that it counts as a triangle.
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

    /// What a curve's residuals say of it.
    fn judged(&self, method: Method, pieces: PiecewiseCubic) -> Option<Candidate> {
        let inside = |host: Stamp<Host>| self.sweep.start <= host && host <= self.sweep.end;
        let off: Vec<(f64, f64, f64)> = self
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
                Some((
                    s.angle.0 - piece.at(ns),
                    piece.rate(ns) * 1e9,
                    s.bound.as_secs_f64(),
                ))
            })
            .collect();
        let mean_square = |xs: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = xs.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
            if n > 0.0 { sum / n } else { 0.0 }
        };
        let rms_deg = mean_square(&mut off.iter().map(|o| o.0)).sqrt();
        let strange_deg = in_a_row(&off);
        let scatter = mean_square(
            &mut pieces
                .as_slice()
                .iter()
                .filter(|p| inside(p.from))
                .map(|p| p.sd_deg),
        );
        let fit = SweepFit {
            method,
            rms_deg,
            sd_deg: (scatter + strange_deg * strange_deg).sqrt(),
            delay: delay(&off),
            profile: None,
            condition: None,
            remarks: Vec::new(),
        };
        // What is left in a row is an error of every point of the sweep.
        let sd = |piece: &CubicPiece| f64::hypot(piece.sd_deg, strange_deg);
        let with_sd = pieces.as_slice().iter().map(|p| p.with_sd(sd(p))).collect();
        Some(Candidate {
            fit,
            pieces: PiecewiseCubic::new(with_sd, pieces.span().1)?,
            strange_deg,
            is_look: false,
        })
    }
}

/// The one with the least error.
fn least(candidates: &[Candidate]) -> Option<usize> {
    let sd = |i: &usize| candidates.get(*i).map_or(f64::INFINITY, |c| c.fit.sd_deg);
    (0..candidates.len()).min_by(|a, b| sd(a).total_cmp(&sd(b)))
}

/// Samples for a fit. While the axis rests all samples say one thing, and weigh as one.
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

/// The same with neighbours of the cruise put together where there are many, as a straight line
/// tells no more by its parts.
fn condensed(observed: &[Observed], guess: &Profile) -> Vec<Observed> {
    let [start, up, brake, end] = guess.corners_s();
    // The guess may be off, and a servo comes after.
    let beside = SETTLED_S + 0.5 * (up - start).max(end - brake);
    let is_straight = |o: &Observed| o.at_s > up + beside && o.at_s < brake - beside;
    let first = observed.partition_point(|o| !is_straight(o) && o.at_s < brake);
    let last = observed
        .partition_point(|o| o.at_s < brake - beside)
        .max(first);
    let (before, rest) = observed.split_at_checked(first).unwrap_or((observed, &[]));
    let (straight, after) = rest.split_at_checked(last - first).unwrap_or((rest, &[]));
    let group = straight.len() / MOST_STRAIGHT + 1;
    let few = straight.chunks(group).filter_map(together);
    let few: Vec<Observed> = few.collect();
    [before, &few, after].concat()
}

/// Observations of a straight line as one.
fn together(some: &[Observed]) -> Option<Observed> {
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

/// What residuals show that does not cancel over a row of them, root mean square, degrees: their
/// means' squares, less what scatter alone would make of these.
fn in_a_row(off: &[(f64, f64, f64)]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in off.chunks(ROW).filter(|row| row.len() > ROW / 2) {
        let n = row.len() as f64;
        let mean = row.iter().map(|o| o.0).sum::<f64>() / n;
        // Scatter by differences of neighbours: a slope within the row is no scatter.
        let differences: f64 = row
            .windows(2)
            .map(|pair| match pair {
                [a, b] => (b.0 - a.0).powi(2) / 2.0,
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

/// Between which delays every sample was taken within its bound: samples of the sweep's faster
/// half, whose residual tells when the axis was where they say.
fn delay(off: &[(f64, f64, f64)]) -> (Span, Span) {
    let fastest = off.iter().map(|o| o.1.abs()).fold(0.0, f64::max);
    let quick = off.iter().filter(|o| o.1.abs() > fastest / 2.0);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (off, rate, bound) in quick {
        let late = off / rate;
        low = low.max(-bound - late);
        high = high.min(bound - late);
    }
    if !low.is_finite() || !high.is_finite() {
        return (Span::ZERO, Span::ZERO);
    }
    // Residuals have errors of their own: where they leave nothing between, the middle is it.
    if high < low {
        let middle = (low + high) / 2.0;
        (low, high) = (middle, middle);
    }
    (
        Span::from_secs_f64(low.min(0.0)),
        Span::from_secs_f64(high.max(0.0)),
    )
}

/// A profile as cubics from the origin until `end_s`: its corners, behind them steps that grow as
/// the servo's answer decays.
fn pieces(fit: &ProfileFit, origin: Stamp<Host>, end_s: f64) -> Option<PiecewiseCubic> {
    let profile = &fit.profile;
    let mut at = vec![0.0, end_s];
    let corners = profile.corners_s();
    for corner in corners {
        at.push(corner);
        let inertia = profile.inertia_s2;
        let (mut since, lag) = (0.0, profile.lag_s);
        // How quickly it answers, and after what time the answer is over.
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
        // Hermite's error is (step / quick)^4 / 384 of what is left: below 1e-6 degrees for any
        // servo.
        while quick > 0.0 && since < 20.0 * over && at.len() < MOST_PIECES {
            since += quick / 8.0 * f64::exp((since / over / 4.0).min(3.0));
            at.push(corner + since);
        }
    }
    // What the samples scatter it by changes along the cruise.
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
            // Just inside: at a corner of a profile without lag the acceleration jumps, and the
            // speed does not.
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
