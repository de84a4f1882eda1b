//! Tilt angle over host time, from samples to an angle at any instant.
//!
//! Between sweeps, and with methods that do not fit sweeps, a [`Trajectory`] connects sample to
//! sample (`interpolate`). Over each sweep it may be the commanded motion fitted to the samples
//! (`profile`, `profile_fit`) or a spline through them (`spline`), whichever has the smaller error
//! (`choose`). All end as piecewise cubics (`pieces`). A trajectory never extrapolates: outside its
//! samples there is no angle.

use units::{DegPerS, Degrees, Host, Span, Stamp};

use crate::angles::AngleSample;
use crate::clock::Moment;
use crate::sweeps::Sweep;

mod at_renewals;
mod banded;
mod bound;
mod candidate;
mod choose;
mod commanded;
mod interpolate;
mod kinks;
mod latch;
mod noise;
mod observations;
mod pieces;
mod prior;
mod profile;
mod profile_fit;
mod profile_pieces;
mod renewals;
mod spline;
#[cfg(test)]
mod tests;

pub use choose::SweepFit;
pub(crate) use interpolate::StreamingFit;
pub use noise::Noise;
pub use pieces::{CubicPiece, PiecewiseCubic};
pub use prior::RegularisedParameters;
pub use profile::Profile;

/// Method by which the angle between samples is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// None: the platform does not tilt.
    None,
    /// The nearest sample.
    Nearest,
    /// A straight line between neighbours.
    Linear,
    /// A cubic between neighbours, with speeds from their neighbours.
    Hermite,
    /// A least-squares spline through a sweep's samples.
    Spline,
    /// The commanded motion, fitted to a sweep's samples.
    Profile,
    /// The commanded motion behind a servo of first order.
    ProfileServo,
    /// The commanded motion behind a servo of second order, which may overshoot.
    ProfileServo2,
}

impl Method {
    /// All methods that use samples, in order of cost.
    pub const ALL: [Self; 7] = [
        Self::Nearest,
        Self::Linear,
        Self::Hermite,
        Self::Profile,
        Self::ProfileServo,
        Self::ProfileServo2,
        Self::Spline,
    ];

    /// Name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Nearest => "nearest",
            Self::Linear => "linear",
            Self::Hermite => "hermite",
            Self::Spline => "spline",
            Self::Profile => "profile",
            Self::ProfileServo => "profile+servo",
            Self::ProfileServo2 => "profile+servo2",
        }
    }

    /// Whether it fits whole sweeps; between sweeps it is linear.
    #[must_use]
    pub const fn is_fit(self) -> bool {
        matches!(
            self,
            Self::Spline | Self::Profile | Self::ProfileServo | Self::ProfileServo2
        )
    }
}

/// A remark on a sweep's angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remark {
    /// The motion was not the commanded one.
    NotAsCommanded {
        /// Error of a profile, root mean square.
        off: Degrees,
    },
    /// Some parameters of the motion follow from the command, as the samples do not determine them.
    Regularised(RegularisedParameters),
    /// Too few samples for a fit: they are connected by straight lines.
    TooFewSamples,
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotAsCommanded { off } => write!(
                f,
                "the motion was not the commanded one, by {:.3} deg: the angles follow the samples instead",
                off.0
            ),
            Self::Regularised(held) => {
                let parts = [
                    (held.start, "beginning"),
                    (held.ramp_up, "acceleration"),
                    (held.ramp_down, "deceleration"),
                    (held.way, "end"),
                    (held.servo, "servo"),
                ];
                let parts: Vec<&str> = parts.iter().filter(|p| p.0).map(|p| p.1).collect();
                write!(
                    f,
                    "too few samples of its {}: kept near the commanded values",
                    parts.join(" and ")
                )
            }
            Self::TooFewSamples => {
                f.write_str("too few samples for a fit: they are joined by straight lines")
            }
        }
    }
}

/// The tilt angle as a function of host time.
#[derive(Clone, Debug)]
pub struct Trajectory {
    curve: Curve,
    method: Method,
    fits: Vec<SweepFit>,
    /// In strictly increasing time.
    samples: Vec<AngleSample>,
    /// One step of the encoder.
    step_deg: f64,
}

