//! Datagrams received by one system call.

use std::io::{self, IoSliceMut};
use std::net::Ipv4Addr;

use nix::sys::socket::{MsgFlags, MultiHeaders, SockaddrIn, recvmmsg};
use units::{Host, Stamp};

use crate::ancillary::{self, Ancillary};
use crate::clock;

/// Most datagrams of one call.
pub(super) const LEN: usize = 64;
/// The longest UDP payload. Memory beyond the received bytes is never touched: a lidar's datagram
/// takes one page.
const BUFFER_LEN: usize = 65_535;

/// A received datagram without its payload.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceivedDatagram {
    len: usize,
    pub(super) source: Ipv4Addr,
    /// Time at which the kernel received it, or of the read if the kernel gives none.
    pub(super) host: Stamp<Host>,
    pub(super) has_kernel_time: bool,
}

/// Buffers that are reused from call to call, and their datagrams.
#[derive(Debug)]
pub(super) struct Batch {
    buffers: Vec<u8>,
    received: Vec<ReceivedDatagram>,
    /// Number of datagrams taken from `received`.
    taken: usize,
}

impl Batch {
    pub(super) fn new() -> Self {
        Self {
            buffers: vec![0; LEN * BUFFER_LEN],
            received: Vec::with_capacity(LEN),
            taken: 0,
        }
    }

    /// The next datagram without its payload.
    pub(super) fn peek(&self) -> Option<&ReceivedDatagram> {
        self.received.get(self.taken)
    }

    /// Takes the next datagram.
    pub(super) fn take(&mut self) -> Option<(ReceivedDatagram, &[u8])> {
        let received = *self.peek()?;
        let payload = self
            .buffers
            .chunks_exact(BUFFER_LEN)
            .nth(self.taken)
            .and_then(|buffer| buffer.get(..received.len));
        self.taken += 1;
        Some((received, payload.unwrap_or_default()))
    }

    /// Whether the call filled the batch: more datagrams may be waiting.
    pub(super) fn was_full(&self) -> bool {
        self.received.len() == LEN
    }

    /// Receives from a socket and discards the previous datagrams. `on_overflow` takes the drop
    /// counter of each datagram.
    ///
    /// # Errors
    /// The system's; `WouldBlock` if no datagram is waiting, and the batch is empty.
    pub(super) fn receive(
        &mut self,
        fd: i32,
        mut on_overflow: impl FnMut(Option<u32>),
    ) -> io::Result<()> {
        self.taken = 0;
        self.received.clear();
        let mut parts: Vec<[IoSliceMut<'_>; 1]> = self
            .buffers
            .chunks_exact_mut(BUFFER_LEN)
            .map(|buffer| [IoSliceMut::new(buffer)])
            .collect();
        // The headers are made for each call: the kernel leaves in them the space that control
        // messages took, and the next call would have no more. The drop counter, which is absent
        // until a datagram is dropped, would not fit.
        let control = Some(ancillary::buffer());
        let mut headers = MultiHeaders::<SockaddrIn>::preallocate(LEN, control);
        for message in recvmmsg(fd, &mut headers, &mut parts, MsgFlags::empty(), None)? {
            let ancillary = Ancillary::of(&message)?;
            on_overflow(ancillary.overflow);
            self.received.push(ReceivedDatagram {
                len: message.bytes,
                source: message
                    .address
                    .map_or(Ipv4Addr::UNSPECIFIED, |from| from.ip()),
                host: ancillary.received.unwrap_or_else(clock::now),
                has_kernel_time: ancillary.received.is_some(),
            });
        }
        Ok(())
    }
}
