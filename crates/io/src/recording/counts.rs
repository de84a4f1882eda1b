//! What a recording holds, by number. Meaning (which port is the lidar's) is the reader's to add.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use protocol::record::Direction;

use super::Fault;

/// Distinct pairs of port and size that are told apart; a stranger's recording must not fill the
/// memory.
const MAX_KINDS: usize = 1024;

/// The first packet that could not be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed {
    /// Where its record starts in the file, in bytes.
    pub offset: u64,
    /// What is wrong with it.
    pub fault: Fault,
}

/// Numbers of packets by kind. `records` is the sum of `datagrams`, `more_datagrams`, `to_drive`,
/// `from_drive`, `other`, `fragments`, `joined` and `malformed`; the rest tells more of these.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Packets in the file, of whatever kind; a damaged stretch is one.
    pub records: u64,
    /// The lidar's datagrams ([`DatagramKind::is_lidar`](super::DatagramKind::is_lidar)) by
    /// destination port and payload size in bytes; the first 1024 such pairs.
    pub datagrams: BTreeMap<(u16, usize), u64>,
    /// The lidar's datagrams beyond those pairs.
    pub more_datagrams: u64,
    /// Frames from the host to the drive.
    pub to_drive: u64,
    /// Frames from the drive to the host.
    pub from_drive: u64,
    /// Sound packets that are neither the lidar's nor the drive's.
    pub other: u64,
    /// Of `other`: UDP, by destination port and payload size in bytes; the first 1024 such pairs.
    pub foreign: BTreeMap<(u16, usize), u64>,
    /// Fragments of IP packets that were not put together.
    pub fragments: u64,
    /// Fragments of datagrams that were put together, the last of each excepted: that one counts as
    /// the datagram.
    pub joined: u64,
    /// Datagrams that were put together of fragments, whatever they were then counted as.
    pub reassembled: u64,
    /// Packets that could not be used.
    pub malformed: u64,
    /// The first of those.
    pub first_malformed: Option<Malformed>,
    /// Of `malformed`: packets of which the capture kept too little (snap length).
    pub snapped: u64,
    /// Of `malformed`: packets without a time (pcapng simple packet blocks).
    pub timeless: u64,
    /// Of `malformed`: stretches of the file that are no records; reading went on behind them.
    pub damaged: u64,
    /// Bytes in those stretches.
    pub damaged_bytes: u64,
}

impl Counts {
    pub(super) fn packet(&mut self) {
        self.records += 1;
    }

    pub(super) fn lidar(&mut self, port: u16, size: usize) {
        if !tally(&mut self.datagrams, port, size) {
            self.more_datagrams += 1;
        }
    }

    pub(super) fn foreign(&mut self, port: u16, size: usize) {
        self.other += 1;
        tally(&mut self.foreign, port, size);
    }

    /// The last of `parts` fragments came; the others were taken for lone ones before.
    pub(super) fn reassembled(&mut self, parts: u64) {
        let before = parts.saturating_sub(1);
        self.fragments = self.fragments.saturating_sub(before);
        self.joined += before;
        self.reassembled += 1;
    }

    pub(super) fn drive(&mut self, direction: Direction) {
        match direction {
            Direction::ToDevice => self.to_drive += 1,
            Direction::FromDevice => self.from_drive += 1,
        }
    }

    pub(super) fn malformed(&mut self, offset: u64, fault: Fault) {
        self.malformed += 1;
        match fault {
            Fault::Snapped { .. } => self.snapped += 1,
            Fault::Timeless => self.timeless += 1,
            _ => {}
        }
        if self.first_malformed.is_none() {
            self.first_malformed = Some(Malformed { offset, fault });
        }
    }
}

/// Whether there was room to count it.
fn tally(kinds: &mut BTreeMap<(u16, usize), u64>, port: u16, size: usize) -> bool {
    let room = kinds.len() < MAX_KINDS;
    match kinds.entry((port, size)) {
        Entry::Occupied(mut n) => *n.get_mut() += 1,
        Entry::Vacant(place) if room => {
            place.insert(1);
        }
        Entry::Vacant(_) => return false,
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_beyond_the_limit_are_still_counted() {
        let mut counts = Counts::default();
        for port in 0..2000 {
            counts.lidar(port, 7);
            counts.foreign(port, 9);
        }
        counts.lidar(3, 7);
        counts.lidar(3, 8);
        assert_eq!(counts.datagrams.len(), MAX_KINDS);
        assert_eq!(counts.more_datagrams, 2000 - 1024 + 1);
        assert_eq!((counts.foreign.len(), counts.other), (MAX_KINDS, 2000));
        assert_eq!((counts.datagrams[&(3, 7)], counts.foreign[&(3, 9)]), (2, 1));
    }
}