#[derive(Clone, Debug)]
pub(crate) enum Curve {
    Fixed(Degrees),
    Piecewise(PiecewiseCubic),
}

impl Trajectory {
    /// A platform that stands still.
    #[must_use]
    pub const fn fixed(angle: Degrees) -> Self {
        Self::of_curve(Curve::Fixed(angle), Method::None)
    }

    const fn of_curve(curve: Curve, method: Method) -> Self {
        Self {
            curve,
            method,
            fits: Vec::new(),
            samples: Vec::new(),
            step_deg: 0.0,
        }
    }

    /// A trajectory through samples in any order; of several at one instant the first is kept.
    /// Angles are quantised by `quantum`. A method that fits sweeps covers `sweeps` and is linear
    /// elsewhere; without a method each sweep gets the one with the smallest error. `None` without
    /// samples.
    #[must_use]
    pub fn through(
        samples: Vec<AngleSample>,
        quantum: Degrees,
        sweeps: &[Sweep],
        method: Option<Method>,
    ) -> Option<Self> {
        let samples = interpolate::in_order(centred(samples, quantum));
        let noise = Noise::of(&samples, quantum);
        let pieces = match method {
            Some(Method::Nearest) => interpolate::nearest(&samples, &noise),
            Some(Method::Hermite) => interpolate::hermite(&samples, &noise),
            _ => interpolate::linear(&samples, &noise),
        }?;
        let simple = method.filter(|m| !m.is_fit() && *m != Method::None);
        let mut trajectory = Self {
            curve: Curve::Piecewise(pieces),
            method: simple.unwrap_or(Method::Linear),
            fits: Vec::new(),
            samples,
            step_deg: quantum.0.abs(),
        };
        if simple.is_none() {
            trajectory.fit(&noise, sweeps, method);
        }
        Some(trajectory)
    }

    /// Adds an error of time common to all samples, one standard deviation in nanoseconds, to each
    /// piece's error at its speed.
    #[must_use]
    pub(crate) fn with_shared_sd(mut self, sd_ns: f64) -> Self {
        if let Curve::Piecewise(pieces) = &mut self.curve {
            pieces.widen(sd_ns);
        }
        self
    }

    /// Replaces the straight lines over each sweep by a fit.
    fn fit(&mut self, noise: &Noise, sweeps: &[Sweep], method: Option<Method>) {
        let Curve::Piecewise(pieces) = &mut self.curve else {
            return;
        };
        for (i, sweep) in sweeps.iter().enumerate() {
            // Half of the pause between two sweeps belongs to each.
            let pause =
                |a: &Sweep, b: &Sweep| a.end.saturating_add(b.start.saturating_since(a.end).half());
            let before = i.checked_sub(1).and_then(|i| sweeps.get(i));
            let low = before.map_or(Stamp::from_nanos(i64::MIN), |before| pause(before, sweep));
            let next = sweeps.get(i + 1);
            let high = next.map_or(Stamp::from_nanos(i64::MAX), |next| pause(sweep, next));
            // The noise of this sweep alone: one estimate for all would mix fast sweeps with rest.
            let inside = within(&self.samples, (sweep.start, sweep.end));
            let noise = Noise::of(inside, Degrees(noise.angle_sd_deg * f64::sqrt(12.0)));
            let best = choose::Candidates::new(sweep, &self.samples, &noise, (low, high))
                .and_then(|candidates| candidates.best(method));
            let fit = match best {
                Some((fit, over)) => {
                    pieces.replace(&over);
                    fit
                }
                None => SweepFit {
                    method: Method::Linear,
                    rms_deg: leave_one_out_rms(inside).unwrap_or_default(),
                    sd_deg: 0.0,
                    delay: (Span::ZERO, Span::ZERO),
                    profile: None,
                    condition: None,
                    remarks: vec![Remark::TooFewSamples],
                },
            };
            self.fits.push(fit);
        }
        if let Some(first) = self.fits.first() {
            self.method = first.method;
        }
    }

