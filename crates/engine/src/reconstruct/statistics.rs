//! Statistics of a scan, from its log.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use analysis::cloud_statistics::{CloudStatistics, StatisticsCollector};
use analysis::density::DensityError;
use scanner::Accuracy;
use serde::Serialize;
use utoipa::ToSchema;

use super::log_view::LogView;
use super::replay::{self, Reconstruction};
use super::report::TimedResiduals;
use super::source::Source;
use crate::failure::{Failure, Kind};

/// Statistics of a scan.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct LogStatistics {
    /// Of its cloud.
    #[serde(flatten)]
    pub cloud: CloudStatistics,
    /// Residuals of clock and angle in equal parts of the recording, in order.
    pub residuals: Vec<TimedResiduals>,
}

/// Density and gaps of a log as `velomotion analyze` measures them, with its ranges and stated
/// standard deviations, and its residuals.
///
/// # Errors
/// As [`replay::make`].
pub fn statistics(
    source: &Source,
    accuracy: Accuracy,
    interrupt: &AtomicBool,
) -> Result<LogStatistics, Failure> {
    let wrong = |error: DensityError| failure(source.path(), &error);
    let request = Reconstruction::of_log(source, accuracy, interrupt)?;
    let mut collector = StatisticsCollector::new().map_err(wrong)?;
    let scan = replay::scan(&request, &mut collector, source.path())?;
    let distance_m = collector.distance_m();
    let seen = distance_m.and_then(|m| LogView::new(&scan, collector.track(), m));
    let made = match seen {
        Some(seen) => collector.finish(Some(&|direction| seen.view.depth_rad(direction))),
        None => collector.finish(None),
    };
    Ok(LogStatistics {
        cloud: made.map_err(wrong)?,
        residuals: scan.residuals,
    })
}

fn failure(path: &Path, error: &DensityError) -> Failure {
    Failure::new(Kind::BadInput, format!("{}: {error}", path.display()))
        .help("report it with the log: it is an error of this program")
}
