//! The RS232 interface of the drive: request and answer with their handshake bytes, half duplex
//! (Communication Guide, "RS232 Communication"). The link models wire time.

use protocol::epos2::message::{GatewayNmt, SendCanFrame, SerialRequest};
use protocol::epos2::rs232::{BodyDecoder, Bytes, FAILED, OKAY, encode_body};
use protocol::epos2::{SerialFrame, objects};

use super::node::SimulatedDrive;
use super::service::CommandService;

/// The RS232 side of a drive.
#[derive(Clone, Debug)]
pub struct Rs232Server {
    state: HandshakeState,
    service: CommandService,
    /// Time of the last byte.
    last_byte_us: u64,
}

/// The next bytes of the master.
#[derive(Clone, Debug)]
enum HandshakeState {
    /// An opcode.
    Opcode,
    /// The rest of its request.
    Body(BodyDecoder),
    /// Whether it is ready for the answer.
    Ready(SerialFrame),
    /// Whether it has received the answer.
    Receipt,
}

impl Rs232Server {
    /// An interface; `seed` determines the garbage in unused words.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            state: HandshakeState::Opcode,
            service: CommandService::new(seed),
            last_byte_us: 0,
        }
    }

    /// Takes bytes from the master at the present instant of the node; the bytes of the drive go to
    /// `out`.
    ///
    /// A silence above the frame timeout (2005) resets the handshake.
    pub fn input(&mut self, node: &mut SimulatedDrive, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        let now_us = node.time_us();
        let timeout_us = 1000 * u64::from(node.dictionary.get(objects::RS232_FRAME_TIMEOUT));
        if now_us.saturating_sub(self.last_byte_us) > timeout_us {
            self.state = HandshakeState::Opcode;
        }
        self.last_byte_us = now_us;
        for &byte in bytes {
            let state = core::mem::replace(&mut self.state, HandshakeState::Opcode);
            self.state = self.take(state, byte, node, out);
        }
    }

    fn take(
        &mut self,
        state: HandshakeState,
        byte: u8,
        node: &mut SimulatedDrive,
        out: &mut impl FnMut(&[u8]),
    ) -> HandshakeState {
        match state {
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
                    self.answer(&request, node, out)
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
            // In either case the next byte is an opcode.
            HandshakeState::Ready(_) | HandshakeState::Receipt => HandshakeState::Opcode,
        }
    }

    /// NMT and "send CAN frame" have no answer on RS232.
    fn answer(
        &mut self,
        request: &SerialFrame,
        node: &mut SimulatedDrive,
        out: &mut impl FnMut(&[u8]),
    ) -> HandshakeState {
        let answer = self.service.execute(node, request);
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
