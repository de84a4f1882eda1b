//! The gateway: requests of a serial interface to other nodes go to the CAN bus (Communication
//! Guide, "Gateway").
//!
//! A node that does not answer is a timeout. The answer to the serial request is immediate: the
//! link models the delay.

use protocol::canopen::nmt::{Nmt, NmtCommand};
use protocol::canopen::sdo::{SdoClient, SdoOutcome, TransferError};
use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::message::{RequestCanFrame, SendCanFrame};
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use super::Abort;
use super::bus::CanBus;
use super::value::{LONGEST, ObjectValue};

/// The client has no clock: it waits until no frame is pending.
type Client = SdoClient<LONGEST>;
const START: Stamp<Host> = Stamp::from_nanos(0);
const EXPIRED: Stamp<Host> = Stamp::from_nanos(1);

/// Reads an object of another node.
pub(super) fn read(
    bus: &mut impl CanBus,
    node: u8,
    address: Address,
) -> Result<ObjectValue, Abort> {
    let outcome = transfer(bus, node, |client| client.read(address).is_ok())?;
    outcome
        .result
        .map(|value| ObjectValue::of_bytes(&value.bytes))
        .map_err(code)
}

/// Writes an object of another node.
pub(super) fn write(
    bus: &mut impl CanBus,
    node: u8,
    address: Address,
    bytes: &[u8],
) -> Result<(), Abort> {
    let outcome = transfer(bus, node, |client| client.write(address, bytes).is_ok())?;
    outcome.result.map(|_| ()).map_err(code)
}

fn transfer(
    bus: &mut impl CanBus,
    node: u8,
    begin: impl FnOnce(&mut Client) -> bool,
) -> Result<SdoOutcome<LONGEST>, Abort> {
    let id = NodeId::new(node).ok_or(Abort::CAN_ID)?;
    let mut client = Client::new(id, Span::from_nanos(1));
    if !begin(&mut client) {
        return Err(Abort::TOO_LONG);
    }
    // Each answer leads to the next frame or to the end; empty segments make a bound necessary.
    for _ in 0..=2 * LONGEST {
        let Some(frame) = client.poll_transmit(START) else {
            break;
        };
        bus.send(&frame, &mut |answer| {
            client.handle_frame(answer);
        });
    }
    client.handle_timeout(EXPIRED);
    let outcome = client.poll_outcome();
    // Aborts a transfer that failed on this side.
    if let Some(frame) = client.poll_transmit(START) {
        bus.send(&frame, &mut |_| {});
    }
    outcome.ok_or(Abort::TIMEOUT)
}

/// The error code of a failed transfer in the serial answer.
fn code(error: TransferError) -> Abort {
    match error {
        TransferError::Aborted(code) => code,
        TransferError::Timeout { .. } => Abort::TIMEOUT,
        TransferError::Toggle { .. } => Abort::TOGGLE,
        TransferError::Size { .. } => Abort::LENGTH,
        TransferError::TooLong { .. } => Abort::MEMORY,
        _ => Abort::COMMAND,
    }
}

/// Network management for other nodes; 0 is all.
pub(super) fn nmt(bus: &mut impl CanBus, node: u16, command: NmtCommand) {
    let addressed = u8::try_from(node).ok().and_then(NodeId::new);
    if addressed.is_some() || node == 0 {
        let node = addressed;
        bus.send(&Nmt { node, command }.to_frame(), &mut |_| {});
    }
}

/// Sends a frame on the bus; frames that it triggers are ignored.
pub(super) fn send(bus: &mut impl CanBus, request: &SendCanFrame) -> Result<(), Abort> {
    let id = CobId::new(request.cob_id).ok_or(Abort::CAN_ID)?;
    let data = request.data.get(..usize::from(request.len));
    let frame = data
        .and_then(|data| CanFrame::new(id, data).ok())
        .ok_or(Abort::LENGTH)?;
    bus.send(&frame, &mut |_| {});
    Ok(())
}

/// Requests a frame by a remote frame and returns its data, padded with zeros.
pub(super) fn request(bus: &mut impl CanBus, request: &RequestCanFrame) -> Result<[u8; 8], Abort> {
    let id = CobId::new(request.cob_id).ok_or(Abort::CAN_ID)?;
    let frame = u8::try_from(request.len)
        .ok()
        .and_then(|len| CanFrame::remote(id, len).ok())
        .ok_or(Abort::LENGTH)?;
    let mut found = None;
    bus.send(&frame, &mut |answer| {
        if answer.cob_id() == Some(id) && !answer.is_remote() {
            let mut data = [0; 8];
            for (to, from) in data.iter_mut().zip(answer.data()) {
                *to = *from;
            }
            found.get_or_insert(data);
        }
    });
    found.ok_or(Abort::TIMEOUT)
}

#[cfg(test)]
#[path = "gateway_tests.rs"]
mod tests;
