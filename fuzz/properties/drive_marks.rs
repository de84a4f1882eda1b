//! Unique positions: replaces the position in the unit's answers by a counter of position reads.
//!
//! A shaft at rest hides a wrongly assigned answer; a counter does not.

use protocol::canopen::sdo::{Expedited, Initiate, SdoResponse};
use protocol::canopen::{CanFrame, CommunicationObject, NodeId, PdoNumber};
use protocol::epos2::message::{ReadObject, SerialAnswer};
use protocol::epos2::objects::POSITION_ACTUAL;
use protocol::epos2::rs232::{self, BodyDecoder};
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{AbortCode, SerialFrame};
use protocol::record::DriveLink;

/// Counts position reads.
#[derive(Debug)]
pub struct Marks {
    link: DriveLink,
    /// Value of the current read.
    qc: i32,
    /// RS232: the opcode sent last, and the value of the answer that waits for its handshake.
    opcode: u8,
    waiting: Option<i32>,
}

impl Marks {
    /// The first read returns 1.
    pub const fn new(link: DriveLink) -> Self {
        Self {
            link,
            qc: 1,
            opcode: 0,
            waiting: None,
        }
    }

    /// Ends a read and returns its value.
    pub const fn next(&mut self) -> i32 {
        self.qc += 1;
        self.qc - 1
    }

    /// Puts the counter into the unit's answer if that is a position.
    pub fn put(&mut self, request_bytes: &[u8], answer_bytes: &mut Vec<u8>) {
        match self.link {
            DriveLink::Usb => {
                let request = decode_usb(request_bytes);
                if let (Some(true), Some(answer)) =
                    (request.as_ref().map(is_read), decode_usb(answer_bytes))
                {
                    *answer_bytes = usb::to_bytes(&marked(&answer, self.qc)).as_slice().to_vec();
                }
            }
            DriveLink::Rs232 => self.put_rs232(request_bytes, answer_bytes),
            DriveLink::Can => self.put_can(answer_bytes),
        }
    }

    fn put_rs232(&mut self, request_bytes: &[u8], answer_bytes: &mut Vec<u8>) {
        match (request_bytes, answer_bytes.as_slice()) {
            (&[opcode], &[rs232::OKAY]) => self.opcode = opcode,
            // The answer is ready and waits.
            (body, &[SerialFrame::ANSWER]) => {
                let body = decode_body(self.opcode, body);
                self.waiting = body.filter(is_read).map(|_| self.qc);
            }
            (_, &[_]) => {}
            (_, body) => {
                if let (Some(qc), Some(answer)) =
                    (self.waiting, decode_body(SerialFrame::ANSWER, body))
                {
                    answer_bytes.clear();
                    let _ = rs232::encode_body(&marked(&answer, qc), answer_bytes);
                }
            }
        }
    }

    fn put_can(&self, answer_bytes: &mut Vec<u8>) {
        let Ok(frame) = CanFrame::from_socketcan(answer_bytes) else {
            return;
        };
        let node = NodeId::new(1).expect("an id");
        let address = POSITION_ACTUAL.address;
        let channel = frame.cob_id().map(CommunicationObject::of);
        if channel == Some(CommunicationObject::TransmitPdo(PdoNumber::One, node))
            && frame.data().len() == 8
        {
            // Position and time, as the client configured the process data.
            let data = [&self.qc.to_le_bytes(), &frame.data()[4..]].concat();
            let id = frame.id();
            let frame = CanFrame::new(id, &data).expect("eight bytes");
            *answer_bytes = frame.to_socketcan().to_vec();
        } else if let Ok((_, SdoResponse::InitiateUpload { address: got, .. })) =
            SdoResponse::parse(&frame)
            && got == address
        {
            let transfer = Initiate::Expedited(Expedited::of(self.qc));
            let answer = SdoResponse::InitiateUpload { address, transfer };
            *answer_bytes = answer.to_frame(node).to_socketcan().to_vec();
        }
    }
}

fn is_read(request: &SerialFrame) -> bool {
    ReadObject::parse(request).is_ok_and(|read| read.address == POSITION_ACTUAL.address)
}

fn decode_usb(bytes: &[u8]) -> Option<SerialFrame> {
    let mut decoder = UsbDecoder::new();
    bytes.iter().find_map(|&byte| decoder.push(byte))?.ok()
}

fn decode_body(opcode: u8, bytes: &[u8]) -> Option<SerialFrame> {
    let mut decoder = BodyDecoder::new(opcode);
    bytes.iter().find_map(|&byte| decoder.push(byte))?.ok()
}

/// The answer with another position.
fn marked(answer: &SerialFrame, qc: i32) -> SerialFrame {
    match SerialAnswer::parse(answer) {
        Ok(parsed) if parsed.error == AbortCode::NONE && parsed.value().is_ok() => {
            let [a, b, c, d] = qc.to_le_bytes();
            let words = [0, 0, u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])];
            SerialFrame::new(SerialFrame::ANSWER, &words).expect("few words")
        }
        _ => *answer,
    }
}
