//! Datagrams taken from a socket by one system call, and handed on one by one. Not here: waiting
//! for them, and whose they are.

use std::io::{self, IoSliceMut};

use nix::sys::socket::{MsgFlags, MultiHeaders, SockaddrIn, recvmmsg};

use super::socket::{Received, control_space, described};

/// Most datagrams of one call.
pub(super) const LEN: usize = 64;
/// The longest UDP payload. Of the memory only what datagrams reach is ever touched: a lidar's, one
/// page each.
const BUFFER_LEN: usize = 65_535;

/// Buffers that are kept from call to call, and what is in them.
#[derive(Debug)]
pub(super) struct Batch {
    buffers: Vec<u8>,
    received: Vec<Received>,
    /// How many of `received` were handed on.
    given: usize,
}

impl Batch {
    pub(super) fn new() -> Self {
        Self {
            buffers: vec![0; LEN * BUFFER_LEN],
            received: Vec::with_capacity(LEN),
            given: 0,
        }
    }

    /// The next datagram without its payload.
    pub(super) fn next(&self) -> Option<&Received> {
        self.received.get(self.given)
    }

    /// Hands on the next datagram.
    pub(super) fn take(&mut self) -> Option<(Received, &[u8])> {
        let received = *self.next()?;
        let payload = self
            .buffers
            .chunks_exact(BUFFER_LEN)
            .nth(self.given)
            .and_then(|buffer| buffer.get(..received.len));
        self.given += 1;
        Some((received, payload.unwrap_or_default()))
    }

    /// Whether the socket gave as much as there was room for: more may be waiting.
    pub(super) fn was_full(&self) -> bool {
        self.received.len() == LEN
    }

    /// Receives anew; what was not handed on is gone. `overflow` hears the kernel's drop counter as
    /// each datagram brings it.
    ///
    /// # Errors
    /// The system's, `WouldBlock` where nothing is there; the batch is empty then.
    pub(super) fn receive(&mut self, fd: i32, mut overflow: impl FnMut(u32)) -> io::Result<()> {
        self.given = 0;
        self.received.clear();
        let mut parts: Vec<[IoSliceMut<'_>; 1]> = self
            .buffers
            .chunks_exact_mut(BUFFER_LEN)
            .map(|buffer| [IoSliceMut::new(buffer)])
            .collect();
        // Made anew each time: the kernel leaves in them how much room for control messages it
        // used, and the next call would find no more than that. The drop counter, which comes only
        // once something was dropped, would not fit.
        let mut headers = MultiHeaders::<SockaddrIn>::preallocate(LEN, Some(control_space()));
        let messages = recvmmsg(fd, &mut headers, &mut parts, MsgFlags::empty(), None)?;
        for message in messages {
            let (received, counter) = described(&message)?;
            counter.map(&mut overflow);
            self.received.push(received);
        }
        Ok(())
    }
}
