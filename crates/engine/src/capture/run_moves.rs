//! Runs the moves of a capture.

use drive::{DriveCommand, DriveEvent, MovePlan};
use io::port::Port;

use crate::capture::moves::Step;
use crate::devices::drive_session::{Session, SessionError};

/// The drive client's command for a planned move.
pub(super) fn command(plan: &MovePlan) -> drive::MoveCommand {
    drive::MoveCommand {
        to: plan.to,
        speed: plan.speed,
        acceleration: plan.acceleration,
    }
}

/// Progress of the moves.
#[derive(Clone, Copy, Debug)]
pub enum MoveProgress<'a> {
    /// A step begins; its number counts from 1.
    Step(usize, &'a Step),
    /// An event of the drive client.
    Event(&'a DriveEvent),
}

/// Connects, homes, runs every move, then disables the axis and sets its brake.
///
/// # Errors
/// [`SessionError`]. The axis has been stopped unless the error reports otherwise.
pub fn run<P: Port>(
    session: &mut Session<'_, P>,
    steps: &[Step],
    on_progress: &mut dyn FnMut(MoveProgress<'_>),
) -> Result<(), SessionError> {
    let mut execute = |command, on_progress: &mut dyn FnMut(MoveProgress<'_>)| {
        let on_event = &mut |event: &DriveEvent| on_progress(MoveProgress::Event(event));
        session.run(command, on_event)
    };
    execute(DriveCommand::Connect, on_progress)?;
    execute(DriveCommand::Home, on_progress)?;
    for (step, number) in steps.iter().zip(1..) {
        on_progress(MoveProgress::Step(number, step));
        let to = command(&step.plan);
        let command = if step.sweep {
            DriveCommand::Sweep(to)
        } else {
            DriveCommand::Goto(to)
        };
        execute(command, on_progress)?;
    }
    execute(DriveCommand::Brake, on_progress)?;
    Ok(())
}
