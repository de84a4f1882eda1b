//! Arguments as requests to the engine.

use cloud::Fields;
#[cfg(devices)]
use engine::capture::jog::{GotoRequest, JogRequest};
use engine::capture_request::CaptureRequest;
#[cfg(devices)]
use engine::failure::Failure;
use engine::reconstruct::decoder_options::DecoderRequest;
use engine::reconstruct::replay;
use lidar::Duplicates;

use super::{AccuracyArguments, Capture, EqualReturns, LidarArguments, Output, TimeArgument};
#[cfg(devices)]
use super::{MotionArguments, TiltVerb};

impl AccuracyArguments {
    /// The accuracy requested from the scanner.
    #[must_use]
    pub fn wanted(&self) -> scanner::Accuracy {
        self.tolerance
            .map_or(scanner::Accuracy::Best, scanner::Accuracy::Within)
    }
}

impl From<TimeArgument> for replay::TimeReference {
    fn from(time: TimeArgument) -> Self {
        match time {
            TimeArgument::Host => Self::Host,
            TimeArgument::Utc => Self::Utc,
        }
    }
}

impl LidarArguments {
    /// The request to the engine.
    #[must_use]
    pub fn request(&self) -> DecoderRequest {
        DecoderRequest {
            model: self.model,
            calibration: self.calibration.clone(),
            duplicates: match self.equal_returns {
                EqualReturns::Once => Duplicates::Unique,
                EqualReturns::Twice => Duplicates::All,
            },
            one_origin: self.one_origin,
        }
    }
}

#[cfg(devices)]
impl TiltVerb {
    /// The request to the engine. A jog is a move to `end_of_jog` of its way.
    ///
    /// # Errors
    /// Those of `end_of_jog`.
    pub fn request(
        self,
        end_of_jog: impl FnOnce(f64) -> Result<f64, Failure>,
    ) -> Result<JogRequest, Failure> {
        let goto = |to_deg: f64, motion: MotionArguments| {
            JogRequest::Goto(GotoRequest {
                to_deg,
                speed_deg_s: motion.speed,
                accel_deg_s2: motion.accel,
            })
        };
        Ok(match self {
            Self::Status | Self::Faults { clear: false } => JogRequest::Status,
            Self::Faults { clear: true } => JogRequest::ClearFaults,
            Self::Stop => JogRequest::Stop,
            Self::Home => JogRequest::Home,
            Self::Goto { to, motion } => goto(to, motion),
            Self::Jog { by, motion } => goto(end_of_jog(by)?, motion),
        })
    }
}

impl From<&Capture> for CaptureRequest {
    fn from(arguments: &Capture) -> Self {
        Self {
            speed_deg_s: arguments.speed,
            from_deg: arguments.from,
            to_deg: arguments.to,
            accel_deg_s2: arguments.accel,
            sweeps: arguments.sweeps,
            both_ways: arguments.both_ways,
            tolerance: arguments
                .accuracy
                .tolerance
                .map(|t| format!("{}m@{}m", t.off.0, t.at.0)),
            name: None,
        }
    }
}

impl Output {
    /// Columns of the cloud in addition to the position.
    #[must_use]
    pub fn fields(&self) -> Fields {
        let fields = [
            (self.uncertainty, Fields::SD),
            (self.echo, Fields::ECHO),
            (self.laser, Fields::LASER),
        ];
        let requested = fields.into_iter().filter(|(is_requested, _)| *is_requested);
        requested.fold(Fields::FILE, |fields, (_, field)| fields | field)
    }
}
