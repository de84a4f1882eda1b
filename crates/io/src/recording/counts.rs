//! What a recording holds, by number. Meaning (which port is the lidar's) is the reader's to add.

use std::collections::BTreeMap;

use protocol::record::Direction;

use super::Fault;

/// Distinct pairs of port and size that are told apart; a stranger's recording must not fill the memory.
const MAX_KINDS: usize = 1024;

/// The first packet that could not be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed {
    /// Where its record starts in the file, in bytes.
    pub offset: u64,
    /// What is wrong with it.
    pub fault: Fault,
}

/// Numbers of packets by kind. `records` is the sum of all the others but `first_malformed`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Packets in the file, of whatever kind.
    pub records: u64,
    /// UDP over IPv4 by destination port and payload size in bytes; the first 1024 such pairs.
    pub datagrams: BTreeMap<(u16, usize), u64>,
    /// UDP over IPv4 beyond those pairs.
    pub more_datagrams: u64,
    /// Frames from the host to the drive.
    pub to_drive: u64,
    /// Frames from the drive to the host.
    pub from_drive: u64,
    /// Sound packets that are neither UDP over IPv4 nor the drive's.
    pub other: u64,
    /// Fragments of IP packets; not put together.
    pub fragments: u64,
    /// Packets that could not be used.
    pub malformed: u64,
    /// The first of those.
    pub first_malformed: Option<Malformed>,
}

impl Counts {
    /// Datagrams to `port`, whatever their size.
    #[must_use]
    pub fn to_port(&self, port: u16) -> u64 {
        self.datagrams
            .range((port, 0)..=(port, usize::MAX))
            .map(|(_, n)| n)
            .sum()
    }

    /// Datagrams of `size` bytes to `port`.
    #[must_use]
    pub fn to_port_of_size(&self, port: u16, size: usize) -> u64 {
        self.datagrams.get(&(port, size)).copied().unwrap_or(0)
    }

    pub(super) fn packet(&mut self) {
        self.records += 1;
    }

    pub(super) fn datagram(&mut self, port: u16, size: usize) {
        if let Some(n) = self.datagrams.get_mut(&(port, size)) {
            *n += 1;
        } else if self.datagrams.len() < MAX_KINDS {
            self.datagrams.insert((port, size), 1);
        } else {
            self.more_datagrams += 1;
        }
    }

    pub(super) fn drive(&mut self, direction: Direction) {
        match direction {
            Direction::ToDevice => self.to_drive += 1,
            Direction::FromDevice => self.from_drive += 1,
        }
    }

    pub(super) fn malformed(&mut self, offset: u64, fault: Fault) {
        self.malformed += 1;
        if self.first_malformed.is_none() {
            self.first_malformed = Some(Malformed { offset, fault });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_beyond_the_limit_are_still_counted() {
        let mut counts = Counts::default();
        for port in 0..2000 {
            counts.datagram(port, 7);
        }
        counts.datagram(3, 7);
        counts.datagram(3, 8);
        assert_eq!(counts.datagrams.len(), MAX_KINDS);
        assert_eq!(counts.more_datagrams, 2000 - 1024 + 1);
        assert_eq!(counts.to_port_of_size(3, 7), 2);
        assert_eq!(counts.to_port(3), 2);
        assert_eq!(counts.to_port(1999), 0);
    }
}
