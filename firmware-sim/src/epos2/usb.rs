//! The USB interface of the drive: one answer per request frame. The link models the timing of FTDI
//! chip and USB.

use protocol::epos2::usb::{UsbDecoder, to_bytes};
use protocol::epos2::{AbortCode, SerialFrameError, objects};

use super::node::SimulatedDrive;
use super::service::CommandService;

/// The USB side of a drive.
#[derive(Clone, Debug)]
pub struct UsbServer {
    decoder: UsbDecoder,
    service: CommandService,
    /// Time of the last byte.
    last_byte_us: u64,
}

impl UsbServer {
    /// An interface; `seed` determines the garbage in unused words.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            decoder: UsbDecoder::new(),
            service: CommandService::new(seed),
            last_byte_us: 0,
        }
    }

    /// Takes bytes from the host at the present instant of the node; each answer goes to `out` as
    /// one frame.
    ///
    /// A frame with a wrong checksum is answered with communication error 05040004; an incomplete
    /// frame is dropped after the frame timeout (2006).
    pub fn input(&mut self, node: &mut SimulatedDrive, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        let now_us = node.time_us();
        let timeout_us = 1000 * u64::from(node.dictionary.get(objects::USB_FRAME_TIMEOUT));
        if now_us.saturating_sub(self.last_byte_us) > timeout_us {
            self.decoder.reset();
        }
        self.last_byte_us = now_us;
        for &byte in bytes {
            let answer = match self.decoder.push(byte) {
                Some(Ok(request)) => self.service.execute(node, &request),
                Some(Err(SerialFrameError::Crc { .. })) => self.service.refuse(AbortCode::CRC),
                Some(Err(_)) | None => continue,
            };
            out(&to_bytes(&answer));
        }
    }
}

#[cfg(test)]
#[path = "usb_tests.rs"]
mod tests;
