//! Any message of the predefined connection set, for monitors of a bus and readers of logs.

use super::cob_id::{CobId, CommunicationObject, NodeId, PdoNumber};
use super::emcy::Emergency;
use super::error::MessageError;
pub(super) use super::error::{data as bytes, wrong_id};
use super::frame::CanFrame;
use super::heartbeat::Heartbeat;
use super::nmt::Nmt;
use super::sdo::{SdoRequest, SdoResponse};
use super::sync::SyncMessage;
use crate::BoundedVec;

/// A decoded frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusMessage {
    /// A command to nodes.
    Nmt(Nmt),
    /// Synchronisation.
    Sync(SyncMessage),
    /// An error of a node, or its end.
    Emergency(Emergency),
    /// Process data from a node, in the layout of its mapping ([`super::pdo::PdoLayout`]).
    TransmitPdo(PdoNumber, NodeId, BoundedVec<u8, 8>),
    /// Process data to a node.
    ReceivePdo(PdoNumber, NodeId, BoundedVec<u8, 8>),
    /// A request to a node's SDO server.
    SdoRequest(NodeId, SdoRequest),
    /// An answer of a node's SDO server.
    SdoResponse(NodeId, SdoResponse),
    /// A heartbeat of a node.
    Heartbeat(Heartbeat),
    /// A frame outside the services, a time stamp, or a remote frame: not decoded.
    Other(CanFrame),
}

impl BusMessage {
    /// The message in `frame`.
    ///
    /// # Errors
    /// [`MessageError`] where the identifier belongs to a service and the content is invalid.
    pub fn parse(frame: &CanFrame) -> Result<Self, MessageError> {
        let Some(id) = frame.cob_id().filter(|_| !frame.is_remote()) else {
            return Ok(Self::Other(*frame));
        };
        let data = frame.data().iter().copied().collect();
        Ok(match CommunicationObject::of(id) {
            CommunicationObject::Nmt => Self::Nmt(Nmt::parse(frame)?),
            CommunicationObject::Sync => Self::Sync(SyncMessage::parse(frame)?),
            CommunicationObject::Emergency(_) => Self::Emergency(Emergency::parse(frame)?),
            CommunicationObject::TransmitPdo(number, node) => Self::TransmitPdo(number, node, data),
            CommunicationObject::ReceivePdo(number, node) => Self::ReceivePdo(number, node, data),
            CommunicationObject::SdoRequest(_) => {
                let (node, request) = SdoRequest::parse(frame)?;
                Self::SdoRequest(node, request)
            }
            CommunicationObject::SdoResponse(_) => {
                let (node, answer) = SdoResponse::parse(frame)?;
                Self::SdoResponse(node, answer)
            }
            CommunicationObject::Heartbeat(_) => Self::Heartbeat(Heartbeat::parse(frame)?),
            CommunicationObject::Time | CommunicationObject::Other(_) => Self::Other(*frame),
        })
    }

    /// The message as a frame.
    #[must_use]
    pub fn to_frame(&self) -> CanFrame {
        match self {
            Self::Nmt(message) => message.to_frame(),
            Self::Sync(message) => message.to_frame(),
            Self::Emergency(message) => message.to_frame(),
            Self::TransmitPdo(number, node, data) => pdo(
                CommunicationObject::TransmitPdo(*number, *node).cob_id(),
                data,
            ),
            Self::ReceivePdo(number, node, data) => pdo(
                CommunicationObject::ReceivePdo(*number, *node).cob_id(),
                data,
            ),
            Self::SdoRequest(node, request) => request.to_frame(*node),
            Self::SdoResponse(node, answer) => answer.to_frame(*node),
            Self::Heartbeat(message) => message.to_frame(),
            Self::Other(frame) => *frame,
        }
    }
}

/// Process data as a frame.
pub(super) fn pdo(id: CobId, data: &BoundedVec<u8, 8>) -> CanFrame {
    // Both hold at most eight bytes, so the fallback is unreachable.
    CanFrame::new(id, data).unwrap_or_else(|_| CanFrame::of(id, []))
}
