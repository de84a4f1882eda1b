//! Emergency messages (CiA 301, "Emergency object"): a node tells of an error the moment it happens, and of its end.
//!
//! What a code means and how the drive reacts is [`DeviceError`]'s.

use super::cob_id::{Channel, NodeId};
use super::error::{Layer, MessageError};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};
use crate::epos2::DeviceError;

/// An error of a node, or its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emergency {
    /// Who tells.
    pub node: NodeId,
    /// What happened; [`DeviceError::NONE`]: all errors are gone.
    pub error: DeviceError,
    /// The error register (1001).
    pub register: u8,
    /// The manufacturer's; the EPOS2 leaves them zero.
    pub vendor: [u8; 5],
}

impl Emergency {
    /// The message of an EPOS2.
    #[must_use]
    pub const fn new(node: NodeId, error: DeviceError, register: u8) -> Self {
        Self {
            node,
            error,
            register,
            vendor: [0; 5],
        }
    }

    /// The message as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        let [low, high] = self.error.0.to_le_bytes();
        let [a, b, c, d, e] = self.vendor;
        CanFrame::of(
            Channel::Emergency(self.node).cob_id(),
            [low, high, self.register, a, b, c, d, e],
        )
    }

    /// The message in `frame`.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = Layer::Emergency;
        let Some(Channel::Emergency(node)) = frame.cob_id().map(Channel::of) else {
            return Err(wrong_id(layer, "081 to 0FF", frame));
        };
        let [low, high, register, vendor @ ..] = *bytes::<8>(layer, frame)?;
        Ok(Self {
            node,
            error: DeviceError(u16::from_le_bytes([low, high])),
            register,
            vendor,
        })
    }

    /// Whether it says that all errors are gone.
    #[must_use]
    pub const fn is_reset(&self) -> bool {
        self.error.0 == DeviceError::NONE.0
    }
}
