//! Which model a sensor is: what its factory byte says, checked against the spacing of its packets.
//!
//! Firmware before 3.0.29 has no factory bytes; VLP-16 recordings of 2014 carry 0x21 there, the HDL-32E's. Device time
//! between packets tells: each model fills a packet in its own time. A spacing that is a multiple of the named
//! model's own means lost packets, not another model. Left out: guessing from a single packet.

use core::ptr;

use protocol::vlp16::{
    DataPacket, Model,
    models::{HDL_32E, VLP_16, VLP_32C},
};
use units::Span;

use crate::stats::Conflict;

/// Stamps are whole microseconds, so spacings are off by up to one; the rest is for a clock being steered.
const TOLERANCE_NS: i64 = 3_000;
/// Longer gaps are no packet's.
const LONGEST: Span = Span::from_millis(100);
/// Multiples of the named model's spacing taken for loss; further apart, spacing tells nothing.
const MOST_LOST: i64 = 8;

/// Whether two blocks of this packet share a firing.
pub(crate) fn is_dual(packet: &DataPacket<'_>) -> bool {
    packet
        .return_mode()
        .is_dual()
        .unwrap_or_else(|| pairs_share_azimuths(packet))
}

/// For a return mode byte that is not listed: dual packets repeat every azimuth once and then move on.
fn pairs_share_azimuths(packet: &DataPacket<'_>) -> bool {
    let mut azimuths = packet.blocks().map(|block| block.azimuth_cdeg());
    let first = azimuths.clone().next();
    let mut moved = false;
    while let (Some(even), Some(odd)) = (azimuths.next(), azimuths.next()) {
        if even != odd {
            return false;
        }
        moved |= Some(even) != first;
    }
    moved
}

/// Follows the evidence for one sensor.
#[derive(Clone, Debug)]
pub(crate) struct Identifier {
    told: Option<&'static Model>,
    /// Set by spacing; holds for the named model it was set against.
    found: Option<Finding>,
}

#[derive(Clone, Copy, Debug)]
struct Finding {
    named: Option<&'static Model>,
    model: &'static Model,
}

impl Identifier {
    pub(crate) const fn new(told: Option<&'static Model>) -> Self {
        Self { told, found: None }
    }

    /// The model after this packet, `spacing` after the packet that arrived before it. `None` until anything says which.
    pub(crate) fn observe(
        &mut self,
        packet: &DataPacket<'_>,
        spacing: Option<Span>,
    ) -> (Option<&'static Model>, Option<Conflict>) {
        let named = self.told.or_else(|| Model::of(packet.product()));
        if self.found.is_some_and(|found| !same(found.named, named)) {
            self.found = None;
        }
        let mut conflict = None;
        if let Some(spacing) = spacing
            && let Some(model) = told_by(spacing, named, is_dual(packet))
            && !same(self.found.map(|found| found.model), Some(model))
        {
            conflict = Some(Conflict {
                product: packet.product(),
                told: self.told,
                spacing,
                spacing_of: model,
            });
            self.found = Some(Finding { named, model });
        }
        // What the user said stands, though it is reported.
        let model = self.told.or(self.found.map(|found| found.model)).or(named);
        (model, conflict)
    }
}

/// The model that fills a packet in `spacing`, unless the named one does, once or several times over.
fn told_by(spacing: Span, named: Option<&'static Model>, dual: bool) -> Option<&'static Model> {
    if spacing < Span::ZERO || LONGEST < spacing {
        return None;
    }
    let spacing_ns = spacing.as_nanos();
    let off_by = |model: &Model, packets: i64| {
        (spacing_ns - packets * i64::from(model.packet_period_ns(dual))).abs()
    };
    let explained =
        named.is_some_and(|named| (1..=MOST_LOST).any(|n| off_by(named, n) <= TOLERANCE_NS));
    if explained {
        return None;
    }
    [&VLP_16, &HDL_32E, &VLP_32C]
        .into_iter()
        .find(|model| off_by(model, 1) <= TOLERANCE_NS)
}

fn same(a: Option<&'static Model>, b: Option<&'static Model>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => ptr::eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use protocol::vlp16::models::PUCK_HI_RES;

    use super::*;

    fn told(us: i64, named: &'static Model, dual: bool) -> Option<&'static str> {
        told_by(Span::from_micros(us), Some(named), dual).map(|model| model.name)
    }

    #[test]
    fn a_vlp16_of_2014_is_known_by_its_spacing() {
        assert_eq!(told(1_327, &HDL_32E, false), Some("VLP-16"));
        assert_eq!(told(1_328, &HDL_32E, false), Some("VLP-16"));
        assert_eq!(told(663, &HDL_32E, true), Some("VLP-16"));
    }

    #[test]
    fn what_the_named_model_explains_is_no_conflict() {
        assert_eq!(told(1_327, &VLP_16, false), None);
        assert_eq!(told(1_328, &PUCK_HI_RES, false), None);
        assert_eq!(told(553, &HDL_32E, false), None);
        assert_eq!(told(664, &VLP_32C, false), None);
        // A VLP-32C that lost a packet is not a VLP-16.
        assert_eq!(told(1_327, &VLP_32C, false), None);
        // Nor does anything follow from arbitrary spacing.
        assert_eq!(told(155_936, &VLP_16, false), None);
        assert_eq!(told(-1_327, &VLP_16, false), None);
        assert_eq!(told(0, &VLP_16, false), None);
    }

    #[test]
    fn a_product_that_is_not_listed_is_found_by_spacing() {
        let by = |us, dual| told_by(Span::from_micros(us), None, dual).map(|model| model.name);
        assert_eq!(by(1_327, false), Some("VLP-16"));
        assert_eq!(by(553, false), Some("HDL-32E"));
        assert_eq!(by(332, true), Some("VLP-32C"));
        assert_eq!(by(1_000, false), None);
    }
}
