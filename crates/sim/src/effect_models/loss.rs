//! Link: independent losses of packets, requests and answers. Bursts are not included.

use crate::effects::{LinkEffect, LinkMessage};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::random::RandomSource;

/// `[effects.loss]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct LossSettings {
    /// Share of lost lidar packets, 0 to 1.
    pub lidar_share: f64,
    /// Share of lost requests and of lost answers of the drive, 0 to 1.
    pub drive_share: f64,
}

/// A link with losses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    settings: LossSettings,
    random: RandomSource,
}

impl Loss {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a share outside 0 to 1.
    pub fn new(settings: &LossSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        check.within("lidar_share", settings.lidar_share, 0.0..=1.0)?;
        check.within("drive_share", settings.drive_share, 0.0..=1.0)?;
        Ok(Self {
            settings: *settings,
            random: RandomSource::new(seed, Self::NAME),
        })
    }
}

effect! {
    Loss, LossSettings, link: Box, "loss",
    idle: "nothing happened to be lost",
    new: Loss::new
}

impl LinkEffect for Loss {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        let share = match message.kind.is_from_lidar() {
            true => self.settings.lidar_share,
            false => self.settings.drive_share,
        };
        let lost = self
            .random
            .at(message.number, message.kind.channel())
            .unit()
            < share;
        if !lost {
            arrive(message);
        }
        u32::from(lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::arrivals;
    use crate::effects::MessageKind;

    #[test]
    fn the_requested_share_is_lost_on_either_link() {
        let settings = LossSettings {
            lidar_share: 0.1,
            drive_share: 1.0,
        };
        let mut loss = Loss::new(&settings, 9).unwrap();
        let arrived = arrivals(&mut loss, MessageKind::Data, &[7; 10_000]);
        let off = arrived.len() as f64 - 9_000.0;
        assert!(off.abs() < 4.0 * (10_000.0 * 0.09_f64).sqrt(), "{off}");
        assert!(arrived.iter().all(|message| message.time_ns == 7));
        assert!(arrivals(&mut loss, MessageKind::Answer, &[7; 100]).is_empty());
        let wrong = LossSettings {
            lidar_share: 1.1,
            ..settings
        };
        assert!(Loss::new(&wrong, 9).is_err());
    }
}
