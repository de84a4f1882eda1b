//! Sources of tilt angles: the drive's traffic in the log, a table of another rig, or none.

use cloud::mount::Mount;
use units::{Degrees, Host, Metres, Span, Stamp};

use crate::angles::{self, AngleSample, AngleTable};
use crate::calibration::PointCalibration;
use crate::clock::Arrival;
use crate::config::{ScanConfig, SweepPlan};
use crate::error::ScanError;
use crate::sample_gaps::SampleGaps;
use crate::survey::ShaftRecords;
use crate::sweeps::{FoundSweeps, HoursTooMany, MoveWatch, Sweep};
use crate::tolerance::{Accuracy, MethodChoice};
use crate::trajectory::{Method, Trajectory};

/// The source of tilt angles.
#[derive(Clone, Debug, PartialEq)]
pub enum TiltSource {
    /// The drive's recorded traffic.
    Log,
    /// None: the platform stands still. The cloud is in the sensor's own frame, without a mount.
    None,
    /// Angles measured by another rig.
    Table(AngleTable),
}

/// Angle samples of a source, and how to make a trajectory of them.
pub(crate) struct TiltAngles {
    samples: Vec<AngleSample>,
    /// One step of the encoder.
    step: Degrees,
    /// Error of time that all samples share, one standard deviation.
    shared_sd_ns: f64,
    /// Shaft samples discarded as implausible.
    pub implausible: u64,
    pub mount: Mount,
    /// Calibration of the axis whose angles these are.
    pub calibration: Option<PointCalibration>,
    /// The method where the source leaves no choice; the log's angles are known sweep by sweep.
    method: Option<Method>,
}

/// All of time, for sources without sweeps.
const ALWAYS: (Stamp<Host>, Stamp<Host>) =
    (Stamp::from_nanos(i64::MIN), Stamp::from_nanos(i64::MAX));

impl TiltSource {
    /// The angle samples of this source.
    pub(crate) fn resolve(
        &self,
        shaft: &ShaftRecords,
        arrivals: &[Arrival],
        config: &ScanConfig,
    ) -> Result<TiltAngles, ScanError> {
        let given = TiltAngles {
            samples: Vec::new(),
            step: Degrees(0.0),
            shared_sd_ns: 0.0,
            implausible: 0,
            mount: config.mount.mount(),
            calibration: None,
            method: None,
        };
        Ok(match self {
            Self::Log => {
                let (mut samples, shared_sd_ns) =
                    angles::with_shared_sd(&shaft.samples, shaft.gearing);
                TiltAngles {
                    implausible: angles::discard_outliers(&mut samples),
                    samples,
                    step: Degrees(shaft.gearing.degrees_per_qc()),
                    shared_sd_ns,
                    calibration: config
                        .calibration
                        .as_ref()
                        .map(|calibration| PointCalibration::new(calibration, shaft.gearing)),
                    ..given
                }
            }
            Self::None => TiltAngles {
                mount: Mount::new(Metres(0.0)),
                method: Some(Method::None),
                ..given
            },
            Self::Table(table) => TiltAngles {
                samples: table.samples(arrivals)?,
                method: Some(Method::Linear),
                ..given
            },
        })
    }
}

impl TiltAngles {
    /// The sweeps of the log; none for other sources.
    pub(crate) fn sweeps(
        &self,
        moves: &MoveWatch,
        plan: Option<&SweepPlan>,
    ) -> Result<FoundSweeps, ScanError> {
        if self.method.is_some() {
            return Ok(FoundSweeps::default());
        }
        let found = moves.sweeps(&self.samples, plan);
        if let [(from, to), ..] = *found.surplus {
            return Err(ScanError::SurplusSweep { from, to });
        }
        let hours = |sweep: &Sweep| sweep.hours_too_many(&self.samples);
        if let Some(HoursTooMany {
            at,
            silence,
            motion,
        }) = found.seen.iter().find_map(hours)
        {
            return Err(ScanError::SetByHours {
                at,
                silence,
                motion,
            });
        }
        match (&*found.seen, &*found.unseen, &*found.ambiguous) {
            ([], &[(from, to), ..], _) => Err(ScanError::UnseenSweep { from, to }),
            ([], [], &[(from, to), ..]) => Err(ScanError::AmbiguousMotion { from, to }),
            ([], [], []) if !self.samples.is_empty() => Err(ScanError::NoSweep),
            _ => Ok(found),
        }
    }

    /// The gaps between the samples within `sweeps`.
    pub(crate) fn gaps(&self, sweeps: &[Sweep]) -> SampleGaps {
        SampleGaps::of(&self.samples, sweeps)
    }

    /// The spans of time within which firings become points.
    pub(crate) fn spans(&self, sweeps: &[Sweep]) -> Vec<(Stamp<Host>, Stamp<Host>)> {
        match self.method {
            Some(_) => vec![ALWAYS],
            None => sweeps.iter().map(|s| (s.start, s.end)).collect(),
        }
    }

    /// The trajectory, and the reason for its method if a tolerance chose it.
    pub(crate) fn trajectory(
        &self,
        sweeps: &[Sweep],
        spans: &[(Stamp<Host>, Stamp<Host>)],
        accuracy: Accuracy,
        clock_bound: Span,
    ) -> Result<(Trajectory, Option<MethodChoice>), ScanError> {
        let through = |method| {
            Trajectory::through(self.samples.clone(), self.step, sweeps, method)
                .map(|trajectory| trajectory.with_shared_sd(self.shared_sd_ns))
        };
        let trajectory = match (self.method, accuracy) {
            (Some(_), Accuracy::Within(_)) => return Err(ScanError::NoBound),
            (Some(Method::None), _) => Some(Trajectory::fixed(Degrees(0.0))),
            (Some(method), _) | (None, Accuracy::By(method)) => through(Some(method)),
            (None, Accuracy::Best) => through(None),
            (None, Accuracy::Within(tolerance)) => {
                let by = |method| through(Some(method));
                let (trajectory, choice) =
                    tolerance.choose(clock_bound, spans, by).map_err(|best| {
                        best.map_or(ScanError::NoTilt, ScanError::UnreachableTolerance)
                    })?;
                return Ok((trajectory, Some(choice)));
            }
        };
        Ok((trajectory.ok_or(ScanError::NoTilt)?, None))
    }
}
