//! Numbers of packets in a recording, by kind.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use protocol::record::Direction;

use super::PacketFault;

/// Limit of distinct pairs of port and size, which bounds memory.
const MAX_KINDS: usize = 1024;

/// The first unusable packet.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Malformed {
    /// Offset of its record in the file, in bytes.
    pub offset: u64,
    /// Its fault.
    pub fault: PacketFault,
}

/// Numbers of packets by kind. `records` is the sum of `datagrams`, `more_datagrams`, `to_drive`,
/// `from_drive`, `other`, `fragments`, `joined` and `malformed`; the other fields detail these.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecordingCounts {
    /// Packets in the file; a damaged stretch counts as one.
    pub records: u64,
    /// The lidar's datagrams ([`DatagramKind::is_lidar`](super::DatagramKind::is_lidar)) by
    /// destination port and payload size in bytes; the first 1024 such pairs.
    pub datagrams: BTreeMap<(u16, usize), u64>,
    /// Further datagrams of the lidar.
    pub more_datagrams: u64,
    /// Frames from the host to the drive.
    pub to_drive: u64,
    /// Frames from the drive to the host.
    pub from_drive: u64,
    /// Intact packets of other devices.
    pub other: u64,
    /// Of `other`: UDP, by destination port and payload size in bytes; the first 1024 such pairs.
    pub foreign: BTreeMap<(u16, usize), u64>,
    /// IP fragments that were not reassembled.
    pub fragments: u64,
    /// Fragments of reassembled datagrams, except the last of each, which counts as the datagram.
    pub joined: u64,
    /// Reassembled datagrams of any kind.
    pub reassembled: u64,
    /// Unusable packets.
    pub malformed: u64,
    /// The first unusable packet.
    pub first_malformed: Option<Malformed>,
    /// Of `malformed`: truncated packets (snap length).
    pub snapped: u64,
    /// Of `malformed`: packets without a time (pcapng simple packet blocks).
    pub timeless: u64,
    /// Of `malformed`: damaged stretches of the file, after which reading continued.
    pub damaged: u64,
    /// Bytes in those stretches.
    pub damaged_bytes: u64,
}

impl RecordingCounts {
    pub(super) fn packet(&mut self) {
        self.records += 1;
    }

    pub(super) fn lidar(&mut self, port: u16, size: usize) {
        if !count_pair(&mut self.datagrams, port, size) {
            self.more_datagrams += 1;
        }
    }

    pub(super) fn foreign(&mut self, port: u16, size: usize) {
        self.other += 1;
        count_pair(&mut self.foreign, port, size);
    }

    /// Counts the completion of a datagram; its earlier fragments were counted as not
    /// reassembled.
    pub(super) fn reassembled(&mut self, fragments: u64) {
        let before = fragments.saturating_sub(1);
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

    pub(super) fn malformed(&mut self, offset: u64, fault: PacketFault) {
        self.malformed += 1;
        match fault {
            PacketFault::Snapped { .. } => self.snapped += 1,
            PacketFault::Timeless => self.timeless += 1,
            _ => {}
        }
        if self.first_malformed.is_none() {
            self.first_malformed = Some(Malformed { offset, fault });
        }
    }
}

/// Counts a pair; returns false beyond the limit.
fn count_pair(kinds: &mut BTreeMap<(u16, usize), u64>, port: u16, size: usize) -> bool {
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
    fn pairs_over_the_limit_are_counted() {
        let mut counts = RecordingCounts::default();
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
