//! Objects of any length, read in segments: the same on each link, each segment an exchange of its own.

use protocol::epos2::CommError;
use protocol::epos2::objects::Address;

use crate::codec::Segment;
use crate::error::{DriveError, Operation};
use crate::pairing::Access;

use super::Ops;

/// Bytes of the longest object that is read in segments.
const MAX_OBJECT: usize = 256;

impl Ops {
    /// Reads an object of any length, in segments. A transfer of which an answer is lost is begun anew.
    ///
    /// # Errors
    /// [`DriveError::Toggle`] for a segment out of turn, besides those of any read.
    pub async fn read_bytes(&self, address: Address) -> Result<Vec<u8>, DriveError> {
        let mut attempts = self.config.timing.read_retries;
        loop {
            match self.transfer(address).await {
                Err(DriveError::NoAnswer { .. }) if attempts > 0 => attempts -= 1,
                result => return result,
            }
        }
    }

    async fn transfer(&self, address: Address) -> Result<Vec<u8>, DriveError> {
        let opened = self.ask(self.request(address, Access::Open, 0)).await?;
        let mut bytes = Vec::new();
        if let (Some(whole), Some(_)) = (opened.reply.segment, opened.reply.about) {
            // On CAN a short object comes at once.
            bytes.extend_from_slice(&whole.bytes);
            return Ok(bytes);
        }
        let mut toggle = false;
        loop {
            let request = self.request(address, Access::Segment { toggle }, 0);
            let segment = self.ask(request).await?.reply.segment;
            let Some(Segment {
                toggle: got,
                last,
                bytes: more,
            }) = segment
            else {
                return Ok(bytes);
            };
            if got != toggle {
                self.break_off(address);
                return Err(DriveError::Toggle {
                    operation: Operation::read(address),
                    expected: toggle,
                    got,
                });
            }
            bytes.extend_from_slice(&more);
            // A transfer of empty segments need not end.
            if last || more.is_empty() || bytes.len() > MAX_OBJECT {
                return Ok(bytes);
            }
            toggle = !toggle;
        }
    }

    /// Tells the node that a transfer is broken off; on a serial link the next one does.
    fn break_off(&self, address: Address) {
        self.on_bus(|bus, _| bus.abort(address, CommError::TOGGLE));
    }
}
