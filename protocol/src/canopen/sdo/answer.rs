//! What a node's SDO server answers.

use super::transfer::{Initiate, Segment, TOGGLE, toggle_bit};
use super::{ABORT, LEN, address, command, message};
use crate::canopen::cob_id::{CommunicationObject, NodeId};
use crate::canopen::error::{MessageError, MessageKind};
use crate::canopen::frame::CanFrame;
use crate::canopen::message::{bytes, wrong_id};
use crate::epos2::CommError;
use crate::epos2::objects::Address;

/// Command specifiers of a server.
const UPLOAD_SEGMENT: u8 = 0;
const DOWNLOAD_SEGMENT: u8 = 1;
const INITIATE_UPLOAD: u8 = 2;
const INITIATE_DOWNLOAD: u8 = 3;

/// A message from server to client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The next segment.
    UploadSegment(Segment),
    /// The segment was taken.
    DownloadSegment {
        /// As in the request.
        toggle: bool,
    },
    /// The object is read.
    InitiateUpload {
        /// The object.
        address: Address,
        /// Its data, or the size of it.
        transfer: Initiate,
    },
    /// The object is written, or its segments may come.
    InitiateDownload {
        /// The object.
        address: Address,
    },
    /// The server refuses or breaks off.
    Abort {
        /// The object of the transfer.
        address: Address,
        /// Why.
        error: CommError,
    },
    /// A command specifier that this protocol does not look into (5 and 6: block transfer).
    Unknown([u8; LEN]),
}

impl Answer {
    /// The data of the frame.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; LEN] {
        match *self {
            Self::UploadSegment(segment) => segment.to_bytes(),
            Self::DownloadSegment { toggle } => {
                let command = command(DOWNLOAD_SEGMENT) | toggle_bit(toggle);
                [command, 0, 0, 0, 0, 0, 0, 0]
            }
            Self::InitiateUpload { address, transfer } => {
                let (bits, data) = transfer.encode();
                message(command(INITIATE_UPLOAD) | bits, address, data)
            }
            Self::InitiateDownload { address } => {
                message(command(INITIATE_DOWNLOAD), address, [0; 4])
            }
            Self::Abort { address, error } => {
                message(command(ABORT), address, error.0.to_le_bytes())
            }
            Self::Unknown(bytes) => bytes,
        }
    }

    /// The message of a frame's data; bits and bytes that it does not use do not count.
    #[must_use]
    pub fn from_bytes(bytes: [u8; LEN]) -> Self {
        let [command, data @ ..] = bytes;
        let [low, high, sub, rest @ ..] = data;
        let address = address(low, high, sub);
        match command >> 5 {
            UPLOAD_SEGMENT => Self::UploadSegment(Segment::parse(command, data)),
            DOWNLOAD_SEGMENT => Self::DownloadSegment {
                toggle: command & TOGGLE != 0,
            },
            INITIATE_UPLOAD => Self::InitiateUpload {
                address,
                transfer: Initiate::parse(command, rest),
            },
            INITIATE_DOWNLOAD => Self::InitiateDownload { address },
            ABORT => Self::Abort {
                address,
                error: CommError(u32::from_le_bytes(rest)),
            },
            _ => Self::Unknown(bytes),
        }
    }

    /// The answer of `node` as a frame.
    #[must_use]
    pub fn to_frame(&self, node: NodeId) -> CanFrame {
        CanFrame::of(
            CommunicationObject::SdoAnswer(node).cob_id(),
            self.to_bytes(),
        )
    }

    /// The node that answers, and the answer in `frame`.
    ///
    /// # Errors
    /// [`MessageError`]; an SDO message has eight bytes whatever it uses of them.
    pub fn parse(frame: &CanFrame) -> Result<(NodeId, Self), MessageError> {
        let layer = MessageKind::SdoAnswer;
        let Some(CommunicationObject::SdoAnswer(node)) =
            frame.cob_id().map(CommunicationObject::of)
        else {
            return Err(wrong_id(layer, "581 to 5FF", frame));
        };
        Ok((node, Self::from_bytes(*bytes(layer, frame)?)))
    }

    /// The object that the answer names; segments name none.
    #[must_use]
    pub const fn address(&self) -> Option<Address> {
        match self {
            Self::InitiateUpload { address, .. }
            | Self::InitiateDownload { address }
            | Self::Abort { address, .. } => Some(*address),
            Self::UploadSegment(_) | Self::DownloadSegment { .. } | Self::Unknown(_) => None,
        }
    }
}
