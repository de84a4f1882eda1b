//! When packets were fired: the part of decoding that a clock fit needs, without points.
//!
//! The decoder holds one of these and has no other source of time, so a survey and the decoding
//! after it agree exactly.

use protocol::vlp16::{DATA_LEN, DataPacket, Model};
use units::{Host, Lidar, Span, Stamp};

use crate::hours::HourUnwrapper;
use crate::identify::{Identifier, is_dual};
use crate::options::Options;
use crate::stats::Conflict;

/// When a data packet was filled, by the device's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacketTiming {
    /// Instant of the first firing.
    pub first_firing: Stamp<Lidar>,
    /// Time from the first firing to when the packet was complete and could leave: 24 firings of
    /// 55.296 us for a VLP-16, 12 with dual returns. A packet that straddles the gap of a limited
    /// field of view takes longer than said here, by the gap.
    pub fill: Span,
}

/// Unwraps packet times of one sensor in order of arrival.
#[derive(Clone, Debug)]
pub struct Timekeeper {
    hours: HourUnwrapper,
    identifier: Identifier,
    last: Option<Stamp<Lidar>>,
}

/// All that is known of a packet before its successor arrives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketFacts {
    pub start: Stamp<Lidar>,
    pub dual: bool,
    /// The model after this packet; it is told by the spacing before it, so it holds for the packet
    /// before as well.
    pub model: Option<&'static Model>,
    pub conflict: Option<Conflict>,
}

impl Timekeeper {
    /// For a sensor decoded with `options`.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self {
            hours: HourUnwrapper::new(),
            identifier: Identifier::new(options.model),
            last: None,
        }
    }

    /// When a payload that arrived at `host` was fired; `None` for anything but a sound data packet
    /// of a known model.
    ///
    /// Where the factory byte is wrong, the model is found from the second packet on; the first
    /// packet's fill is the named model's.
    pub fn packet(&mut self, host: Stamp<Host>, payload: &[u8]) -> Option<PacketTiming> {
        if payload.len() != DATA_LEN {
            return None;
        }
        let packet = DataPacket::new(payload).ok()?;
        let known = self.observe(host, &packet);
        let fill = known.model?.packet_period_ns(known.dual);
        Some(PacketTiming {
            first_firing: known.start,
            fill: Span::from_nanos(i64::from(fill)),
        })
    }

    pub(crate) fn observe(&mut self, host: Stamp<Host>, packet: &DataPacket<'_>) -> PacketFacts {
        let start = self.hours.unwrap(packet.timestamp_us(), host);
        let spacing = self.last.map(|last| start.saturating_since(last));
        self.last = Some(start);
        let (model, conflict) = self.identifier.observe(packet, spacing);
        PacketFacts {
            start,
            dual: is_dual(packet),
            model,
            conflict,
        }
    }
}
