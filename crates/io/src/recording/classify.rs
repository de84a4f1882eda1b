//! Classification and counting of a recording's packets.

use std::ops::Range;

use super::link::{self, Content};
use super::reassembly::Fragment;
use super::{
    CapturedPacket, DatagramKind, FoundRecord, FoundWire, PacketFault, PayloadLocation, Recording,
};

impl<R> Recording<R> {
    /// Parses a packet and counts it.
    pub(super) fn classify(&mut self, packet: &CapturedPacket, offset: u64) -> Option<FoundRecord> {
        let data = self.window.bytes().get(packet.data.clone());
        let data = data.unwrap_or_default();
        let content = match link::parse(packet.link, packet.direction, data) {
            // A capture with a complete datagram is valid even if it lost the bytes after it.
            Ok(content @ Content::Datagram { .. }) => Ok(content),
            _ if (data.len() as u64) < u64::from(packet.original) => Err(PacketFault::Snapped {
                captured: data.len() as u32,
                original: packet.original,
            }),
            result => result,
        };
        let wire = match content {
            Ok(Content::Datagram {
                source,
                port,
                payload,
            }) => {
                let start = packet.data.start;
                let payload =
                    start.saturating_add(payload.start)..start.saturating_add(payload.end);
                self.datagram(source, port, payload, PayloadLocation::Window)?
            }
            Ok(Content::Fragment(fragment)) => self.fragment(packet, &fragment, offset)?,
            Ok(Content::Serial { link, direction }) => {
                self.counts.drive += 1;
                FoundWire::Serial {
                    link,
                    direction,
                    frame: packet.data.clone(),
                }
            }
            Ok(Content::Can { direction, frame }) => {
                self.counts.drive += 1;
                self.can_frame = frame;
                FoundWire::Can { direction }
            }
            Ok(Content::OtherFragment) => {
                self.counts.fragments += 1;
                return None;
            }
            Ok(Content::Other) => {
                self.counts.other += 1;
                return None;
            }
            Err(fault) => {
                self.counts.malformed(offset, fault);
                return None;
            }
        };
        Some(FoundRecord {
            host: packet.host,
            wire,
        })
    }

    /// Counts a datagram; `None` if it is not wanted.
    fn datagram(
        &mut self,
        source: [u8; 4],
        port: u16,
        payload: Range<usize>,
        location: PayloadLocation,
    ) -> Option<FoundWire> {
        let bytes = match location {
            PayloadLocation::Window => self.window.bytes().get(payload.clone()),
            PayloadLocation::Reassembler => self.reassembler.datagram().get(payload.clone()),
        };
        let bytes = bytes.unwrap_or_default();
        if DatagramKind::of(bytes).is_lidar() {
            self.counts.datagrams += 1;
        } else {
            self.counts.other += 1;
            if !self.keep_foreign {
                return None;
            }
        }
        Some(FoundWire::Datagram {
            source,
            port,
            payload,
            location,
        })
    }

    /// Adds a fragment; returns the datagram if the fragment completes it.
    fn fragment(
        &mut self,
        packet: &CapturedPacket,
        fragment: &Fragment,
        offset: u64,
    ) -> Option<FoundWire> {
        let data = self.window.bytes().get(packet.data.clone())?;
        let bytes = data.get(fragment.payload.clone())?;
        let Some(fragments) = self.reassembler.add(packet.host, fragment, bytes) else {
            self.counts.fragments += 1;
            return None;
        };
        self.counts.reassembled(fragments);
        match link::udp(self.reassembler.datagram()) {
            Ok((port, payload)) => self.datagram(
                fragment.id.source,
                port,
                payload,
                PayloadLocation::Reassembler,
            ),
            Err(fault) => {
                self.counts.malformed(offset, fault);
                None
            }
        }
    }
}
