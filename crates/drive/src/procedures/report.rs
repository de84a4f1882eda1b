//! Identity, error history and status of the drive. Nothing here changes anything.

use protocol::canopen::sdo::TransferError;
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::{self, error_history};
use protocol::epos2::{AbortCode, DeviceError};
use units::Quadcounts;

use crate::error::DriveError;
use crate::event::{CommandOutcome, DeviceName, DriveIdentity, DriveStatus};
use crate::ops::Ops;

use super::power::is_referenced;

/// Entries of the error history (1003).
const HISTORY_LEN: u8 = 5;
/// Lower half of the device type (1000): CiA profile 402.
const PROFILE_402: u32 = 0x0192;
/// Vendor id of maxon motor.
const MAXON: u32 = 0x0000_00FB;

/// Identifies the drive; fails unless it is a servo drive by maxon.
pub(super) async fn identify(ops: &Ops) -> Result<DriveIdentity, DriveError> {
    let wrong = |object: objects::TypedObject<u32>, expected, got| DriveError::WrongDevice {
        address: object.address,
        what: object.name,
        expected,
        got,
    };
    let is_bus = ops.on_can(|_, _| ()).is_some();
    let device_type = ops.read(objects::DEVICE_TYPE).await;
    let device_type = device_type.map_err(|error| match error {
        // A gateway waits for the node.
        DriveError::Refused { error, .. } if error == AbortCode::TIMEOUT => absent(ops),
        DriveError::LinkLost { .. } if is_bus => absent(ops),
        error => error,
    })?;
    if device_type & 0xFFFF != PROFILE_402 {
        let expected = device_type & !0xFFFF | PROFILE_402;
        return Err(wrong(objects::DEVICE_TYPE, expected, device_type));
    }
    let vendor = ops.read(objects::VENDOR_ID).await?;
    if vendor != MAXON {
        return Err(wrong(objects::VENDOR_ID, MAXON, vendor));
    }
    Ok(DriveIdentity {
        name: device_name(ops).await?,
        vendor,
        product: ops.read(objects::PRODUCT_CODE).await?,
        revision: ops.read(objects::REVISION).await?,
        serial: ops.read(objects::SERIAL_NUMBER).await?,
        software: ops.read(objects::SOFTWARE_VERSION).await?,
        hardware: ops.read(objects::HARDWARE_VERSION).await?,
    })
}

fn absent(ops: &Ops) -> DriveError {
    let node = ops.config.node;
    DriveError::NodeAbsent { node }
}

/// The device's name; empty if it cannot be read.
async fn device_name(ops: &Ops) -> Result<DeviceName, DriveError> {
    match ops.read_bytes(objects::DEVICE_NAME).await {
        Ok(bytes) => Ok(DeviceName::new(&bytes)),
        Err(DriveError::Refused { .. }) => Ok(DeviceName::default()),
        // An unusual name is no reason to fail, but lost bytes are.
        Err(DriveError::Transfer { error, .. })
            if !matches!(
                error,
                TransferError::Toggle { .. }
                    | TransferError::Size { .. }
                    | TransferError::EmptySegment
            ) =>
        {
            Ok(DeviceName::default())
        }
        Err(error) => Err(error),
    }
}

/// The error history, newest first.
pub(super) async fn history(ops: &Ops) -> Result<Vec<DeviceError>, DriveError> {
    let count = ops.read(objects::ERROR_COUNT).await?.min(HISTORY_LEN);
    let mut errors = Vec::new();
    for n in 1..=count {
        // The lower half is the error code, the upper is manufacturer-specific.
        let entry = ops.read(error_history(n)).await?;
        errors.push(DeviceError(entry as u16));
    }
    Ok(errors)
}

/// The newest entry of the error history.
pub(super) async fn newest_error(ops: &Ops) -> Result<Option<DeviceError>, DriveError> {
    Ok(history(ops).await?.first().copied())
}

/// Runs [`crate::DriveCommand::Status`].
pub(crate) async fn status(ops: Ops) -> Result<CommandOutcome, DriveError> {
    let identity = identify(&ops).await?;
    let statusword = ops.read(objects::STATUSWORD).await?;
    let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let referenced = is_referenced(statusword);
    Ok(CommandOutcome::Status(DriveStatus {
        identity,
        statusword,
        state: DeviceState::from_statusword(statusword),
        mode: ops.read(objects::MODE_DISPLAY).await?,
        referenced,
        position,
        angle: referenced.then(|| ops.config.gearing.angle(position)),
        velocity_rpm: ops.read(objects::VELOCITY_ACTUAL).await?,
        inputs: ops.read(objects::INPUT_STATE).await?,
        history: history(&ops).await?,
    }))
}
