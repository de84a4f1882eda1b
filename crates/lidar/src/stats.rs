//! What a decoder saw, for people and for `info`.
//!
//! Counts only; what they mean for a scan is left to the reader.

use core::fmt;

use protocol::vlp16::{Model, PacketError, Pps, Product, ReturnMode};
use units::Span;

/// Counts over everything that a decoder was given, up to the last packet it emitted.
#[derive(Clone, Debug, Default)]
pub struct Stats {
    /// Sound data packets, those not emitted included.
    pub data: u64,
    /// Position packets.
    pub position: u64,
    /// Payloads that begin or measure as a data packet and are not one.
    pub malformed: u64,
    /// What was wrong with the first of those.
    pub first_malformed: Option<PacketError>,
    /// Payloads of anything else.
    pub other: u64,
    /// Data packets of a model that neither factory byte nor spacing tells; not emitted.
    pub unidentified: u64,
    /// Data packets that repeated the one before them, byte for byte; not emitted twice.
    pub duplicates: u64,
    /// Data packets that arrived after their successor and were put back in order.
    pub reordered: u64,
    /// Data packets that arrived after their successor had been emitted; left out, so that time
    /// never runs backwards.
    pub late: u64,
    /// Times that the device's clock was set: forwards against the host's, or backwards. Nothing is
    /// counted lost there.
    pub clock_steps: u64,
    /// Data packets missing, by device time.
    pub lost_packets: u64,
    /// Firings emitted, each of all lasers.
    pub firings: u64,
    /// FiringChannels with a distance in the packets emitted.
    pub returns: u64,
    /// The same with the two returns of a dual pair counted once where their distances are equal.
    pub unique_returns: u64,
    /// What the packets were decoded as.
    pub model: Option<&'static Model>,
    /// The last product byte seen.
    pub product: Option<Product>,
    /// The last return mode byte seen.
    pub return_mode: Option<ReturnMode>,
    /// The last state of the pulse-per-second input.
    pub pps: Option<Pps>,
    /// Mean speed of the rotor in revolutions per minute, over the time in which it fired.
    pub rpm: Option<f64>,
    /// Device time from the first firing to the end of the last packet; clock steps left out.
    pub duration: Span,
    /// Where sources of the model disagreed, each kind once.
    pub conflicts: Vec<Conflict>,
    /// How many lasers the corrections asked for have, where the model has another number of them:
    /// then none was applied.
    pub corrections_refused: Option<usize>,
}

/// The factory byte, or the user, says one model and the packets' spacing another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conflict {
    /// What the factory byte says.
    pub product: Product,
    /// What the user says, which then stands.
    pub told: Option<&'static Model>,
    /// Device time between the two packets that disagree.
    pub spacing: Span,
    /// The model that fills a packet in that time.
    pub spacing_of: &'static Model,
}

impl Stats {
    pub(crate) fn report(&mut self, conflict: Conflict) {
        let known = self
            .conflicts
            .iter()
            .any(|c| c.product == conflict.product && c.spacing_of == conflict.spacing_of);
        if !known {
            self.conflicts.push(conflict);
        }
    }
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Model::of(self.product) {
            Some(named) => write!(f, "the packets' factory byte says {}", named.name)?,
            None => {
                let byte = self.product.to_u8();
                write!(f, "the packets' factory byte 0x{byte:02X} is not known")?;
            }
        }
        write!(
            f,
            ", their spacing of {:.0} us says {}; decoded as {}",
            self.spacing.as_micros_f64(),
            self.spacing_of.name,
            self.told.unwrap_or(self.spacing_of).name
        )?;
        if self.told.is_some() {
            write!(f, " as asked")?;
        }
        Ok(())
    }
}
