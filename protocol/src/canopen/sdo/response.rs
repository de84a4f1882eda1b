//! Responses of a node's SDO server.

use super::data::{GenericSdoSegment, Initiate, SEGMENT_LEN, TOGGLE, toggle_bit};
use super::{ABORT, GenericSdoRequest, LEN, address, command, message};
use crate::canopen::AbortCode;
use crate::canopen::Address;

/// Server command specifiers.
const UPLOAD_SEGMENT: u8 = 0;
const DOWNLOAD_SEGMENT: u8 = 1;
const INITIATE_UPLOAD: u8 = 2;
const INITIATE_DOWNLOAD: u8 = 3;

/// A message from server to client on CAN.
pub type SdoResponse = GenericSdoResponse<SEGMENT_LEN>;

/// A message from server to client, with segments of up to `L` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GenericSdoResponse<const L: usize> {
    /// The next segment.
    UploadSegment(GenericSdoSegment<L>),
    /// Confirms a segment that was written.
    DownloadSegment {
        /// Toggle bit of the request.
        toggle: bool,
    },
    /// Starts or completes a read.
    InitiateUpload {
        /// The object.
        address: Address,
        /// Its data or size.
        transfer: Initiate,
    },
    /// Confirms an expedited write, or the start of a segmented one.
    InitiateDownload {
        /// The object.
        address: Address,
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

impl<const L: usize> GenericSdoResponse<L> {
    /// The data of the frame. A segment is cut to the seven bytes that fit.
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

    /// The message in a frame's data. Unused bits and bytes are ignored.
    #[must_use]
    pub fn from_bytes(bytes: [u8; LEN]) -> Self {
        let [command, data @ ..] = bytes;
        let [low, high, sub, rest @ ..] = data;
        let address = address(low, high, sub);
        match command >> 5 {
            UPLOAD_SEGMENT => Self::UploadSegment(GenericSdoSegment::parse(command, data)),
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
                error: AbortCode(u32::from_le_bytes(rest)),
            },
            _ => Self::Unknown(bytes),
        }
    }

    /// The object named by the response; segments name none.
    #[must_use]
    pub const fn address(&self) -> Option<Address> {
        match self {
            Self::InitiateUpload { address, .. }
            | Self::InitiateDownload { address }
            | Self::Abort { address, .. } => Some(*address),
            Self::UploadSegment(_) | Self::DownloadSegment { .. } | Self::Unknown(_) => None,
        }
    }

    /// Whether this can be the response to `request`: same service, same object where both name
    /// one.
    #[must_use]
    pub fn answers(&self, request: &GenericSdoRequest<L>) -> bool {
        let same_object = match (self.address(), request.address()) {
            (Some(got), Some(expected)) => got == expected,
            _ => true,
        };
        same_object
            && matches!(
                (self, request),
                (
                    Self::UploadSegment(_),
                    GenericSdoRequest::UploadSegment { .. }
                ) | (
                    Self::DownloadSegment { .. },
                    GenericSdoRequest::DownloadSegment(_)
                ) | (
                    Self::InitiateUpload { .. },
                    GenericSdoRequest::InitiateUpload { .. }
                ) | (
                    Self::InitiateDownload { .. },
                    GenericSdoRequest::InitiateDownload { .. }
                ) | (Self::Abort { .. }, _)
            )
    }
}
