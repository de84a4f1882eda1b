//! Times of packets, without decoding points, for the clock fit.
//!
//! The decoder takes its times from a [`Timekeeper`], so a survey and the later decoding agree
//! exactly.

use protocol::vlp16::{DATA_LEN, DataPacket, LidarModel};
use units::{Host, Lidar, Span, Stamp};

use crate::hours::HourUnwrapper;
use crate::identify::{Identifier, is_dual};
use crate::options::Options;
use crate::stats::ModelConflict;

/// Device time of a data packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PacketTiming {
    /// Time of the first firing.
    pub first_firing: Stamp<Lidar>,
    /// Time from the first firing to the completion of the packet: 24 firings of 55.296 us for a
    /// VLP-16, 12 with dual returns. The gap of a limited field of view is not included.
    pub fill: Span,
    /// Name of the sensor's model.
    pub model: &'static str,
}

/// Unwraps packet times of one sensor in order of arrival.
#[derive(Clone, Debug)]
pub struct Timekeeper {
    hours: HourUnwrapper,
    identifier: Identifier,
    last: Option<Stamp<Lidar>>,
}

/// Facts about a packet before its successor arrives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketFacts {
    pub start: Stamp<Lidar>,
    pub dual: bool,
    /// The model after this packet. It follows from the spacing before it, so it applies to the
    /// previous packet as well.
    pub model: Option<&'static LidarModel>,
    pub conflict: Option<ModelConflict>,
}

impl Timekeeper {
    /// Creates a timekeeper for a sensor that is decoded with `options`.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self {
            hours: HourUnwrapper::new(),
            identifier: Identifier::new(options.model),
            last: None,
        }
    }

    /// Time of a payload that arrived at `host`; `None` unless it is a valid data packet of a known
    /// model.
    ///
    /// If the factory byte is wrong, the model is known after some packets; until then it is that
    /// of the byte.
    pub fn packet(&mut self, host: Stamp<Host>, payload: &[u8]) -> Option<PacketTiming> {
        if payload.len() != DATA_LEN {
            return None;
        }
        let packet = DataPacket::new(payload).ok()?;
        let known = self.observe(host, &packet);
        let model = known.model?;
        let fill = model.packet_period_ns(known.dual);
        Some(PacketTiming {
            first_firing: known.start,
            fill: Span::from_nanos(i64::from(fill)),
            model: model.name,
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
