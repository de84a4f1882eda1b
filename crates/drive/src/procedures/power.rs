//! The device control state machine as the client walks it: wait for a state, clear a fault, enable, change mode.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{State, control, status};
use units::Span;

use crate::error::DriveError;
use crate::event::{Outcome, Progress};
use crate::objects;
use crate::ops::Ops;

use super::report::history;

/// Pause between two looks at something that changes within milliseconds.
const LOOK: Span = Span::from_millis(1);
/// Fault resets tried: one clears one cause, and a drive may report several.
const RESETS: u32 = 3;

/// Whether the drive is in fault or on the way there.
pub(super) fn is_fault(statusword: u16) -> bool {
    matches!(
        State::from_statusword(statusword),
        Some(State::Fault | State::FaultReactionDisabled | State::FaultReactionEnabled)
    )
}

/// Whether the power stage is off.
pub(super) fn is_off(statusword: u16) -> bool {
    matches!(
        State::from_statusword(statusword),
        Some(State::SwitchOnDisabled | State::ReadyToSwitchOn | State::Fault)
    )
}

/// The newest fault as an error.
pub(super) async fn fault(ops: &Ops) -> DriveError {
    match history(ops).await {
        Ok(history) => DriveError::Fault {
            error: history.first().copied(),
        },
        Err(error) => error,
    }
}

/// Reads the statusword until it is as wanted. With `expected` for the error message.
///
/// # Errors
/// [`DriveError::State`] for a statusword that was asked for after the state limit.
pub(super) async fn wait_for(
    ops: &Ops,
    expected: &'static str,
    wanted: impl Fn(u16) -> bool,
) -> Result<u16, DriveError> {
    let limit = ops.now().saturating_add(ops.config.timing.state_limit);
    loop {
        let asked = ops.now();
        let got = ops.read(objects::STATUSWORD).await?;
        if wanted(got) {
            return Ok(got);
        }
        if asked > limit {
            return Err(DriveError::State { expected, got });
        }
        ops.sleep(LOOK).await;
    }
}

/// As [`wait_for`], but a fault ends the wait.
async fn wait_for_state(ops: &Ops, expected: &'static str, state: State) -> Result<(), DriveError> {
    let is = |word| State::from_statusword(word) == Some(state);
    let got = wait_for(ops, expected, |word| is(word) || is_fault(word)).await?;
    if is(got) {
        Ok(())
    } else {
        Err(fault(ops).await)
    }
}

/// Clears whatever fault there is; the axis stays disabled. Gives back what the newest fault was.
pub(super) async fn clear_fault(ops: &Ops) -> Result<(), DriveError> {
    let settled = |word| !is_fault(word) || State::from_statusword(word) == Some(State::Fault);
    let mut got = wait_for(ops, "the end of the fault reaction", settled).await?;
    if !is_fault(got) {
        return Ok(());
    }
    let error = history(ops).await?.first().copied();
    for _ in 0..RESETS {
        // The reset bit acts on its rising edge.
        ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
            .await?;
        ops.write(objects::CONTROLWORD, control::FAULT_RESET)
            .await?;
        ops.sleep(RESET_TIME).await;
        got = ops.read(objects::STATUSWORD).await?;
        if !is_fault(got) {
            break;
        }
    }
    ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
        .await?;
    if is_fault(got) {
        return Err(DriveError::FaultStays { error });
    }
    ops.tell(Progress::FaultCleared { error });
    Ok(())
}

/// A fault reset shows within some control cycles.
const RESET_TIME: Span = Span::from_millis(20);

/// [`crate::Command::ClearFaults`]
pub(crate) async fn clear_faults(ops: Ops) -> Result<Outcome, DriveError> {
    let found: Vec<DeviceError> = history(&ops).await?;
    clear_fault(&ops).await?;
    Ok(Outcome::FaultsCleared(found))
}

/// Power on, brake open, holding.
pub(super) async fn enable(ops: &Ops) -> Result<(), DriveError> {
    let got = ops.read(objects::STATUSWORD).await?;
    match State::from_statusword(got) {
        Some(State::OperationEnabled) => return Ok(()),
        Some(State::SwitchOnDisabled | State::ReadyToSwitchOn) => {}
        // From anywhere else the way leads through "disabled".
        _ => {
            ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
                .await?;
            wait_for_state(ops, "switch-on disabled", State::SwitchOnDisabled).await?;
        }
    }
    ops.write(objects::CONTROLWORD, control::SHUTDOWN).await?;
    wait_for_state(ops, "ready to switch on", State::ReadyToSwitchOn).await?;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    wait_for_state(ops, "operation enabled", State::OperationEnabled).await?;
    ops.tell(Progress::Enabled);
    Ok(())
}

/// Reads the statusword of an axis that must be enabled. Which fault it is is asked once the axis has been made safe.
///
/// # Errors
/// [`DriveError::Fault`], or [`DriveError::State`] for any other state.
pub(super) async fn check_enabled(ops: &Ops) -> Result<u16, DriveError> {
    let got = ops.read(objects::STATUSWORD).await?;
    if is_fault(got) {
        return Err(DriveError::Fault { error: None });
    }
    if State::from_statusword(got) != Some(State::OperationEnabled) {
        return Err(DriveError::State {
            expected: "operation enabled",
            got,
        });
    }
    Ok(got)
}

/// Changes the mode of operation and waits until it is in effect.
pub(super) async fn set_mode(ops: &Ops, mode: i8) -> Result<(), DriveError> {
    ops.write(objects::MODE, mode).await?;
    let limit = ops.now().saturating_add(ops.config.timing.state_limit);
    loop {
        let asked = ops.now();
        match ops.expect(objects::MODE_DISPLAY, mode).await {
            Err(DriveError::NotTaken { .. }) if asked <= limit => ops.sleep(LOOK).await,
            result => return result,
        }
    }
}

/// Whether the statusword says that the axis knows where it is.
pub(super) fn is_referenced(statusword: u16) -> bool {
    statusword & status::REFERENCED != 0
}
