//! The data path from recorded bytes to points, in two passes over the same records.
//!
//! The first pass, [`align`], reads times and angles: survey, clock, angles, sweeps, trajectory.
//! The second, [`place()`], decodes every firing and places its returns. Both are pure functions of
//! the records in their order. [`crate::Live`] takes the same steps record by record, with
//! streaming estimates of clock and trajectory.

use cloud::{Sink, SinkError};
use drive::record::Record;
use lidar::{Options, Stats};

use crate::alignment::{Alignment, PlacementCounts};
use crate::config::ScanConfig;
use crate::error::ScanError;
use crate::placer::Placer;
use crate::residuals;
use crate::survey::Survey;
use crate::tilt_source::TiltSource;
use crate::tolerance::Accuracy;

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
        // `clock_steps`, `clock`: the lower envelope of packet delays (Olson 2010, Pitman 1939).
        let timeline = self.timeline().ok_or(ScanError::NoLidarPackets)?;
        let recorded = self.take_arrivals();
        // `survey`: stamps of the drive's records on the same host clock.
        let shaft = self.into_shaft_records(&timeline.drive);
        let (clock, arrivals) = (timeline.clock, timeline.arrivals);
        // `angles`: encoder positions at the middle of their polls, or by the drive's own clock.
        let angles = tilt.resolve(&shaft, &arrivals, config)?;
        // `sweeps`: profile moves as commanded, found in the angles.
        let found = angles.sweeps(&shaft.moves, config.sweep.as_ref())?;
        let last_packet = arrivals.iter().map(|arrival| arrival.host).max();
        let spans = angles.spans(&found.seen);
        // `trajectory`: the commanded profile or a spline, by least squares (Levenberg-Marquardt).
        let (trajectory, choice) =
            angles.trajectory(&found.seen, &spans, accuracy, clock.bound())?;
        Ok(Alignment {
            residuals: residuals::over_time(&arrivals, &recorded, &clock, &trajectory, &spans),
            clock,
            steps: timeline.steps,
            delay_changes: timeline.delay_changes,
            trajectory,
            choice,
            unobserved_ends: found.unobserved_ends(last_packet),
            sample_gaps: angles.gaps(&found.seen),
            sweeps: found.seen,
            unseen_sweeps: found.unseen,
            inferred_sweeps: found.inferred,
            ambiguous_motions: found.ambiguous,
            mount: angles.mount,
            calibration: angles.calibration,
            implausible: angles.implausible,
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
