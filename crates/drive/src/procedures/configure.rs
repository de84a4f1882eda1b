//! The drive's settings: profile, limits, limit switches, brake.
//!
//! Nothing is saved in the drive (1010): a restart restores its own settings, and connecting writes
//! these again. Gains and motor data are left to the commissioning tool.

use std::ops::RangeInclusive;

use protocol::epos2::cia402::mode;
use protocol::epos2::objects::{self, Scalar, TypedObject};
use units::Span;

use crate::config::{BrakeConfig, LimitSwitchConfig, whole_ms};
use crate::error::DriveError;
use crate::ops::Ops;

use super::network;
use super::power::set_mode;

/// Motion profile type (6086): trapezoidal.
const TRAPEZOID: i16 = 0;
/// Position window (6067) switched off: "target reached" means the end of the profile.
const NO_WINDOW: u32 = u32::MAX;

/// Writes every setting and reads it back. The axis must be disabled.
pub(super) async fn configure(ops: &Ops) -> Result<(), DriveError> {
    let config = &ops.config;
    configure_limit_switches(ops, config.limit_switches).await?;
    configure_software_limits(ops).await?;
    set_mode(ops, mode::PROFILE_POSITION).await?;
    let acceleration = config.max_acceleration.0;
    let following_error = config
        .tolerance_qc(config.max_following_error)
        .0
        .unsigned_abs();
    for (object, value) in [
        (objects::MAX_PROFILE_VELOCITY, config.max_speed.0),
        (
            objects::MAX_ACCELERATION,
            acceleration.max(config.quick_stop.0),
        ),
        (objects::PROFILE_ACCELERATION, acceleration),
        (objects::PROFILE_DECELERATION, acceleration),
        (objects::QUICK_STOP_DECELERATION, config.quick_stop.0),
    ] {
        ops.write_verified(object, value).await?;
    }
    ops.write_verified(objects::PROFILE_TYPE, TRAPEZOID).await?;
    for (object, value) in [
        (objects::POSITION_WINDOW, NO_WINDOW),
        (objects::MAX_FOLLOWING_ERROR, following_error),
    ] {
        ops.write_verified(object, value).await?;
    }
    match config.brake {
        Some(brake) => configure_brake(ops, brake).await,
        None => Ok(()),
    }
}

/// Compares the drive's own configuration, which the client never writes, with that of the axis.
/// Done before every move: an exchanged drive may differ without any other sign.
async fn verify_drive(ops: &Ops) -> Result<(), DriveError> {
    let config = &ops.config;
    let lines = i64::from(config.gearing.qc_per_motor_turn() / 4);
    let key = Some("[axis] encoder_lines");
    expect(ops, objects::ENCODER_LINES, lines..=lines, key).await?;
    // An incremental encoder with or without index.
    expect(ops, objects::SENSOR_TYPE, 1..=2, None).await?;
    // The other direction mirrors the angles.
    let polarity = i64::from(config.sensor_polarity);
    let key = Some("[axis] sensor_polarity");
    expect(ops, objects::SENSOR_POLARITY, polarity..=polarity, key).await?;
    if let Some(brake) = config.brake {
        verify_brake(ops, brake).await?;
    }
    // A fault stops the axis by a ramp.
    expect(ops, objects::FAULT_OPTION, 1..=2, None).await?;
    expect(ops, objects::VELOCITY_NOTATION, 0..=0, None).await?;
    let fast_enough = config.max_speed.0.into()..=i64::MAX;
    let key = Some("[axis] max_speed_deg_s");
    expect(ops, objects::MAX_MOTOR_SPEED, fast_enough, key).await
}

/// Fails if the brake's output has the other polarity: the brake would open at power off.
async fn verify_brake(ops: &Ops, brake: BrakeConfig) -> Result<(), DriveError> {
    let got = ops.read(objects::OUTPUT_POLARITY).await?;
    let bit = 1 << objects::OUTPUT_BRAKE;
    if (got & bit != 0) == brake.inverted {
        return Ok(());
    }
    Err(DriveError::Contradiction {
        address: objects::OUTPUT_POLARITY.address,
        name: objects::OUTPUT_POLARITY.name,
        expected: match brake.inverted {
            true => format!("bit {} set", objects::OUTPUT_BRAKE),
            false => format!("bit {} clear", objects::OUTPUT_BRAKE),
        },
        got: got.into(),
        key: Some("[axis] brake_inverted"),
    })
}

/// Fails if an object's value is not one of `expected`. `key` is the configuration's for it.
async fn expect<T: Scalar + Into<i64>>(
    ops: &Ops,
    object: TypedObject<T>,
    expected: RangeInclusive<i64>,
    key: Option<&'static str>,
) -> Result<(), DriveError> {
    let got = ops.read(object).await?.into();
    if expected.contains(&got) {
        return Ok(());
    }
    let (least, most) = expected.into_inner();
    Err(DriveError::Contradiction {
        address: object.address,
        name: object.name,
        expected: match most {
            i64::MAX => format!("at least {least}"),
            _ if least == most => least.to_string(),
            _ => format!("{least} to {most}"),
        },
        got,
        key,
    })
}

