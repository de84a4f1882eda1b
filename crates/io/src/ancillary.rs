//! Ancillary data of the kernel: when a packet was received, and how many were dropped before it.

use std::os::fd::AsFd;

use nix::sys::socket::{ControlMessageOwned, RecvMsg, setsockopt, sockopt};
use nix::sys::time::TimeSpec;
use units::{Host, Stamp};

/// Ancillary data of one packet.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ancillary {
    /// `SO_TIMESTAMPNS`: time at which the packet left the network stack.
    pub(crate) received: Option<Stamp<Host>>,
    /// `SO_RXQ_OVFL`: the socket's counter of dropped packets; absent until one was dropped.
    pub(crate) overflow: Option<u32>,
}

/// Packets that the kernel dropped, counted from its 32-bit counter, which wraps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DropCounter {
    last: u32,
    total: u64,
}

/// Switches the ancillary data of a socket on.
pub(crate) fn enable(socket: &impl AsFd) -> nix::Result<()> {
    setsockopt(socket, sockopt::ReceiveTimestampns, &true)?;
    setsockopt(socket, sockopt::RxqOvfl, &1)
}

/// Buffer for the ancillary data of one packet.
pub(crate) fn buffer() -> Vec<u8> {
    nix::cmsg_space!(TimeSpec, u32)
}

impl Ancillary {
    pub(crate) fn of<S>(message: &RecvMsg<'_, '_, S>) -> nix::Result<Self> {
        let mut ancillary = Self::default();
        for part in message.cmsgs()? {
            match part {
                ControlMessageOwned::ScmTimestampns(time) => {
                    let s_in_ns = time.tv_sec().saturating_mul(1_000_000_000);
                    let ns = s_in_ns.saturating_add(time.tv_nsec());
                    ancillary.received = Some(Stamp::from_nanos(ns));
                }
                ControlMessageOwned::RxqOvfl(counter) => ancillary.overflow = Some(counter),
                _ => {}
            }
        }
        Ok(ancillary)
    }
}

impl DropCounter {
    pub(crate) fn update(&mut self, overflow: Option<u32>) {
        if let Some(counter) = overflow {
            self.total += u64::from(counter.wrapping_sub(self.last));
            self.last = counter;
        }
    }

    pub(crate) const fn total(self) -> u64 {
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_counter_may_wrap() {
        let mut dropped = DropCounter::default();
        for overflow in [None, Some(u32::MAX), None, Some(4)] {
            dropped.update(overflow);
        }
        assert_eq!(dropped.total(), u64::from(u32::MAX) + 5);
    }
}
