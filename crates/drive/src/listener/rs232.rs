//! An RS232 dialogue by looking on at both sides: which bytes are handshake, which are bodies.
//!
//! Whatever does not fit ends the dialogue; the next opcode begins another, as for the unit.

use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, RequestCanFrame, SegmentedRead,
    SegmentedWrite, WriteObject,
};
use protocol::epos2::rs232::{BodyDecoder, FAILED, OKAY};
use protocol::epos2::{Frame, FrameError};
use protocol::record::Direction;

/// Opcodes of requests that are answered.
const OPCODES: [u8; 7] = [
    ReadObject::OPCODE,
    WriteObject::OPCODE,
    InitiateSegmentedRead::OPCODE,
    InitiateSegmentedWrite::OPCODE,
    SegmentedRead::OPCODE,
    SegmentedWrite::OPCODE,
    RequestCanFrame::OPCODE,
];

/// Looks on at a dialogue.
#[derive(Clone, Debug)]
pub(super) struct Rs232Watch {
    turn: Turn,
}

#[derive(Clone, Debug)]
enum Turn {
    /// The master is to send an opcode.
    Opcode,
    /// The unit is to take it.
    Ready(u8),
    /// The master sends the body.
    Body(BodyDecoder),
    /// The unit is to take it.
    Accepted,
    /// The unit is to announce its answer.
    Lead,
    /// The master is to take that.
    Announced,
    /// The unit answers.
    Answer(BodyDecoder),
    /// The master is to take it.
    Receipt,
}

/// What a byte completed.
pub(super) enum Said {
    Nothing,
    Noise,
    Request(Result<Frame, FrameError>),
    /// An answer is ready: what was asked for has been done.
    Announced,
    Answer(Result<Frame, FrameError>),
}

impl Rs232Watch {
    pub fn new() -> Self {
        Self { turn: Turn::Opcode }
    }

    pub fn hear(&mut self, direction: Direction, byte: u8) -> Said {
        match direction {
            Direction::ToDevice => self.master(byte),
            Direction::FromDevice => self.unit(byte),
        }
    }

    fn master(&mut self, byte: u8) -> Said {
        match (&mut self.turn, byte) {
            (Turn::Body(decoder), _) => match decoder.push(byte) {
                None => return Said::Nothing,
                Some(frame) => {
                    self.turn = if frame.is_ok() {
                        Turn::Accepted
                    } else {
                        Turn::Opcode
                    };
                    return Said::Request(frame);
                }
            },
            (Turn::Announced, OKAY) => self.turn = Turn::Answer(BodyDecoder::new(Frame::ANSWER)),
            (Turn::Receipt, OKAY | FAILED) => self.turn = Turn::Opcode,
            (_, opcode) if OPCODES.contains(&opcode) => self.turn = Turn::Ready(opcode),
            _ => self.turn = Turn::Opcode,
        }
        Said::Nothing
    }

    fn unit(&mut self, byte: u8) -> Said {
        match (&mut self.turn, byte) {
            (Turn::Ready(opcode), OKAY) => self.turn = Turn::Body(BodyDecoder::new(*opcode)),
            (Turn::Accepted, OKAY) => self.turn = Turn::Lead,
            (Turn::Lead, Frame::ANSWER) => {
                self.turn = Turn::Announced;
                return Said::Announced;
            }
            (Turn::Ready(_) | Turn::Accepted, FAILED) => self.turn = Turn::Opcode,
            (Turn::Answer(decoder), _) => {
                if let Some(frame) = decoder.push(byte) {
                    self.turn = Turn::Receipt;
                    return Said::Answer(frame);
                }
            }
            _ => {
                self.turn = Turn::Opcode;
                return Said::Noise;
            }
        }
        Said::Nothing
    }
}
