//! The instants at which a drive renewed its position.
//!
//! A latched position is exact at its renewal, whatever its age when it was polled. The curve that
//! shows a latch shows which renewal each sample belongs to, where the axis is quick; samples at
//! their renewals have no ages, and a fit through them has no error by them. The drift of the
//! drive's clock cannot be told from an error of the curve's speed: it stays an error.

use super::latch::{CYCLE_S, MAX_COUNT_S, Residual, WINDOW, mean_direction};

/// Relative drift of the drive's clock against the host's, one standard deviation: two crystals of
/// 50 ppm.
const DRIFT_SD: f64 = 50e-6;
/// The instants at which the positions of samples were renewed.
pub(super) struct Renewals {
    /// Middle of the sweep and phase there, seconds, and growth of the phase per second.
    middle_s: f64,
    phase_s: f64,
    drift: f64,
    /// Standard deviation of the growth.
    drift_sd: f64,
    count_deg: f64,
}

/// Error of a curve, in cycles at the speed there, up to which a residual shows its renewal.
const MAX_CURVE_CYCLES: f64 = 0.25;
/// Standard deviations of the curve within that.
const CURVE_SDS: f64 = 4.0;
/// Share of samples that may lie halfway between two renewals.
const MAX_DOUBTFUL: f64 = 0.02;

impl Renewals {
    /// The grid of instants at which a curve had the angles of latched samples.
    pub fn find(residuals: &[Residual], angle_sd_deg: f64) -> Option<Self> {
        let count_deg = angle_sd_deg * f64::sqrt(12.0);
        let quick: Vec<Residual> = residuals
            .iter()
            .filter(|r| shows_renewal(r, count_deg))
            .copied()
            .collect();
        let mut phases: Vec<(f64, f64)> = Vec::new();
        for window in quick.chunks(WINDOW) {
            let (Some(first), Some(last)) = (window.first(), window.last()) else {
                continue;
            };
            let (cosine, sine) = mean_direction(window, |r| r.at_s + r.late_s());
            let mut phase_s = sine.atan2(cosine) / std::f64::consts::TAU * CYCLE_S;
            if let Some((_, before_s)) = phases.last() {
                phase_s += ((before_s - phase_s) / CYCLE_S).round() * CYCLE_S;
            }
            phases.push((f64::midpoint(first.at_s, last.at_s), phase_s));
        }
        let n = phases.len() as f64;
        if phases.is_empty() {
            return None;
        }
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| phases.iter().map(of).sum::<f64>() / n;
        let (middle_s, phase_s) = (mean(&|p| p.0), mean(&|p| p.1));
        let square = mean(&|p| (p.0 - middle_s).powi(2));
        let product = mean(&|p| (p.0 - middle_s) * (p.1 - phase_s));
        let seen = if square > 0.0 { product / square } else { 0.0 };
        // The speed of the curve has an error, too, by the ages of its samples: what the phases
        // show of the drift is as uncertain.
        let duration_s = residuals.last()?.at_s - residuals.first()?.at_s;
        let seen_sd = CYCLE_S / ((quick.len() as f64).sqrt() * duration_s);
        let known = DRIFT_SD.powi(2) / (DRIFT_SD.powi(2) + seen_sd.powi(2));
        let found = Self {
            middle_s,
            phase_s,
            drift: known * seen,
            drift_sd: known.sqrt() * seen_sd,
            count_deg,
        };
        let is_doubtful = |r: &&Residual| {
            let seen_s = r.at_s + r.late_s();
            found
                .instant_s(r)
                .is_some_and(|at_s| (at_s - seen_s).abs() > 0.25 * CYCLE_S)
        };
        let doubtful = quick.iter().filter(is_doubtful).count();
        (doubtful as f64 <= MAX_DOUBTFUL * quick.len() as f64).then_some(found)
    }

    /// The renewal that a sample shows; `None` if the axis was too slow.
    pub fn instant_s(&self, residual: &Residual) -> Option<f64> {
        let seen_s = residual.at_s + residual.late_s();
        let phase_s = self.phase_s(residual.at_s);
        shows_renewal(residual, self.count_deg)
            .then(|| ((seen_s - phase_s) / CYCLE_S).round() * CYCLE_S + phase_s)
    }

    /// The phase at an instant.
    fn phase_s(&self, at_s: f64) -> f64 {
        self.phase_s + self.drift * (at_s - self.middle_s)
    }

    /// Standard deviation of the instants by the drift of the drive's clock.
    pub fn sd_s(&self, at_s: f64) -> f64 {
        self.drift_sd * (at_s - self.middle_s).abs()
    }
}

/// Whether the error of the curve and of the position are small against the way of a cycle.
fn shows_renewal(residual: &Residual, count_deg: f64) -> bool {
    let rate = residual.rate_deg_s.abs();
    count_deg < MAX_COUNT_S * rate
        && CURVE_SDS * residual.curve_sd_deg < MAX_CURVE_CYCLES * CYCLE_S * rate
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polls of 1 kHz that scatter about the end of a cycle: their ages are near zero or near a
    /// cycle. The drive's clock is 60 ppm fast, and its phase 0.3 ms.
    #[test]
    fn renewals_are_found_whatever_the_ages() {
        let cycle_s = CYCLE_S / (1.0 + 60e-6);
        let residuals: Vec<Residual> = (0..1_000u32)
            .map(|i| {
                let drawn = |factor: f64| (f64::from(i) * factor).fract() - 0.5;
                let taken_s = f64::from(i) * CYCLE_S + 0.3e-3 + 0.2e-3 * drawn(0.618_033_99);
                let renewed_s = ((taken_s - 0.3e-3) / cycle_s).floor() * cycle_s + 0.3e-3;
                Residual {
                    at_s: taken_s,
                    off_deg: 50.0 * (renewed_s - taken_s) + 0.0015 * drawn(0.414_213_56),
                    rate_deg_s: if i < 10 { 0.1 } else { 50.0 },
                    bound_s: 0.2e-3,
                    curve_sd_deg: 0.001,
                }
            })
            .collect();
        let renewals = Renewals::find(&residuals, 0.0015 / f64::sqrt(12.0)).unwrap();
        for residual in residuals.iter().skip(10) {
            let seen_s = residual.at_s + residual.off_deg / 50.0;
            let found_s = renewals.instant_s(residual).unwrap();
            let late_s = (found_s - seen_s).abs();
            assert!(late_s < 25e-6, "{late_s} at {seen_s}");
        }
        // A slow axis shows none.
        assert_eq!(renewals.instant_s(&residuals[0]), None);
        assert!(renewals.sd_s(0.0) > renewals.sd_s(0.4));
    }

    /// Residuals without a grid are no renewals.
    #[test]
    fn samples_without_a_latch_have_no_renewals() {
        let residuals: Vec<Residual> = (0..1_000u32)
            .map(|i| Residual {
                at_s: f64::from(i) * 2.513e-3,
                off_deg: 0.0,
                rate_deg_s: 50.0,
                bound_s: 0.2e-3,
                curve_sd_deg: 0.001,
            })
            .collect();
        assert!(Renewals::find(&residuals, 0.0004).is_none());
    }
}
