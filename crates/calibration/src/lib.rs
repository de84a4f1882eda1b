//! Calibration of the scanner from its own scans, without targets, and the study of its accuracy
//! ([`study`]).
//!
//! `shots` takes the points of logs back to ranges and azimuths, `model` says where a shot goes
//! under a set of parameters, `patches` collects small surface elements from the cloud of these,
//! `equations` sums what their residuals say of the parameters, and [`calibrate`] repeats that
//! until nothing moves; `flatness` adds the common range of all lasers. Known limits: walls that
//! are wavy over less than half a metre count as noise, and the common range is known only as well
//! as large surfaces are flat.
//!
//! ```
//! use calibration::{CalibrationRequest, NominalLaser, Scan, calibrate};
//! use cloud::Points;
//! use cloud::mount::Mount;
//! use units::Metres;
//!
//! # fn main() -> Result<(), cloud::MissingColumns> {
//! let lasers =
//!     [NominalLaser { elevation_deg: -15.0, vertical_offset_m: 0.0112 }];
//! // The points of a log, placed without mount.
//! let scans = [Scan::new(&Points::new(Scan::FIELDS), &lasers)?];
//! let request = CalibrationRequest {
//!     scans: &scans,
//!     lasers: &lasers,
//!     start: Mount::new(Metres(0.06)),
//!     gear: 120.0,
//!     fixed: &["play".to_owned()],
//! };
//! match calibrate(&request, &mut |_loops, _moves_sd| false) {
//!     Ok(calibration) => println!("{:?}", calibration.mount()),
//!     Err(refusal) => println!("{refusal}"),
//! }
//! # Ok(())
//! # }
//! ```

mod accuracy;
mod calibration;
mod equations;
mod estimate;
mod flatness;
mod floor;
mod linear;
mod model;
mod parameters;
mod patches;
mod shots;
mod surface;
#[cfg(test)]
mod tests;

pub use accuracy::{
    AccuracyStudy, AngleErrors, BinGroup, BudgetBin, KnownCovariance, PointError, ResidualBin,
    StationPair, StudyRequest, SweepPair, study,
};
pub use calibration::{
    BaseEvidence, Calibration, CalibrationEvidence, CalibrationRefusal, ParameterEstimate,
};
pub use estimate::{CalibrationRequest, calibrate};
pub use parameters::ParameterKind;
pub use shots::{NominalLaser, Scan};
