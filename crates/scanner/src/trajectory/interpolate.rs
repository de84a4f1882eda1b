//! From sample to sample: the nearest one, a straight line, or a cubic with the speeds between
//! neighbours.
//!
//! All three pass through every sample, including its error, and do not use the command. They are
//! cheap, possible while samples still come in, and independent of what moved the axis.

use units::Span;

use super::AngleSample;
use super::noise::{Noise, rates, seconds};
use super::pieces::{CubicPiece, PiecewiseCubic};

/// The angle of the nearest sample. Samples are in strictly increasing time.
pub(super) fn nearest(samples: &[AngleSample], noise: &Noise) -> Option<PiecewiseCubic> {
    let rates = rates(samples);
    let mut from = samples.first()?.host;
    let mut pieces = Vec::with_capacity(samples.len());
    for (i, (sample, rate)) in samples.iter().zip(&rates).enumerate() {
        let until = samples.get(i + 1).map_or(sample.host, |next| {
            let half = next.host.saturating_since(sample.host).half();
            sample.host.saturating_add(half)
        });
        // Mean square of a uniform distribution over the half intervals on both sides.
        let [a, b] = [
            sample.host.saturating_since(from),
            until.saturating_since(sample.host),
        ]
        .map(Span::as_secs_f64);
        let reach = ((a * a - a * b + b * b) / 3.0).sqrt();
        let sd = f64::hypot(noise.sd_deg(sample, *rate), rate * reach);
        pieces.push(CubicPiece::line(from, sample.angle.0, 0.0).with_sd(sd));
        from = until;
    }
    PiecewiseCubic::new(pieces, samples.last()?.host)
}

/// A straight line between neighbours. Samples are in strictly increasing time.
pub(super) fn linear(samples: &[AngleSample], noise: &Noise) -> Option<PiecewiseCubic> {
    let rates = rates(samples);
    let bent = |i: usize| bend(samples, i) / 8.0;
    between(samples, noise, &rates, |a, b, [sa, sb], i| {
        let ns = b.host.saturating_since(a.host).as_nanos() as f64;
        // Mean over the line of the variances of both ends, and of a parabola's distance from its
        // chord.
        let sd = f64::sqrt((sa * sa + sb * sb) / 3.0 + bent(i).powi(2) * (8.0 / 15.0));
        CubicPiece::line(a.host, a.angle.0, (b.angle.0 - a.angle.0) / ns).with_sd(sd)
    })
}

/// Straight lines from sample to sample while they come in.
#[derive(Clone, Debug, Default)]
pub(crate) struct StreamingFit {
    last: [Option<AngleSample>; 2],
}

impl StreamingFit {
    /// The newest sample.
    pub(crate) const fn newest(&self) -> Option<&AngleSample> {
        self.last[1].as_ref()
    }

    /// The line to a sample from the one before it; `None` for the first, and for one that is not
    /// later.
    pub(crate) fn add(&mut self, sample: AngleSample) -> Option<CubicPiece> {
        let [before, last] = self.last;
        if last.is_some_and(|last| sample.host <= last.host) {
            return None;
        }
        self.last = [last, Some(sample)];
        let last = last?;
        let rate = (sample.angle.0 - last.angle.0) / seconds(&last, &sample);
        let bent = before.map_or(0.0, |before| {
            let rate_before = (last.angle.0 - before.angle.0) / seconds(&before, &last);
            (rate - rate_before) * seconds(&last, &sample) / 8.0
        });
        let noise = Noise::UNIFORM;
        let [a, b] = [last, sample].map(|s| noise.sd_deg(&s, rate));
        let sd = f64::sqrt((a * a + b * b) / 3.0 + bent * bent * (8.0 / 15.0));
        Some(CubicPiece::line(last.host, last.angle.0, rate * 1e-9).with_sd(sd))
    }
}

