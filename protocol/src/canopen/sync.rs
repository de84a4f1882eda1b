//! SYNC (CiA 301, "Synchronisation object"): nodes sample and send their process data on it.

use super::cob_id::CobId;
use super::error::{CanopenLayer, MessageError};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};

/// A SYNC message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncMessage {
    /// Counter of the producer, 1 to 240 (CiA 301 4.2). `None` without object 1019, as in the
    /// EPOS2.
    pub counter: Option<u8>,
}

impl SyncMessage {
    /// The message as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        match self.counter {
            None => CanFrame::of(CobId::SYNC, []),
            Some(counter) => CanFrame::of(CobId::SYNC, [counter]),
        }
    }

    /// The message in `frame`.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = CanopenLayer::Sync;
        if frame.cob_id() != Some(CobId::SYNC) {
            return Err(wrong_id(layer, "080", frame));
        }
        let counter = if frame.dlc() == 1 {
            let [counter] = *bytes::<1>(layer, frame)?;
            Some(counter)
        } else {
            bytes::<0>(layer, frame)?;
            None
        };
        Ok(Self { counter })
    }
}
