//! Goto, sweep and hold: profile-position moves with the shaft sampled all along.
//!
//! The targets were checked against the limits before the procedure began. The drive makes the profile; the client asks for the position
//! as often as configured and now and then whether all is well.

use protocol::epos2::cia402::{control, mode, status};
use units::{Host, Quadcounts, Span, Stamp};

use crate::error::DriveError;
use crate::event::{Arrived, Outcome, Progress};
use crate::objects;
use crate::ops::Ops;
use crate::plan::{Aim, Plan};

use super::configure::verify_safety;
use super::network;
use super::power::{check_enabled, enable, is_referenced, set_mode, wait_for};
use super::stop::make_safe;

/// [`crate::Command::Goto`]
pub(crate) async fn goto(ops: Ops, aim: Aim) -> Result<Outcome, DriveError> {
    guarded(ops, aim, Span::ZERO).await
}

/// [`crate::Command::Sweep`]
pub(crate) async fn sweep(ops: Ops, aim: Aim) -> Result<Outcome, DriveError> {
    let hold = ops.config.timing.hold;
    guarded(ops, aim, hold).await
}

/// [`crate::Command::Hold`]
pub(crate) async fn hold(mut ops: Ops, until: Stamp<Host>) -> Result<Outcome, DriveError> {
    ops.watch(true);
    let mut watch = Watch::new(&ops);
    while ops.now() < until {
        let looked = match ops.sample().await {
            Ok(_) => watch.look_for_fault(&ops).await,
            Err(error) => Err(error),
        };
        if let Err(cause) = looked {
            return Err(make_safe(&mut ops, cause).await);
        }
    }
    Ok(Outcome::Held)
}

async fn guarded(mut ops: Ops, aim: Aim, hold: Span) -> Result<Outcome, DriveError> {
    ops.watch(true);
    match move_to(&mut ops, aim, hold).await {
        Ok(arrived) => Ok(Outcome::Arrived(arrived)),
        Err(cause) => Err(make_safe(&mut ops, cause).await),
    }
}

async fn move_to(ops: &mut Ops, aim: Aim, hold: Span) -> Result<Arrived, DriveError> {
    verify_safety(ops).await?;
    let got = ops.read(objects::STATUSWORD).await?;
    if !is_referenced(got) {
        return Err(DriveError::NotReferenced { got });
    }
    ops.set_referenced(true);
    set_mode(ops, mode::PROFILE_POSITION).await?;
    network::arm(ops).await?;
    enable(ops).await?;
    set_up(ops, aim).await?;
    sample_for(ops, hold).await?;
    let from = ops.sample().await?.position;
    let plan = ops
        .config
        .plan_move(from, aim.target, aim.speed, aim.acceleration)?;
    let started = start(ops, plan).await?;
    let (position, arrived) = follow(ops, aim.target, &plan, started).await?;
    ops.set_moving(false);
    sample_for(ops, hold).await?;
    network::disarm(ops).await?;
    Ok(Arrived {
        plan,
        position,
        angle: ops.config.gearing.angle(position),
        started,
        arrived,
    })
}

async fn set_up(ops: &Ops, aim: Aim) -> Result<(), DriveError> {
    ops.set(objects::PROFILE_VELOCITY, aim.speed.0).await?;
    ops.set(objects::PROFILE_ACCELERATION, aim.acceleration.0)
        .await?;
    ops.set(objects::PROFILE_DECELERATION, aim.acceleration.0)
        .await?;
    ops.set(objects::TARGET_POSITION, aim.target.0).await?;
    // The setpoint bit acts on its rising edge, and only once the last acknowledgement is gone.
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    wait_for(ops, "setpoint acknowledgement (bit 12) cleared", |word| {
        word & status::SETPOINT_ACKNOWLEDGE == 0
    })
    .await
    .map(drop)
}

/// Sets the axis moving; gives back when.
async fn start(ops: &mut Ops, plan: Plan) -> Result<Stamp<Host>, DriveError> {
    ops.set_moving(true);
    ops.write(objects::CONTROLWORD, control::START_ABSOLUTE)
        .await?;
    let started = ops.now();
    ops.tell(Progress::Moving(plan));
    let limit = started.saturating_add(ops.config.timing.state_limit);
    loop {
        // The ramp is on and its shape is told by samples alone: every other request is between two of them.
        ops.sample().await?;
        let asked = ops.now();
        let got = check_enabled(ops).await?;
        if got & status::SETPOINT_ACKNOWLEDGE != 0 {
            break;
        }
        if asked > limit {
            return Err(DriveError::State {
                expected: "setpoint acknowledged (bit 12)",
                got,
            });
        }
    }
    ops.sample().await?;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    Ok(started)
}

/// Samples until the axis is at its target.
async fn follow(
    ops: &mut Ops,
    target: Quadcounts,
    plan: &Plan,
    started: Stamp<Host>,
) -> Result<(Quadcounts, Stamp<Host>), DriveError> {
    let timing = ops.config.timing;
    let limit = started
        .saturating_add(plan.duration)
        .saturating_add(timing.arrival_margin);
    let tolerance = ops.config.arrival_tolerance.0.unsigned_abs();
    let mut watch = Watch::new(ops);
    let mut reached = false;
    // The statusword, and after it the position, were asked for after the limit: a host that was held up may have slept through
    // the arrival.
    let mut late = false;
    loop {
        let sample = ops.sample().await?;
        if reached && sample.position.0.abs_diff(target.0) <= tolerance {
            return Ok((sample.position, sample.answer));
        }
        if late && sample.request > limit {
            return Err(DriveError::NotArrived {
                target,
                position: sample.position,
                waited: ops.now().saturating_since(started),
                reached,
            });
        }
        late = ops.now() > limit;
        let word = if late {
            Some(check_enabled(ops).await?)
        } else {
            watch.look(ops).await?
        };
        if let Some(word) = word {
            reached = word & status::TARGET_REACHED != 0;
        }
    }
}

/// Samples at standstill.
async fn sample_for(ops: &mut Ops, span: Span) -> Result<(), DriveError> {
    let until = ops.now().saturating_add(span);
    let mut watch = Watch::new(ops);
    while ops.now() < until {
        ops.sample().await?;
        watch.look(ops).await?;
    }
    Ok(())
}

/// Looks at the statusword once a period.
struct Watch {
    next: Stamp<Host>,
    period: Span,
}

impl Watch {
    fn new(ops: &Ops) -> Self {
        let period = ops.config.timing.status_period;
        Self {
            next: ops.now().saturating_add(period),
            period,
        }
    }

    fn due(&mut self, now: Stamp<Host>) -> bool {
        let due = now >= self.next;
        if due {
            self.next = now.saturating_add(self.period);
        }
        due
    }

    /// The statusword of an axis that must be enabled, if a look is due.
    async fn look(&mut self, ops: &Ops) -> Result<Option<u16>, DriveError> {
        if self.due(ops.now()) {
            check_enabled(ops).await.map(Some)
        } else {
            Ok(None)
        }
    }

    /// The same for an axis that may be disabled.
    async fn look_for_fault(&mut self, ops: &Ops) -> Result<(), DriveError> {
        if !self.due(ops.now()) {
            return Ok(());
        }
        let word = ops.read(objects::STATUSWORD).await?;
        if super::power::is_fault(word) {
            return Err(DriveError::Fault { error: None });
        }
        Ok(())
    }
}
