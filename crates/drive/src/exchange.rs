//! One exchange with the drive on any link: access to an object, and the reply.
//!
//! On CAN an exchange is an SDO request with its response. The serial links have commands of their
//! own for the same services; their replies name neither the object nor the service.

use protocol::canopen::sdo::{
    Expedited, GenericSdoRequest, GenericSdoResponse, GenericSdoSegment, Initiate,
};
use protocol::epos2::message::{SegmentedRead, SerialAnswer};
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, SerialFrame, SerialFrameError};

/// Bytes of the longest segment: those of the serial links (a length of six bits).
pub(crate) const MAX_SEGMENT: usize = 63;

pub(crate) type TransferRequest = GenericSdoRequest<MAX_SEGMENT>;
pub(crate) type TransferResponse = GenericSdoResponse<MAX_SEGMENT>;
pub(crate) type TransferSegment = GenericSdoSegment<MAX_SEGMENT>;

/// Access to an object in one exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ObjectAccess {
    /// Reads up to four bytes (ReadObject).
    Read,
    /// Writes `width` bytes, one to four (WriteObject).
    Write { value: u32, width: u8 },
    /// One step of a transfer of any length.
    Transfer(TransferRequest),
    /// Any other command; only the listener sees them.
    Other,
}

impl ObjectAccess {
    /// The access made by an SDO request; `None` for an abort, which has no response.
    pub fn of_sdo(request: TransferRequest) -> Option<Self> {
        match request {
            TransferRequest::InitiateDownload {
                transfer: Initiate::Expedited(data),
                ..
            } => Some(Self::Write {
                value: data.to_u32(),
                width: data.as_slice().len() as u8,
            }),
            TransferRequest::Abort { .. } | TransferRequest::Unknown(_) => None,
            request => Some(Self::Transfer(request)),
        }
    }

    /// The SDO request that makes this access on CAN.
    pub fn to_sdo(self, address: Address) -> TransferRequest {
        match self {
            Self::Read | Self::Other => TransferRequest::InitiateUpload { address },
            Self::Write { value, width } => {
                let bytes = value.to_le_bytes();
                let data = bytes.get(..usize::from(width)).and_then(Expedited::new);
                let transfer = Initiate::Expedited(data.unwrap_or_else(|| Expedited::of(value)));
                TransferRequest::InitiateDownload { address, transfer }
            }
            Self::Transfer(request) => request,
        }
    }
}

/// A reply before it is matched to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reply {
    /// From a CAN bus.
    Sdo(TransferResponse),
    /// From a serial link.
    Serial(SerialReply),
}

/// The possible meanings of a serial reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SerialReply {
    pub error: AbortCode,
    /// Data words after the error code.
    pub words: usize,
    /// Exactly two words as a number; bits above the object's width are undefined.
    pub value: Option<u32>,
    /// The words as a segment, if they have that format.
    pub segment: Option<TransferSegment>,
}

/// Data words in the answer to ReadObject.
const VALUE_WORDS: usize = 2;

impl Reply {
    /// Parses a frame of a serial link.
    pub fn parse(frame: &SerialFrame) -> Result<Self, SerialFrameError> {
        let answer = SerialAnswer::parse(frame)?;
        let words = answer.data.as_slice().len();
        let segment = SegmentedRead::parse_answer(frame).ok().and_then(Result::ok);
        Ok(Self::Serial(SerialReply {
            error: answer.error,
            words,
            value: answer.value().ok().filter(|_| words == VALUE_WORDS),
            segment: segment.map(|segment| TransferSegment {
                toggle: segment.toggle,
                last: !segment.more,
                bytes: segment.bytes,
            }),
        }))
    }

    /// The error code; [`AbortCode::NONE`] for success.
    pub fn error(&self) -> AbortCode {
        match self {
            // An abort without a code is an error all the same.
            Self::Sdo(TransferResponse::Abort { error, .. }) if error.is_none() => {
                AbortCode::GENERAL
            }
            Self::Sdo(TransferResponse::Abort { error, .. }) => *error,
            Self::Sdo(_) => AbortCode::NONE,
            Self::Serial(reply) => reply.error,
        }
    }

    /// The value of an object of up to four bytes.
    pub fn value(&self) -> Option<u32> {
        match self {
            Self::Sdo(TransferResponse::InitiateUpload { transfer, .. }) => match transfer {
                Initiate::Expedited(data) => Some(data.to_u32()),
                Initiate::Unsized(bytes) => Some(u32::from_le_bytes(*bytes)),
                Initiate::Segmented { .. } => None,
            },
            Self::Sdo(_) => None,
            Self::Serial(reply) => reply.value,
        }
    }

    /// Whether this can be the reply to an access to the object at `address`. A serial error can be
    /// the reply to anything.
    pub fn fits(&self, address: Address, access: ObjectAccess) -> bool {
        let reply = match self {
            Self::Sdo(response) => {
                let is_complete = self.value().is_some() || !self.error().is_none();
                return response.address().is_none_or(|named| named == address)
                    && response.answers(&access.to_sdo(address))
                    && (access != ObjectAccess::Read || is_complete);
            }
            Self::Serial(reply) => reply,
        };
        match access {
            _ if !reply.error.is_none() => true,
            ObjectAccess::Read => reply.value.is_some(),
            ObjectAccess::Write { .. }
            | ObjectAccess::Transfer(
                TransferRequest::InitiateUpload { .. } | TransferRequest::InitiateDownload { .. },
            ) => reply.words == 0,
            ObjectAccess::Transfer(TransferRequest::UploadSegment { .. }) => {
                reply.segment.is_some()
            }
            ObjectAccess::Transfer(TransferRequest::DownloadSegment(_)) => {
                reply.words == 1
                    && reply
                        .segment
                        .is_some_and(|segment| segment.bytes.is_empty())
            }
            ObjectAccess::Transfer(_) => false,
            ObjectAccess::Other => true,
        }
    }

    /// The reply without an error as the SDO response to `request`.
    pub fn to_sdo(self, request: &TransferRequest) -> TransferResponse {
        let reply = match self {
            Self::Sdo(response) => return response,
            Self::Serial(reply) => reply,
        };
        match (*request, reply.segment) {
            (TransferRequest::InitiateUpload { address }, _) => TransferResponse::InitiateUpload {
                address,
                transfer: Initiate::Segmented { size: None },
            },
            (TransferRequest::InitiateDownload { address, .. }, _) => {
                TransferResponse::InitiateDownload { address }
            }
            (TransferRequest::UploadSegment { .. }, Some(segment)) => {
                TransferResponse::UploadSegment(segment)
            }
            (TransferRequest::DownloadSegment(_), Some(segment)) => {
                TransferResponse::DownloadSegment {
                    toggle: segment.toggle,
                }
            }
            (request, _) => TransferResponse::Unknown(request.to_bytes()),
        }
    }
}
