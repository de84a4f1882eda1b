//! What the drive says about itself: identity, error history, status. Nothing here changes anything.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::State;
use units::Quadcounts;

use crate::error::DriveError;
use crate::event::{DeviceName, Identity, Outcome, Status};
use crate::objects::{self, error_history};
use crate::ops::Ops;

use super::power::is_referenced;

/// Entries of the error history (1003).
const HISTORY: u8 = 5;
/// Lower half of the device type: CiA profile 402.
const PROFILE_402: u32 = 0x0192;
/// maxon motor's vendor id.
const MAXON: u32 = 0x0000_00FB;

/// Who is there; anything but a drive by maxon is refused.
pub(super) async fn identify(ops: &Ops) -> Result<Identity, DriveError> {
    let wrong = |object: objects::Object<u32>, expected, got| DriveError::WrongDevice {
        address: object.address,
        what: object.name,
        expected,
        got,
    };
    let device_type = ops.read(objects::DEVICE_TYPE).await?;
    if device_type & 0xFFFF != PROFILE_402 {
        let expected = device_type & !0xFFFF | PROFILE_402;
        return Err(wrong(objects::DEVICE_TYPE, expected, device_type));
    }
    let vendor = ops.read(objects::VENDOR_ID).await?;
    if vendor != MAXON {
        return Err(wrong(objects::VENDOR_ID, MAXON, vendor));
    }
    Ok(Identity {
        name: name(ops).await?,
        vendor,
        product: ops.read(objects::PRODUCT_CODE).await?,
        revision: ops.read(objects::REVISION).await?,
        serial: ops.read(objects::SERIAL_NUMBER).await?,
        software: ops.read(objects::SOFTWARE_VERSION).await?,
        hardware: ops.read(objects::HARDWARE_VERSION).await?,
    })
}

/// The device's name; empty where it keeps it for itself.
async fn name(ops: &Ops) -> Result<DeviceName, DriveError> {
    match ops.read_bytes(objects::DEVICE_NAME).await {
        Ok(bytes) => Ok(DeviceName::new(&bytes)),
        Err(DriveError::Refused { .. } | DriveError::TooLong { .. }) => Ok(DeviceName::default()),
        Err(error) => Err(error),
    }
}

/// The error history, newest first.
pub(super) async fn history(ops: &Ops) -> Result<Vec<DeviceError>, DriveError> {
    let count = ops.read(objects::ERROR_COUNT).await?.min(HISTORY);
    let mut errors = Vec::new();
    for n in 1..=count {
        // The code is the lower half; the upper is additional information of the manufacturer.
        let entry = ops.read(error_history(n)).await?;
        errors.push(DeviceError(entry as u16));
    }
    Ok(errors)
}

/// [`crate::Command::Status`]
pub(crate) async fn status(ops: Ops) -> Result<Outcome, DriveError> {
    let identity = identify(&ops).await?;
    let statusword = ops.read(objects::STATUSWORD).await?;
    let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let referenced = is_referenced(statusword);
    Ok(Outcome::Status(Status {
        identity,
        statusword,
        state: State::from_statusword(statusword),
        mode: ops.read(objects::MODE_DISPLAY).await?,
        referenced,
        position,
        angle: referenced.then(|| ops.config.gearing.angle(position)),
        velocity_rpm: ops.read(objects::VELOCITY_ACTUAL).await?,
        inputs: ops.read(objects::INPUT_STATE).await?,
        history: history(&ops).await?,
    }))
}
