//! Direct access to any object of the drive.
//!
//! So that a write causes no motion, it requires a disabled axis, and the controlword is reserved
//! for the motion commands.

use protocol::epos2::objects::{self, Address};

use crate::command::ObjectBytes;
use crate::error::DriveError;
use crate::event::CommandOutcome;
use crate::ops::Ops;

use super::power::is_off;

/// Runs [`crate::DriveCommand::Read`].
pub(crate) async fn read(ops: Ops, address: Address) -> Result<CommandOutcome, DriveError> {
    let bytes = ops.read_bytes(address).await?;
    Ok(CommandOutcome::Read { address, bytes })
}

/// Rejects objects that must not be written directly.
///
/// # Errors
/// [`DriveError::Reserved`].
pub(crate) fn check_writable(address: Address) -> Result<(), DriveError> {
    if address.index == objects::CONTROLWORD.address.index {
        return Err(DriveError::Reserved { address });
    }
    Ok(())
}

/// Runs [`crate::DriveCommand::Write`].
pub(crate) async fn write(
    ops: Ops,
    address: Address,
    bytes: ObjectBytes,
) -> Result<CommandOutcome, DriveError> {
    let got = ops.read(objects::STATUSWORD).await?;
    if !is_off(got) {
        return Err(DriveError::State {
            expected: "power off",
            got,
        });
    }
    ops.write_bytes(address, &bytes).await?;
    Ok(CommandOutcome::Written(address))
}
