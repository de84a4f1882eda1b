//! Whether the bases of the logs stand, and the solution that follows.

use super::{Estimator, GaussNewtonStep, Solution};
use crate::calibration::{BaseEvidence, CalibrationRefusal};
use crate::linear::{Cholesky, Matrix};

/// A drift is real above this many standard deviations and this speed.
const DRIFT_SD: f64 = 8.0;
const DRIFT_MM_S: f64 = 1.0;
/// Distance at which a rotating base moves points, metres.
const DRIFT_AT_M: f64 = 20.0;
/// Creep of a base that stands, one standard deviation: 72 mm in an hour.
const CREEP_M_S: f64 = 2e-5;
/// Chi-squared that the drift of a base that stands exceeds with a probability of 0.1 %, by the
/// number of its free parts. In 100 simulated scans it was 1.3 times as large as expected.
const STANDING: [f64; 7] = [0.0, 10.8, 13.8, 16.3, 18.5, 20.5, 22.5];
/// Standard deviations of a drift that the test finds, nearly always.
const FOUND_SD: f64 = 5.5;
/// A scan that would not show a drift of this speed, or of 5 mm/s at 5 m (0.06 deg/s), does not
/// show that its base stands.
const POWER_M_S: f64 = 0.02;
/// Possible drift of the base of such a scan, one standard deviation.
const UNSEEN_M_S: f64 = 1e-3;

impl BaseEvidence {
    /// Whether the scan shows that the base moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.chi2 > STANDING[self.parts]
    }

    fn is_moving(&self) -> bool {
        self.stands && self.moves()
    }

    /// Whether the scan would not show it.
    fn is_unseen(&self) -> bool {
        self.stands && !self.is_moving() && self.unseen_m_s > POWER_M_S
    }
}

impl Estimator<'_> {
    /// The solution from the first start, of bases that stand where the scans show that they do: a
    /// drift that no base has would be a part of delay, scale and elevations.
    pub(super) fn solve_first(
        &self,
        progress: &mut dyn FnMut(usize, f64) -> bool,
    ) -> Result<(Solution, Vec<BaseEvidence>), CalibrationRefusal> {
        let logs = 0..self.layout.logs;
        let mut priors = self.priors.clone();
        for log in logs.clone() {
            self.limit_drift(&mut priors, log, CREEP_M_S);
        }
        let mut bases = vec![
            BaseEvidence {
                stands: true,
                ..BaseEvidence::default()
            };
            logs.len()
        ];
        loop {
            let solution = self.solve(&self.start, &priors, None, progress);
            let mut freed = Vec::new();
            if let Ok(solution) = &solution {
                for (log, base) in bases.iter_mut().enumerate().filter(|(_, base)| base.stands) {
                    *base = self.base(solution, log)?;
                }
                // The base that moves most first: its drift may seem to be that of another.
                let moving = logs.clone().filter(|&log| bases[log].is_moving());
                let most = moving.max_by(|&a, &b| bases[a].chi2.total_cmp(&bases[b].chi2));
                freed.extend(most.map(|log| (log, f64::INFINITY)));
                if freed.is_empty() {
                    let unseen = logs.clone().filter(|&log| bases[log].is_unseen());
                    freed.extend(unseen.map(|log| (log, UNSEEN_M_S)));
                }
            }
            if freed.is_empty() {
                let solution = solution?;
                self.check_settled(&solution)?;
                for (log, base) in bases.iter().enumerate().filter(|(_, base)| !base.stands) {
                    self.check_drift(&solution, log, base)?;
                }
                self.check_fit(&solution)?;
                return Ok((solution, bases));
            }
            for (log, most_m_s) in freed {
                bases[log].stands = false;
                self.limit_drift(&mut priors, log, most_m_s);
            }
        }
    }

    /// Sets the standard deviations of a log's drift before the scan: those of any base, but at
    /// most this speed, also of points at 20 m.
    fn limit_drift(&self, priors: &mut [f64], log: usize, most_m_s: f64) {
        for (axis, index) in self.layout.drift_of(log).enumerate() {
            let lever = if axis < 3 { 1.0 } else { DRIFT_AT_M };
            priors[index] = self.priors[index].min(most_m_s / lever);
        }
    }

    /// Refuses a base that moves. Over a bare floor a drift along it follows the noise of the
    /// elements' normals from step to step, beyond its standard deviation, but one step from a base
    /// that stands finds none.
    fn check_drift(
        &self,
        solution: &Solution,
        log: usize,
        base: &BaseEvidence,
    ) -> Result<(), CalibrationRefusal> {
        let drift = self.layout.drift_of(log);
        for (axis, index) in drift.enumerate() {
            let sd = solution.covariance.at(index, index).sqrt();
            let value = solution.values[index].abs();
            let lever = if axis < 3 { 1.0 } else { DRIFT_AT_M };
            let (mm_s, sds) = (value * lever * 1e3, value / sd);
            if base.chi2 > DRIFT_SD * DRIFT_SD && sds > DRIFT_SD && mm_s > DRIFT_MM_S {
                let log = log + 1;
                return Err(CalibrationRefusal::Drift { log, mm_s, sds });
            }
        }
        Ok(())
    }

    /// Whether the base of a log stands, by the drift that one step from a base that stands finds
    /// where it may be any (Wald's test). The covariance is the formal one: the scatter of the
    /// elements' gradients would contain the drift.
    fn base(&self, standing: &Solution, log: usize) -> Result<BaseEvidence, CalibrationRefusal> {
        let mut priors = standing.priors.clone();
        let drift = self.layout.drift_of(log);
        priors[drift.clone()].copy_from_slice(&self.priors[drift.clone()]);
        let free: Vec<usize> = drift.filter(|&index| priors[index] > 0.0).collect();
        let GaussNewtonStep {
            step,
            formal: covariance,
            ..
        } = self.step(&standing.equations, &standing.values_before, &priors)?;
        let sd = |index: usize| covariance.at(index, index).sqrt();
        let found = |index: usize| (standing.values_before[index] + step[index]) / sd(index);
        let mut correlation = Matrix::zero(free.len());
        for (i, &row) in free.iter().enumerate() {
            for (j, &column) in free.iter().enumerate() {
                *correlation.at_mut(i, j) = covariance.at(row, column) / (sd(row) * sd(column));
            }
        }
        let factor = Cholesky::new(&correlation).ok_or(CalibrationRefusal::Singular)?;
        let mut root: Vec<f64> = free.iter().map(|&index| found(index)).collect();
        factor.forward(&mut root);
        let first = self.layout.drift(log);
        let speeds = free.iter().map(|&index| {
            let lever = if index < first + 3 { 1.0 } else { DRIFT_AT_M };
            sd(index) * lever
        });
        Ok(BaseEvidence {
            stands: true,
            // Noise that is larger than stated is no drift.
            chi2: root.iter().map(|part| part * part).sum::<f64>()
                / self.chi2(&standing.equations).max(1.0),
            parts: free.len(),
            unseen_m_s: FOUND_SD * speeds.fold(0.0, f64::max),
        })
    }
}
