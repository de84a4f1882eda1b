//! Goto, sweep and hold: moves in profile position mode, sampled throughout.
//!
//! Targets are validated before the procedure starts. The drive generates the profile; the client
//! polls the position and periodically checks the statusword.

use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects;
use units::{Host, Quadcounts, Span, Stamp};

use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, MoveReport, ShaftSample};
use crate::ops::Ops;
use crate::plan::{MovePlan, ValidatedMove};

use super::configure::verify_before_move;
use super::guard::MotionGuard;
use super::network;
use super::power::{
    check_enabled, check_state, enable, is_fault, is_referenced, set_mode, wait_for,
};
use super::stop::stop_after_failure;
use super::switches::SwitchWatch;

/// Runs [`crate::DriveCommand::Goto`].
pub(crate) async fn goto(ops: Ops, target: ValidatedMove) -> Result<CommandOutcome, DriveError> {
    guarded_move(ops, target, Span::ZERO).await
}

/// Runs [`crate::DriveCommand::Sweep`].
pub(crate) async fn sweep(ops: Ops, target: ValidatedMove) -> Result<CommandOutcome, DriveError> {
    let hold = ops.config.timing.hold;
    guarded_move(ops, target, hold).await
}

/// Runs [`crate::DriveCommand::Hold`].
pub(crate) async fn hold(mut ops: Ops, until: Stamp<Host>) -> Result<CommandOutcome, DriveError> {
    ops.aborts_on_alarm = true;
    match sample_until(&mut ops, until).await {
        Ok(()) => Ok(CommandOutcome::Held),
        Err(cause) => Err(stop_after_failure(&mut ops, cause).await),
    }
}

/// Samples an axis: one that is powered must not move, one without power may be turned by hand.
async fn sample_until(ops: &mut Ops, until: Stamp<Host>) -> Result<(), DriveError> {
    let state = DeviceState::from_statusword(ops.read(objects::STATUSWORD).await?);
    if let Some(held @ (DeviceState::OperationEnabled | DeviceState::QuickStopActive)) = state {
        return sample_at_rest(ops, until, held).await;
    }
    let mut check = PeriodicCheck::new(ops, STATUS_CHECKS);
    while ops.now() < until {
        ops.next_sample().await?;
        if check.is_due(ops.now()) && is_fault(ops.read(objects::STATUSWORD).await?) {
            return Err(DriveError::Fault { error: None });
        }
    }
    Ok(())
}

async fn guarded_move(
    mut ops: Ops,
    target: ValidatedMove,
    hold: Span,
) -> Result<CommandOutcome, DriveError> {
    ops.aborts_on_alarm = true;
    let mut begun = None;
    match run(&mut ops, target, hold, &mut begun).await {
        Ok(report) => Ok(CommandOutcome::Arrived(report)),
        Err(cause) => {
            let error = stop_after_failure(&mut ops, cause).await;
            let arrived = arrived_in_silence(&mut ops, &error, begun).await;
            arrived.map(CommandOutcome::Arrived).ok_or(error)
        }
    }
}

/// The completed move of an axis that was silent at its end: it has been stopped in time, and rests
/// at its target all the same.
async fn arrived_in_silence(
    ops: &mut Ops,
    error: &DriveError,
    begun: Option<(MovePlan, Stamp<Host>)>,
) -> Option<MoveReport> {
    let (DriveError::LinkLost { silent, .. }, Some((plan, started))) = (error, begun) else {
        return None;
    };
    let (position, reply) = ops.read_timed(objects::POSITION_ACTUAL).await.ok()?;
    let angle = ops.config.gearing.angle(Quadcounts(position));
    if (angle.0 - plan.to.0).abs() > ops.config.arrival_tolerance.0 {
        return None;
    }
    ops.report(CommandProgress::StoppedAtTarget(*silent));
    Some(MoveReport {
        plan,
        position: Quadcounts(position),
        angle,
        started,
        arrived: reply.received,
    })
}

