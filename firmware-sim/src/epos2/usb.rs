//! The unit's USB interface: one answer a request frame.
//!
//! Its timing (the FTDI's latency timer, the frames of USB) belongs to the link, not here.

use protocol::epos2::usb::{UsbDecoder, to_bytes};
use protocol::epos2::{CommError, SerialFrameError, objects};

use super::bus::CanBus;
use super::node::Node;
use super::service::CommandService;

/// The USB side of a unit.
#[derive(Clone, Debug)]
pub struct UsbServer {
    decoder: UsbDecoder,
    service: CommandService,
    /// When the frame under way last had a byte.
    heard_us: u64,
}

impl UsbServer {
    /// An interface whose garbage in unused words follows from `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            decoder: UsbDecoder::new(),
            service: CommandService::new(seed),
            heard_us: 0,
        }
    }

    /// Takes bytes from the host at the node's present instant; each answer goes to `out` as one whole frame.
    ///
    /// A frame with a wrong checksum is answered with communication error 05040004; one that breaks off is forgotten, at the
    /// latest after the frame timeout (2006). On the unit's CAN bus there is nobody else.
    pub fn input(&mut self, node: &mut Node, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        self.input_with_bus(node, &mut (), bytes, out);
    }

    /// As [`UsbServer::input`], with other nodes on the unit's CAN bus for its gateway.
    pub fn input_with_bus(
        &mut self,
        node: &mut Node,
        bus: &mut impl CanBus,
        bytes: &[u8],
        out: &mut impl FnMut(&[u8]),
    ) {
        let now_us = node.time_us();
        let timeout_us = 1000 * u64::from(node.dictionary.get(objects::USB_FRAME_TIMEOUT));
        if now_us.saturating_sub(self.heard_us) > timeout_us {
            self.decoder.reset();
        }
        self.heard_us = now_us;
        for &byte in bytes {
            let answer = match self.decoder.push(byte) {
                Some(Ok(request)) => self.service.execute(node, bus, &request),
                Some(Err(SerialFrameError::Crc { .. })) => self.service.refuse(CommError::CRC),
                Some(Err(_)) | None => continue,
            };
            out(&to_bytes(&answer));
        }
    }
}

#[cfg(test)]
#[path = "usb_tests.rs"]
mod tests;
