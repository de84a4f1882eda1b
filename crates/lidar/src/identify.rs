//! Identification of the model by factory byte and packet spacing.
//!
//! Firmware before 3.0.29 has no factory bytes; VLP-16 recordings of 2014 have 0x21 there, the
//! HDL-32E's. The device time between packets identifies the model, since each model fills a packet
//! in its own time. A multiple of the named model's spacing means lost packets, not another model.

use core::ptr;

use protocol::vlp16::{
    DataPacket, LidarModel,
    models::{HDL_32E, VLP_16, VLP_32C},
};
use units::Span;

use crate::stats::ModelConflict;

/// Tolerance of spacings: stamps are whole microseconds, which allows 1 us; the rest covers a
/// steered clock.
const TOLERANCE_NS: i64 = 3_000;
/// Longest gap that is examined.
const LONGEST: Span = Span::from_millis(100);
/// Largest multiple of the named model's spacing that counts as loss.
const MAX_LOST: i64 = 8;
/// Consecutive spacings that fit another model without loss, and the named model only with loss,
/// that identify the other model. Regular loss of every second packet without a single spacing of
/// the named model is assumed not to occur.
const REGULAR_SPACINGS: u8 = 4;

/// Whether two blocks of this packet share a firing: its pulses have two returns.
#[must_use]
pub fn is_dual(packet: &DataPacket<'_>) -> bool {
    packet
        .return_mode()
        .is_dual()
        .unwrap_or_else(|| pairs_share_azimuths(packet))
}

/// For unknown return modes: dual packets repeat every azimuth once.
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

/// Identifies the model of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct Identifier {
    user_model: Option<&'static LidarModel>,
    /// Model by spacing, for the named model that it contradicts.
    by_spacing: Option<SpacingFinding>,
    /// Whether a spacing confirmed the current model.
    confirmed: bool,
    /// Model by the last spacing, if it contradicts a confirmed model.
    contradicted_by: Option<&'static LidarModel>,
    /// Model that explains the last spacings without loss, and their number.
    regular: Option<(&'static LidarModel, u8)>,
}

#[derive(Clone, Copy, Debug)]
struct SpacingFinding {
    named: Option<&'static LidarModel>,
    model: &'static LidarModel,
}

impl Identifier {
    pub(crate) const fn new(user_model: Option<&'static LidarModel>) -> Self {
        Self {
            user_model,
            by_spacing: None,
            confirmed: false,
            contradicted_by: None,
            regular: None,
        }
    }

    /// The model after this packet, which is `spacing` after the previous one; `None` while
    /// unknown.
    pub(crate) fn observe(
        &mut self,
        packet: &DataPacket<'_>,
        spacing: Option<Span>,
    ) -> (Option<&'static LidarModel>, Option<ModelConflict>) {
        let named = self.user_model.or_else(|| LidarModel::of(packet.product()));
        if self
            .by_spacing
            .is_some_and(|by_spacing| !same(by_spacing.named, named))
        {
            self.by_spacing = None;
            self.confirmed = false;
            self.regular = None;
        }
        // Models of one spacing, as VLP-16 and Hi-Res, differ in the factory byte alone. For others
        // the spacing decides: a VLP-16 of 2014 has the byte of an HDL-32E.
        let of_byte = LidarModel::of(packet.product());
        let contradicts = |requested: &LidarModel| {
            let period_ns = |model: &LidarModel| model.packet_period_ns(is_dual(packet));
            of_byte.is_some_and(|model| {
                model.name != requested.name && period_ns(model) == period_ns(requested)
            })
        };
        let requested = self.user_model.filter(|model| contradicts(model));
        let mut conflict = requested.map(|requested| ModelConflict {
            product: packet.product(),
            user_model: Some(requested),
            spacing: None,
        });
        if let Some(spacing) = spacing
            && let Some(model) = self.contradicting_model(spacing, named, is_dual(packet))
        {
            self.confirmed = false;
            self.by_spacing = if same(Some(model), named) {
                None
            } else {
                conflict = Some(ModelConflict {
                    product: packet.product(),
                    user_model: self.user_model,
                    spacing: Some((spacing, model)),
                });
                Some(SpacingFinding { named, model })
            };
        }
        // The user's choice takes precedence, with a reported conflict.
        let model = self
            .user_model
            .or(self.by_spacing.map(|by_spacing| by_spacing.model))
            .or(named);
        (model, conflict)
    }

