//! The gateway: requests of a serial interface to other nodes go to the CAN bus (Communication
//! Guide, "Gateway"). The drive is alone on its bus, so other nodes never answer.

use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::message::{RequestCanFrame, SendCanFrame};

use super::AbortCode;

/// The failure of an access to an object of another node.
pub(super) const fn transfer_error(node: u8) -> AbortCode {
    match NodeId::new(node) {
        Some(_) => AbortCode::TIMEOUT,
        None => AbortCode::CAN_ID,
    }
}

/// Sends a frame on the bus.
pub(super) fn send(request: &SendCanFrame) -> Result<(), AbortCode> {
    let id = CobId::new(request.cob_id).ok_or(AbortCode::CAN_ID)?;
    let data = request.data.get(..usize::from(request.len));
    data.and_then(|data| CanFrame::new(id, data).ok())
        .map(|_| ())
        .ok_or(AbortCode::LENGTH)
}

/// The failure of a request for a frame by a remote frame.
pub(super) fn request_error(request: &RequestCanFrame) -> AbortCode {
    let len = u8::try_from(request.len);
    match CobId::new(request.cob_id) {
        None => AbortCode::CAN_ID,
        Some(id) if len.is_ok_and(|len| CanFrame::remote(id, len).is_ok()) => AbortCode::TIMEOUT,
        Some(_) => AbortCode::LENGTH,
    }
}

#[cfg(test)]
#[path = "gateway_tests.rs"]
mod tests;
