//! Course of the motor shaft: its position at every control cycle, linear in between.
//!
//! Eight bytes per millisecond. Positions are mechanical, independent of the drive.s zero.

use units::{Gearing, Span};

use crate::gear_ripple::GearRipple;
use crate::motion::AxisState;
use crate::packet_maker::Platform;

/// The drive's control cycle.
pub(crate) const CYCLE: Span = Span::from_millis(1);
const CYCLE_NS: i64 = CYCLE.as_nanos();

/// Positions of the motor shaft over the whole run. Times are host nanoseconds since the start.
#[derive(Clone, Debug)]
pub(crate) struct ShaftCourse {
    /// Time of the first knot.
    first_ns: i64,
    degrees_per_qc: f64,
    qc_per_motor_turn: f64,
    ripple: Option<GearRipple>,
    /// Position at the beginning of each cycle and at the end of the last, in 2^-32 quadcounts.
    knots: Vec<i64>,
}

impl ShaftCourse {
    /// A shaft at `position` (2^-32 quadcounts) at the beginning of the first cycle, behind a gear
    /// with this ripple.
    pub fn new(gearing: Gearing, position: i64, ripple: Option<GearRipple>) -> Self {
        Self {
            first_ns: 0,
            degrees_per_qc: gearing.degrees_per_qc(),
            qc_per_motor_turn: f64::from(gearing.qc_per_motor_turn()),
            ripple,
            knots: vec![position],
        }
    }

    /// Adds the next cycle, at whose end the shaft is at `position` (2^-32 quadcounts).
    pub fn push(&mut self, position: i64) {
        self.knots.push(position);
    }

    /// Drops the motion before `host_ns` in whole cycles. The last knot is kept.
    pub fn forget_before(&mut self, host_ns: i64) {
        let since_ns = host_ns.saturating_sub(self.first_ns);
        let cycles = usize::try_from(since_ns.div_euclid(CYCLE_NS)).unwrap_or(0);
        let cycles = cycles.min(self.knots.len().saturating_sub(1));
        self.knots.drain(..cycles);
        self.first_ns += i64::try_from(cycles).unwrap_or(0) * CYCLE_NS;
    }

    /// End of the known motion: the beginning of the next cycle.
    pub fn end_ns(&self) -> i64 {
        let cycles = i64::try_from(self.knots.len().saturating_sub(1)).unwrap_or(i64::MAX);
        self.first_ns
            .saturating_add(cycles.saturating_mul(CYCLE_NS))
    }
}

impl Platform for ShaftCourse {
    #[inline]
    fn state(&self, host_ns: i64) -> Option<AxisState> {
        const QUADCOUNT: f64 = (1_u64 << 32) as f64;
        let since_ns = host_ns.saturating_sub(self.first_ns);
        let cycle = usize::try_from(since_ns.div_euclid(CYCLE_NS)).ok()?;
        let into = since_ns.rem_euclid(CYCLE_NS) as f64 / CYCLE_NS as f64;
        let from = *self.knots.get(cycle)? as f64;
        let to = *self.knots.get(cycle + 1)? as f64;
        let position_qc = (from + (to - from) * into) / QUADCOUNT;
        let rate_qc_s = (to - from) / QUADCOUNT / CYCLE.as_secs_f64();
        let (mut angle_deg, mut rate_deg_s) = (
            position_qc * self.degrees_per_qc,
            rate_qc_s * self.degrees_per_qc,
        );
        if let Some(ripple) = &self.ripple {
            let turns = position_qc / self.qc_per_motor_turn;
            angle_deg += ripple.ahead(turns).0;
            rate_deg_s += ripple.ahead_per_turn(turns).0 * rate_qc_s / self.qc_per_motor_turn;
        }
        Some(AxisState {
            angle_deg,
            rate_deg_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use units::Degrees;

    use super::*;

    const QC: i64 = 1 << 32;

    fn shaft_with(ripple: Option<GearRipple>) -> ShaftCourse {
        let gearing = Gearing::new(500, 120, 1).unwrap();
        let mut shaft = ShaftCourse::new(gearing, -QC, ripple);
        shaft.push(-3 * QC);
        shaft.push(-3 * QC + QC / 2);
        shaft
    }

    fn shaft() -> ShaftCourse {
        shaft_with(None)
    }

    fn tilt(shaft: &ShaftCourse, ns: i64) -> Option<f64> {
        shaft.state(ns).map(|state| state.angle_deg)
    }

    #[test]
    fn angles_are_linear_between_cycles_and_rates_are_their_slopes() {
        for (ns, qc, qc_per_ms) in [
            (0, -1.0, -2.0),
            (500_000, -2.0, -2.0),
            (1_000_000, -3.0, 0.5),
            (1_999_999, -2.500_000_5, 0.5),
        ] {
            let state = shaft().state(ns).unwrap();
            assert!((state.angle_deg - 0.0015 * qc).abs() < 1e-15, "{ns}");
            assert!((state.rate_deg_s - 1.5 * qc_per_ms).abs() < 1e-12, "{ns}");
        }
    }

    #[test]
    fn angles_are_unknown_before_and_after() {
        assert_eq!(tilt(&shaft(), -1), None);
        assert_eq!(tilt(&shaft(), 2_000_000), None);
        assert_eq!(tilt(&shaft(), i64::MAX), None);
        assert_eq!(shaft().end_ns(), 2_000_000);
    }

    #[test]
    fn dropped_motion_is_unknown_and_the_rest_unchanged() {
        let mut short = shaft();
        short.forget_before(0);
        assert_eq!(short.knots, shaft().knots);
        short.forget_before(1_700_000);
        assert_eq!(tilt(&short, 999_999), None);
        for ns in [1_000_000, 1_500_000, 1_999_999] {
            assert_eq!(tilt(&short, ns), tilt(&shaft(), ns), "{ns}");
        }
        short.forget_before(i64::MAX);
        assert_eq!(short.end_ns(), shaft().end_ns());
        short.push(0);
        assert_eq!(short.knots.len(), 2);
    }

    #[test]
    fn gear_ripple_moves_only_the_platform() {
        let even = shaft();
        let rippled = shaft_with(Some(GearRipple {
            amplitude: Degrees(0.003),
            per_motor_turn: 1,
            phase: Degrees(90.0),
        }));
        let off = tilt(&rippled, 500_000).unwrap() - tilt(&even, 500_000).unwrap();
        let turn = (-2.0 / 2000.0_f64) * core::f64::consts::TAU;
        assert!((off - 0.003 * turn.cos()).abs() < 1e-12, "{off}");
        assert_eq!(rippled.knots, even.knots);
        // The rate is the slope.
        let near = |ns: i64| rippled.state(ns).unwrap();
        let slope = (near(500_100).angle_deg - near(499_900).angle_deg) / 200e-9;
        assert!((slope - near(500_000).rate_deg_s).abs() < 1e-6, "{slope}");
    }
}