/// A cubic between neighbours that never leaves their range. Its speed at each sample is that of
/// the parabola through it and its neighbours. Samples are in strictly increasing time.
pub(super) fn hermite(samples: &[AngleSample], noise: &Noise) -> Option<PiecewiseCubic> {
    let rates = rates(samples);
    let speeds = parabolas(samples);
    between(samples, noise, &rates, |a, b, [sa, sb], i| {
        let ns = b.host.saturating_since(a.host).as_nanos() as f64;
        let speed = |i: usize| speeds.get(i).copied().unwrap_or_default() * 1e-9;
        // The mean gain of a cubic convolution on noise is 57/70 = 0.81 (Keys 1981, kernel with a =
        // -1/2).
        let sd = f64::sqrt((sa * sa + sb * sb) / 2.0 * 57.0 / 70.0);
        let (from, to) = ([a.angle.0, speed(i)], [b.angle.0, speed(i + 1)]);
        CubicPiece::hermite(a.host, ns, from, to).with_sd(sd)
    })
}

fn between(
    samples: &[AngleSample],
    noise: &Noise,
    rates: &[f64],
    piece: impl Fn(&AngleSample, &AngleSample, [f64; 2], usize) -> CubicPiece,
) -> Option<PiecewiseCubic> {
    let (first, last) = (samples.first()?, samples.last()?);
    let mut pieces: Vec<CubicPiece> = samples
        .windows(2)
        .zip(rates.windows(2))
        .enumerate()
        .filter_map(|(i, pairs)| match pairs {
            ([a, b], [ra, rb]) => {
                let sds = [noise.sd_deg(a, *ra), noise.sd_deg(b, *rb)];
                Some(piece(a, b, sds, i))
            }
            _ => None,
        })
        .collect();
    if pieces.is_empty() {
        pieces.push(
            CubicPiece::line(first.host, first.angle.0, 0.0).with_sd(noise.sd_deg(first, 0.0)),
        );
    }
    PiecewiseCubic::new(pieces, last.host)
}

/// Change of the speed around the interval after sample `i`, times its length, degrees.
fn bend(samples: &[AngleSample], i: usize) -> f64 {
    let rate = |k: usize| {
        let (a, b) = (samples.get(k)?, samples.get(k + 1)?);
        Some((b.angle.0 - a.angle.0) / seconds(a, b))
    };
    let across = rate(i).unwrap_or_default();
    let before = i.checked_sub(1).and_then(rate).unwrap_or(across);
    let after = rate(i + 1).unwrap_or(across);
    let length = samples
        .get(i)
        .zip(samples.get(i + 1))
        .map_or(0.0, |(a, b)| seconds(a, b));
    // The middles of the intervals before and after are about two lengths apart.
    (after - before) / 2.0 * length
}

/// Degrees per second at each sample, of the parabola through it and both neighbours; at the ends,
/// of the line to the only one.
fn parabolas(samples: &[AngleSample]) -> Vec<f64> {
    let slope = |i: usize| {
        let (a, b) = (samples.get(i)?, samples.get(i + 1)?);
        let length = seconds(a, b);
        Some(((b.angle.0 - a.angle.0) / length, length))
    };
    (0..samples.len())
        .map(|i| match (i.checked_sub(1).and_then(slope), slope(i)) {
            (Some((before, h0)), Some((after, h1))) => {
                // Between close stamps the parabola is unstable: limited so that the cubic does not
                // leave the range of its ends (Fritsch and Carlson 1980).
                let most = 3.0 * f64::min(before.abs(), after.abs());
                let speed = (before * h1 + after * h0) / (h0 + h1);
                if before * after > 0.0 {
                    speed.clamp(-most, most)
                } else {
                    0.0
                }
            }
            (Some((only, _)), None) | (None, Some((only, _))) => only,
            (None, None) => 0.0,
        })
        .collect()
}

/// Sorts by time; of several samples at one instant the first is kept.
pub(super) fn in_order(mut samples: Vec<AngleSample>) -> Vec<AngleSample> {
    samples.sort_by_key(|s| s.host);
    samples.dedup_by_key(|s| s.host);
    samples
}
