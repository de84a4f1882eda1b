//! Numbers of packets in a recording, by kind.

use super::PacketFault;

/// The first unusable packet.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MalformedPacket {
    /// Offset of its record in the file, in bytes.
    pub offset: u64,
    /// Its fault.
    pub fault: PacketFault,
}

/// Numbers of packets by kind. `records` is the sum of `datagrams`, `drive`, `other`, `fragments`,
/// `joined` and `malformed`; the other fields detail these.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecordingCounts {
    /// Packets in the file; a damaged stretch counts as one.
    pub records: u64,
    /// The lidar's datagrams ([`DatagramKind::is_lidar`](super::DatagramKind::is_lidar)).
    pub datagrams: u64,
    /// Frames of the drive, in both directions.
    pub drive: u64,
    /// Intact packets of other devices.
    pub other: u64,
    /// IP fragments that were not reassembled.
    pub fragments: u64,
    /// Fragments of reassembled datagrams, except the last of each, which counts as the datagram.
    pub joined: u64,
    /// Reassembled datagrams of any kind.
    pub reassembled: u64,
    /// Unusable packets.
    pub malformed: u64,
    /// The first unusable packet.
    pub first_malformed: Option<MalformedPacket>,
    /// Truncated packets (snap length), a part of `malformed`.
    pub snapped: u64,
    /// Damaged stretches of the file, a part of `malformed`; reading continued after them.
    pub damaged: u64,
    /// Bytes in those stretches.
    pub damaged_bytes: u64,
    /// Offset of a section after the first (pcapng): files that were joined.
    pub second_section: Option<u64>,
}

impl RecordingCounts {
    /// Counts the completion of a datagram; its earlier fragments were counted as not
    /// reassembled.
    pub(super) fn reassembled(&mut self, fragments: u64) {
        let before = fragments.saturating_sub(1);
        self.fragments = self.fragments.saturating_sub(before);
        self.joined += before;
        self.reassembled += 1;
    }

    pub(super) fn malformed(&mut self, offset: u64, fault: PacketFault) {
        self.malformed += 1;
        self.snapped += u64::from(matches!(fault, PacketFault::Snapped { .. }));
        if self.first_malformed.is_none() {
            self.first_malformed = Some(MalformedPacket { offset, fault });
        }
    }
}
