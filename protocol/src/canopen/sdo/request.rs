//! Requests from an SDO client to a node's server. CiA 301's "download" writes, "upload" reads.

use super::data::{GenericSdoSegment, Initiate, SEGMENT_LEN, TOGGLE, toggle_bit};
use super::{ABORT, LEN, address, command, message};
use crate::canopen::AbortCode;
use crate::canopen::Address;

/// Client command specifiers.
const DOWNLOAD_SEGMENT: u8 = 0;
const INITIATE_DOWNLOAD: u8 = 1;
const INITIATE_UPLOAD: u8 = 2;
const UPLOAD_SEGMENT: u8 = 3;

/// A message from client to server on CAN.
pub type SdoRequest = GenericSdoRequest<SEGMENT_LEN>;

/// A message from client to server, with segments of up to `L` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GenericSdoRequest<const L: usize> {
    /// Starts writing an object.
    InitiateDownload {
        /// The object.
        address: Address,
        /// Its data or size.
        transfer: Initiate,
    },
    /// Writes the next segment.
    DownloadSegment(GenericSdoSegment<L>),
    /// Starts reading an object.
    InitiateUpload {
        /// The object.
        address: Address,
    },
    /// Reads the next segment.
    UploadSegment {
        /// Alternates from segment to segment, beginning with `false`.
        toggle: bool,
    },
    /// Aborts the transfer.
    Abort {
        /// The object of the transfer.
        address: Address,
        /// The abort code.
        error: AbortCode,
    },
    /// Another command specifier (5 and 6: block transfer).
    Unknown([u8; LEN]),
}

impl<const L: usize> GenericSdoRequest<L> {
    /// The object named by the request; segments name none.
    #[must_use]
    pub const fn address(&self) -> Option<Address> {
        match self {
            Self::InitiateDownload { address, .. }
            | Self::InitiateUpload { address }
            | Self::Abort { address, .. } => Some(*address),
            Self::DownloadSegment(_) | Self::UploadSegment { .. } | Self::Unknown(_) => None,
        }
    }

    /// The data of the frame. A segment is cut to the seven bytes that fit.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; LEN] {
        match *self {
            Self::InitiateDownload { address, transfer } => {
                let (bits, data) = transfer.encode();
                message(command(INITIATE_DOWNLOAD) | bits, address, data)
            }
            Self::DownloadSegment(segment) => segment.to_bytes(),
            Self::InitiateUpload { address } => message(command(INITIATE_UPLOAD), address, [0; 4]),
            Self::UploadSegment { toggle } => {
                let command = command(UPLOAD_SEGMENT) | toggle_bit(toggle);
                [command, 0, 0, 0, 0, 0, 0, 0]
            }
            Self::Abort { address, error } => {
                message(command(ABORT), address, error.0.to_le_bytes())
            }
            Self::Unknown(bytes) => bytes,
        }
    }

    /// The message in a frame's data. Unused bits and bytes are ignored.
    #[must_use]
    pub fn from_bytes(bytes: [u8; LEN]) -> Self {
        let [command, data @ ..] = bytes;
        let [low, high, sub, rest @ ..] = data;
        let address = address(low, high, sub);
        match command >> 5 {
            DOWNLOAD_SEGMENT => Self::DownloadSegment(GenericSdoSegment::parse(command, data)),
            INITIATE_DOWNLOAD => Self::InitiateDownload {
                address,
                transfer: Initiate::parse(command, rest),
            },
            INITIATE_UPLOAD => Self::InitiateUpload { address },
            UPLOAD_SEGMENT => Self::UploadSegment {
                toggle: command & TOGGLE != 0,
            },
            ABORT => Self::Abort {
                address,
                error: AbortCode(u32::from_le_bytes(rest)),
            },
            _ => Self::Unknown(bytes),
        }
    }
}
