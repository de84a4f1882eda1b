//! Passive decoder of an RS232 dialogue: separates handshake from bodies.
//!
//! A byte that does not fit ends the dialogue; the next opcode begins another, as for the drive. A
//! handshake that is not in the log follows from the byte after it.

use protocol::epos2::message::{
    InitiateSegmentedRead, InitiateSegmentedWrite, ReadObject, RequestCanFrame, SegmentedRead,
    SegmentedWrite, WriteObject,
};
use protocol::epos2::rs232::{BodyDecoder, FAILED, OKAY};
use protocol::epos2::{SerialFrame, SerialFrameError};
use protocol::record::Direction;

/// Opcodes of requests with an answer.
const OPCODES: [u8; 7] = [
    ReadObject::OPCODE,
    WriteObject::OPCODE,
    InitiateSegmentedRead::OPCODE,
    InitiateSegmentedWrite::OPCODE,
    SegmentedRead::OPCODE,
    SegmentedWrite::OPCODE,
    RequestCanFrame::OPCODE,
];

/// Decodes both sides of a dialogue.
#[derive(Clone, Debug, Default)]
pub(super) struct Rs232Listener {
    awaiting: Awaiting,
}

/// The next byte of the dialogue.
#[derive(Clone, Debug, Default)]
enum Awaiting {
    /// From the master: an opcode.
    #[default]
    Opcode,
    /// From the drive: the handshake for this opcode.
    OpcodeHandshake(u8),
    /// From the master: the body.
    Body(BodyDecoder),
    /// From the drive: the handshake for the body.
    BodyHandshake,
    /// From the drive: the answer's opcode.
    AnswerOpcode,
    /// From the master: the handshake for the answer's opcode.
    AnswerOpcodeHandshake,
    /// From the drive: the answer.
    Answer(BodyDecoder),
    /// From the master: the handshake for the answer.
    AnswerHandshake,
}

/// Result of a byte on a serial link.
pub(super) enum SerialEvent {
    Noise,
    Request(Result<SerialFrame, SerialFrameError>),
    /// An answer on RS232 is ready: the request has been executed.
    Announced,
    Answer(Result<SerialFrame, SerialFrameError>),
}

impl Rs232Listener {
    pub fn push(&mut self, direction: Direction, byte: u8) -> Option<SerialEvent> {
        match direction {
            Direction::ToDrive => self.push_from_master(byte),
            Direction::FromDrive => self.push_from_drive(byte),
        }
    }

    fn push_from_master(&mut self, byte: u8) -> Option<SerialEvent> {
        self.awaiting = match (&mut self.awaiting, byte) {
            (Awaiting::Body(decoder), _) => {
                let frame = decoder.push(byte)?;
                self.awaiting = if frame.is_ok() {
                    Awaiting::BodyHandshake
                } else {
                    Awaiting::Opcode
                };
                return Some(SerialEvent::Request(frame));
            }
            (Awaiting::OpcodeHandshake(opcode), _) if !OPCODES.contains(&byte) => {
                let mut decoder = BodyDecoder::new(*opcode);
                decoder.push(byte);
                Awaiting::Body(decoder)
            }
            (Awaiting::AnswerOpcodeHandshake, OKAY) => {
                Awaiting::Answer(BodyDecoder::new(SerialFrame::ANSWER))
            }
            (Awaiting::BodyHandshake | Awaiting::AnswerOpcode, OKAY) => {
                self.awaiting = Awaiting::Answer(BodyDecoder::new(SerialFrame::ANSWER));
                return Some(SerialEvent::Announced);
            }
            (Awaiting::AnswerHandshake, OKAY | FAILED) => Awaiting::Opcode,
            (_, opcode) if OPCODES.contains(&opcode) => Awaiting::OpcodeHandshake(opcode),
            _ => Awaiting::Opcode,
        };
        None
    }

    fn push_from_drive(&mut self, byte: u8) -> Option<SerialEvent> {
        let (next, event) = match (&mut self.awaiting, byte) {
            (Awaiting::OpcodeHandshake(opcode), OKAY) => {
                (Awaiting::Body(BodyDecoder::new(*opcode)), None)
            }
            (Awaiting::BodyHandshake, OKAY) => (Awaiting::AnswerOpcode, None),
            (Awaiting::BodyHandshake | Awaiting::AnswerOpcode, SerialFrame::ANSWER) => (
                Awaiting::AnswerOpcodeHandshake,
                Some(SerialEvent::Announced),
            ),
            (Awaiting::AnswerOpcodeHandshake, _) => {
                let mut decoder = BodyDecoder::new(SerialFrame::ANSWER);
                decoder.push(byte);
                (Awaiting::Answer(decoder), None)
            }
            (Awaiting::OpcodeHandshake(_) | Awaiting::BodyHandshake, FAILED) => {
                (Awaiting::Opcode, None)
            }
            (Awaiting::Answer(decoder), _) => {
                let frame = decoder.push(byte)?;
                (Awaiting::AnswerHandshake, Some(SerialEvent::Answer(frame)))
            }
            _ => (Awaiting::Opcode, Some(SerialEvent::Noise)),
        };
        self.awaiting = next;
        event
    }
}
