//! Wire: some of the lidar's packets are held up and overtaken by others, as UDP allows.
//!
//! Left out: the drive, whose link keeps its order, and how far a packet is held up by chance: each by as much.

use serde::Deserialize;

use super::settings::{Settings, Stopwatch, Unfit};
use super::some_later::SomeLater;
use super::{Asked, Effect, Listed, Parcel, Wire};

/// `[effects.reorder]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ReorderSettings {
    /// Share of the packets that are held up, 0 to 1.
    pub share: f64,
    /// For how long, microseconds; 2000 unless said, which is more than from one packet of a VLP-16 to the next.
    #[serde(default = "more_than_a_packet")]
    pub later_us: f64,
}

const fn more_than_a_packet() -> f64 {
    2_000.0
}

/// A link that lets packets overtake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reorder {
    some: SomeLater,
}

impl Reorder {
    /// What the scene file calls it.
    pub const NAME: &'static str = "reorder";

    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for a share that is not within 0 and 1, or a time below 0 or above a second.
    pub fn new(settings: &ReorderSettings, seed: u64) -> Result<Self, Unfit> {
        let some = SomeLater::new(Self::NAME, settings.share, settings.later_us, seed)?;
        Ok(Self { some })
    }
}

impl Settings for ReorderSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(Reorder::new(self, seed)?);
        asked.wire.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for Reorder {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "no packet happened to be held up"
    }
}

impl Wire for Reorder {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let late = self.some.picks(&parcel);
        arrive(match late {
            true => self.some.later(parcel),
            false => parcel,
        });
        u32::from(late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParcelKind;
    use crate::effects::testing::arrivals;

    #[test]
    fn what_is_held_up_is_overtaken() {
        let settings = ReorderSettings {
            share: 0.2,
            later_us: 2_000.0,
        };
        let mut reorder = Reorder::new(&settings, 4).unwrap();
        let sent: Vec<i64> = (0..1_000).map(|number| number * 1_327_104).collect();
        let arrived = arrivals(&mut reorder, ParcelKind::Data, &sent);
        let late = (arrived.iter().zip(&sent))
            .filter(|(parcel, sent)| parcel.leaves_ns - **sent == 2_000_000)
            .count();
        assert!((late as f64 - 200.0).abs() < 4.0 * 160_f64.sqrt(), "{late}");
        assert!(!arrived.is_sorted_by_key(|parcel| parcel.leaves_ns));
        let drive = arrivals(&mut reorder, ParcelKind::Answer, &sent);
        assert!(
            drive
                .iter()
                .zip(&sent)
                .all(|(parcel, sent)| parcel.leaves_ns == *sent)
        );
    }
}
