//! Statistics of a scan, from its log.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use analysis::cloud_statistics::{CloudStatistics, StatisticsCollector};
use analysis::density::DensityError;
use scanner::Accuracy;

use super::log_view::LogView;
use super::replay::{self, Reconstruction};
use super::source::Source;
use crate::failure::{Failure, Kind};

/// Density and gaps of a log as `velomotion analyze` measures them, with its ranges and stated
/// standard deviations.
///
/// # Errors
/// As [`replay::make`].
pub fn statistics(
    source: &Source,
    accuracy: Accuracy,
    interrupt: &AtomicBool,
) -> Result<CloudStatistics, Failure> {
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
    made.map_err(wrong)
}

fn failure(path: &Path, error: &DensityError) -> Failure {
    Failure::new(Kind::BadInput, format!("{}: {error}", path.display()))
        .help("report it with the log: it is an error of this program")
}
