//! Read and write: any object of the drive, by hand.
//!
//! What the objects mean is the caller's business. So that nothing moves by it, writing asks for an axis without power, and
//! the controlword is left to the commands that watch over what comes of it.

use crate::command::ObjectBytes;
use crate::error::DriveError;
use crate::event::Outcome;
use crate::objects::{self, Address};
use crate::ops::Ops;

use super::power::is_off;

/// [`crate::Command::Read`]
pub(crate) async fn read(ops: Ops, address: Address) -> Result<Outcome, DriveError> {
    let bytes = ops.read_bytes(address).await?;
    Ok(Outcome::Read { address, bytes })
}

/// Whether an object may be written by hand.
///
/// # Errors
/// [`DriveError::Reserved`]
pub(crate) fn check_writable(address: Address) -> Result<(), DriveError> {
    if address.index == objects::CONTROLWORD.address.index {
        return Err(DriveError::Reserved { address });
    }
    Ok(())
}

/// [`crate::Command::Write`]
pub(crate) async fn write(
    ops: Ops,
    address: Address,
    bytes: ObjectBytes,
) -> Result<Outcome, DriveError> {
    let got = ops.read(objects::STATUSWORD).await?;
    if !is_off(got) {
        return Err(DriveError::State {
            expected: "power off",
            got,
        });
    }
    ops.write_bytes(address, &bytes).await?;
    Ok(Outcome::Written(address))
}