    /// Another model than the current one, if this spacing is sufficient evidence.
    ///
    /// Without a confirmation one spacing suffices. Against a confirmed model it takes two in a
    /// row, since one may be a clock step or a gap of the field of view.
    fn contradicting_model(
        &mut self,
        spacing: Span,
        named: Option<&'static LidarModel>,
        dual: bool,
    ) -> Option<&'static LidarModel> {
        let current = self.by_spacing.map(|by_spacing| by_spacing.model).or(named);
        match evidence_of(spacing, current, named, dual, self.confirmed)? {
            SpacingEvidence::Current => {
                self.confirmed = true;
                self.contradicted_by = None;
                self.regular = None;
                None
            }
            SpacingEvidence::Lossless(model) => {
                let before = self.regular.filter(|&(before, _)| ptr::eq(before, model));
                let run = before.map_or(1, |(_, run)| run + 1);
                self.regular = Some((model, run));
                if self.confirmed || run < REGULAR_SPACINGS {
                    return None;
                }
                self.regular = None;
                Some(model)
            }
            SpacingEvidence::Other(model)
                if self.confirmed && !same(self.contradicted_by, Some(model)) =>
            {
                self.contradicted_by = Some(model);
                None
            }
            SpacingEvidence::Other(model) => {
                self.contradicted_by = None;
                Some(model)
            }
        }
    }
}