    /// A trajectory of one piece, to be continued by [`Trajectory::append`].
    pub(crate) fn of_piece(piece: CubicPiece, end: Stamp<Host>, method: Method) -> Option<Self> {
        let curve = Curve::Piecewise(PiecewiseCubic::new(vec![piece], end)?);
        Some(Self::of_curve(curve, method))
    }

    /// Continues with `piece` until `end`.
    pub(crate) fn append(&mut self, piece: CubicPiece, end: Stamp<Host>) {
        if let Curve::Piecewise(pieces) = &mut self.curve {
            pieces.append(piece, end);
        }
    }

    /// Drops pieces that end before `host`.
    pub(crate) fn drop_before(&mut self, host: Stamp<Host>) {
        if let Curve::Piecewise(pieces) = &mut self.curve {
            pieces.drop_before(host);
        }
    }

    /// The angle at an instant; `None` outside the time of the samples.
    #[must_use]
    pub fn angle(&self, at: Moment) -> Option<Degrees> {
        match &self.curve {
            Curve::Fixed(angle) => Some(*angle),
            Curve::Piecewise(pieces) => pieces.angle(at),
        }
    }

    /// The piece at an instant; `None` for a fixed platform, and outside the time of the samples.
    #[must_use]
    pub fn piece(&self, at: Moment) -> Option<&CubicPiece> {
        match &self.curve {
            Curve::Fixed(_) => None,
            Curve::Piecewise(pieces) => pieces.piece(at),
        }
    }

    /// Variance of the angle at an instant known to `clock_sd_ns` nanoseconds (one standard
    /// deviation), square radians: (piece's deviation)^2 + (rate x clock's deviation)^2. 0 without
    /// a piece.
    #[must_use]
    pub fn variance_rad2(&self, at: Moment, clock_sd_ns: f64) -> f64 {
        self.piece(at).map_or(0.0, |piece| {
            piece.variance_rad2(piece.rate(piece.since(at)), clock_sd_ns)
        })
    }

    pub(crate) const fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The samples, in strictly increasing time; none for a fixed platform.
    #[must_use]
    pub fn samples(&self) -> &[AngleSample] {
        &self.samples
    }

    /// The samples within a span.
    pub(crate) fn samples_within(&self, span: (Stamp<Host>, Stamp<Host>)) -> &[AngleSample] {
        within(&self.samples, span)
    }

    /// The method; of several sweeps that of the first.
    #[must_use]
    pub const fn method(&self) -> Method {
        self.method
    }

    /// The fit of each sweep; empty if no sweeps were fitted.
    #[must_use]
    pub fn fits(&self) -> &[SweepFit] {
        &self.fits
    }

