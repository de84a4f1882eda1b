//! Accuracy, density and time of a scan before it is made: how fast may it be, and what is lost?
//!
//! A [`ScanPredictor`] takes the lidar ([`PlanLidar`]), what errors depend on ([`ErrorModel`]) and
//! the sweeps as the drive will run them ([`PlannedScan`]). Gaps are those of the rays of the
//! motion with its ramps ([`PlannedRays`]), errors a budget ([`ErrorBudget`]).

mod budget;
mod deciding;
mod figure;
mod gaps;
mod lidar;
mod place;
mod places;
mod row;
mod search;
mod started;
mod sweep;
mod table;

pub use budget::{ErrorBudget, ErrorModel, LinkTiming};
pub use figure::figure;
pub use gaps::{PlannedRays, StartedSweep};
pub use lidar::{PlanLaser, PlanLidar};
pub use place::PlannedPlace;
pub use row::{DRIVE_BYTES_S, PACKET_BYTES, ROW_BYTES};
pub use row::{GapQuantiles, PlanRow, PlannedScan, ScanPredictor, ScanSetting};
pub use search::{LimitKind, NearestScan, PlanLimits};
pub use sweep::TiltSweep;
