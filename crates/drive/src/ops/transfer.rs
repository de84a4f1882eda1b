//! Objects of any length, read and written in segments: the same on each link, each segment an exchange of its own.

use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError};

use crate::codec::Segment;
use crate::error::{DriveError, Operation, Wrote};
use crate::pairing::Access;

use super::{Ops, lock};

/// Bytes of the longest object that is read in segments.
const MAX_OBJECT: usize = 256;

impl Ops {
    /// Reads an object of any length, in segments. A transfer of which an answer is lost is begun anew.
    ///
    /// # Errors
    /// [`DriveError::Toggle`] for a segment out of turn, [`DriveError::TooLong`] beyond 256 bytes, besides those of any read.
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
                self.break_off(address, CommError::TOGGLE);
                return Err(DriveError::Toggle {
                    operation: Operation::read(address),
                    expected: toggle,
                    got,
                });
            }
            bytes.extend_from_slice(&more);
            if bytes.len() > MAX_OBJECT {
                self.break_off(address, CommError::MEMORY);
                return Err(DriveError::TooLong {
                    operation: Operation::read(address),
                    most: MAX_OBJECT,
                });
            }
            // A transfer of empty segments need not end.
            if last || more.is_empty() {
                return Ok(bytes);
            }
            toggle = !toggle;
        }
    }

    /// Tells the node that a transfer is broken off; on a serial link the next one does.
    fn break_off(&self, address: Address, why: CommError) {
        self.on_bus(|bus, _| bus.abort(address, why));
    }

    /// Writes an object of any length: up to four bytes at once, more in segments. Nothing is repeated: after a loss nobody knows
    /// what the drive made of it.
    ///
    /// # Errors
    /// [`DriveError::Toggle`] for a confirmation out of turn, besides those of any write. The transfer is broken off then.
    pub async fn write_bytes(&self, address: Address, bytes: &[u8]) -> Result<(), DriveError> {
        if let Some(value) = number(bytes) {
            let width = bytes.len() as u8; // up to four
            return self.write_raw(address, value, width).await;
        }
        let ended = self.download(address, bytes).await;
        match ended {
            Err(DriveError::Toggle { .. }) => self.break_off(address, CommError::TOGGLE),
            Err(DriveError::NoAnswer { .. }) => self.break_off(address, CommError::TIMEOUT),
            _ => {}
        }
        ended
    }

    async fn download(&self, address: Address, bytes: &[u8]) -> Result<(), DriveError> {
        let operation = Operation {
            address,
            wrote: Some(Wrote::Bytes(bytes.len())),
        };
        let len = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        let open = self.request(address, Access::OpenWrite { len }, 0);
        self.ask_as(operation, open).await?;
        let most = lock(&self.core).link.segment_len();
        let mut toggle = false;
        let mut rest = bytes;
        loop {
            let (now, later) = rest.split_at(rest.len().min(most));
            let mut segment = Segment {
                toggle,
                last: later.is_empty(),
                bytes: Bounded::new(),
            };
            segment.bytes.extend(now.iter().copied());
            let request = self.request(address, Access::WriteSegment(segment), 0);
            let confirmed = self.ask_as(operation, request).await?.reply.segment;
            let got = confirmed.map_or(toggle, |segment| segment.toggle);
            if got != toggle {
                return Err(DriveError::Toggle {
                    operation,
                    expected: toggle,
                    got,
                });
            }
            if later.is_empty() {
                return Ok(());
            }
            rest = later;
            toggle = !toggle;
        }
    }
}

/// One to four bytes as a number, low byte first.
fn number(bytes: &[u8]) -> Option<u32> {
    if !(1..=4).contains(&bytes.len()) {
        return None;
    }
    let mut number = [0; 4];
    for (to, from) in number.iter_mut().zip(bytes) {
        *to = *from;
    }
    Some(u32::from_le_bytes(number))
}