/// Evidence of a spacing for or against the current model.
#[derive(Clone, Copy, Debug)]
enum SpacingEvidence {
    /// The spacing of the current model.
    Current,
    /// The spacing of another model, and no multiple of the current one's.
    Other(&'static LidarModel),
    /// A multiple of the current model's spacing, and the spacing of another model.
    Lossless(&'static LidarModel),
}

/// Evidence of a spacing; `None` if it may be loss, a gap or a clock step.
fn evidence_of(
    spacing: Span,
    current: Option<&'static LidarModel>,
    named: Option<&'static LidarModel>,
    dual: bool,
    confirmed: bool,
) -> Option<SpacingEvidence> {
    if spacing < Span::ZERO || LONGEST < spacing {
        return None;
    }
    let spacing_ns = spacing.as_nanos();
    let fits = |model: &LidarModel, packets: i64| {
        let off_by = spacing_ns - packets * i64::from(model.packet_period_ns(dual));
        off_by.abs() <= TOLERANCE_NS
    };
    // The named model precedes others of equal timing.
    let models = named.into_iter().chain([&VLP_16, &HDL_32E, &VLP_32C]);
    if let Some(current) = current {
        if fits(current, 1) {
            return Some(SpacingEvidence::Current);
        }
        if (2..=MAX_LOST).any(|packets| fits(current, packets)) {
            let mut models = models;
            return models
                .find(|model| fits(model, 1))
                .map(SpacingEvidence::Lossless);
        }
    }
    // Packets may be missing at the start as well; fewer are more likely.
    let most = if confirmed { 1 } else { MAX_LOST };
    (1..=most).find_map(|packets| {
        let mut models = models.clone();
        models
            .find(|model| fits(model, packets))
            .map(SpacingEvidence::Other)
    })
}

fn same(a: Option<&'static LidarModel>, b: Option<&'static LidarModel>) -> bool {
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

    /// Model by the first spacing, if it contradicts the named model.
    fn contradiction(us: i64, named: &'static LidarModel, dual: bool) -> Option<&'static str> {
        match evidence_of(Span::from_micros(us), Some(named), Some(named), dual, false)? {
            SpacingEvidence::Current | SpacingEvidence::Lossless(_) => None,
            SpacingEvidence::Other(model) => Some(model.name),
        }
    }

    #[test]
    fn a_vlp16_of_2014_is_identified_by_spacing() {
        assert_eq!(contradiction(1_327, &HDL_32E, false), Some("VLP-16"));
        assert_eq!(contradiction(1_328, &HDL_32E, false), Some("VLP-16"));
        assert_eq!(contradiction(663, &HDL_32E, true), Some("VLP-16"));
    }

    #[test]
    fn spacings_of_the_named_model_are_not_a_conflict() {
        assert_eq!(contradiction(1_327, &VLP_16, false), None);
        assert_eq!(contradiction(1_328, &PUCK_HI_RES, false), None);
        assert_eq!(contradiction(553, &HDL_32E, false), None);
        assert_eq!(contradiction(664, &VLP_32C, false), None);
        // A VLP-32C that lost a packet is not a VLP-16.
        assert_eq!(contradiction(1_327, &VLP_32C, false), None);
        // Arbitrary spacings are no evidence.
        assert_eq!(contradiction(155_936, &VLP_16, false), None);
        assert_eq!(contradiction(-1_327, &VLP_16, false), None);
        assert_eq!(contradiction(0, &VLP_16, false), None);
    }

    #[test]
    fn unknown_products_are_identified_by_spacing() {
        let by = |us, dual| match evidence_of(Span::from_micros(us), None, None, dual, false)? {
            SpacingEvidence::Current | SpacingEvidence::Lossless(_) => None,
            SpacingEvidence::Other(model) => Some(model.name),
        };
        assert_eq!(by(1_327, false), Some("VLP-16"));
        assert_eq!(by(553, false), Some("HDL-32E"));
        assert_eq!(by(276, true), Some("HDL-32E"));
        assert_eq!(by(332, true), Some("VLP-32C"));
        assert_eq!(by(1_000, false), None);
        // A packet is lost before the second one.
        assert_eq!(by(1_106, false), Some("HDL-32E"));
        assert_eq!(by(2_654, false), Some("VLP-16"));
    }

    #[test]
    fn models_are_distinguished_at_any_rounding() {
        let modes = [false, true];
        for (real, dual) in [&VLP_16, &HDL_32E, &VLP_32C]
            .into_iter()
            .flat_map(|m| modes.map(|d| (m, d)))
        {
            let period_ns = i64::from(real.packet_period_ns(dual));
            for first_ns in 0..1_000 {
                // Both stamps are truncated to microseconds.
                let us = (first_ns + period_ns) / 1_000;
                for named in [&VLP_16, &PUCK_HI_RES, &HDL_32E, &VLP_32C] {
                    let timing = |model: &LidarModel| model.packet_period_ns(dual);
                    let is_multiple = timing(real).is_multiple_of(timing(named));
                    // Only a VLP-32C that loses every second packet resembles a VLP-16.
                    assert!(
                        !is_multiple || timing(real) == timing(named) || named.name == "VLP-32C"
                    );
                    let expected = (!is_multiple).then_some(real.name);
                    assert_eq!(
                        contradiction(us, named, dual),
                        expected,
                        "{us} us, {}",
                        named.name
                    );
                }
            }
        }
    }

    /// An empty packet of a product and mode.
    fn bytes(mode: u8, product: u8) -> [u8; 1_206] {
        let mut bytes = [0; 1_206];
        for block in bytes.chunks_mut(100).take(12) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
        }
        bytes[1_204..].copy_from_slice(&[mode, product]);
        bytes
    }

    /// The models after packets at these spacings, and the number of conflicts.
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
    fn loss_at_the_start_is_corrected() {
        let named_hdl = follow(0x21, &[2_654, 1_327, 1_328]);
        assert_eq!(
            named_hdl,
            (vec!["HDL-32E", "VLP-16", "VLP-16", "VLP-16"], 1)
        );
        let named_vlp = follow(0x22, &[2_654, 1_327, 1_328]);
        assert_eq!(named_vlp, (vec!["VLP-16"; 4], 0));
        let not_named = follow(0x99, &[1_659, 553, 553]);
        assert_eq!(not_named, (vec!["?", "HDL-32E", "HDL-32E", "HDL-32E"], 1));
        // Two periods of a VLP-32C are one of a VLP-16; the third packet decides.
        let not_named = follow(0x99, &[1_327, 664, 663, 664]);
        assert_eq!(
            not_named,
            (vec!["?", "VLP-16", "VLP-32C", "VLP-32C", "VLP-32C"], 2)
        );
    }

    #[test]
    fn regular_spacings_identify_a_vlp16_named_vlp32c() {
        let (models, conflicts) = follow(0x28, &[1_327, 1_327, 1_328, 1_327, 1_327]);
        assert_eq!(models[..4], ["VLP-32C"; 4]);
        assert_eq!((&models[4..], conflicts), (&["VLP-16"; 2][..], 1));
        // One packet at the named model's spacing confirms it.
        let (models, conflicts) = follow(0x28, &[664, 1_327, 1_327, 1_328, 1_327, 1_327]);
        assert_eq!((models, conflicts), (vec!["VLP-32C"; 7], 0));
        // Irregular loss is no evidence.
        let (models, _) = follow(0x28, &[1_327, 1_991, 1_327, 1_327, 664, 664]);
        assert_eq!(models, vec!["VLP-32C"; 7]);
    }

    #[test]
    fn single_spacings_change_nothing() {
        // A clock step or a gap of a limited field of view may resemble another model once.
        let chance = follow(0x22, &[1_327, 1_327, 553, 1_327, 1_328, 664, 553, 1_327]);
        assert_eq!(chance, (vec!["VLP-16"; 9], 0));
        let hdl = follow(0x21, &[553, 1_327, 553, 553]);
        assert_eq!(hdl, (vec!["HDL-32E"; 5], 0));
    }

    #[test]
    fn a_wrong_first_spacing_is_corrected() {
        // The first spacing resembles another model; the next ones are the named model's.
        let (models, conflicts) = follow(0x21, &[1_327, 553, 553, 553]);
        assert_eq!(
            models,
            ["HDL-32E", "VLP-16", "HDL-32E", "HDL-32E", "HDL-32E"]
        );
        assert_eq!(conflicts, 1);
    }

    #[test]
    fn a_replaced_sensor_is_identified() {
        let (models, _) = follow(0x99, &[1_327, 1_327, 553, 553, 553]);
        assert_eq!(models[4..], ["HDL-32E"; 2]);
    }
}
