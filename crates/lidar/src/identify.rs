//! Which model a sensor is: what its factory byte says, checked against the spacing of its packets.
//!
//! Firmware before 3.0.29 has no factory bytes; VLP-16 recordings of 2014 carry 0x21 there, the
//! HDL-32E's. Device time between packets tells: each model fills a packet in its own time. A
//! spacing that is a multiple of the named model's own means lost packets, not another model. Left
//! out: guessing from a single packet.

use core::ptr;

use protocol::vlp16::{
    DataPacket, Model,
    models::{HDL_32E, VLP_16, VLP_32C},
};
use units::Span;

use crate::stats::Conflict;

/// Stamps are whole microseconds, so spacings are off by up to one; the rest is for a clock being
/// steered.
const TOLERANCE_NS: i64 = 3_000;
/// Longer gaps are no packet's.
const LONGEST: Span = Span::from_millis(100);
/// Multiples of the named model's spacing taken for loss; further apart, spacing tells nothing.
const MOST_LOST: i64 = 8;
/// So many spacings in a row that loss would explain, and another model without any, are the other
/// model's: where the named model's own has never been seen, nobody loses every second packet and
/// none besides.
const TOO_REGULAR: u8 = 4;

/// Whether two blocks of this packet share a firing.
pub(crate) fn is_dual(packet: &DataPacket<'_>) -> bool {
    packet
        .return_mode()
        .is_dual()
        .unwrap_or_else(|| pairs_share_azimuths(packet))
}

/// For a return mode byte that is not listed: dual packets repeat every azimuth once and then move
/// on.
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
    found: Option<SpacingFinding>,
    /// Whether a spacing was exactly that of the model that holds.
    confirmed: bool,
    /// What the last spacing said against a confirmed model.
    doubt: Option<&'static Model>,
    /// The model that would explain the last spacings without loss, and how many they are.
    regular: Option<(&'static Model, u8)>,
}

#[derive(Clone, Copy, Debug)]
struct SpacingFinding {
    named: Option<&'static Model>,
    model: &'static Model,
}

impl Identifier {
    pub(crate) const fn new(told: Option<&'static Model>) -> Self {
        Self {
            told,
            found: None,
            confirmed: false,
            doubt: None,
            regular: None,
        }
    }

    /// The model after this packet, `spacing` after the packet that arrived before it. `None` until
    /// anything says which.
    pub(crate) fn observe(
        &mut self,
        packet: &DataPacket<'_>,
        spacing: Option<Span>,
    ) -> (Option<&'static Model>, Option<Conflict>) {
        let named = self.told.or_else(|| Model::of(packet.product()));
        if self.found.is_some_and(|found| !same(found.named, named)) {
            self.found = None;
            self.confirmed = false;
            self.regular = None;
        }
        let mut conflict = None;
        if let Some(spacing) = spacing
            && let Some(model) = self.weigh(spacing, named, is_dual(packet))
        {
            self.confirmed = false;
            self.found = if same(Some(model), named) {
                None
            } else {
                conflict = Some(Conflict {
                    product: packet.product(),
                    told: self.told,
                    spacing,
                    spacing_of: model,
                });
                Some(SpacingFinding { named, model })
            };
        }
        // What the user said stands, though it is reported.
        let model = self.told.or(self.found.map(|found| found.model)).or(named);
        (model, conflict)
    }

    /// Another model than the one that holds, if this spacing is reason enough.
    ///
    /// At first one spacing is: no packet before it had the time to say anything else. Against a
    /// model that spacings have confirmed it takes two in a row: one can be chance, where a clock
    /// was set or the sensor looked away.
    fn weigh(
        &mut self,
        spacing: Span,
        named: Option<&'static Model>,
        dual: bool,
    ) -> Option<&'static Model> {
        let holds = self.found.map(|found| found.model).or(named);
        match told_by(spacing, holds, named, dual, self.confirmed)? {
            SpacingEvidence::Holds => {
                self.confirmed = true;
                self.doubt = None;
                self.regular = None;
                None
            }
            SpacingEvidence::Lossless(model) => {
                let before = self.regular.filter(|&(before, _)| ptr::eq(before, model));
                let run = before.map_or(1, |(_, run)| run + 1);
                self.regular = Some((model, run));
                if self.confirmed || run < TOO_REGULAR {
                    return None;
                }
                self.regular = None;
                Some(model)
            }
            SpacingEvidence::Other(model) if self.confirmed && !same(self.doubt, Some(model)) => {
                self.doubt = Some(model);
                None
            }
            SpacingEvidence::Other(model) => {
                self.doubt = None;
                Some(model)
            }
        }
    }
}

