//! Goto, sweep and hold: moves in profile position mode, sampled throughout.
//!
//! Targets are validated before the procedure starts. The drive generates the profile; the client
//! polls the position and periodically checks the statusword.

use protocol::epos2::cia402::{control, mode, status};
use protocol::epos2::objects;
use units::{Host, Quadcounts, Span, Stamp};

use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress, MoveReport};
use crate::ops::Ops;
use crate::plan::{MovePlan, ValidatedMove};

use super::configure::verify_safety;
use super::network;
use super::power::{check_enabled, enable, is_fault, is_referenced, set_mode, wait_for};
use super::stop::make_safe;

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
    match sample_until_fault(&mut ops, until).await {
        Ok(()) => Ok(CommandOutcome::Held),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

/// Samples an axis that may be disabled.
async fn sample_until_fault(ops: &mut Ops, until: Stamp<Host>) -> Result<(), DriveError> {
    let mut check = PeriodicCheck::new(ops);
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
    match run(&mut ops, target, hold).await {
        Ok(report) => Ok(CommandOutcome::Arrived(report)),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

async fn run(ops: &mut Ops, target: ValidatedMove, hold: Span) -> Result<MoveReport, DriveError> {
    verify_safety(ops).await?;
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
    let started = start(ops, plan).await?;
    let (position, arrived) = sample_until_arrival(ops, target.target, &plan, started).await?;
    ops.is_moving = false;
    sample_for(ops, hold).await?;
    network::disarm(ops).await?;
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

/// Starts the move; returns when.
async fn start(ops: &mut Ops, plan: MovePlan) -> Result<Stamp<Host>, DriveError> {
    ops.is_moving = true;
    ops.write(objects::CONTROLWORD, control::START_ABSOLUTE)
        .await?;
    let started = ops.now();
    ops.report(CommandProgress::Moving(plan));
    let limit = started.saturating_add(ops.config.timing.state_limit);
    loop {
        // The axis accelerates and only samples show how: each other request goes between two of
        // them.
        ops.next_sample().await?;
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
    ops.next_sample().await?;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    Ok(started)
}

/// Samples until the axis is at its target; returns its position and when.
async fn sample_until_arrival(
    ops: &mut Ops,
    target: Quadcounts,
    plan: &MovePlan,
    started: Stamp<Host>,
) -> Result<(Quadcounts, Stamp<Host>), DriveError> {
    let limit = started
        .saturating_add(plan.duration)
        .saturating_add(ops.config.timing.arrival_margin);
    let tolerance = ops.config.arrival_tolerance.0.unsigned_abs();
    let mut check = PeriodicCheck::new(ops);
    let mut reached = false;
    // Set when the statusword was requested after the limit. Only a position requested after that
    // proves a failure, as a delayed host may have missed the arrival.
    let mut is_overdue = false;
    loop {
        let sample = ops.next_sample().await?;
        if reached && sample.position.0.abs_diff(target.0) <= tolerance {
            return Ok((sample.position, sample.answer));
        }
        if is_overdue && sample.request > limit {
            return Err(DriveError::NotArrived {
                target,
                position: sample.position,
                waited: ops.now().saturating_since(started),
                reached,
            });
        }
        is_overdue = ops.now() > limit;
        if is_overdue || check.is_due(ops.now()) {
            reached = check_enabled(ops).await? & status::TARGET_REACHED != 0;
        }
    }
}

/// Samples an enabled axis at standstill.
async fn sample_for(ops: &mut Ops, span: Span) -> Result<(), DriveError> {
    let until = ops.now().saturating_add(span);
    let mut check = PeriodicCheck::new(ops);
    while ops.now() < until {
        ops.next_sample().await?;
        if check.is_due(ops.now()) {
            check_enabled(ops).await?;
        }
    }
    Ok(())
}

/// Timer of the statusword checks.
struct PeriodicCheck {
    next: Stamp<Host>,
    period: Span,
}

impl PeriodicCheck {
    fn new(ops: &Ops) -> Self {
        let period = ops.config.timing.status_period;
        Self {
            next: ops.now().saturating_add(period),
            period,
        }
    }

    fn is_due(&mut self, now: Stamp<Host>) -> bool {
        let is_due = now >= self.next;
        if is_due {
            self.next = now.saturating_add(self.period);
        }
        is_due
    }
}
