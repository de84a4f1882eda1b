//! Where the motor shaft has been: its position at every control cycle, straight in between.
//!
//! Eight bytes a millisecond. The position is the mechanical one, whatever the drive calls zero. Left out: how it moved,
//! which is the drive's firmware, and backlash of the gear.

use crate::effects::GearRipple;
use units::{Degrees, Gearing, Host, Span, Stamp};

/// The drive's control cycle.
pub(crate) const CYCLE: Span = Span::from_millis(1);

/// Positions of the motor shaft over the whole run.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    start: Stamp<Host>,
    degrees_per_qc: f64,
    qc_per_motor_turn: f64,
    ripple: Option<GearRipple>,
    /// Position at the beginning of each cycle, and at the end of the last, in 2^-32 quadcounts.
    knots: Vec<i64>,
}

impl Shaft {
    /// A shaft at `position` (2^-32 quadcounts) at the beginning of the first cycle.
    pub fn new(start: Stamp<Host>, gearing: Gearing, position: i64) -> Self {
        Self {
            start,
            degrees_per_qc: gearing.degrees_per_qc(),
            qc_per_motor_turn: f64::from(gearing.qc_per_motor_turn()),
            ripple: None,
            knots: vec![position],
        }
    }

    /// The same behind a gear that is not true.
    pub fn with_ripple(self, ripple: Option<GearRipple>) -> Self {
        Self { ripple, ..self }
    }

    /// Adds the next cycle, at whose end the shaft is at `position` (2^-32 quadcounts).
    pub fn push(&mut self, position: i64) {
        self.knots.push(position);
    }

    /// Forgets the motion before `host`, as far as whole cycles go. The last one is kept.
    pub fn forget_before(&mut self, host: Stamp<Host>) {
        let since = host.saturating_since(self.start).as_nanos();
        let cycles = usize::try_from(since.div_euclid(CYCLE.as_nanos())).unwrap_or(0);
        let cycles = cycles.min(self.knots.len().saturating_sub(1));
        self.knots.drain(..cycles);
        let ns = i64::try_from(cycles).unwrap_or(0) * CYCLE.as_nanos();
        self.start = self.start.saturating_add(Span::from_nanos(ns));
    }

    /// Where the known motion ends: the beginning of the next cycle.
    pub fn end(&self) -> Stamp<Host> {
        let cycles = i64::try_from(self.knots.len().saturating_sub(1)).unwrap_or(i64::MAX);
        let ns = cycles.saturating_mul(CYCLE.as_nanos());
        self.start.saturating_add(Span::from_nanos(ns))
    }

    /// The platform's tilt angle at an instant of the known motion.
    #[inline]
    pub fn tilt(&self, host: Stamp<Host>) -> Option<Degrees> {
        let since = host.saturating_since(self.start).as_nanos();
        let cycle = usize::try_from(since.div_euclid(CYCLE.as_nanos())).ok()?;
        let into = since.rem_euclid(CYCLE.as_nanos()) as f64 / CYCLE.as_nanos() as f64;
        let from = *self.knots.get(cycle)? as f64;
        let to = *self.knots.get(cycle + 1)? as f64;
        const QUADCOUNT: f64 = (1_u64 << 32) as f64;
        let position_qc = (from + (to - from) * into) / QUADCOUNT;
        let even = position_qc * self.degrees_per_qc;
        Some(match &self.ripple {
            None => Degrees(even),
            Some(ripple) => Degrees(even + ripple.ahead(position_qc / self.qc_per_motor_turn).0),
        })
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

    #[test]
    fn what_is_forgotten_is_unknown_and_the_rest_as_it_was() {
        let mut forgetful = shaft();
        let begin = Stamp::from_nanos(1_000);
        forgetful.forget_before(begin);
        assert_eq!(forgetful.knots, shaft().knots);
        forgetful.forget_before(Stamp::from_nanos(1_000 + 1_700_000));
        assert_eq!(forgetful.tilt(Stamp::from_nanos(1_000 + 999_999)), None);
        for ns in [1_000_000, 1_500_000, 1_999_999] {
            let at = Stamp::from_nanos(1_000 + ns);
            assert_eq!(forgetful.tilt(at), shaft().tilt(at), "{ns}");
        }
        forgetful.forget_before(Stamp::from_nanos(i64::MAX));
        assert_eq!(forgetful.end(), shaft().end());
        forgetful.push(0);
        assert_eq!(forgetful.knots.len(), 2);
    }

    #[test]
    fn a_gear_that_is_not_true_moves_the_platform_alone() {
        let ripple = GearRipple {
            amplitude: Degrees(0.003),
            per_motor_turn: 1,
            phase: Degrees(90.0),
        };
        let even = shaft();
        let rippled = shaft().with_ripple(Some(ripple));
        let at = Stamp::from_nanos(501_000);
        let off = rippled.tilt(at).unwrap().0 - even.tilt(at).unwrap().0;
        let turn = (-2.0 / 2000.0_f64) * core::f64::consts::TAU;
        assert!((off - 0.003 * turn.cos()).abs() < 1e-12, "{off}");
        assert_eq!(rippled.knots, even.knots);
    }
}