async fn run(
    ops: &mut Ops,
    target: ValidatedMove,
    hold: Span,
    begun: &mut Option<(MovePlan, Stamp<Host>)>,
) -> Result<MoveReport, DriveError> {
    verify_before_move(ops).await?;
    let got = ops.read(objects::STATUSWORD).await?;
    if !is_referenced(got) {
        return Err(DriveError::NotReferenced { got });
    }
    ops.set_referenced(true);
    set_mode(ops, mode::PROFILE_POSITION).await?;
    network::arm(ops).await?;
    enable(ops).await?;
    configure(ops, target).await?;
    sample_for(ops, hold).await?;
    let from = ops.next_sample().await?.position;
    let plan = ops.config.plan_move(from, target);
    let mut switches = SwitchWatch::of_move(&ops.config, from.0, target.target.0);
    switches.check(ops).await?;
    let (mut guard, started) = start(ops, plan).await?;
    *begun = Some((plan, started));
    let (position, arrived) =
        sample_until_arrival(ops, target.target, &mut guard, &mut switches, started).await?;
    ops.is_moving = false;
    sample_for(ops, hold).await?;
    Ok(MoveReport {
        plan,
        position,
        angle: ops.config.gearing.angle(position),
        started,
        arrived,
    })
}

async fn configure(ops: &Ops, target: ValidatedMove) -> Result<(), DriveError> {
    for (object, value) in [
        (objects::PROFILE_VELOCITY, target.speed.0),
        (objects::PROFILE_ACCELERATION, target.acceleration.0),
        (objects::PROFILE_DECELERATION, target.acceleration.0),
    ] {
        ops.write_verified(object, value).await?;
    }
    ops.write_verified(objects::TARGET_POSITION, target.target.0)
        .await?;
    // The setpoint bit acts on its rising edge, after the last acknowledgement is cleared.
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    wait_for(ops, "setpoint acknowledgement (bit 12) cleared", |word| {
        word & status::SETPOINT_ACKNOWLEDGE == 0
    })
    .await
    .map(drop)
}

/// Starts the move; returns its guard, and when the drive confirmed the start.
async fn start(ops: &mut Ops, plan: MovePlan) -> Result<(MotionGuard, Stamp<Host>), DriveError> {
    ops.is_moving = true;
    let sent = ops.now();
    ops.write(objects::CONTROLWORD, control::START_ABSOLUTE)
        .await?;
    let started = ops.now();
    let mut guard = MotionGuard::new(&ops.config, plan, sent, started);
    ops.report(CommandProgress::Moving(plan));
    let limit = started.saturating_add(ops.config.timing.state_limit);
    loop {
        // The axis accelerates and only samples show how: every other request goes between two of
        // them.
        guarded_sample(ops, &mut guard).await?;
        if guard.is_suspicious() {
            continue;
        }
        let requested = ops.now();
        let got = check_enabled(ops).await?;
        if got & status::SETPOINT_ACKNOWLEDGE != 0 {
            break;
        }
        if requested > limit {
            return Err(DriveError::State {
                expected: "setpoint acknowledged (bit 12)",
                got,
            });
        }
    }
    guarded_sample(ops, &mut guard).await?;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    Ok((guard, started))
}

/// The next sample, compared with the plan.
async fn guarded_sample(ops: &mut Ops, guard: &mut MotionGuard) -> Result<ShaftSample, DriveError> {
    let sample = ops.next_sample().await?;
    let checked = guard.check(&sample, ops.config.gearing.angle(sample.position));
    ops.set_lag(guard.lag);
    checked?;
    Ok(sample)
}

/// Time from giving up a silent link to the stop of the axis: a probe and a quick stop without
/// reply.
const BLIND_STOP: Span = Span::from_millis(250);

