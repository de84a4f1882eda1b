//! The data path from recorded bytes to points, in two passes over the same records.
//!
//! The first pass, [`align`], reads times and angles: survey, clock, angles, sweeps, trajectory.
//! The second, [`place()`], decodes every firing and places its returns. Both are pure functions of
//! the records in their order. [`crate::Live`] takes the same steps record by record, with
//! streaming estimates of clock and trajectory.

use cloud::{Sink, SinkError};
use drive::record::Record;
use lidar::{Options, Stats};
use units::Span;

use crate::alignment::{Alignment, PlacementCounts};
use crate::config::ScanConfig;
use crate::error::ScanError;
use crate::placer::Placer;
use crate::residuals;
use crate::steps::Timeline;
use crate::survey::Survey;
use crate::sweeps::FoundSweeps;
use crate::tilt_source::TiltSource;
use crate::tolerance::Accuracy;

/// A log that goes on for longer after the last position of a sweep lacks positions.
const LEAST_REST: Span = Span::from_millis(100);

/// First pass: solves for clock and trajectory of a log written with `config`.
///
/// # Errors
/// As for [`Survey::new`] and [`Survey::solve`].
pub fn align<'r>(
    records: impl IntoIterator<Item = Record<'r>>,
    config: &ScanConfig,
    options: Options,
    tilt: &TiltSource,
    accuracy: Accuracy,
) -> Result<Alignment, ScanError> {
    let mut survey = Survey::new(config, options)?;
    for record in records {
        survey.observe(&record);
    }
    survey.solve(config, tilt, accuracy)
}

impl Survey {
    /// Solves for clock, sweeps and trajectory; `accuracy` applies to angles of the log.
    ///
    /// # Errors
    /// [`ScanError`] if the records hold no lidar packet, or `tilt` is [`TiltSource::Log`] and they
    /// hold no angle or no sweep; [`ScanError::UnreachableTolerance`] if no method is accurate
    /// enough.
    pub fn solve(
        mut self,
        config: &ScanConfig,
        tilt: &TiltSource,
        accuracy: Accuracy,
    ) -> Result<Alignment, ScanError> {
        // `steps`, `clock`: the lower envelope of packet delays (Olson 2010, Pitman 1939).
        let Timeline {
            clock,
            steps,
            delay_changes,
            drive,
            arrivals,
        } = self.timeline().ok_or(ScanError::NoLidarPackets)?;
        let recorded = self.take_arrivals();
        // `survey`: stamps of the drive's records on the same host clock.
        let shaft = self.into_shaft_records(&drive);
        // `angles`: encoder positions at the middle of their polls, or by the drive's own clock.
        let angles = tilt.resolve(&shaft, &arrivals, config)?;
        // `sweeps`: profile moves as commanded, found in the angles.
        let FoundSweeps {
            seen: sweeps,
            unseen: unseen_sweeps,
            inferred: inferred_sweeps,
            unfinished,
            ambiguous: ambiguous_motions,
            surplus: _,
        } = angles.sweeps(&shaft.moves, config.sweep.as_ref())?;
        let last_packet = arrivals.iter().map(|arrival| arrival.host).max();
        let goes_on = |index: &usize| {
            let end = sweeps.get(*index).map(|sweep| sweep.end + LEAST_REST);
            end < last_packet
        };
        let unobserved_ends = unfinished.into_iter().filter(goes_on).collect();
        let spans = angles.spans(&sweeps);
        let sample_gaps = angles.gaps(&sweeps);
        // `trajectory`: the commanded profile or a spline, by least squares (Levenberg-Marquardt).
        let (trajectory, choice) = angles.trajectory(&sweeps, &spans, accuracy, clock.bound())?;
        let residuals = residuals::over_time(&arrivals, &recorded, &clock, &trajectory, &spans);
        Ok(Alignment {
            clock,
            steps,
            delay_changes,
            trajectory,
            choice,
            sweeps,
            unseen_sweeps,
            inferred_sweeps,
            unobserved_ends,
            ambiguous_motions,
            mount: angles.mount,
            calibration: angles.calibration,
            implausible: angles.implausible,
            sample_gaps,
            residuals,
            range_sd_m: config.lidar.range_sd_m,
            spans,
        })
    }
}

/// Second pass: places every return (`mount`: Eq. 4-6) and hands the points to `sink`, which has
/// begun. The caller finishes the sink.
///
/// # Errors
/// Returns the errors of the sink.
pub fn place<'r>(
    records: impl IntoIterator<Item = Record<'r>>,
    alignment: &Alignment,
    options: Options,
    sink: &mut dyn Sink,
) -> Result<(PlacementCounts, Stats), SinkError> {
    let mut placer = Placer::new(alignment, options, sink);
    for record in records {
        placer.observe(&record)?;
    }
    placer.finish()
}
