//! The drive's settings, written and read back: profile, limits, limit switches, brake.
//!
//! Nothing is saved in the drive (1010): after a restart it is as its owner left it, and connecting sets it up again. Gains and
//! motor data are the commissioning tool's business.

use crate::config::{Brake, LimitSwitches, whole_ms};
use crate::error::DriveError;
use crate::objects::{self, Object};
use crate::ops::Ops;
use protocol::epos2::cia402::mode;

use super::network;
use super::power::set_mode;

/// Writes every setting and reads it back. The axis must be disabled.
pub(super) async fn configure(ops: &Ops) -> Result<(), DriveError> {
    let config = &ops.config;
    limit_switches(ops, config.limit_switches).await?;
    software_limits(ops).await?;
    set_mode(ops, mode::PROFILE_POSITION).await?;
    let fastest = config.max_acceleration.max(config.quick_stop).0;
    ops.set(objects::MAX_PROFILE_VELOCITY, config.max_speed.0)
        .await?;
    ops.set(objects::MAX_ACCELERATION, fastest).await?;
    ops.set(objects::PROFILE_ACCELERATION, config.max_acceleration.0)
        .await?;
    ops.set(objects::PROFILE_DECELERATION, config.max_acceleration.0)
        .await?;
    ops.set(objects::QUICK_STOP_DECELERATION, config.quick_stop.0)
        .await?;
    ops.set(objects::PROFILE_TYPE, TRAPEZOID).await?;
    ops.set(objects::POSITION_WINDOW, NO_WINDOW).await?;
    let following = config.max_following_error.0.unsigned_abs();
    ops.set(objects::MAX_FOLLOWING_ERROR, following).await?;
    match config.brake {
        Some(brake) => set_brake(ops, brake).await,
        None => Ok(()),
    }
}

/// 6086: trapezoidal profile.
const TRAPEZOID: i16 = 0;
/// 6067: "target reached" means the end of the profile.
const NO_WINDOW: u32 = u32::MAX;

/// Reads what keeps the axis within its range. Done before every move, as a drive that restarted in between has forgotten it.
pub(super) async fn verify_safety(ops: &Ops) -> Result<(), DriveError> {
    let switches = ops.config.limit_switches.mask();
    for object in [objects::INPUT_MASK, objects::INPUT_EXECUTION_MASK] {
        let got = ops.read(object).await?;
        if got & switches != switches {
            return Err(DriveError::NotTaken {
                address: object.address,
                expected: u32::from(got | switches),
                got: u32::from(got),
            });
        }
    }
    let limits = ops.config.limits_qc()?;
    ops.expect(objects::MIN_POSITION, limits.min.0).await?;
    ops.expect(objects::MAX_POSITION, limits.max.0).await?;
    network::verify(ops).await
}

/// Whether the drive has lost what it was told when it was connected: only a restart does that.
pub(super) async fn has_forgotten(ops: &Ops) -> Result<bool, DriveError> {
    let limits = ops.config.limits_qc()?;
    let min = ops.read(objects::MIN_POSITION).await?;
    let max = ops.read(objects::MAX_POSITION).await?;
    Ok(min != limits.min.0 && max != limits.max.0)
}

/// By default a limit switch does not stop the axis: only a bit in 2071:4 makes it run its error routine.
async fn limit_switches(ops: &Ops, switches: LimitSwitches) -> Result<(), DriveError> {
    let purposes = [(switches.negative, 0), (switches.positive, 1)];
    for (input, purpose) in purposes {
        if let Some(input) = input {
            set_if_other(ops, Object::new(0x2070, input, "input"), purpose).await?;
        }
    }
    let mask = switches.mask();
    let polarity = if switches.active_low { mask } else { 0 };
    ops.set_bits(objects::INPUT_POLARITY, mask, polarity)
        .await?;
    ops.set_bits(objects::INPUT_MASK, mask, mask).await?;
    ops.set_bits(objects::INPUT_EXECUTION_MASK, mask, mask)
        .await
}

async fn software_limits(ops: &Ops) -> Result<(), DriveError> {
    let limits = ops.config.limits_qc()?;
    // Opened first, so that the new pair never crosses the old one.
    ops.write(objects::MAX_POSITION, i32::MAX).await?;
    ops.set(objects::MIN_POSITION, limits.min.0).await?;
    ops.set(objects::MAX_POSITION, limits.max.0).await
}

async fn set_brake(ops: &Ops, brake: Brake) -> Result<(), DriveError> {
    let ms = |span| u16::try_from(whole_ms(span)).unwrap_or(u16::MAX);
    ops.set(objects::BRAKE_RISE, ms(brake.rise)).await?;
    ops.set(objects::BRAKE_FALL, ms(brake.fall)).await?;
    let output = Object::new(0x2079, brake.output, "output");
    set_if_other(ops, output, objects::OUTPUT_BRAKE).await?;
    let bit = 1 << objects::OUTPUT_BRAKE;
    ops.set_bits(objects::OUTPUT_MASK, bit, bit).await
}

/// Purposes are written only where they differ: a drive refuses a purpose that another terminal has already.
async fn set_if_other(ops: &Ops, object: Object<u16>, value: u16) -> Result<(), DriveError> {
    if ops.read(object).await? == value {
        return Ok(());
    }
    ops.set(object, value).await
}
