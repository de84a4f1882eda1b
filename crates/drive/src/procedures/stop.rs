//! Stop and brake: the axis at rest, seen to be at rest, power off, brake set.
//!
//! Rest is judged by the encoder: 606C is no finer than the encoder counts of a control cycle (30 rpm at 2000 qc a turn), while a position
//! that stays within some counts for 50 ms stands.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::control;
use units::{Quadcounts, Span};

use crate::error::DriveError;
use crate::event::{Outcome, Place, Progress, Stopped};
use crate::objects;
use crate::ops::Ops;

use super::configure::has_forgotten;
use super::network;
use super::power::{is_fault, is_off, is_referenced, wait_for};
use super::report::history;

/// Counts within which a shaft at rest may flicker.
const REST_QC: u32 = 3;

/// [`crate::Command::Stop`]
pub(crate) async fn stop(mut ops: Ops) -> Result<Outcome, DriveError> {
    halt(&mut ops).await.map(Outcome::Stopped)
}

/// [`crate::Command::Brake`]
pub(crate) async fn brake(mut ops: Ops) -> Result<Outcome, DriveError> {
    match rest(&mut ops).await {
        Ok(stopped) => Ok(Outcome::Stopped(stopped)),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

/// Brings the axis to rest after a failure and tells how that went. The quick stop comes first, questions later.
pub(super) async fn make_safe(ops: &mut Ops, cause: DriveError) -> DriveError {
    ops.watch(false);
    let halted = match cause {
        DriveError::LinkLost { .. }
        | DriveError::NodeSilent { .. }
        | DriveError::NoAnswer { damaged: true, .. } => halt_unheard(ops).await,
        _ => halt(ops).await,
    };
    match halted {
        Ok(stopped) => {
            let cause = explain(ops, cause).await;
            ops.tell(Progress::MadeSafe(stopped));
            cause
        }
        Err(stop) => DriveError::NotStopped {
            cause: Box::new(cause),
            stop: Box::new(stop),
        },
    }
}

/// Quick stop, then rest. Harmless in every state: a drive that is off stays off, one in fault stays in fault.
pub(super) async fn halt(ops: &mut Ops) -> Result<Stopped, DriveError> {
    ops.set_moving(true);
    ops.write_urgently(objects::CONTROLWORD, control::QUICK_STOP)
        .await?;
    rest(ops).await
}

/// The same where nothing was heard any more, or nothing whole: given up soon, so that it is soon known whether the axis stops.
async fn halt_unheard(ops: &mut Ops) -> Result<Stopped, DriveError> {
    ops.set_moving(true);
    ops.write_at_last(objects::CONTROLWORD, control::QUICK_STOP)
        .await?;
    rest(ops).await
}

/// What lies behind a failure, asked of an axis at rest: which fault, and whether the drive has restarted.
async fn explain(ops: &Ops, cause: DriveError) -> DriveError {
    let known = match cause {
        DriveError::Fault { error } => error,
        DriveError::State { .. } | DriveError::NotReferenced { .. } => None,
        DriveError::NotTaken { .. } | DriveError::Restarted { error: None } => None,
        other => return other,
    };
    let newest = match known {
        Some(error) => Some(error),
        // A history that cannot be read says nothing.
        None => newest_error(ops).await.unwrap_or_default(),
    };
    match cause {
        DriveError::Restarted { .. } => DriveError::Restarted { error: newest },
        _ if has_forgotten(ops).await == Ok(true) => DriveError::Restarted { error: newest },
        DriveError::Fault { .. } => DriveError::Fault { error: newest },
        other => other,
    }
}

async fn newest_error(ops: &Ops) -> Result<Option<DeviceError>, DriveError> {
    Ok(history(ops).await?.first().copied())
}

/// Waits for standstill, then power off and brake.
async fn rest(ops: &mut Ops) -> Result<Stopped, DriveError> {
    ops.set_moving(true);
    standstill(ops).await?;
    ops.write_again(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await?;
    let statusword = wait_for(ops, "power off", is_off).await?;
    ops.set_moving(false);
    let brake = ops.config.brake;
    ops.sleep(brake.map_or(Span::ZERO, |brake| brake.fall))
        .await;
    let position = ops.sample().await?.position;
    let fault = is_fault(statusword);
    let error = if fault {
        newest_error(ops).await?
    } else {
        None
    };
    // The power is off: whether the host is heard does not matter any more.
    let _ = network::disarm(ops).await;
    let place = place(ops, statusword, error);
    Ok(Stopped {
        position,
        place,
        angle: (place == Place::Known).then(|| ops.config.gearing.angle(position)),
        fault,
        brake: brake.is_some(),
    })
}

/// What the position of an axis at rest is worth.
fn place(ops: &Ops, statusword: u16, error: Option<DeviceError>) -> Place {
    let referenced = is_referenced(statusword);
    match error {
        _ if !referenced && !ops.was_referenced() => Place::NotHomed,
        Some(error) if loses_position(error) => Place::Lost { error: Some(error) },
        _ if referenced => Place::Known,
        _ => Place::Lost { error: None },
    }
}

/// Errors after which counts may be missing, whatever the statusword says.
fn loses_position(error: DeviceError) -> bool {
    matches!(
        error,
        DeviceError::POSITION_SENSOR
            | DeviceError::INDEX
            | DeviceError::ENCODER_RESOLUTION
            | DeviceError::HALL_ANGLE
            | DeviceError::SENSOR_BREACH
    )
}

async fn standstill(ops: &mut Ops) -> Result<(), DriveError> {
    let timing = ops.config.timing;
    let ramp = f64::from(ops.config.max_speed.0) / f64::from(ops.config.quick_stop.0);
    let began = ops.now();
    let limit = began
        .saturating_add(Span::from_secs_f64(ramp))
        .saturating_add(timing.state_limit);
    let mut place: Option<Quadcounts> = None;
    let mut since = began;
    let mut late = false;
    loop {
        let sample = ops.sample().await?;
        let stands = place.is_some_and(|p| p.0.abs_diff(sample.position.0) <= REST_QC);
        if stands {
            if sample.request.saturating_since(since) >= timing.standstill {
                return Ok(());
            }
            continue;
        }
        // Two places, both asked for after the limit: a host that was held up may have slept through the stop.
        if late {
            return Err(DriveError::StillMoving {
                position: sample.position,
                waited: ops.now().saturating_since(began),
            });
        }
        late = sample.request > limit;
        place = Some(sample.position);
        since = sample.answer;
    }
}
