//! Motion of the axis outside captures.

use drive::{CommandOutcome, DriveCommand, DriveEvent, DriveStatus};
use io::port::Port;
use serde::{Deserialize, Serialize};
use units::{DegPerS, DegPerS2, Degrees};
use utoipa::ToSchema;

use crate::capture::run_moves;
use crate::config::{Config, Device};
use crate::devices::drive_session::{Session, SessionError};
use crate::devices::profile as devices;
use crate::failure::{Failure, Kind};

/// A move to an angle; the body of `POST /tilt/goto`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"to_deg": -20, "speed_deg_s": 10}))]
pub struct GotoRequest {
    /// Target, degrees.
    pub to_deg: f64,
    /// Speed, degrees per second.
    #[serde(default = "GotoRequest::default_speed")]
    pub speed_deg_s: f64,
    /// Acceleration, degrees per second squared; the device's own by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accel_deg_s2: Option<f64>,
}

impl GotoRequest {
    /// The default of `tilt goto --speed`, degrees per second.
    #[must_use]
    pub const fn default_speed() -> f64 {
        10.0
    }
}

/// A request to read the drive or move the axis outside a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JogRequest {
    /// Report the state; nothing moves.
    Status,
    /// Find the zero position at the limit switch.
    Home,
    /// Move to an angle.
    Goto(GotoRequest),
    /// Stop now and set the brake.
    Stop,
    /// Leave the fault state; the fault history stays.
    ClearFaults,
}

/// The drive commands of a request, in order.
///
/// # Errors
/// [`Kind::Usage`] for a move that this axis cannot make.
pub fn commands(
    request: JogRequest,
    config: &Config,
    device: &Device,
) -> Result<Vec<DriveCommand>, Failure> {
    Ok(match request {
        JogRequest::Status => vec![],
        JogRequest::ClearFaults => vec![DriveCommand::ClearFaults],
        JogRequest::Stop => vec![DriveCommand::Stop],
        JogRequest::Home => vec![
            DriveCommand::Connect,
            DriveCommand::Home,
            DriveCommand::Brake,
        ],
        JogRequest::Goto(to) => {
            let axis = devices::axis(&config.axis)?;
            let accel = to.accel_deg_s2.unwrap_or(device.accel_deg_s2);
            let plan = axis
                .plan(
                    Degrees(config.axis.homing.to_deg),
                    Degrees(to.to_deg),
                    DegPerS(to.speed_deg_s),
                    DegPerS2(accel),
                )
                .map_err(|error| Failure::new(Kind::Usage, error.to_string()).help(error.help()))?;
            vec![
                DriveCommand::Connect,
                DriveCommand::Goto(run_moves::command(&plan)),
                DriveCommand::Brake,
            ]
        }
    })
}

/// Whether a move may home the axis first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Homing {
    /// Only on request.
    AsAsked,
    /// Before any move.
    First,
}

/// Runs the commands and reads the drive's state.
///
/// # Errors
/// [`SessionError`].
pub fn run<P: Port>(
    session: &mut Session<'_, P>,
    commands: &[DriveCommand],
    homing: Homing,
    on_event: &mut dyn FnMut(&DriveEvent),
) -> Result<DriveStatus, SessionError> {
    for command in commands {
        if homing == Homing::First && matches!(command, DriveCommand::Goto(_)) {
            session.run(DriveCommand::Home, on_event)?;
        }
        session.run(*command, on_event)?;
    }
    match session.run(DriveCommand::Status, &mut |_| {})? {
        CommandOutcome::Status(status) => Ok(status),
        _ => Err(SessionError::Interrupted),
    }
}

/// The failure of a motion, with what to do about it.
#[must_use]
pub fn failure(error: &SessionError) -> Failure {
    let help = error.help().unwrap_or_else(|| {
        "the axis is at rest, its power stage off and its brake set if it has one; with [axis] without_brake = \"hold\" it is held powered".to_owned()
    });
    Failure::new(error.kind(), error.to_string()).help(help)
}
