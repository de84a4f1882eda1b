//! Home: the drive searches its reference by itself; the client sets it up, watches, and checks the result.

use protocol::epos2::cia402::{control, mode, status};
use units::Quadcounts;

use crate::error::DriveError;
use crate::event::{Outcome, Progress};
use crate::objects;
use crate::ops::Ops;

use super::configure::verify_safety;
use super::network;
use super::power::{check_enabled, enable, is_referenced, set_mode};
use super::stop::make_safe;

/// [`crate::Command::Home`]
pub(crate) async fn home(mut ops: Ops) -> Result<Outcome, DriveError> {
    ops.watch(true);
    match search(&mut ops).await {
        Ok(outcome) => Ok(outcome),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

async fn search(ops: &mut Ops) -> Result<Outcome, DriveError> {
    verify_safety(ops).await?;
    // Into a known state before the mode changes: a start bit left over from another master must not act.
    ops.write(objects::CONTROLWORD, control::SHUTDOWN).await?;
    set_mode(ops, mode::HOMING).await?;
    set_up(ops).await?;
    network::arm(ops).await?;
    enable(ops).await?;
    ops.set_moving(true);
    ops.set_referenced(false);
    ops.write(objects::CONTROLWORD, control::START_HOMING)
        .await?;
    ops.tell(Progress::Homing);
    watch(ops).await?;
    ops.set_moving(false);
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    set_mode(ops, mode::PROFILE_POSITION).await?;
    let outcome = check(ops).await?;
    network::disarm(ops).await?;
    Ok(outcome)
}

async fn set_up(ops: &Ops) -> Result<(), DriveError> {
    let homing = ops.config.homing;
    let offset = ops.config.quadcounts("homing.offset", homing.offset)?;
    let position = ops
        .config
        .quadcounts("homing.home_position", homing.home_position)?;
    ops.set(objects::HOMING_METHOD, homing.method).await?;
    ops.set(objects::HOMING_SWITCH_SPEED, homing.switch_speed.0)
        .await?;
    ops.set(objects::HOMING_ZERO_SPEED, homing.zero_speed.0)
        .await?;
    ops.set(objects::HOMING_ACCELERATION, homing.acceleration.0)
        .await?;
    ops.set(objects::HOME_OFFSET, offset.0).await?;
    ops.set(objects::HOME_POSITION, position.0).await?;
    if homing.by_current() {
        ops.set(objects::HOMING_CURRENT, homing.current_threshold_ma)
            .await?;
    }
    Ok(())
}

/// Waits for bits 10 and 12. The first look comes a period late, when the bits of an earlier homing have gone.
async fn watch(ops: &mut Ops) -> Result<(), DriveError> {
    const DONE: u16 = status::TARGET_REACHED | status::HOMING_ATTAINED;
    let homing = ops.config.homing;
    let limit = ops.now().saturating_add(homing.time_limit);
    loop {
        ops.sleep(ops.config.timing.status_period).await;
        let asked = ops.now();
        let got = check_enabled(ops).await?;
        if got & status::HOMING_ERROR != 0 {
            return Err(DriveError::Homing {
                method: homing.method,
                got,
            });
        }
        if got & DONE == DONE {
            return Ok(());
        }
        // For whoever looks on. A drive that does not tell is homed all the same; one that is gone is missed at the next look.
        if let Ok((demand, answered)) = ops.read_timed(objects::POSITION_DEMAND).await {
            ops.tell(Progress::Searching {
                at: answered.answer,
                demand: Quadcounts(demand),
            });
        }
        if asked > limit {
            return Err(DriveError::HomingTime {
                method: homing.method,
                limit: homing.time_limit,
                got,
            });
        }
    }
}

async fn check(ops: &mut Ops) -> Result<Outcome, DriveError> {
    let got = check_enabled(ops).await?;
    if !is_referenced(got) {
        return Err(DriveError::NotReferenced { got });
    }
    ops.set_referenced(true);
    let position = settled(ops).await?;
    let angle = ops.config.gearing.angle(position);
    if !is_inside(ops, position)? {
        return Err(DriveError::Outside {
            at: angle,
            min: ops.config.limits.min,
            max: ops.config.limits.max,
        });
    }
    Ok(Outcome::Homed { position, angle })
}

/// Where the axis is, once it is within the limits or stands: the drive calls homing done when its demand is there, and a servo comes
/// after it.
async fn settled(ops: &mut Ops) -> Result<Quadcounts, DriveError> {
    let timing = ops.config.timing;
    let limit = ops.now().saturating_add(timing.state_limit);
    let mut place = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let mut since = ops.now();
    while !is_inside(ops, place)? {
        let asked = ops.now();
        if asked.saturating_since(since) >= timing.standstill || asked > limit {
            break;
        }
        ops.sleep(timing.status_period).await;
        let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
        if position != place {
            (place, since) = (position, ops.now());
        }
    }
    Ok(place)
}

/// Whether a position is within the limits, to the tolerance of an arrival.
fn is_inside(ops: &Ops, position: Quadcounts) -> Result<bool, DriveError> {
    let limits = ops.config.limits_qc()?;
    let tolerance = ops.config.arrival_tolerance.0;
    Ok(limits.min.0.saturating_sub(tolerance) <= position.0
        && position.0 <= limits.max.0.saturating_add(tolerance))
}
