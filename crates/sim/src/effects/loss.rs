//! Wire: packets, requests and answers that never arrive, each by itself.
//!
//! Left out: losses in bursts.

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Effect, Listed, Parcel, Wire};
use crate::random::Source;

/// `[effects.loss]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct LossSettings {
    /// Share of the lidar's packets, 0 to 1.
    pub lidar_share: f64,
    /// Share of the drive's requests, and of its answers, 0 to 1.
    pub drive_share: f64,
}

/// A link that loses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    settings: LossSettings,
    random: Source,
}

impl Loss {
    /// What the scene file calls it.
    pub const NAME: &'static str = "loss";

    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for a share that is not within 0 and 1.
    pub fn new(settings: &LossSettings, seed: u64) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        check.within("lidar_share", settings.lidar_share, 0.0..=1.0)?;
        check.within("drive_share", settings.drive_share, 0.0..=1.0)?;
        Ok(Self {
            settings: *settings,
            random: Source::new(seed, Self::NAME),
        })
    }
}

impl Settings for LossSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(Loss::new(self, seed)?);
        asked.wire.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for Loss {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "nothing happened to be lost"
    }
}

impl Wire for Loss {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let share = match parcel.kind.is_lidars() {
            true => self.settings.lidar_share,
            false => self.settings.drive_share,
        };
        let lost = self.random.at(parcel.number, parcel.kind.channel()).unit() < share;
        if !lost {
            arrive(parcel);
        }
        u32::from(lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParcelKind;
    use crate::effects::testing::arrivals;

    #[test]
    fn as_many_as_asked_are_lost_on_either_link() {
        let settings = LossSettings {
            lidar_share: 0.1,
            drive_share: 1.0,
        };
        let mut loss = Loss::new(&settings, 9).unwrap();
        let arrived = arrivals(&mut loss, ParcelKind::Data, &[7; 10_000]);
        let off = arrived.len() as f64 - 9_000.0;
        assert!(off.abs() < 4.0 * (10_000.0 * 0.09_f64).sqrt(), "{off}");
        assert!(arrived.iter().all(|parcel| parcel.leaves_ns == 7));
        assert!(arrivals(&mut loss, ParcelKind::Answer, &[7; 100]).is_empty());
        let wrong = LossSettings {
            lidar_share: 1.1,
            ..settings
        };
        assert!(Loss::new(&wrong, 9).is_err());
    }
}
