//! One packet of a recording: what it carries, how it is counted, and whether it is given on. How
//! packets are framed and taken apart is told elsewhere.

use std::ops::Range;

use super::link::{self, Content};
use super::reassembly::Fragment;
use super::{DatagramKind, Fault, Found, FoundWire, Packet, Place, Recording};

impl<R> Recording<R> {
    /// Looks inside a packet and counts it.
    pub(super) fn classify(&mut self, packet: &Packet, offset: u64) -> Option<Found> {
        let data = self.window.bytes().get(packet.data.clone());
        let data = data.unwrap_or_default();
        let content = match link::look_inside(packet.link, packet.direction, data) {
            // A capture that kept the whole datagram and lost only what was behind it is as good as
            // any.
            Ok(content @ Content::Datagram { .. }) => Ok(content),
            _ if (data.len() as u64) < u64::from(packet.original) => Err(Fault::Snapped {
                captured: data.len() as u32,
                original: packet.original,
            }),
            looked => looked,
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
                self.datagram(source, port, payload, Place::Window)?
            }
            Ok(Content::Fragment(fragment)) => self.fragment(packet, &fragment, offset)?,
            Ok(Content::Serial { link, direction }) => {
                self.counts.drive(direction);
                FoundWire::Serial {
                    link,
                    direction,
                    frame: packet.data.clone(),
                }
            }
            Ok(Content::Can { direction, frame }) => {
                self.counts.drive(direction);
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
        Some(Found {
            host: packet.host,
            wire,
        })
    }

    /// Counts a datagram by what it is; `None` if nobody wants it.
    fn datagram(
        &mut self,
        source: [u8; 4],
        port: u16,
        payload: Range<usize>,
        place: Place,
    ) -> Option<FoundWire> {
        let bytes = match place {
            Place::Window => self.window.bytes().get(payload.clone()),
            Place::Reassembler => self.reassembler.datagram().get(payload.clone()),
        };
        let bytes = bytes.unwrap_or_default();
        if DatagramKind::of(bytes).is_lidar() {
            self.counts.lidar(port, bytes.len());
        } else {
            self.counts.foreign(port, bytes.len());
            if !self.keep_foreign {
                return None;
            }
        }
        Some(FoundWire::Datagram {
            source,
            port,
            payload,
            place,
        })
    }

    /// Takes a part of a datagram; the whole, if it was the last.
    fn fragment(&mut self, packet: &Packet, fragment: &Fragment, offset: u64) -> Option<FoundWire> {
        let data = self.window.bytes().get(packet.data.clone())?;
        let bytes = data.get(fragment.payload.clone())?;
        let Some(parts) = self.reassembler.add(packet.host, fragment, bytes) else {
            self.counts.fragments += 1;
            return None;
        };
        self.counts.reassembled(parts);
        match link::udp(self.reassembler.datagram()) {
            Ok((port, payload)) => {
                self.datagram(fragment.id.source, port, payload, Place::Reassembler)
            }
            Err(fault) => {
                self.counts.malformed(offset, fault);
                None
            }
        }
    }
}