/// Samples until the axis is at its target; returns its position and when.
async fn sample_until_arrival(
    ops: &mut Ops,
    target: Quadcounts,
    guard: &mut MotionGuard,
    switches: &mut SwitchWatch,
    started: Stamp<Host>,
) -> Result<(Quadcounts, Stamp<Host>), DriveError> {
    let limit = started
        .saturating_add(guard.plan().duration)
        .saturating_add(ops.config.timing.arrival_margin);
    let tolerance = ops.config.tolerance_qc(ops.config.arrival_tolerance);
    let tolerance = tolerance.0.unsigned_abs();
    let mut check = PeriodicCheck::new(ops, STATUS_CHECKS);
    let mut switch_check = PeriodicCheck::new(ops, SWITCH_CHECKS);
    let mut reached = false;
    // Set when the statusword was requested after the limit. Only a position requested after that
    // proves a failure, as a delayed host may have missed the arrival.
    let mut is_overdue = false;
    let planned_end = started.saturating_add(guard.plan().duration);
    let last_stop = planned_end.saturating_add(-BLIND_STOP);
    loop {
        // An axis that moves on unseen must be stopped before it is beyond its limits.
        let left = last_stop.saturating_since(ops.now()).max(Span::ZERO);
        ops.silence_limit = ops.config.timing.silence_limit.min(left);
        let sample = guarded_sample(ops, guard).await?;
        if reached && sample.position.0.abs_diff(target.0) <= tolerance {
            return Ok((sample.position, sample.answer));
        }
        if is_overdue && sample.request > limit {
            return Err(DriveError::NotArrived {
                target: ops.config.gearing.angle(target),
                position: ops.config.gearing.angle(sample.position),
                waited: ops.now().saturating_since(started),
                reached,
            });
        }
        is_overdue = ops.now() > limit;
        if guard.is_suspicious() {
            continue;
        }
        if is_overdue || check.is_due(ops.now()) {
            reached = check_enabled(ops).await? & status::TARGET_REACHED != 0;
        } else if switch_check.is_due(ops.now()) {
            switches.check(ops).await?;
        }
    }
}

/// Samples an enabled axis at standstill for a time.
async fn sample_for(ops: &mut Ops, span: Span) -> Result<(), DriveError> {
    let until = ops.now().saturating_add(span);
    match span {
        Span::ZERO => Ok(()),
        _ => sample_at_rest(ops, until, DeviceState::OperationEnabled).await,
    }
}

/// Samples an axis at standstill that stays powered in this state; it must not move away.
async fn sample_at_rest(
    ops: &mut Ops,
    until: Stamp<Host>,
    state: DeviceState,
) -> Result<(), DriveError> {
    ops.silence_limit = ops.config.timing.silence_limit;
    let here = ops.next_sample().await?;
    let no_move = ValidatedMove {
        target: here.position,
        speed: ops.config.max_speed,
        acceleration: ops.config.max_acceleration,
    };
    let plan = ops.config.plan_move(here.position, no_move);
    let mut guard = MotionGuard::new(&ops.config, plan, here.request, here.answer);
    let mut check = PeriodicCheck::new(ops, STATUS_CHECKS);
    while ops.now() < until {
        guarded_sample(ops, &mut guard).await?;
        if check.is_due(ops.now()) {
            check_state(ops, state).await?;
        }
    }
    ops.silence_limit = Span::ZERO;
    Ok(())
}

/// Status periods between two checks of the statusword.
const STATUS_CHECKS: i64 = 1;
/// Status periods between two checks of the limit switches.
pub(super) const SWITCH_CHECKS: i64 = 4;

/// Timer of repeated checks.
pub(super) struct PeriodicCheck {
    next: Stamp<Host>,
    period: Span,
}

impl PeriodicCheck {
    pub fn new(ops: &Ops, status_periods: i64) -> Self {
        let period = ops.config.timing.status_period.as_nanos();
        let period = Span::from_nanos(period.saturating_mul(status_periods));
        Self {
            next: ops.now().saturating_add(period),
            period,
        }
    }

    pub fn is_due(&mut self, now: Stamp<Host>) -> bool {
        let is_due = now >= self.next;
        if is_due {
            self.next = now.saturating_add(self.period);
        }
        is_due
    }
}