/// What a spacing says of the model that holds.
#[derive(Clone, Copy, Debug)]
enum SpacingEvidence {
    /// It is exactly its spacing.
    Holds,
    /// It is another's, and no multiple of its own.
    Other(&'static Model),
    /// It is a multiple of its own, and another's as it is.
    Lossless(&'static Model),
}

/// Whose spacing this is. `None` for what any loss, gap or setting of the clock could be.
fn told_by(
    spacing: Span,
    holds: Option<&'static Model>,
    named: Option<&'static Model>,
    dual: bool,
    confirmed: bool,
) -> Option<SpacingEvidence> {
    if spacing < Span::ZERO || LONGEST < spacing {
        return None;
    }
    let spacing_ns = spacing.as_nanos();
    let is = |model: &Model, packets: i64| {
        let off_by = spacing_ns - packets * i64::from(model.packet_period_ns(dual));
        off_by.abs() <= TOLERANCE_NS
    };
    // The named model goes before others of its timing.
    let models = named.into_iter().chain([&VLP_16, &HDL_32E, &VLP_32C]);
    if let Some(holds) = holds {
        if is(holds, 1) {
            return Some(SpacingEvidence::Holds);
        }
        if (2..=MOST_LOST).any(|packets| is(holds, packets)) {
            let mut models = models;
            return models
                .find(|model| is(model, 1))
                .map(SpacingEvidence::Lossless);
        }
    }
    // Packets may be missing right at the start as well; fewer are likelier than more.
    let most = if confirmed { 1 } else { MOST_LOST };
    (1..=most).find_map(|packets| {
        let mut models = models.clone();
        models
            .find(|model| is(model, packets))
            .map(SpacingEvidence::Other)
    })
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

    /// What the very first spacing says against the named model.
    fn told(us: i64, named: &'static Model, dual: bool) -> Option<&'static str> {
        match told_by(Span::from_micros(us), Some(named), Some(named), dual, false)? {
            SpacingEvidence::Holds | SpacingEvidence::Lossless(_) => None,
            SpacingEvidence::Other(model) => Some(model.name),
        }
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
        let by = |us, dual| match told_by(Span::from_micros(us), None, None, dual, false)? {
            SpacingEvidence::Holds | SpacingEvidence::Lossless(_) => None,
            SpacingEvidence::Other(model) => Some(model.name),
        };
        assert_eq!(by(1_327, false), Some("VLP-16"));
        assert_eq!(by(553, false), Some("HDL-32E"));
        assert_eq!(by(276, true), Some("HDL-32E"));
        assert_eq!(by(332, true), Some("VLP-32C"));
        assert_eq!(by(1_000, false), None);
        // A packet lost before the second arrived.
        assert_eq!(by(1_106, false), Some("HDL-32E"));
        assert_eq!(by(2_654, false), Some("VLP-16"));
    }

    #[test]
    fn each_model_is_told_from_each_other_at_any_rounding_of_the_stamps() {
        let modes = [false, true];
        for (real, dual) in [&VLP_16, &HDL_32E, &VLP_32C]
            .into_iter()
            .flat_map(|m| modes.map(|d| (m, d)))
        {
            let period_ns = i64::from(real.packet_period_ns(dual));
            for first_ns in 0..1_000 {
                // Both stamps are cut to whole microseconds.
                let us = (first_ns + period_ns) / 1_000;
                for named in [&VLP_16, &PUCK_HI_RES, &HDL_32E, &VLP_32C] {
                    let timing = |model: &Model| model.packet_period_ns(dual);
                    let is_multiple = timing(real).is_multiple_of(timing(named));
                    // A VLP-32C that loses every second packet is all that a VLP-16 can be taken
                    // for.
                    assert!(
                        !is_multiple || timing(real) == timing(named) || named.name == "VLP-32C"
                    );
                    let expected = (!is_multiple).then_some(real.name);
                    assert_eq!(told(us, named, dual), expected, "{us} us, {}", named.name);
                }
            }
        }
    }

    /// A packet of this product and mode with nothing in it.
    fn bytes(mode: u8, product: u8) -> [u8; 1_206] {
        let mut bytes = [0; 1_206];
        for block in bytes.chunks_mut(100).take(12) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
        }
        bytes[1_204..].copy_from_slice(&[mode, product]);
        bytes
    }

    /// The models that hold after packets that follow each other at these spacings, and how many
    /// conflicts were reported.
    fn follow(product: u8, spacings_us: &[i64]) -> (Vec<&'static str>, usize) {
        let bytes = bytes(0x37, product);
        let packet = DataPacket::new(&bytes).unwrap();
        let mut identifier = Identifier::new(None);
        let mut conflicts = 0;
        let first = [None].into_iter();
        let spacings = first.chain(spacings_us.iter().map(|&us| Some(Span::from_micros(us))));
        let models = spacings.map(|spacing| {
            let (model, conflict) = identifier.observe(&packet, spacing);
            conflicts += usize::from(conflict.is_some());
            model.map_or("?", |model| model.name)
        });
        (models.collect(), conflicts)
    }

    #[test]
    fn loss_at_the_start_does_not_mislead() {
        let named_hdl = follow(0x21, &[2_654, 1_327, 1_328]);
        assert_eq!(
            named_hdl,
            (vec!["HDL-32E", "VLP-16", "VLP-16", "VLP-16"], 1)
        );
        let named_vlp = follow(0x22, &[2_654, 1_327, 1_328]);
        assert_eq!(named_vlp, (vec!["VLP-16"; 4], 0));
        let not_named = follow(0x99, &[1_659, 553, 553]);
        assert_eq!(not_named, (vec!["?", "HDL-32E", "HDL-32E", "HDL-32E"], 1));
        // Two packets of a VLP-32C are one of a VLP-16; the third packet tells.
        let not_named = follow(0x99, &[1_327, 664, 663, 664]);
        assert_eq!(
            not_named,
            (vec!["?", "VLP-16", "VLP-32C", "VLP-32C", "VLP-32C"], 2)
        );
    }

    #[test]
    fn a_vlp16_that_says_vlp32c_is_no_vlp32c_that_loses_every_second_packet() {
        let (models, conflicts) = follow(0x28, &[1_327, 1_327, 1_328, 1_327, 1_327]);
        assert_eq!(models[..4], ["VLP-32C"; 4]);
        assert_eq!((&models[4..], conflicts), (&["VLP-16"; 2][..], 1));
        // One packet that follows at its own pace is enough to be what it says.
        let (models, conflicts) = follow(0x28, &[664, 1_327, 1_327, 1_328, 1_327, 1_327]);
        assert_eq!((models, conflicts), (vec!["VLP-32C"; 7], 0));
        // Nor is what lost packets now and then.
        let (models, _) = follow(0x28, &[1_327, 1_991, 1_327, 1_327, 664, 664]);
        assert_eq!(models, vec!["VLP-32C"; 7]);
    }

    #[test]
    fn one_spacing_by_chance_changes_nothing() {
        // A clock that was set, or a gap of a limited field of view, may look like another model's
        // packet once.
        let chance = follow(0x22, &[1_327, 1_327, 553, 1_327, 1_328, 664, 553, 1_327]);
        assert_eq!(chance, (vec!["VLP-16"; 9], 0));
        let hdl = follow(0x21, &[553, 1_327, 553, 553]);
        assert_eq!(hdl, (vec!["HDL-32E"; 5], 0));
    }

    #[test]
    fn a_first_spacing_that_misled_is_taken_back() {
        // The first spacing by chance another's; the named model's own two times over.
        let (models, conflicts) = follow(0x21, &[1_327, 553, 553, 553]);
        assert_eq!(
            models,
            ["HDL-32E", "VLP-16", "HDL-32E", "HDL-32E", "HDL-32E"]
        );
        assert_eq!(conflicts, 1);
    }

    #[test]
    fn a_sensor_swapped_for_another_is_followed() {
        let (models, _) = follow(0x99, &[1_327, 1_327, 553, 553, 553]);
        assert_eq!(models[4..], ["HDL-32E"; 2]);
    }
}
