//! Where the motor shaft has been: its position at every control cycle, straight in between.
//!
//! Eight bytes a millisecond. The position is the mechanical one, whatever the drive calls zero. Left out: how it moved,
//! which is the drive's firmware, and backlash and ripple of the gear.

use units::{Degrees, Gearing, Host, Span, Stamp};

/// The drive's control cycle.
pub(crate) const CYCLE: Span = Span::from_millis(1);

/// Positions of the motor shaft over the whole run.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    start: Stamp<Host>,
    degrees_per_qc: f64,
    /// Position at the beginning of each cycle, and at the end of the last, in 2^-32 quadcounts.
    knots: Vec<i64>,
}

impl Shaft {
    /// A shaft at `position` (2^-32 quadcounts) at the beginning of the first cycle.
    pub fn new(start: Stamp<Host>, gearing: Gearing, position: i64) -> Self {
        Self {
            start,
            degrees_per_qc: gearing.degrees_per_qc(),
            knots: vec![position],
        }
    }

    /// Adds the next cycle, at whose end the shaft is at `position` (2^-32 quadcounts).
    pub fn push(&mut self, position: i64) {
        self.knots.push(position);
    }

    /// Where the known motion ends: the beginning of the next cycle.
    pub fn end(&self) -> Stamp<Host> {
        let cycles = i64::try_from(self.knots.len().saturating_sub(1)).unwrap_or(i64::MAX);
        let ns = cycles.saturating_mul(CYCLE.as_nanos());
        self.start.saturating_add(Span::from_nanos(ns))
    }

    /// The tilt angle at an instant of the known motion.
    #[inline]
    pub fn tilt(&self, host: Stamp<Host>) -> Option<Degrees> {
        let since = host.saturating_since(self.start).as_nanos();
        let cycle = usize::try_from(since.div_euclid(CYCLE.as_nanos())).ok()?;
        let into = since.rem_euclid(CYCLE.as_nanos()) as f64 / CYCLE.as_nanos() as f64;
        let from = *self.knots.get(cycle)? as f64;
        let to = *self.knots.get(cycle + 1)? as f64;
        const QUADCOUNT: f64 = (1_u64 << 32) as f64;
        Some(Degrees(
            (from + (to - from) * into) / QUADCOUNT * self.degrees_per_qc,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QC: i64 = 1 << 32;

    fn shaft() -> Shaft {
        let gearing = Gearing::new(500, 120, 1).unwrap();
        let mut shaft = Shaft::new(Stamp::from_nanos(1_000), gearing, -QC);
        shaft.push(-3 * QC);
        shaft.push(-3 * QC + QC / 2);
        shaft
    }

    fn tilt(ns: i64) -> Option<f64> {
        shaft()
            .tilt(Stamp::from_nanos(1_000 + ns))
            .map(|angle| angle.0)
    }

    #[test]
    fn straight_between_cycles() {
        for (ns, qc) in [
            (0, -1.0),
            (500_000, -2.0),
            (1_000_000, -3.0),
            (1_999_999, -2.500_000_5),
        ] {
            assert!((tilt(ns).unwrap() - 0.0015 * qc).abs() < 1e-15, "{ns}");
        }
    }

    #[test]
    fn unknown_before_and_after() {
        assert_eq!(tilt(-1), None);
        assert_eq!(tilt(2_000_000), None);
        assert_eq!(tilt(i64::MAX - 1_000), None);
        assert_eq!(shaft().end(), Stamp::from_nanos(2_001_000));
    }
}