/// Verifies the settings that keep the axis within its range. Done before every move, as a drive
/// that restarted has lost them. Returns the time of the quicker of two replies.
pub(super) async fn verify_safety(ops: &Ops) -> Result<Span, DriveError> {
    verify_drive(ops).await?;
    let switches = ops.config.limit_switches.mask();
    let mut quickest = Span::from_nanos(i64::MAX);
    for object in [objects::INPUT_MASK, objects::INPUT_EXECUTION_MASK] {
        let (got, reply) = ops.read_timed(object).await?;
        quickest = quickest.min(reply.took());
        if got & switches != switches {
            return Err(DriveError::NotTaken {
                address: object.address,
                expected: u32::from(got | switches),
                got: u32::from(got),
            });
        }
    }
    let limits = ops.config.limits_qc()?;
    ops.verify(objects::MIN_POSITION, limits.min.0).await?;
    ops.verify(objects::MAX_POSITION, limits.max.0).await?;
    network::verify(ops).await?;
    Ok(quickest)
}

/// Further reads before replies count as slow: a busy host delays some, but not all.
const REPLY_CHECKS: u8 = 5;

/// Verifies what [`verify_safety`] does, and that replies come well within the time limit of a
/// move: else the move would begin and end as unanswered.
pub(super) async fn verify_before_move(ops: &Ops) -> Result<(), DriveError> {
    let limit = Span::from_nanos(ops.config.timing.timeout_moving.as_nanos() / 5 * 4);
    let mut took = verify_safety(ops).await?;
    for _ in 0..REPLY_CHECKS {
        if took <= limit {
            return Ok(());
        }
        let (_, reply) = ops.read_timed(objects::MIN_POSITION).await?;
        took = took.min(reply.took());
    }
    match took <= limit {
        true => Ok(()),
        false => Err(DriveError::SlowReplies { took, limit }),
    }
}

/// Whether the drive has lost the software limits written by connecting, which only a restart
/// causes.
pub(super) async fn has_lost_settings(ops: &Ops) -> Result<bool, DriveError> {
    let limits = ops.config.limits_qc()?;
    let min = ops.read(objects::MIN_POSITION).await?;
    let max = ops.read(objects::MAX_POSITION).await?;
    Ok(min != limits.min.0 && max != limits.max.0)
}

/// Assigns and enables the limit switches. By default a switch does not stop the axis: only its bit
/// in 2071:4 makes the drive run its error reaction.
async fn configure_limit_switches(
    ops: &Ops,
    switches: LimitSwitchConfig,
) -> Result<(), DriveError> {
    let functions = [(switches.negative, 0), (switches.positive, 1)];
    for (input, function) in functions {
        if let Some(input) = input {
            write_if_different(ops, objects::digital_input(input), function).await?;
        }
    }
    let mask = switches.mask();
    let polarity = if switches.active_low { mask } else { 0 };
    ops.write_bits(objects::INPUT_POLARITY, mask, polarity)
        .await?;
    ops.write_bits(objects::INPUT_MASK, mask, mask).await?;
    ops.write_bits(objects::INPUT_EXECUTION_MASK, mask, mask)
        .await
}

async fn configure_software_limits(ops: &Ops) -> Result<(), DriveError> {
    let limits = ops.config.limits_qc()?;
    // The upper limit is opened first, so that the new pair never crosses the old one.
    ops.write(objects::MAX_POSITION, i32::MAX).await?;
    ops.write_verified(objects::MIN_POSITION, limits.min.0)
        .await?;
    ops.write_verified(objects::MAX_POSITION, limits.max.0)
        .await
}

async fn configure_brake(ops: &Ops, brake: BrakeConfig) -> Result<(), DriveError> {
    let ms = |span| u16::try_from(whole_ms(span)).unwrap_or(u16::MAX);
    ops.write_verified(objects::BRAKE_RISE, ms(brake.rise))
        .await?;
    ops.write_verified(objects::BRAKE_FALL, ms(brake.fall))
        .await?;
    let output = objects::digital_output(brake.output);
    write_if_different(ops, output, objects::OUTPUT_BRAKE).await?;
    let bit = 1 << objects::OUTPUT_BRAKE;
    ops.write_bits(objects::OUTPUT_MASK, bit, bit).await
}

/// Writes a terminal's function only if it differs: a drive refuses a function that another
/// terminal has.
async fn write_if_different(
    ops: &Ops,
    object: TypedObject<u16>,
    value: u16,
) -> Result<(), DriveError> {
    if ops.read(object).await? == value {
        return Ok(());
    }
    ops.write_verified(object, value).await
}
