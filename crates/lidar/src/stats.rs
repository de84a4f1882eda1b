//! Statistics of a decoder.

use core::fmt;

use protocol::vlp16::{LidarModel, PacketError, Pps, Product, ReturnMode};
use units::Span;

/// Statistics of all payloads so far; firings and returns are those of emitted packets.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Stats {
    /// Valid data packets, emitted or not.
    pub data: u64,
    /// Position packets.
    pub position: u64,
    /// Payloads with the flag or length of a data packet that are invalid.
    pub malformed: u64,
    /// Error of the first malformed payload.
    pub first_malformed: Option<PacketError>,
    /// Other payloads.
    pub other: u64,
    /// Data packets of an unidentified model; not emitted.
    pub unidentified: u64,
    /// Data packets equal to the previous one; not emitted.
    pub duplicates: u64,
    /// Data packets that arrived after their successor and were reordered.
    pub reordered: u64,
    /// Data packets that arrived after their successor was emitted; skipped, so that time never
    /// decreases.
    pub late: u64,
    /// Steps of the device's clock: backwards, or forwards against the host's clock. No packets
    /// count as lost there.
    pub clock_steps: u64,
    /// Data packets missing, by device time.
    pub lost_packets: u64,
    /// Places of missing packets: the first [`Stats::MAX_GAPS`] of them.
    pub gaps: Vec<PacketGap>,
    /// Emitted firings of all lasers.
    pub firings: u64,
    /// Returns in the emitted packets.
    pub returns: u64,
    /// Returns with equal dual pairs counted once.
    pub unique_returns: u64,
    /// The decoded model.
    pub model: Option<&'static LidarModel>,
    /// The last product byte.
    pub product: Option<Product>,
    /// The last return mode.
    pub return_mode: Option<ReturnMode>,
    /// The last state of the pulse-per-second input.
    pub pps: Option<Pps>,
    /// Mean speed in revolutions per minute while firing.
    pub rpm: Option<f64>,
    /// Device time from the first firing to the end of the last packet, without clock steps.
    pub duration: Span,
    /// Contradictions about the model, each kind once.
    pub conflicts: Vec<ModelConflict>,
    /// Number of lasers in the corrections, if it differs from the model's: no correction was
    /// applied.
    pub corrections_refused: Option<usize>,
}

/// A place in a recording at which packets are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PacketGap {
    /// Device time from the first firing to the gap, without clock steps.
    pub at: Span,
    /// Missing packets.
    pub packets: u64,
}

/// Contradiction between the factory byte, the packet spacing and the user's model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelConflict {
    /// Product by the factory byte.
    pub product: Product,
    /// The user's model, which takes precedence.
    pub user_model: Option<&'static LidarModel>,
    /// Device time between two packets and the model with that period, if it contradicts.
    pub spacing: Option<(Span, &'static LidarModel)>,
}

impl Stats {
    /// Gaps that are kept.
    pub const MAX_GAPS: usize = 100;

    /// Counts packets that are missing after the packet that ends at `at`.
    pub(crate) fn add_lost(&mut self, at: Span, packets: u64) {
        self.lost_packets = self.lost_packets.saturating_add(packets);
        if packets > 0 && self.gaps.len() < Self::MAX_GAPS {
            self.gaps.push(PacketGap { at, packets });
        }
    }

    /// Corrects the count after a packet that arrived behind its successor: `lost` packets were
    /// missing then, at the first `gaps` places.
    pub(crate) fn take_back_lost(&mut self, lost: u64, gaps: usize) {
        self.lost_packets = lost.saturating_sub(1);
        self.gaps.truncate(gaps);
        // With more gaps than are kept, the last one kept may not be the one to correct.
        let kept: u64 = self.gaps.iter().map(|gap| gap.packets).sum();
        if kept > self.lost_packets
            && let Some(last) = self.gaps.last_mut()
        {
            last.packets -= 1;
            self.gaps.retain(|gap| gap.packets > 0);
        }
    }

    /// Keeps each kind once. A spacing replaces the same contradiction without one.
    pub(crate) fn report(&mut self, conflict: ModelConflict) {
        let of_product = |known: &&mut ModelConflict| known.product == conflict.product;
        let mut known = self.conflicts.iter_mut().filter(of_product);
        let model = |conflict: &ModelConflict| conflict.spacing.map(|(_, model)| model);
        match known.find(|known| {
            known.spacing.is_none()
                || conflict.spacing.is_none()
                || model(known) == model(&conflict)
        }) {
            Some(known) if known.spacing.is_none() => *known = conflict,
            Some(_) => {}
            None => self.conflicts.push(conflict),
        }
    }
}

impl fmt::Display for ModelConflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match LidarModel::of(self.product) {
            Some(named) => write!(f, "the packets' factory byte says {}", named.name)?,
            None => {
                let byte = self.product.to_u8();
                write!(f, "the packets' factory byte 0x{byte:02X} is not known")?;
            }
        }
        let spacing_of = self.spacing.map(|(spacing, model)| {
            let spacing_us = spacing.as_micros_f64();
            write!(
                f,
                ", their spacing of {spacing_us:.0} us says {}",
                model.name
            )
            .map(|()| model)
        });
        let spacing_of = spacing_of.transpose()?;
        match (self.user_model, spacing_of) {
            (Some(model), _) => write!(f, "; decoded as {} as asked", model.name),
            (None, Some(model)) => write!(f, "; decoded as {}", model.name),
            (None, None) => Ok(()),
        }
    }
}
