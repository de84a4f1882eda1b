//! The device control state machine (CiA 402): wait for a state, clear a fault, enable, change the
//! mode.

use protocol::epos2::cia402::{DeviceState, control, status};
use protocol::epos2::objects;
use units::Span;

use crate::error::DriveError;
use crate::event::{CommandOutcome, CommandProgress};
use crate::ops::Ops;

use super::report::{history, newest_error};

/// Interval of checks of a value that changes within milliseconds.
const CHECK_INTERVAL: Span = Span::from_millis(1);
/// Fault resets tried: each clears one cause, and a drive may report several.
const MAX_RESETS: u32 = 3;
/// Time until a fault reset shows in the statusword: some control cycles of 1 ms.
const RESET_TIME: Span = Span::from_millis(20);

/// Whether the drive is in fault or in its fault reaction.
pub(super) fn is_fault(statusword: u16) -> bool {
    matches!(
        DeviceState::from_statusword(statusword),
        Some(
            DeviceState::Fault
                | DeviceState::FaultReactionDisabled
                | DeviceState::FaultReactionEnabled
        )
    )
}

/// Whether the power stage is off.
pub(super) fn is_off(statusword: u16) -> bool {
    matches!(
        DeviceState::from_statusword(statusword),
        Some(DeviceState::SwitchOnDisabled | DeviceState::ReadyToSwitchOn | DeviceState::Fault)
    )
}

/// Whether the power stage is on and the drive holds its position.
fn is_holding(statusword: u16) -> bool {
    matches!(
        DeviceState::from_statusword(statusword),
        Some(DeviceState::OperationEnabled | DeviceState::QuickStopActive)
    )
}

/// Whether an axis in this state stays powered at rest: it is configured so, and it is powered.
pub(super) fn is_held(ops: &Ops, statusword: u16) -> bool {
    ops.config.holds() && is_holding(statusword)
}

/// Whether the axis is referenced.
pub(super) fn is_referenced(statusword: u16) -> bool {
    statusword & status::REFERENCED != 0
}

/// Reads the statusword until `is_wanted`; `expected` describes it for the error message.
///
/// # Errors
/// [`DriveError::State`] for a statusword requested after the state limit.
pub(super) async fn wait_for(
    ops: &Ops,
    expected: &'static str,
    is_wanted: impl Fn(u16) -> bool,
) -> Result<u16, DriveError> {
    let limit = ops.now().saturating_add(ops.config.timing.state_limit);
    loop {
        let requested = ops.now();
        let got = ops.read(objects::STATUSWORD).await?;
        if is_wanted(got) {
            return Ok(got);
        }
        if requested > limit {
            return Err(DriveError::State { expected, got });
        }
        ops.sleep(CHECK_INTERVAL).await;
    }
}

/// Like [`wait_for`]; also fails on a fault.
async fn wait_for_state(
    ops: &Ops,
    expected: &'static str,
    state: DeviceState,
) -> Result<(), DriveError> {
    let is = |word| DeviceState::from_statusword(word) == Some(state);
    let got = wait_for(ops, expected, |word| is(word) || is_fault(word)).await?;
    if is(got) {
        return Ok(());
    }
    Err(DriveError::Fault {
        error: newest_error(ops).await?,
    })
}

/// Clears any fault; the axis stays disabled.
pub(super) async fn clear_fault(ops: &Ops) -> Result<(), DriveError> {
    let is_settled =
        |word| !is_fault(word) || DeviceState::from_statusword(word) == Some(DeviceState::Fault);
    let mut got = wait_for(ops, "the end of the fault reaction", is_settled).await?;
    if !is_fault(got) {
        return Ok(());
    }
    let error = newest_error(ops).await?;
    for _ in 0..MAX_RESETS {
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
    ops.report(CommandProgress::FaultCleared { error });
    Ok(())
}

/// Runs [`crate::DriveCommand::ClearFaults`].
pub(crate) async fn clear_faults(ops: Ops) -> Result<CommandOutcome, DriveError> {
    let found = history(&ops).await?;
    clear_fault(&ops).await?;
    Ok(CommandOutcome::FaultsCleared(found))
}

/// Enables the power stage and opens the brake.
pub(super) async fn enable(ops: &Ops) -> Result<(), DriveError> {
    let got = ops.read(objects::STATUSWORD).await?;
    match DeviceState::from_statusword(got) {
        Some(DeviceState::OperationEnabled) => return Ok(()),
        Some(DeviceState::SwitchOnDisabled | DeviceState::ReadyToSwitchOn) => {}
        // Held after a stop: its head must not fall.
        Some(DeviceState::QuickStopActive) if ops.config.holds() => {
            ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
                .await?;
            return wait_for_state(ops, "operation enabled", DeviceState::OperationEnabled).await;
        }
        // Any other state is left through "switch-on disabled".
        _ => {
            ops.write(objects::CONTROLWORD, control::DISABLE_VOLTAGE)
                .await?;
            wait_for_state(ops, "switch-on disabled", DeviceState::SwitchOnDisabled).await?;
        }
    }
    ops.write(objects::CONTROLWORD, control::SHUTDOWN).await?;
    wait_for_state(ops, "ready to switch on", DeviceState::ReadyToSwitchOn).await?;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    wait_for_state(ops, "operation enabled", DeviceState::OperationEnabled).await?;
    ops.report(CommandProgress::Enabled);
    Ok(())
}

/// Reads the statusword of an axis that must be enabled. The error history is read after the axis
/// has been stopped.
///
/// # Errors
/// [`DriveError::Fault`] without its cause, or [`DriveError::State`].
pub(super) async fn check_enabled(ops: &Ops) -> Result<u16, DriveError> {
    check_state(ops, DeviceState::OperationEnabled).await
}

/// Reads the statusword of an axis that must be in a state.
///
/// # Errors
/// [`DriveError::Fault`] without its cause, or [`DriveError::State`].
pub(super) async fn check_state(ops: &Ops, state: DeviceState) -> Result<u16, DriveError> {
    let is_so = |got| DeviceState::from_statusword(got) == Some(state);
    let mut got = ops.read(objects::STATUSWORD).await?;
    if !is_so(got) {
        // A single reply may be that to an earlier request.
        got = ops.read(objects::STATUSWORD).await?;
    }
    if is_fault(got) {
        return Err(DriveError::Fault { error: None });
    }
    if !is_so(got) {
        return Err(DriveError::State {
            expected: state.name(),
            got,
        });
    }
    Ok(got)
}

/// Changes the mode of operation and waits until the drive displays it.
pub(super) async fn set_mode(ops: &Ops, mode: i8) -> Result<(), DriveError> {
    ops.write(objects::MODE, mode).await?;
    let limit = ops.now().saturating_add(ops.config.timing.state_limit);
    loop {
        let requested = ops.now();
        match ops.verify(objects::MODE_DISPLAY, mode).await {
            Err(DriveError::NotTaken { .. }) if requested <= limit => {
                ops.sleep(CHECK_INTERVAL).await;
            }
            result => return result,
        }
    }
}
