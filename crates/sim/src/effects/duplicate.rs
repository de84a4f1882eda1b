//! Wire: some of the lidar's packets arrive twice, as behind a switch that mirrors a port.
//!
//! Left out: the drive, whose link does not, and more than two of one packet.

use serde::Deserialize;

use super::settings::{Settings, Stopwatch, Unfit};
use super::some_later::SomeLater;
use super::{Asked, Effect, Listed, Parcel, Wire};

/// `[effects.duplicate]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct DuplicateSettings {
    /// Share of the packets, 0 to 1.
    pub share: f64,
    /// How much later the second comes, microseconds; 20 unless said.
    #[serde(default = "at_once")]
    pub later_us: f64,
}

const fn at_once() -> f64 {
    20.0
}

/// A link that says things twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duplicate {
    some: SomeLater,
}

impl Duplicate {
    /// What the scene file calls it.
    pub const NAME: &'static str = "duplicate";

    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for a share that is not within 0 and 1, or a time below 0 or above a second.
    pub fn new(settings: &DuplicateSettings, seed: u64) -> Result<Self, Unfit> {
        let some = SomeLater::new(Self::NAME, settings.share, settings.later_us, seed)?;
        Ok(Self { some })
    }
}

impl Settings for DuplicateSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(Duplicate::new(self, seed)?);
        asked.wire.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for Duplicate {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "no packet happened to come twice"
    }
}

impl Wire for Duplicate {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        arrive(parcel);
        let twice = self.some.picks(&parcel);
        if twice {
            arrive(self.some.later(parcel));
        }
        u32::from(twice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParcelKind;
    use crate::effects::testing::arrivals;

    #[test]
    fn some_come_twice() {
        let settings = DuplicateSettings {
            share: 0.5,
            later_us: 20.0,
        };
        let mut duplicate = Duplicate::new(&settings, 4).unwrap();
        let arrived = arrivals(&mut duplicate, ParcelKind::Position, &[100; 1_000]);
        let seconds = arrived
            .iter()
            .filter(|parcel| parcel.leaves_ns == 20_100)
            .count();
        assert_eq!(arrived.len() - seconds, 1_000);
        assert!((seconds as f64 - 500.0).abs() < 4.0 * 250_f64.sqrt());
        assert_eq!(
            arrivals(&mut duplicate, ParcelKind::Request, &[0; 50]).len(),
            50
        );
    }
}