    /// Agreement of the samples within `spans`, degrees: their root mean square deviation from the
    /// fits, or without fits from the line between their neighbours. `None` with too few samples.
    ///
    /// It contains the jitter of the stamps, and for lines their error on ramps; a constant delay
    /// does not appear.
    #[must_use]
    pub fn rms_deg(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> Option<f64> {
        if self.fits.is_empty() {
            let squares = spans.iter().filter_map(|span| {
                let inside = within(&self.samples, *span);
                leave_one_out_rms(inside).map(|rms| (rms * rms * inside.len() as f64, inside.len()))
            });
            let (sum, count) =
                squares.fold((0.0, 0), |(s, n), (square, count)| (s + square, n + count));
            return (count > 0).then(|| (sum / count as f64).sqrt());
        }
        let squares: f64 = self.fits.iter().map(|fit| fit.rms_deg * fit.rms_deg).sum();
        Some((squares / self.fits.len() as f64).sqrt())
    }

    /// Greatest error of the angle within `spans`, degrees. For fits: three standard deviations or
    /// half a step of the encoder, whichever is greater, the delay that all samples may share at
    /// the speed there, and the error of corners that the samples do not determine, as of ramps
    /// shorter than their interval. For connected samples: a step of the encoder, half a poll's
    /// round trip at the speed there, and the error of a straight line where the speed changes.
    #[must_use]
    pub fn bound_deg(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> f64 {
        let over = |(i, span): (usize, &(Stamp<Host>, Stamp<Host>))| {
            let fit = self.fits.get(i).filter(|fit| fit.method.is_fit());
            match (fit, &self.curve) {
                (Some(fit), Curve::Piecewise(pieces)) => {
                    let is_regularised = |remark: &Remark| matches!(remark, Remark::Regularised(_));
                    let is_open = fit.remarks.iter().any(is_regularised);
                    let samples = within(&self.samples, *span);
                    let inner = bound::of_fit(pieces, *span, fit, self.step_deg);
                    match &fit.profile {
                        Some(profile) if is_open => inner + bound::of_corner(samples, profile),
                        Some(profile) => inner + bound::of_short_ramps(samples, profile),
                        None => inner,
                    }
                }
                _ => self.step_deg + bound::of_joined(&self.samples, *span, self.method),
            }
        };
        spans.iter().enumerate().map(over).fold(0.0, f64::max)
    }

    /// The part of [`Trajectory::bound_deg`] due to a delay that all samples of a sweep may share,
    /// degrees.
    #[must_use]
    pub fn delay_deg(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> f64 {
        let fastest = self.fastest(spans).0.abs();
        let shared = self.fits.iter().map(SweepFit::shared_s);
        shared.fold(0.0, f64::max) * fastest
    }

    /// Greatest speed within `spans`, signed; zero without samples.
    #[must_use]
    pub fn fastest(&self, spans: &[(Stamp<Host>, Stamp<Host>)]) -> DegPerS {
        let inside = spans.iter().map(|span| within(&self.samples, *span));
        // Over several samples: between neighbours the jitter of stamps would count as speed.
        let speeds = inside.flat_map(|samples| {
            samples.windows(8).filter_map(|window| {
                let (a, b) = (window.first()?, window.last()?);
                Some((b.angle.0 - a.angle.0) / noise::seconds(a, b))
            })
        });
        DegPerS(speeds.fold(0.0, |most: f64, speed| {
            if speed.abs() > most.abs() {
                speed
            } else {
                most
            }
        }))
    }
}

/// Samples within a span.
fn within(samples: &[AngleSample], (from, to): (Stamp<Host>, Stamp<Host>)) -> &[AngleSample] {
    let low = samples.partition_point(|s| s.host < from);
    let high = samples.partition_point(|s| s.host <= to);
    samples.get(low..high.max(low)).unwrap_or_default()
}

/// Root mean square deviation of each sample from the line between its neighbours, degrees. `None`
/// with fewer than three samples.
fn leave_one_out_rms(samples: &[AngleSample]) -> Option<f64> {
    let off = samples.windows(3).filter_map(|w| match w {
        [a, b, c] => {
            let part = noise::seconds(a, b) / noise::seconds(a, c);
            Some(a.angle.0 + (c.angle.0 - a.angle.0) * part - b.angle.0)
        }
        _ => None,
    });
    let (sum, count) = off.fold((0.0, 0u32), |(sum, n), e| (sum + e * e, n + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

/// Corrects for quantisation. On its way through a count the shaft is on average in the middle of
/// it; at rest it is at the count's edge, where it was sent.
fn centred(mut samples: Vec<AngleSample>, quantum: Degrees) -> Vec<AngleSample> {
    samples.sort_by_key(|s| s.host);
    let angles: Vec<f64> = samples.iter().map(|s| s.angle.0).collect();
    let alike = |a: &f64, b: &f64| (a - b).abs() < quantum.0.abs() / 2.0;
    let runs: Vec<(f64, usize)> = angles
        .chunk_by(alike)
        .filter_map(|run| Some((*run.first()?, run.len())))
        .collect();
    let passes = |i: usize| {
        let before = i.checked_sub(1).and_then(|i| runs.get(i));
        match (before, runs.get(i), runs.get(i + 1)) {
            (Some(before), Some(here), Some(after)) => {
                (here.0 - before.0) * (after.0 - here.0) > 0.0
            }
            _ => false,
        }
    };
    let mut rest = samples.iter_mut();
    for (i, (_, count)) in runs.iter().enumerate() {
        let shift = if passes(i) {
            quantum.0.abs() / 2.0
        } else {
            0.0
        };
        for sample in rest.by_ref().take(*count) {
            sample.angle.0 += shift;
        }
    }
    samples
}
