//! A calibration: its parameters and evidence, or why the scans do not support one.

use cloud::mount::Mount;

use crate::floor;
use crate::model::{self, Fixed, ScannerModel};
use crate::parameters::{
    DEVICE, Layout, POSITION_X, POSITION_Z, ParameterKind, ROTATION_X, ROTATION_Z,
};
use crate::shots::Scan;

/// Fewest surface elements.
pub(crate) const MIN_PATCHES: usize = 100;
/// Most loops.
pub(crate) const MAX_LOOPS: usize = 12;
/// Bounds of chi2 per degree of freedom.
pub(crate) const CHI2: [f64; 2] = [0.85, 1.15];

/// A calibration.
#[derive(Clone, Debug)]
pub struct Calibration {
    pub(crate) layout: Layout,
    pub(crate) fixed: Fixed,
    /// The parameters in order.
    pub parameters: Vec<ParameterEstimate>,
    /// Covariance of the parameters by rows, in the units of their names.
    pub covariance: Vec<f64>,
    pub(crate) values: Vec<f64>,
    /// Evidence.
    pub evidence: CalibrationEvidence,
}

/// A parameter's estimate, in the unit of its name.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParameterEstimate {
    /// Quantity.
    pub kind: ParameterKind,
    /// Name with unit.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
    /// Standard deviation over that before the scan; 0 for a fixed parameter.
    pub posterior_over_prior: f64,
    /// Strongest correlation with another parameter, and its name.
    pub correlation: Option<(String, f64)>,
    /// Largest displacement at 20 m by the correction itself and by its standard deviation, metres.
    pub at_20_m: [f64; 2],
}

/// Evidence for a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CalibrationEvidence {
    /// Loops until nothing moved.
    pub loops: usize,
    /// Largest last move, in standard deviations.
    pub last_move_sd: f64,
    /// Surface elements.
    pub patches: usize,
    /// Shots in them.
    pub shots: usize,
    /// Squared residuals per degree of freedom.
    pub chi2: f64,
    /// The base of each log.
    pub bases: Vec<BaseEvidence>,
    /// Range noise of each laser, metres.
    pub noise_m: Vec<f64>,
    /// Mean and root mean square of each laser's residuals before, metres.
    pub before_m: Vec<[f64; 2]>,
    /// The same after.
    pub after_m: Vec<[f64; 2]>,
    /// Root mean square of all residuals before and after, metres.
    pub rms_m: [f64; 2],
    /// Root mean square of each surface element before and after, metres.
    pub patches_m: [Vec<f64>; 2],
}

/// Evidence of a scan on the motion of its base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BaseEvidence {
    /// Whether it is taken to stand, but for a creep of 0.02 mm/s.
    pub stands: bool,
    /// Chi-squared of the drift by one step from a base that stands.
    pub chi2: f64,
    /// Free parts of the drift.
    pub(crate) parts: usize,
    /// A slower drift may be unseen, metres per second, also of points at 20 m.
    pub unseen_m_s: f64,
}

/// A calibration that the scans do not support. Nothing may be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationRefusal {
    /// No shots, or too few surface elements.
    #[error("expected {MIN_PATCHES} surface elements or more, found {patches} in {shots} shots")]
    FewPatches {
        /// Elements found.
        patches: usize,
        /// Shots of all scans.
        shots: usize,
    },
    /// The parameters still move.
    #[error(
        "not settled after {MAX_LOOPS} loops: {name} still moves by {moves_sd:.1} of its standard deviations"
    )]
    NotSettled {
        /// The parameter that moves most.
        name: String,
        /// By how many standard deviations.
        moves_sd: f64,
    },
    /// The base moved.
    #[error(
        "the base moved during log {log}: {mm_s:.1} mm/s at 20 m, {sds:.0} standard deviations"
    )]
    Drift {
        /// Number of the log, from 1.
        log: usize,
        /// Speed, millimetres per second.
        mm_s: f64,
        /// In standard deviations.
        sds: f64,
    },
    /// The model does not describe the residuals.
    #[error(
        "residuals do not fit: chi2 is {chi2:.2} per degree of freedom, expected {} to {}", CHI2[0], CHI2[1]
    )]
    Misfit {
        /// Squared residuals per degree of freedom.
        chi2: f64,
    },
    /// Starts that lead to different results.
    #[error("different starts disagree: {name} by {sds:.1} of its standard deviations")]
    StartsDisagree {
        /// The parameter that differs most.
        name: String,
        /// By how many standard deviations.
        sds: f64,
    },
    /// No level surface below the scanner.
    #[error("no floor: expected level surfaces below the scanner")]
    NoFloor,
    /// The caller ended it.
    #[error("interrupted")]
    Interrupted,
    /// A name to be fixed that is neither a parameter nor the first words of one.
    #[error("{name:?} is neither a parameter nor the first words of one; there are {}", known.join(", "))]
    UnknownParameter {
        /// The name.
        name: String,
        /// The parameters of the device.
        known: Vec<String>,
    },
    /// A matrix without inverse: the numbers of the scans are not finite.
    #[error("the normal equations have no solution")]
    Singular,
}

impl Calibration {
    /// The same calibration, with a zero of the tilt at which the floor of the scans is level
    /// across the axis. No other parameter knows this zero.
    ///
    /// # Errors
    /// [`CalibrationRefusal::NoFloor`].
    pub fn level(self, scans: &[Scan]) -> Result<Self, CalibrationRefusal> {
        let model = ScannerModel::new(&self.layout, &self.fixed, &self.values);
        let tilt = floor::tilt_rad(scans, &model, &self.evidence.noise_m);
        let tilt = tilt.ok_or(CalibrationRefusal::NoFloor)?;
        let turned = Mount::at([0.0; 3], [0.0, tilt.to_degrees(), 0.0]);
        let [x, _, z] = turned.on_platform(self.mount().position_m());
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let rotated = Mount::at([0.0; 3], self.mount().rotation_deg());
        // Columns of the rotation, and its angles about x, then y, then z.
        let [i, j, k] = axes.map(|axis| turned.on_platform(rotated.on_platform(axis)));
        let mut leveled = self;
        leveled.fixed.rotation_y = (-i[2]).clamp(-1.0, 1.0).asin();
        for (index, value) in [
            (ROTATION_X, j[2].atan2(k[2])),
            (ROTATION_Z, i[1].atan2(i[0])),
            (POSITION_X, x),
            (POSITION_Z, z),
        ] {
            leveled.values[index] = value;
            let unit = leveled.layout.parameters()[index].si_per_unit;
            leveled.parameters[index].value = value / unit;
        }
        Ok(leveled)
    }

    /// The calibrated mount.
    #[must_use]
    pub fn mount(&self) -> Mount {
        model::mount(&self.fixed, &self.values)
    }

    /// The estimate of a parameter.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&ParameterEstimate> {
        self.parameters
            .iter()
            .find(|parameter| parameter.name == name)
    }

    /// The value of the only parameter of a kind, in the unit of its name; 0 without one.
    #[must_use]
    pub fn value(&self, kind: ParameterKind) -> f64 {
        let mut of_kind = self.parameters.iter().filter(|p| p.kind == kind);
        of_kind.next().map_or(0.0, |estimate| estimate.value)
    }

    /// Values of the mount and the axis, then of the lasers: all but the drift of the logs.
    #[must_use]
    pub fn of_the_scanner(&self) -> &[ParameterEstimate] {
        &self.parameters[..DEVICE + 3 * self.layout.lasers]
    }
}
