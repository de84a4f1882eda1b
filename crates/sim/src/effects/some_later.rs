//! What wires share that treat some of the lidar's packets by chance: which packets, each by its own draw, and how much later those come.
//!
//! Left out: what comes later, the packet itself or another copy of it.

use super::Parcel;
use super::settings::{Check, Unfit};
use crate::random::Source;

/// A share of the packets, and a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SomeLater {
    share: f64,
    later_ns: i64,
    random: Source,
}

impl SomeLater {
    /// For an effect, by the settings `share` and `later_us` of it.
    pub fn new(effect: &'static str, share: f64, later_us: f64, seed: u64) -> Result<Self, Unfit> {
        let check = Check(effect);
        let later_us = check.within("later_us", later_us, 0.0..=1e6)?;
        Ok(Self {
            share: check.within("share", share, 0.0..=1.0)?,
            later_ns: (later_us * 1e3).round() as i64,
            random: Source::new(seed, effect),
        })
    }

    /// Whether a parcel is one of them. None of the drive's is.
    pub fn picks(&self, parcel: &Parcel) -> bool {
        let mut draws = self.random.at(parcel.number, parcel.kind.channel());
        parcel.kind.is_lidars() && draws.unit() < self.share
    }

    /// A parcel, so much later.
    pub const fn later(&self, parcel: Parcel) -> Parcel {
        Parcel {
            leaves_ns: parcel.leaves_ns.saturating_add(self.later_ns),
            ..parcel
        }
    }
}
