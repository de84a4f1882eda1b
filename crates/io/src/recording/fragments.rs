//! Fragments of IP packets put together again, as far as a lidar's packet needs it: the 1214 bytes
//! of UDP that an interface with a small MTU (a tunnel, a relay) sends in two or three pieces.
//!
//! Bounded: 32 datagrams of at most 2 KiB at a time; what is larger, older than a second or one too
//! many is given up. Not here: checksums, and packets that are whole.

use std::collections::VecDeque;
use std::net::IpAddr;
use std::ops::Range;

use units::{Host, Span, Stamp};

/// The longest datagram put together, in bytes.
const MAX_LEN: usize = 2048;
/// Offsets count in these (RFC 791, 3.1), in bytes.
const UNIT_LEN: usize = 8;
/// Datagrams of which parts are kept.
const MAX_OPEN: usize = 32;
/// An identification is used again after 65,536 packets: 11 s of a sensor in dual return and its
/// position packets at the worst.
const MAX_AGE: Span = Span::from_secs(1);

/// Which datagram a fragment is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key {
    pub(super) source: IpAddr,
    pub(super) destination: IpAddr,
    pub(super) identification: u32,
}

/// One fragment of a UDP datagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fragment {
    pub(super) key: Key,
    /// Where its bytes belong, in bytes.
    pub(super) offset: usize,
    /// More follow behind it.
    pub(super) more: bool,
    /// Its bytes, from the start of the captured packet.
    pub(super) payload: Range<usize>,
}

#[derive(Debug)]
struct Open {
    key: Key,
    since: Stamp<Host>,
    bytes: Box<[u8; MAX_LEN]>,
    /// One bit for each unit that is there.
    have: [u64; MAX_LEN / UNIT_LEN / 64],
    /// Length of the whole, once its last fragment is there.
    length: Option<usize>,
    parts: u64,
}

/// Puts fragments together.
#[derive(Debug, Default)]
pub(super) struct Joiner {
    open: VecDeque<Open>,
    done: Option<Open>,
}

impl Joiner {
    /// Takes a fragment that was captured at `host`. If that was the last one missing: how many
    /// there were; the datagram is then in [`Joiner::bytes`].
    pub(super) fn take(
        &mut self,
        host: Stamp<Host>,
        fragment: &Fragment,
        bytes: &[u8],
    ) -> Option<u64> {
        self.open.retain(|open| {
            let age = host.saturating_since(open.since);
            (Span::from_nanos(-MAX_AGE.as_nanos())..=MAX_AGE).contains(&age)
        });
        let end = fragment.offset.checked_add(bytes.len())?;
        // All but the last come in whole units.
        if end > MAX_LEN || (fragment.more && !bytes.len().is_multiple_of(UNIT_LEN)) {
            return None;
        }
        let at = match self.open.iter().position(|open| open.key == fragment.key) {
            Some(at) => at,
            None => {
                if self.open.len() >= MAX_OPEN {
                    self.open.pop_front();
                }
                self.open.push_back(Open::new(fragment.key, host));
                self.open.len() - 1
            }
        };
        let open = self.open.get_mut(at)?;
        open.put(fragment, bytes);
        if !open.complete() {
            return None;
        }
        self.done = self.open.remove(at);
        self.done.as_ref().map(|done| done.parts)
    }

    /// The datagram put together last: UDP header and payload.
    pub(super) fn bytes(&self) -> &[u8] {
        self.done.as_ref().map_or(&[], |done| {
            done.bytes
                .get(..done.length.unwrap_or(0))
                .unwrap_or_default()
        })
    }
}

impl Open {
    fn new(key: Key, since: Stamp<Host>) -> Self {
        Self {
            key,
            since,
            bytes: Box::new([0; MAX_LEN]),
            have: [0; MAX_LEN / UNIT_LEN / 64],
            length: None,
            parts: 0,
        }
    }

    fn put(&mut self, fragment: &Fragment, bytes: &[u8]) {
        let end = fragment.offset + bytes.len();
        if let Some(space) = self.bytes.get_mut(fragment.offset..end) {
            space.copy_from_slice(bytes);
        }
        for unit in fragment.offset / UNIT_LEN..end.div_ceil(UNIT_LEN) {
            if let Some(word) = self.have.get_mut(unit / 64) {
                *word |= 1 << (unit % 64);
            }
        }
        if !fragment.more {
            self.length = Some(end);
        }
        self.parts += 1;
    }

    fn complete(&self) -> bool {
        let Some(length) = self.length else {
            return false;
        };
        let has = |unit: usize| {
            self.have
                .get(unit / 64)
                .is_some_and(|word| word >> (unit % 64) & 1 == 1)
        };
        (0..length.div_ceil(UNIT_LEN)).all(has)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    fn fragment(identification: u32, offset: usize, more: bool) -> Fragment {
        Fragment {
            key: Key {
                source: Ipv4Addr::new(10, 0, 0, 1).into(),
                destination: Ipv4Addr::BROADCAST.into(),
                identification,
            },
            offset,
            more,
            payload: 0..0,
        }
    }

    fn at(ms: i64) -> Stamp<Host> {
        Stamp::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn in_any_order_and_interleaved() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.take(at(0), &fragment(1, 16, false), b"tail"), None);
        assert_eq!(joiner.take(at(1), &fragment(2, 0, true), &[b'x'; 8]), None);
        assert_eq!(joiner.take(at(2), &fragment(1, 8, true), b"89abcdef"), None);
        let parts = joiner.take(at(3), &fragment(1, 0, true), b"01234567");
        assert_eq!(parts, Some(3));
        assert_eq!(joiner.bytes(), b"0123456789abcdeftail");
        assert_eq!(joiner.take(at(4), &fragment(2, 8, false), b"y"), Some(2));
        assert_eq!(joiner.bytes(), b"xxxxxxxxy");
    }

    #[test]
    fn an_old_part_is_not_joined_with_a_new_one() {
        let mut joiner = Joiner::default();
        joiner.take(at(0), &fragment(1, 0, true), b"01234567");
        assert_eq!(joiner.take(at(1001), &fragment(1, 8, false), b"new"), None);
        // Nor with one from before a clock was set back.
        joiner.take(at(5000), &fragment(2, 0, true), b"01234567");
        assert_eq!(joiner.take(at(3000), &fragment(2, 8, false), b"new"), None);
    }

    #[test]
    fn memory_is_bounded_whatever_comes() {
        let mut joiner = Joiner::default();
        for n in 0..10_000 {
            assert_eq!(joiner.take(at(0), &fragment(n, 8, true), &[0; 8]), None);
            assert_eq!(joiner.take(at(0), &fragment(n, 65_528, false), b"x"), None);
            assert_eq!(joiner.take(at(0), &fragment(n, 0, true), &[0; 7]), None);
            assert_eq!(
                joiner.take(at(0), &fragment(n, usize::MAX, true), b"x"),
                None
            );
        }
        assert_eq!(joiner.open.len(), MAX_OPEN);
    }
}
