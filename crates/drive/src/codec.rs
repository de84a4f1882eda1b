//! The one place that knows which bytes a transport uses: a request to a frame, bytes to replies.
//!
//! The USB frames of the EPOS2 for now; each further transport is another variant here. Timing, pairing and retries are the
//! link's business.

use protocol::epos2::message::{Answer, ReadObject, WriteObject};
use protocol::epos2::objects::Address;
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::epos2::{CommError, Frame, FrameError};

use crate::pairing::Access;

/// An answer, not yet paired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reply {
    pub error: CommError,
    /// Data words after the error code.
    pub words: usize,
    /// The first two of them as a number; above the object's width it is garbage.
    pub value: Option<u32>,
}

/// What a run of bytes turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decoded {
    Reply(Reply),
    /// A good frame that answers nothing, such as an echo.
    Foreign,
    /// Began like a frame and was none.
    Damaged,
}

/// A transport's frames.
#[derive(Clone, Debug)]
pub(crate) struct Codec {
    node: u8,
    transport: Transport,
}

#[derive(Clone, Debug)]
enum Transport {
    Usb(UsbDecoder),
}

impl Codec {
    pub fn usb(node: u8) -> Self {
        Self {
            node,
            transport: Transport::Usb(UsbDecoder::new()),
        }
    }

    /// The bytes that ask for `access` to an object.
    pub fn encode(&self, address: Address, access: Access) -> Vec<u8> {
        let node = self.node;
        let frame = match access {
            Access::Write(value) => WriteObject {
                node,
                address,
                value,
            }
            .to_frame(),
            Access::Read | Access::Other => ReadObject { node, address }.to_frame(),
        };
        match &self.transport {
            Transport::Usb(_) => usb::to_bytes(&frame).as_slice().to_vec(),
        }
    }

    /// Takes a byte from the device.
    pub fn push(&mut self, byte: u8) -> Option<Decoded> {
        match &mut self.transport {
            Transport::Usb(decoder) => decoder.push(byte).map(|frame| decoded(&frame)),
        }
    }
}

fn decoded(frame: &Result<Frame, FrameError>) -> Decoded {
    let Ok(frame) = frame else {
        return Decoded::Damaged;
    };
    match Answer::parse(frame) {
        Ok(answer) => Decoded::Reply(Reply::from(&answer)),
        Err(FrameError::Opcode { .. }) => Decoded::Foreign,
        Err(_) => Decoded::Damaged,
    }
}

impl From<&Answer> for Reply {
    fn from(answer: &Answer) -> Self {
        let words = answer.data.as_slice().len();
        Self {
            error: answer.error,
            words,
            value: answer.value().ok().filter(|_| words == VALUE_WORDS),
        }
    }
}

/// Data words in the answer to ReadObject.
const VALUE_WORDS: usize = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STATUSWORD: Address = Address::new(0x6041, 0);
    const CONTROLWORD: Address = Address::new(0x6040, 0);

    fn decode(bytes: &[u8]) -> Vec<Decoded> {
        let mut codec = Codec::usb(1);
        bytes.iter().filter_map(|&b| codec.push(b)).collect()
    }

    /// Frames of the Communication Guide's format, CRC worked out by hand.
    #[test]
    fn golden_requests() {
        let codec = Codec::usb(1);
        assert_eq!(
            codec.encode(STATUSWORD, Access::Read),
            [0x90, 2, 0x10, 2, 0x41, 0x60, 0, 1, 0x64, 0xCF]
        );
        assert_eq!(
            codec.encode(CONTROLWORD, Access::Write(0x0F)),
            [
                0x90, 2, 0x11, 4, 0x40, 0x60, 0, 1, 0x0F, 0, 0, 0, 0x2D, 0x2C
            ]
        );
    }

    #[test]
    fn golden_answers() {
        let read = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x37, 2, 0, 0, 0x68, 0];
        let reply = |error, words, value| {
            vec![Decoded::Reply(Reply {
                error: CommError(error),
                words,
                value,
            })]
        };
        assert_eq!(decode(&read), reply(0, 2, Some(0x237)));
        let written = [0x90, 2, 0, 2, 0, 0, 0, 0, 0x40, 0x8B];
        assert_eq!(decode(&written), reply(0, 0, None));
        let absent = [0x90, 2, 0, 2, 0, 0, 2, 6, 0xA4, 1];
        assert_eq!(decode(&absent), reply(0x0602_0000, 0, None));
    }

    #[test]
    fn an_echo_is_no_answer() {
        let codec = Codec::usb(1);
        let echo = codec.encode(STATUSWORD, Access::Read);
        assert_eq!(decode(&echo), [Decoded::Foreign]);
    }

    #[test]
    fn a_wrong_checksum_is_told() {
        let read = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x36, 2, 0, 0, 0x68, 0];
        assert_eq!(decode(&read), [Decoded::Damaged]);
    }

    proptest! {
        #[test]
        fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
            decode(&bytes);
        }
    }
}
