//! The unit's RS232 interface: request and answer with their handshake bytes, half duplex (Communication Guide, "RS232
//! Communication").
//!
//! Wire time at the baud rate belongs to the link, not here.

use protocol::epos2::message::{GatewayNmt, SendCanFrame, SerialRequest};
use protocol::epos2::rs232::{BodyDecoder, Bytes, FAILED, OKAY, encode_body};
use protocol::epos2::{SerialFrame, objects};

use super::bus::CanBus;
use super::node::Node;
use super::service::CommandService;

/// The RS232 side of a unit.
#[derive(Clone, Debug)]
pub struct Rs232Server {
    turn: HandshakeState,
    service: CommandService,
    /// When the last byte came.
    heard_us: u64,
}

/// Whose turn it is and for what.
#[derive(Clone, Debug)]
enum HandshakeState {
    /// The master's: an opcode.
    Opcode,
    /// The master's: the rest of its request.
    Body(BodyDecoder),
    /// The master's: whether it is ready for the answer.
    Ready(SerialFrame),
    /// The master's: whether it has understood the answer.
    Receipt,
}

impl Rs232Server {
    /// An interface whose garbage in unused words follows from `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            turn: HandshakeState::Opcode,
            service: CommandService::new(seed),
            heard_us: 0,
        }
    }

    /// Takes bytes from the master at the node's present instant; what the unit sends goes to `out`.
    ///
    /// A silence longer than the frame timeout (2005) ends whatever was under way. On the unit's CAN bus there is nobody else.
    pub fn input(&mut self, node: &mut Node, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        self.input_with_bus(node, &mut (), bytes, out);
    }

    /// As [`Rs232Server::input`], with other nodes on the unit's CAN bus for its gateway.
    pub fn input_with_bus(
        &mut self,
        node: &mut Node,
        bus: &mut impl CanBus,
        bytes: &[u8],
        out: &mut impl FnMut(&[u8]),
    ) {
        let now_us = node.time_us();
        let timeout_us = 1000 * u64::from(node.dictionary.get(objects::RS232_FRAME_TIMEOUT));
        if now_us.saturating_sub(self.heard_us) > timeout_us {
            self.turn = HandshakeState::Opcode;
        }
        self.heard_us = now_us;
        for &byte in bytes {
            let turn = core::mem::replace(&mut self.turn, HandshakeState::Opcode);
            self.turn = self.take(turn, byte, node, bus, out);
        }
    }

    fn take(
        &mut self,
        turn: HandshakeState,
        byte: u8,
        node: &mut Node,
        bus: &mut impl CanBus,
        out: &mut impl FnMut(&[u8]),
    ) -> HandshakeState {
        match turn {
            HandshakeState::Opcode if SerialRequest::OPCODES.contains(&byte) => {
                out(&[OKAY]);
                HandshakeState::Body(BodyDecoder::new(byte))
            }
            HandshakeState::Opcode => {
                out(&[FAILED]);
                HandshakeState::Opcode
            }
            HandshakeState::Body(mut decoder) => match decoder.push(byte) {
                None => HandshakeState::Body(decoder),
                Some(Ok(request)) => {
                    out(&[OKAY]);
                    self.answer(&request, node, bus, out)
                }
                Some(Err(_)) => {
                    out(&[FAILED]);
                    HandshakeState::Opcode
                }
            },
            HandshakeState::Ready(answer) if byte == OKAY => {
                let mut body = Bytes::new();
                // An answer always has words.
                if encode_body(&answer, &mut body).is_err() {
                    return HandshakeState::Opcode;
                }
                out(&body);
                HandshakeState::Receipt
            }
            // Refused, understood or not: the next byte is an opcode.
            HandshakeState::Ready(_) | HandshakeState::Receipt => HandshakeState::Opcode,
        }
    }

    /// NMT and "send CAN frame" have no answer on RS232.
    fn answer(
        &mut self,
        request: &SerialFrame,
        node: &mut Node,
        bus: &mut impl CanBus,
        out: &mut impl FnMut(&[u8]),
    ) -> HandshakeState {
        let answer = self.service.execute(node, bus, request);
        if [GatewayNmt::OPCODE, SendCanFrame::OPCODE].contains(&request.opcode) {
            return HandshakeState::Opcode;
        }
        out(&[SerialFrame::ANSWER]);
        HandshakeState::Ready(answer)
    }
}

#[cfg(test)]
#[path = "rs232_tests.rs"]
mod tests;
