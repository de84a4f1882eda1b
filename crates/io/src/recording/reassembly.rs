//! Reassembly of fragmented IPv4 datagrams, as far as a lidar needs it: 1214 bytes of UDP that an
//! interface with a small MTU (a tunnel, a relay) sends in two or three pieces.
//!
//! Memory is bounded: at most 32 datagrams of 2 KiB are incomplete at a time, none of them for
//! longer than a second.

use std::collections::VecDeque;
use std::ops::Range;

use etherparse::defrag::IpDefragBuf;
use etherparse::{IpFragOffset, IpNumber};
use units::{Host, Span, Stamp};

/// Longest datagram that is reassembled, in bytes.
const MAX_LEN: usize = 2048;
/// Datagrams that may be incomplete at a time.
const MAX_INCOMPLETE: usize = 32;
/// Age at which an incomplete datagram is dropped. An identification repeats after 65,536 packets,
/// which a sensor in dual return with its position packets sends in 11 s.
const MAX_AGE: Span = Span::from_secs(1);

/// Identity of the datagram that a fragment belongs to (RFC 791, 3.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DatagramId {
    pub(super) source: [u8; 4],
    pub(super) destination: [u8; 4],
    pub(super) identification: u16,
}

/// One fragment of a UDP datagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fragment {
    pub(super) id: DatagramId,
    pub(super) offset: IpFragOffset,
    pub(super) more_fragments: bool,
    /// The fragment's bytes, counted from the start of the captured packet.
    pub(super) payload: Range<usize>,
}

#[derive(Debug)]
struct IncompleteDatagram {
    id: DatagramId,
    since: Stamp<Host>,
    buffer: IpDefragBuf,
    fragments: u64,
}

/// Reassembles datagrams.
#[derive(Debug, Default)]
pub(super) struct Reassembler {
    incomplete: VecDeque<IncompleteDatagram>,
    datagram: Vec<u8>,
}

impl Reassembler {
    /// Adds a fragment captured at `host`. When it completes a datagram, the number of fragments is
    /// returned and [`Reassembler::datagram`] holds the bytes.
    pub(super) fn add(
        &mut self,
        host: Stamp<Host>,
        fragment: &Fragment,
        bytes: &[u8],
    ) -> Option<u64> {
        self.incomplete.retain(|datagram| {
            let age_ns = host.saturating_since(datagram.since).as_nanos();
            age_ns.saturating_abs() <= MAX_AGE.as_nanos()
        });
        if usize::from(fragment.offset.byte_offset()) + bytes.len() > MAX_LEN {
            return None;
        }
        let known = self.incomplete.iter().position(|d| d.id == fragment.id);
        let index = known.unwrap_or_else(|| {
            if self.incomplete.len() >= MAX_INCOMPLETE {
                self.incomplete.pop_front();
            }
            self.incomplete.push_back(IncompleteDatagram {
                id: fragment.id,
                since: host,
                buffer: IpDefragBuf::new(IpNumber::UDP, Vec::new(), Vec::new()),
                fragments: 0,
            });
            self.incomplete.len() - 1
        });
        let datagram = self.incomplete.get_mut(index)?;
        let added = datagram
            .buffer
            .add(fragment.offset, fragment.more_fragments, bytes);
        added.ok()?;
        datagram.fragments += 1;
        if !datagram.buffer.is_complete() {
            return None;
        }
        let complete = self.incomplete.remove(index)?;
        self.datagram = complete.buffer.take_bufs().0;
        Some(complete.fragments)
    }

    /// The datagram reassembled last: UDP header and payload.
    pub(super) fn datagram(&self) -> &[u8] {
        &self.datagram
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fragment(identification: u16, offset: u16, more_fragments: bool) -> Fragment {
        Fragment {
            id: DatagramId {
                source: [10, 0, 0, 1],
                destination: [255; 4],
                identification,
            },
            offset: IpFragOffset::try_new(offset / 8).unwrap(),
            more_fragments,
            payload: 0..0,
        }
    }

    fn at(ms: i64) -> Stamp<Host> {
        Stamp::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn fragments_may_be_out_of_order_and_interleaved() {
        let mut reassembler = Reassembler::default();
        let mut add = |ms, fragment, bytes: &[u8]| {
            let fragments = reassembler.add(at(ms), &fragment, bytes)?;
            Some((fragments, reassembler.datagram().to_vec()))
        };
        assert_eq!(add(0, fragment(1, 16, false), b"tail"), None);
        assert_eq!(add(1, fragment(2, 0, true), &[b'x'; 8]), None);
        assert_eq!(add(2, fragment(1, 8, true), b"89abcdef"), None);
        let whole = b"0123456789abcdeftail".to_vec();
        assert_eq!(add(3, fragment(1, 0, true), b"01234567"), Some((3, whole)));
        let whole = b"xxxxxxxxy".to_vec();
        assert_eq!(add(4, fragment(2, 8, false), b"y"), Some((2, whole)));
    }

    #[test]
    fn old_fragments_are_not_joined_with_new_ones() {
        let mut reassembler = Reassembler::default();
        reassembler.add(at(0), &fragment(1, 0, true), b"01234567");
        let new = fragment(1, 8, false);
        assert_eq!(reassembler.add(at(1001), &new, b"new"), None);
        // Nor with fragments from before the clock was set back.
        reassembler.add(at(5000), &fragment(2, 0, true), b"01234567");
        let new = fragment(2, 8, false);
        assert_eq!(reassembler.add(at(3000), &new, b"new"), None);
    }

    #[test]
    fn memory_is_bounded() {
        let mut reassembler = Reassembler::default();
        for n in 0..10_000 {
            for (offset, more, bytes) in [
                (8, true, &[0; 8][..]),
                (65_528, false, b"x"),
                (0, true, &[0; 7]),
                (65_528, true, &[0; 8]),
            ] {
                let fragment = fragment(n, offset, more);
                assert_eq!(reassembler.add(at(0), &fragment, bytes), None);
            }
        }
        assert_eq!(reassembler.incomplete.len(), MAX_INCOMPLETE);
    }
}
