//! Stop and brake: the axis at rest, seen to be at rest, power off, brake set.
//!
//! Rest is judged by the encoder: 606C is no finer than the encoder counts of a control cycle (30 rpm at 2000 qc a turn), while a position
//! that stays within some counts for 50 ms stands.

use protocol::epos2::cia402::control;
use units::{Quadcounts, Span};

use crate::error::DriveError;
use crate::event::{Outcome, Progress, Stopped};
use crate::objects;
use crate::ops::Ops;

use super::power::{is_fault, is_off, is_referenced, wait_for};

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

/// Brings the axis to rest after a failure and tells how that went.
pub(super) async fn make_safe(ops: &mut Ops, cause: DriveError) -> DriveError {
    match halt(ops).await {
        Ok(stopped) => {
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

/// Waits for standstill, then power off and brake.
async fn rest(ops: &mut Ops) -> Result<Stopped, DriveError> {
    ops.set_moving(true);
    standstill(ops).await?;
    ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await?;
    let statusword = wait_for(ops, "power off", is_off).await?;
    ops.set_moving(false);
    let brake = ops.config.brake;
    ops.sleep(brake.map_or(Span::ZERO, |brake| brake.fall))
        .await;
    let position = ops.sample().await?.position;
    Ok(Stopped {
        position,
        angle: is_referenced(statusword).then(|| ops.config.gearing.angle(position)),
        fault: is_fault(statusword),
        brake: brake.is_some(),
    })
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
    loop {
        let sample = ops.sample().await?;
        let stands = place.is_some_and(|p| p.0.abs_diff(sample.position.0) <= REST_QC);
        if !stands {
            place = Some(sample.position);
            since = sample.answer;
        } else if sample.request.saturating_since(since) >= timing.standstill {
            return Ok(());
        }
        if ops.now() > limit {
            return Err(DriveError::StillMoving {
                position: sample.position,
                waited: ops.now().saturating_since(began),
            });
        }
    }
}
