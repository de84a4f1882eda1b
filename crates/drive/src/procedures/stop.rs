//! Stop and brake: axis at rest and observed to be, power off, brake set. An axis without a brake
//! is held by the drive instead if the configuration says so.
//!
//! The encoder decides about standstill. The velocity (606C) is too coarse: one count per control
//! cycle is 30 rpm at 2000 qc per revolution. The axis is at rest if its positions of 50 ms spread
//! little and their mean does not drift.
//!
//! A quick stop that does not bring the axis to rest is followed by power off, which also closes
//! the brake; so is a quick stop without a reply, as the drive may still receive.

use std::collections::VecDeque;

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::control;
use protocol::epos2::objects;
use units::{Degrees, Quadcounts, Span};

use crate::config::AxisConfig;
use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, PositionValidity, ShaftSample, StopReport};
use crate::ops::Ops;

use super::configure::has_lost_settings;
use super::network;
use super::power::{is_fault, is_held, is_off, is_referenced, wait_for};
use super::ramp::QuickStopRamp;
use super::report::newest_error;

/// Time between two commands of power off while the axis still moves: 1.1 deg at 56.25 deg/s.
const POWER_OFF_PERIOD: Span = Span::from_millis(20);
/// Time after the ramp in which an axis with power comes to rest: ten standstill windows. An axis
/// without power coasts longer.
const SETTLING: Span = Span::from_millis(500);
/// Share of the standstill spread by which the mean position may drift within the window: 0.3 deg/s
/// with the defaults.
const DRIFT_SHARE: f64 = 0.25;

/// Runs [`crate::DriveCommand::Stop`].
pub(crate) async fn stop(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    halt(&mut ops).await.map(CommandOutcome::Stopped)
}

/// Runs [`crate::DriveCommand::Brake`].
pub(crate) async fn brake(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    match disable_at_standstill(&mut ops).await {
        Ok(report) => Ok(CommandOutcome::Stopped(report)),
        Err(cause) => Err(stop_after_failure(&mut ops, cause).await),
    }
}

