//! SDO requests and answers as the link's requests and replies.
//!
//! Objects of up to four bytes travel in one exchange; longer ones in segments, each an exchange of its own. Block transfer is left
//! out: no EPOS2 has it.

use protocol::canopen::sdo::{self, Answer, Expedited, Initiate, Request};
use protocol::canopen::{CanFrame, Channel, NodeId};
use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError};

use super::{About, Decoded, Kind, Reply, Segment};
use crate::pairing::Access;

/// The request for `access` to an object of `width` bytes.
pub(super) fn request(address: Address, access: Access, width: u8) -> Request {
    match access {
        Access::Write(value) => {
            let bytes = value.to_le_bytes();
            let data = bytes.get(..usize::from(width)).and_then(Expedited::new);
            let transfer = Initiate::Expedited(data.unwrap_or_else(|| Expedited::of(value)));
            Request::InitiateDownload { address, transfer }
        }
        Access::Segment { toggle } => Request::UploadSegment { toggle },
        Access::OpenWrite { len } => {
            let transfer = Initiate::Segmented { size: Some(len) };
            Request::InitiateDownload { address, transfer }
        }
        Access::WriteSegment(segment) => Request::DownloadSegment(sdo::Segment {
            toggle: segment.toggle,
            last: segment.last,
            ..sdo::Segment::cut(&segment.bytes, 0, segment.toggle)
        }),
        Access::Read | Access::Open | Access::Other => Request::InitiateUpload { address },
    }
}

/// What a `struct can_frame` is to the client of `node`.
pub(super) fn received(node: NodeId, bytes: &[u8]) -> Decoded {
    let Ok(frame) = CanFrame::from_socketcan(bytes) else {
        return Decoded::Noise;
    };
    if frame.cob_id() != Some(Channel::SdoAnswer(node).cob_id()) {
        return Decoded::Bus(frame);
    }
    match Answer::parse(&frame) {
        Ok((_, answer)) => decode(&answer).map_or(Decoded::Foreign, Decoded::Reply),
        Err(_) => Decoded::Damaged,
    }
}

/// An answer as a reply; `None` for block transfer, which nobody asked for.
pub(crate) fn decode(answer: &Answer) -> Option<Reply> {
    let reply = |address, kind| Reply {
        error: CommError::NONE,
        words: 0,
        value: None,
        segment: None,
        about: Some(About { address, kind }),
    };
    Some(match *answer {
        Answer::InitiateUpload { address, transfer } => {
            let data = match transfer {
                Initiate::Expedited(data) => Some((data.to_u32(), whole(data.as_slice()))),
                Initiate::Unsized(bytes) => Some((u32::from_le_bytes(bytes), whole(&bytes))),
                Initiate::Segmented { .. } => None,
            };
            Reply {
                value: data.map(|(value, _)| value),
                segment: data.map(|(_, segment)| segment),
                ..reply(Some(address), Kind::Upload)
            }
        }
        Answer::UploadSegment(segment) => Reply {
            segment: Some(Segment {
                toggle: segment.toggle,
                last: segment.last,
                ..whole(&segment.bytes)
            }),
            ..reply(None, Kind::UploadSegment)
        },
        Answer::InitiateDownload { address } => reply(Some(address), Kind::Download),
        Answer::DownloadSegment { toggle } => Reply {
            segment: Some(Segment {
                toggle,
                ..whole(&[])
            }),
            ..reply(None, Kind::DownloadSegment)
        },
        Answer::Abort { address, error } => Reply {
            // An abort without a reason is an error all the same.
            error: if error.is_none() {
                CommError::GENERAL
            } else {
                error
            },
            ..reply(Some(address), Kind::Abort)
        },
        Answer::Unknown(_) => return None,
    })
}

/// All of an object.
fn whole(data: &[u8]) -> Segment {
    let mut bytes = Bounded::new();
    bytes.extend(data.iter().copied());
    Segment {
        toggle: false,
        last: true,
        bytes,
    }
}

/// What a request asks, for whoever looks on; `None` for an abort, which has no answer. Segments name no object; whether a
/// read is one in segments its answer decides.
pub(crate) fn asked(request: &Request) -> Option<(Address, Access)> {
    match *request {
        Request::InitiateUpload { address } => Some((address, Access::Open)),
        Request::InitiateDownload {
            address,
            transfer: Initiate::Expedited(data),
        } => Some((address, Access::Write(data.to_u32()))),
        Request::InitiateDownload {
            address,
            transfer: Initiate::Segmented { size },
        } => {
            let len = size.unwrap_or_default();
            Some((address, Access::OpenWrite { len }))
        }
        Request::InitiateDownload { address, .. } => Some((address, Access::Other)),
        Request::UploadSegment { toggle } => Some((Address::default(), Access::Segment { toggle })),
        Request::DownloadSegment(segment) => {
            let written = Segment {
                toggle: segment.toggle,
                last: segment.last,
                ..whole(&segment.bytes)
            };
            Some((Address::default(), Access::WriteSegment(written)))
        }
        Request::Abort { .. } | Request::Unknown(_) => None,
    }
}
