//! SYNC (CiA 301, "Synchronisation object"): the beat on which nodes latch and send their process data.
//!
//! Who beats, and how evenly, is the caller's business.

use super::cob_id::CobId;
use super::error::{MessageError, MessageKind};
use super::frame::CanFrame;
use super::message::{bytes, wrong_id};

/// A beat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncMessage {
    /// CiA 301 4.2 lets the producer count beats, 1 to 240. The EPOS2 knows no counter (it has no object 1019): `None`.
    pub counter: Option<u8>,
}

impl SyncMessage {
    /// The beat as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        match self.counter {
            None => CanFrame::of(CobId::SYNC, []),
            Some(counter) => CanFrame::of(CobId::SYNC, [counter]),
        }
    }

    /// The beat in `frame`.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let layer = MessageKind::Sync;
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
