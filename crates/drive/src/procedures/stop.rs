//! Stop and brake: axis at rest and observed to be, power off, brake set.
//!
//! The encoder decides about standstill. The velocity (606C) is too coarse: one count per control
//! cycle is 30 rpm at 2000 qc per revolution. A position that varies by a few counts for 50 ms is
//! at rest.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::control;
use protocol::epos2::objects;
use units::{Quadcounts, Span};

use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, PositionValidity, StopReport};
use crate::ops::Ops;

use super::configure::has_lost_settings;
use super::network;
use super::power::{is_fault, is_off, is_referenced, wait_for};
use super::report::newest_error;

/// Counts by which the position of a shaft at rest may vary.
const STANDSTILL_QC: u32 = 3;

/// Runs [`crate::DriveCommand::Stop`].
pub(crate) async fn stop(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    halt(&mut ops).await.map(CommandOutcome::Stopped)
}

/// Runs [`crate::DriveCommand::Brake`].
pub(crate) async fn brake(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    match disable_at_standstill(&mut ops).await {
        Ok(report) => Ok(CommandOutcome::Stopped(report)),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

/// Stops the axis after a failure; returns the error to report. The quick stop precedes any
/// diagnosis.
pub(super) async fn make_safe(ops: &mut Ops, cause: DriveError) -> DriveError {
    ops.aborts_on_alarm = false;
    let stopped = match cause {
        DriveError::LinkLost { .. }
        | DriveError::NodeSilent { .. }
        | DriveError::NoAnswer { damaged: true, .. } => halt_on_lost_link(ops).await,
        _ => halt(ops).await,
    };
    match stopped {
        Ok(report) => {
            let cause = diagnose(ops, cause).await;
            ops.report(CommandProgress::MadeSafe(report));
            cause
        }
        Err(stop) => DriveError::NotStopped {
            cause: Box::new(cause),
            stop: Box::new(stop),
        },
    }
}

/// Quick stop, then power off. Harmless in every state: a drive that is off or in fault stays so.
pub(super) async fn halt(ops: &mut Ops) -> Result<StopReport, DriveError> {
    ops.is_moving = true;
    ops.write_urgent(objects::CONTROLWORD, control::QUICK_STOP)
        .await?;
    disable_at_standstill(ops).await
}

/// Like [`halt`] on a link without (undamaged) replies: fails soon, so that the caller soon knows.
async fn halt_on_lost_link(ops: &mut Ops) -> Result<StopReport, DriveError> {
    ops.is_moving = true;
    ops.write_last_attempt(objects::CONTROLWORD, control::QUICK_STOP)
        .await?;
    disable_at_standstill(ops).await
}

/// Completes an error once the axis is at rest: which fault, and whether the drive has restarted.
async fn diagnose(ops: &Ops, cause: DriveError) -> DriveError {
    let known = match cause {
        DriveError::Fault { error } => error,
        DriveError::State { .. } | DriveError::NotReferenced { .. } => None,
        DriveError::NotTaken { .. } | DriveError::Restarted { error: None } => None,
        other => return other,
    };
    let newest = match known {
        Some(error) => Some(error),
        // Without a readable history the cause stays unknown.
        None => newest_error(ops).await.unwrap_or_default(),
    };
    match cause {
        DriveError::Restarted { .. } => DriveError::Restarted { error: newest },
        _ if has_lost_settings(ops).await == Ok(true) => DriveError::Restarted { error: newest },
        DriveError::Fault { .. } => DriveError::Fault { error: newest },
        other => other,
    }
}

/// Waits for standstill, then disables the power stage and lets the brake close.
async fn disable_at_standstill(ops: &mut Ops) -> Result<StopReport, DriveError> {
    ops.is_moving = true;
    wait_for_standstill(ops).await?;
    ops.write_idempotent(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await?;
    let statusword = wait_for(ops, "power off", is_off).await?;
    ops.is_moving = false;
    let brake = ops.config.brake;
    ops.sleep(brake.map_or(Span::ZERO, |brake| brake.fall))
        .await;
    let position = ops.next_sample().await?.position;
    let fault = is_fault(statusword);
    let error = if fault {
        newest_error(ops).await?
    } else {
        None
    };
    // The power is off: an error of the monitoring no longer matters.
    let _ = network::disarm(ops).await;
    let validity = position_validity(ops, statusword, error);
    Ok(StopReport {
        position,
        validity,
        angle: (validity == PositionValidity::Valid).then(|| ops.config.gearing.angle(position)),
        fault,
        brake: brake.is_some(),
    })
}

fn position_validity(ops: &Ops, statusword: u16, error: Option<DeviceError>) -> PositionValidity {
    let referenced = is_referenced(statusword);
    match error {
        _ if !referenced && !ops.was_referenced() => PositionValidity::NotHomed,
        Some(error) if invalidates_position(error) => PositionValidity::Lost { error: Some(error) },
        _ if referenced => PositionValidity::Valid,
        _ => PositionValidity::Lost { error: None },
    }
}

/// Errors after which counts may be missing, even if the statusword shows a reference.
fn invalidates_position(error: DeviceError) -> bool {
    matches!(
        error,
        DeviceError::POSITION_SENSOR
            | DeviceError::INDEX
            | DeviceError::ENCODER_RESOLUTION
            | DeviceError::HALL_ANGLE
            | DeviceError::SENSOR_BREACH
    )
}

async fn wait_for_standstill(ops: &mut Ops) -> Result<(), DriveError> {
    let timing = ops.config.timing;
    let ramp_s = f64::from(ops.config.max_speed.0) / f64::from(ops.config.quick_stop.0);
    let began = ops.now();
    let limit = began
        .saturating_add(Span::from_secs_f64(ramp_s))
        .saturating_add(timing.state_limit);
    let mut reference: Option<Quadcounts> = None;
    let mut since = began;
    let mut is_overdue = false;
    loop {
        let sample = ops.next_sample().await?;
        let is_constant =
            reference.is_some_and(|qc| qc.0.abs_diff(sample.position.0) <= STANDSTILL_QC);
        if is_constant {
            if sample.request.saturating_since(since) >= timing.standstill {
                return Ok(());
            }
            continue;
        }
        // Both positions were requested after the limit: a delayed host may have missed the stop.
        if is_overdue {
            return Err(DriveError::StillMoving {
                position: sample.position,
                waited: ops.now().saturating_since(began),
            });
        }
        is_overdue = sample.request > limit;
        reference = Some(sample.position);
        since = sample.answer;
    }
}
