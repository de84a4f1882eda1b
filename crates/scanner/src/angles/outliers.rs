//! Discards samples that no platform can produce: a single position far off its neighbours.
//!
//! A link without a checksum (SLCAN on a serial line) may pass a flipped bit as a position. The
//! motion between two samples is bounded by the motion around them and by the greatest
//! acceleration; a single sample beyond that is discarded. Runs of wrong samples are not found
//! here.

use super::AngleSample;

/// Smaller deviations are never outliers.
const ALWAYS_DEG: f64 = 0.1;
/// Above the acceleration of any tilting platform.
const HARDEST_DEG_S2: f64 = 20_000.0;

/// Twice the speed of the fastest sweep, 100 deg/s.
pub(crate) const MAX_SPEED_DEG_S: f64 = 200.0;

/// Whether an axis that moves at `speed_deg_s` at most gets from one sample to the next.
pub(crate) fn is_reached(from: &AngleSample, to: &AngleSample, speed_deg_s: f64) -> bool {
    let time = to.host.saturating_since(from.host) + from.bound + to.bound;
    (to.angle.0 - from.angle.0).abs() <= ALWAYS_DEG + speed_deg_s * time.as_secs_f64()
}

/// Discards outliers while samples come in: one that the axis cannot have reached waits for the
/// next, which shows whether the axis is there.
#[derive(Clone, Debug, Default)]
pub(crate) struct OutlierFilter {
    last: Option<AngleSample>,
    waiting: Option<AngleSample>,
}

impl OutlierFilter {
    /// The samples that are certain after this one, in order of time.
    pub fn push(&mut self, this: AngleSample) -> impl Iterator<Item = AngleSample> + use<> {
        let waited = self.waiting.take().filter(|waited| {
            self.last
                .is_none_or(|last| is_plausible(&last, waited, &this))
        });
        let last = waited.or(self.last);
        let is_reached = last.is_none_or(|last| is_reached(&last, &this, MAX_SPEED_DEG_S));
        self.last = last;
        match is_reached {
            true => self.last = Some(this),
            false => self.waiting = Some(this),
        }
        [waited, is_reached.then_some(this)].into_iter().flatten()
    }
}

/// Discards outliers from samples in order of time, and returns their number.
pub(crate) fn discard(samples: &mut Vec<AngleSample>) -> u64 {
    let before = samples.len();
    let mut kept: Vec<AngleSample> = Vec::with_capacity(before);
    for (i, this) in samples.iter().enumerate() {
        let plausible = match (kept.last(), samples.get(i + 1)) {
            (Some(last), Some(next)) => is_plausible(last, this, next),
            // The first and the last sample have no neighbour on one side.
            _ => true,
        };
        if plausible {
            kept.push(*this);
        }
    }
    *samples = kept;
    (before - samples.len()) as u64
}

fn is_plausible(last: &AngleSample, this: &AngleSample, next: &AngleSample) -> bool {
    let (since, until) = (
        this.host.saturating_since(last.host).as_secs_f64(),
        next.host.saturating_since(this.host).as_secs_f64(),
    );
    let whole = since + until;
    let across = next.angle.0 - last.angle.0;
    let share = if whole > 0.0 { since / whole } else { 0.5 };
    let deviation = (this.angle.0 - last.angle.0 - across * share).abs();
    // Motion in one direction never deviates from the line by more than its ends differ. A reversal
    // under full acceleration adds half of its distance; sample times vary within their bounds.
    let slack = (last.bound + this.bound + next.bound).as_secs_f64();
    let hard = 0.5 * HARDEST_DEG_S2 * (whole + slack).powi(2);
    deviation <= ALWAYS_DEG + across.abs() + hard
}

#[cfg(test)]
mod tests {
    use units::{Degrees, Span, Stamp};

    use super::*;

    fn samples(angles: impl IntoIterator<Item = f64>, step_us: i64) -> Vec<AngleSample> {
        let sample = |(i, angle)| AngleSample {
            host: Stamp::from_nanos(i as i64 * step_us * 1_000),
            bound: Span::from_micros(50),
            angle: Degrees(angle),
        };
        angles.into_iter().enumerate().map(sample).collect()
    }

    #[test]
    fn flipped_bits_are_discarded() {
        for bit in 8..31 {
            let mut stream = samples((0..100).map(|i| -0.05625 * f64::from(i)), 1_000);
            stream[40].angle.0 += 0.0015 * f64::from(1 << bit);
            let clean = stream.clone();
            assert_eq!(discard(&mut stream), 1, "bit {bit}");
            assert!(!stream.contains(&clean[40]));
        }
    }

    #[test]
    fn a_stream_is_filtered_without_delay() {
        let filtered = |stream: &[AngleSample]| -> Vec<AngleSample> {
            let mut filter = OutlierFilter::default();
            stream.iter().flat_map(|this| filter.push(*this)).collect()
        };
        let clean = samples((0..100).map(|i| -0.05625 * f64::from(i)), 1_000);
        assert_eq!(filtered(&clean), clean);
        let mut wild = clean.clone();
        wild[40].angle.0 += 1.5;
        let passed = filtered(&wild);
        assert_eq!(passed.len(), 99);
        assert!(!passed.contains(&wild[40]));
        // A drive that restarts at zero stays there.
        let restarted = samples((0..50).map(|i| if i < 20 { -30.0 } else { 0.0 }), 1_000);
        assert_eq!(filtered(&restarted), restarted);
    }

    #[test]
    fn the_fastest_motion_has_no_outliers() {
        // Triangles at 15,000 deg/s2, polled every 5 ms, 60 ms and at random.
        for step_us in [1_000, 5_000, 60_000] {
            let angle = |t: f64| {
                let t = t.rem_euclid(0.4);
                let half = |t: f64| 0.5 * 15_000.0 * t * t;
                if t < 0.1 {
                    half(t)
                } else if t < 0.3 {
                    2.0 * half(0.1) - half(0.2 - t)
                } else {
                    half(0.4 - t)
                }
            };
            let mut moving = samples(
                (0..500).map(|i| angle(f64::from(i) * step_us as f64 * 1e-6)),
                step_us,
            );
            assert_eq!(discard(&mut moving), 0, "{step_us}");
        }
    }

    #[test]
    fn a_lasting_jump_is_kept() {
        let mut jumped = samples((0..50).map(|i| if i < 20 { 0.0 } else { 30.0 }), 1_000);
        assert_eq!(discard(&mut jumped), 0);
        assert_eq!(discard(&mut Vec::new()), 0);
    }
}
