//! A random selection of the lidar's packets, each by its own draw, and a delay for them.

use super::settings::{InvalidSetting, SettingCheck};
use crate::effects::LinkMessage;
use crate::random::RandomSource;

/// A share of the packets, and a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PacketSelection {
    share: f64,
    delay_ns: i64,
    random: RandomSource,
}

impl PacketSelection {
    /// For an effect with the settings `share` and `later_us`.
    pub fn new(
        effect: &'static str,
        share: f64,
        later_us: f64,
        seed: u64,
    ) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(effect);
        let later_us = check.within("later_us", later_us, 0.0..=1e6)?;
        Ok(Self {
            share: check.within("share", share, 0.0..=1.0)?,
            delay_ns: (later_us * 1e3).round() as i64,
            random: RandomSource::new(seed, effect),
        })
    }

    /// Whether a message is selected. None of the drive's is.
    pub fn selects(&self, message: &LinkMessage) -> bool {
        let mut draws = self.random.at(message.number, message.kind.channel());
        message.kind.is_from_lidar() && draws.unit() < self.share
    }

    /// The message with the delay.
    pub const fn delayed(&self, message: LinkMessage) -> LinkMessage {
        LinkMessage {
            time_ns: message.time_ns.saturating_add(self.delay_ns),
            ..message
        }
    }
}
