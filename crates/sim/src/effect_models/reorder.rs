//! Link: some of the lidar's packets are delayed and overtaken, as UDP allows. The drive's link
//! keeps its order.

use crate::effects::{LinkEffect, LinkMessage};
use serde::Deserialize;

use super::selection::PacketSelection;
use super::settings::InvalidSetting;

/// `[effects.reorder]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ReorderSettings {
    /// Share of delayed packets, 0 to 1.
    pub share: f64,
    /// Their delay, microseconds; default 2000, more than the period of a VLP-16's packets.
    #[serde(default = "more_than_a_packet")]
    pub later_us: f64,
}

const fn more_than_a_packet() -> f64 {
    2_000.0
}

/// A link that reorders packets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reorder(PacketSelection);

impl Reorder {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a share outside 0 to 1 or a delay outside 0 to 1 s.
    pub fn new(settings: &ReorderSettings, seed: u64) -> Result<Self, InvalidSetting> {
        PacketSelection::new(Self::NAME, settings.share, settings.later_us, seed).map(Self)
    }
}

effect! {
    Reorder, ReorderSettings, link: Box, "reorder",
    idle: "no packet happened to be held up",
    new: Reorder::new
}

impl LinkEffect for Reorder {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        let late = self.0.selects(&message);
        arrive(match late {
            true => self.0.delayed(message),
            false => message,
        });
        u32::from(late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::arrivals;
    use crate::effects::MessageKind;

    #[test]
    fn delayed_packets_are_overtaken() {
        let settings = ReorderSettings {
            share: 0.2,
            later_us: 2_000.0,
        };
        let mut reorder = Reorder::new(&settings, 4).unwrap();
        let sent: Vec<i64> = (0..1_000).map(|number| number * 1_327_104).collect();
        let arrived = arrivals(&mut reorder, MessageKind::Data, &sent);
        let late = (arrived.iter().zip(&sent))
            .filter(|(message, sent)| message.time_ns - **sent == 2_000_000)
            .count();
        assert!((late as f64 - 200.0).abs() < 4.0 * 160_f64.sqrt(), "{late}");
        assert!(!arrived.is_sorted_by_key(|message| message.time_ns));
        let drive = arrivals(&mut reorder, MessageKind::Answer, &sent);
        assert!(
            drive
                .iter()
                .zip(&sent)
                .all(|(message, sent)| message.time_ns == *sent)
        );
    }
}