/// Stops the axis after a failure; returns the error to report. The quick stop precedes any
/// diagnosis.
pub(super) async fn stop_after_failure(ops: &mut Ops, cause: DriveError) -> DriveError {
    ops.aborts_on_alarm = false;
    ops.silence_limit = Span::ZERO;
    ops.loaded_silence_limit = Span::ZERO;
    ops.is_slow = matches!(cause, DriveError::SlowReplies { .. });
    let stopped = match cause {
        DriveError::LinkLost { .. }
        | DriveError::NodeSilent { .. }
        | DriveError::NoAnswer { damaged: true, .. } => halt_on_lost_link(ops).await,
        _ => halt(ops).await,
    };
    match stopped {
        Ok(report) => {
            let cause = diagnose(ops, cause).await;
            ops.report(CommandProgress::StoppedAfterFailure(report));
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
    ops.loaded_silence_limit = Span::ZERO;
    let mut quick_stop = ops
        .write_urgent(objects::CONTROLWORD, control::QUICK_STOP)
        .await;
    // No state of the drive refuses it: the reply was damaged or that of another request.
    if matches!(quick_stop, Err(DriveError::Refused { .. })) {
        quick_stop = ops
            .write_urgent(objects::CONTROLWORD, control::QUICK_STOP)
            .await;
    }
    let stopped = match quick_stop {
        Ok(()) => disable_at_standstill(ops).await,
        Err(error) => Err(error),
    };
    match stopped {
        Ok(report) => Ok(report),
        Err(error) => cut_power(ops, error).await,
    }
}

/// Like [`halt`] on a link without (undamaged) replies: fails soon, so that the caller soon knows.
async fn halt_on_lost_link(ops: &mut Ops) -> Result<StopReport, DriveError> {
    ops.is_moving = true;
    match ops
        .write_last_attempt(objects::CONTROLWORD, control::QUICK_STOP)
        .await
    {
        Ok(()) => match disable_at_standstill(ops).await {
            Ok(report) => Ok(report),
            Err(error) => cut_power(ops, error).await,
        },
        Err(error) => {
            // The drive may have received the quick stop: its ramp comes before power off.
            ops.aborts_on_alarm = false;
            ops.sleep(quick_stop_ramp(ops)).await;
            cut_power(ops, error).await
        }
    }
}

/// Switches the power off after a quick stop that failed with `error`; the brake closes at once.
/// Returns `error` if this has no reply either.
async fn cut_power(ops: &mut Ops, error: DriveError) -> Result<StopReport, DriveError> {
    let off = ops
        .write_last_attempt(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await;
    if off.is_err() {
        return Err(error);
    }
    ops.is_coasting = true;
    match disable_at_standstill(ops).await {
        Ok(report) => {
            ops.report(CommandProgress::PowerCut);
            Ok(report)
        }
        Err(DriveError::StillMoving {
            position, waited, ..
        }) => Err(DriveError::StillMoving {
            position,
            waited,
            power_off: true,
        }),
        Err(_) => Err(error),
    }
}

/// Duration of a quick stop from the highest speed.
fn quick_stop_ramp(ops: &Ops) -> Span {
    let config = &ops.config;
    Span::from_secs_f64(f64::from(config.max_speed.0) / f64::from(config.quick_stop.0))
}

/// Completes an error once the axis is at rest: which fault, and whether the drive has restarted.
async fn diagnose(ops: &Ops, cause: DriveError) -> DriveError {
    let known = match cause {
        DriveError::Fault { error } => error,
        DriveError::State { .. } | DriveError::NotReferenced { .. } => None,
        DriveError::NotTaken { .. } | DriveError::Restarted { error: None } => None,
        // A fault or a restart explains the motion, a silent host the state.
        DriveError::OffPlan { .. } | DriveError::LimitSwitch { .. } => None,
        DriveError::NodeLeft { .. } => None,
        other => return other,
    };
    let newest = match known {
        Some(error) => Some(error),
        // Without a readable history the cause stays unknown.
        None => newest_error(ops).await.unwrap_or_default(),
    };
    if matches!(cause, DriveError::Restarted { .. }) || has_lost_settings(ops).await == Ok(true) {
        return DriveError::Restarted { error: newest };
    }
    let state = ops.read(objects::STATUSWORD).await.ok();
    // A drive that holds the axis stops it without a fault (6007 = 3).
    let is_held = ops.config.holds() && state.is_some_and(|word| !is_fault(word));
    let silence = ops.on_can(|can, _| can.host_silence).flatten();
    match (cause, silence.filter(|_| is_held)) {
        (
            DriveError::Fault {
                error: None | Some(DeviceError::CAN_LIFE_GUARD),
            }
            | DriveError::State { .. }
            | DriveError::NotTaken { .. }
            | DriveError::NodeLeft { .. }
            | DriveError::OffPlan { .. },
            Some(silence),
        ) => DriveError::HostSilent { silence },
        (DriveError::OffPlan { .. } | DriveError::LimitSwitch { .. }, _)
            if state.is_some_and(is_fault) =>
        {
            DriveError::Fault { error: newest }
        }
        (DriveError::Fault { .. }, _) => DriveError::Fault { error: newest },
        (other, _) => other,
    }
}

/// Waits for standstill, then disables the power stage and lets the brake close. The one policy at
/// the end of every move and stop.
async fn disable_at_standstill(ops: &mut Ops) -> Result<StopReport, DriveError> {
    ops.is_moving = true;
    let at_rest = wait_for_standstill(ops).await?;
    let mut statusword = 0;
    if ops.config.holds() {
        statusword = ops.read(objects::STATUSWORD).await?;
    }
    let held = is_held(ops, statusword);
    if !held {
        ops.write_idempotent(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
            .await?;
        statusword = wait_for(ops, "power off", is_off).await?;
    }
    let brake = ops.config.brake;
    ops.sleep(brake.map_or(Span::ZERO, |brake| brake.fall))
        .await;
    let position = match held {
        true => ops.next_sample().await?.position,
        false => wait_without_power(ops, at_rest).await?,
    };
    ops.is_moving = false;
    let fault = is_fault(statusword);
    let error = if fault {
        newest_error(ops).await?
    } else {
        None
    };
    // The power is off, or 6007 keeps it on: an error of the monitoring no longer matters.
    let _ = network::disarm(ops).await;
    let validity = position_validity(ops, statusword, error);
    Ok(StopReport {
        position,
        validity,
        angle: (validity == PositionValidity::Valid).then(|| ops.config.gearing.angle(position)),
        fault,
        brake: brake.is_some(),
        held,
    })
}

/// Waits until an axis that was `at_rest` with power is at rest without: its head may fall.
async fn wait_without_power(ops: &mut Ops, at_rest: Quadcounts) -> Result<Quadcounts, DriveError> {
    ops.is_coasting = true;
    let position = wait_for_standstill(ops)
        .await
        .map_err(|error| match error {
            DriveError::StillMoving {
                position, waited, ..
            } => DriveError::StillMoving {
                position,
                waited,
                power_off: true,
            },
            error => error,
        })?;
    let qc = position.0.saturating_sub(at_rest.0);
    let moved = ops.config.gearing.degrees_per_qc() * f64::from(qc);
    if moved.abs() > ops.config.guard.ahead.0 {
        ops.report(CommandProgress::MovedAfterPowerOff(Degrees(moved)));
    }
    Ok(position)
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

async fn wait_for_standstill(ops: &mut Ops) -> Result<Quadcounts, DriveError> {
    let began = ops.now();
    let margin = match ops.is_coasting {
        true => ops.config.timing.state_limit,
        false => SETTLING.min(ops.config.timing.state_limit),
    };
    let limit = began
        .saturating_add(quick_stop_ramp(ops))
        .saturating_add(margin);
    let mut window = StandstillWindow::new(&ops.config);
    let mut ramp = (!ops.is_coasting).then(|| QuickStopRamp::new(&ops.config, ops.lag()));
    let mut is_overdue = false;
    let mut repeat_at = began.saturating_add(POWER_OFF_PERIOD);
    loop {
        // The drive may have lost the first one. A lost link fails the next sample.
        if ops.is_coasting && ops.now() >= repeat_at && !window.is_steady() {
            let _ = ops
                .write_idempotent(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
                .await;
            repeat_at = ops.now().saturating_add(POWER_OFF_PERIOD);
        }
        let sample = ops.next_sample().await?;
        if window.is_at_rest_with(&sample) {
            return Ok(sample.position);
        }
        // All positions were requested after the limit: a delayed host may have missed the stop.
        let has_left = ramp.as_mut().is_some_and(|ramp| ramp.is_left_by(&sample));
        if has_left || is_overdue && !window.is_steady() {
            return Err(DriveError::StillMoving {
                position: ops.config.gearing.angle(sample.position),
                waited: ops.now().saturating_since(began),
                power_off: false,
            });
        }
        let first = window.samples.front();
        is_overdue = first.is_some_and(|first| first.request > limit);
    }
}

/// The latest positions, and whether they show an axis at rest.
struct StandstillWindow {
    /// Time that the window covers at least.
    span: Span,
    /// Largest spread of the positions, qc.
    spread: f64,
    samples: VecDeque<ShaftSample>,
}

impl StandstillWindow {
    fn new(config: &AxisConfig) -> Self {
        Self {
            span: config.timing.standstill,
            spread: f64::from(config.tolerance_qc(config.standstill_spread).0),
            samples: VecDeque::new(),
        }
    }

    /// Adds a sample; returns whether the axis was at rest throughout the window.
    fn is_at_rest_with(&mut self, sample: &ShaftSample) -> bool {
        self.samples.push_back(*sample);
        // The window begins with the newest sample that is old enough.
        while let Some(second) = self.samples.get(1)
            && sample.request.saturating_since(second.answer) >= self.span
        {
            self.samples.pop_front();
        }
        let covers = self
            .samples
            .front()
            .is_some_and(|first| sample.request.saturating_since(first.answer) >= self.span);
        covers && self.is_steady()
    }

    /// Whether the positions spread little and their mean does not drift.
    fn is_steady(&self) -> bool {
        let positions = || {
            self.samples
                .iter()
                .map(|sample| f64::from(sample.position.0))
        };
        let lowest = positions().fold(f64::INFINITY, f64::min);
        let highest = positions().fold(f64::NEG_INFINITY, f64::max);
        let half = self.samples.len() / 2;
        let mean = |sum: f64| sum / half.max(1) as f64;
        let drift = mean(positions().rev().take(half).sum()) - mean(positions().take(half).sum());
        highest - lowest <= self.spread && drift.abs() <= (self.spread * DRIFT_SHARE).max(3.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event::SampleTrigger;
    use units::{Gearing, Quadcounts, Stamp};

    /// Milliseconds until rest is found in positions polled every `period_ms`.
    fn found_after(period_ms: i64, position: impl Fn(i64) -> f64) -> Option<i64> {
        found_by(&AxisConfig::default(), period_ms, position)
    }

    fn found_by(config: &AxisConfig, period_ms: i64, position: impl Fn(i64) -> f64) -> Option<i64> {
        let mut window = StandstillWindow::new(config);
        (0..2_000).step_by(period_ms as usize).find(|ms| {
            let at = Stamp::from_nanos(ms * 1_000_000);
            window.is_at_rest_with(&ShaftSample {
                request: at,
                answer: at,
                position: Quadcounts(position(*ms).round() as i32),
                trigger: SampleTrigger::Request,
                drive_us: None,
            })
        })
    }

    #[test]
    fn an_axis_at_rest_is_found_after_the_window() {
        assert_eq!(found_after(1, |_| 7.0), Some(50));
        assert_eq!(found_after(10, |_| 7.0), Some(50));
    }

    /// An encoder at the edge of a count, and a servo that hunts by 8 qc.
    #[test]
    fn dither_is_rest() {
        for period_ms in [1, 2, 8, 15] {
            let dither = |ms: i64| 8.0 * (ms as f64 * 0.7).sin();
            let found = found_after(period_ms, dither).unwrap();
            assert!(found <= 150, "{period_ms} ms: {found} ms");
        }
    }

    /// 0.02 deg per count: 0.03 deg would be a single count.
    #[test]
    fn dither_of_a_coarse_encoder_is_rest() {
        let gearing = Gearing::new(50, 90, 1).unwrap();
        let config = AxisConfig {
            gearing,
            standstill_spread: AxisConfig::rest_tolerance(gearing),
            ..AxisConfig::default()
        };
        for period_ms in [1, 2, 8, 15] {
            let dither = |ms: i64| 8.0 * (ms as f64 * 0.7).sin();
            let found = found_by(&config, period_ms, dither).unwrap();
            assert!(found <= 150, "{period_ms} ms: {found} ms");
            // 10 deg/s.
            let moving = found_by(&config, period_ms, |ms| ms as f64 * 0.5);
            assert_eq!(moving, None, "{period_ms} ms");
        }
    }

    /// The spread of a slow axis is small, too: its drift shows the motion.
    #[test]
    fn slow_motion_is_not_rest() {
        for deg_s in [0.4, 1.0, 56.25] {
            let qc_per_ms = deg_s / 0.0015 / 1e3;
            assert_eq!(
                found_after(1, |ms| ms as f64 * qc_per_ms),
                None,
                "{deg_s} deg/s"
            );
        }
    }

    #[test]
    fn rest_is_found_after_motion() {
        let stops = |ms: i64| (ms.min(200) * 40) as f64;
        let found = found_after(1, stops).unwrap();
        assert!((248..=255).contains(&found), "{found}");
    }
}
