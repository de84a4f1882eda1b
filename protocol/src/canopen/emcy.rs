//! Emergency messages (CiA 301, "Emergency object"): a node reports an error when it occurs, and
//! its end. The meaning of most codes depends on the device.

use super::cob_id::{CommunicationObject, NodeId};
use super::error::{CanopenLayer, MessageError};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};

/// An error of a node, or its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emergency {
    /// The reporting node.
    pub node: NodeId,
    /// Error code; 0: all errors are gone.
    pub code: u16,
    /// The error register (1001).
    pub register: u8,
    /// Manufacturer-specific bytes.
    pub vendor: [u8; 5],
}

impl Emergency {
    /// A message without manufacturer-specific bytes.
    #[must_use]
    pub const fn new(node: NodeId, code: u16, register: u8) -> Self {
        Self {
            node,
            code,
            register,
            vendor: [0; 5],
        }
    }

    /// The message as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        let [low, high] = self.code.to_le_bytes();
        let [a, b, c, d, e] = self.vendor;
        CanFrame::of(
            CommunicationObject::Emergency(self.node).cob_id(),
            [low, high, self.register, a, b, c, d, e],
        )
    }

    /// The message in `frame`.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = CanopenLayer::Emergency;
        let Some(CommunicationObject::Emergency(node)) =
            frame.cob_id().map(CommunicationObject::of)
        else {
            return Err(wrong_id(layer, "081 to 0FF", frame));
        };
        let [low, high, register, vendor @ ..] = *bytes::<8>(layer, frame)?;
        Ok(Self {
            node,
            code: u16::from_le_bytes([low, high]),
            register,
            vendor,
        })
    }

    /// Whether all errors are gone.
    #[must_use]
    pub const fn is_reset(&self) -> bool {
        self.code == 0
    }
}
