//! Link: some of the lidar's packets arrive twice, as behind a switch with a mirrored port. The
//! drive's link is not affected.

use crate::effects::{LinkEffect, LinkMessage};
use serde::Deserialize;

use super::selection::PacketSelection;
use super::settings::InvalidSetting;

/// `[effects.duplicate]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct DuplicateSettings {
    /// Share of the packets, 0 to 1.
    pub share: f64,
    /// Delay of the copy, microseconds; default 20.
    #[serde(default = "at_once")]
    pub later_us: f64,
}

const fn at_once() -> f64 {
    20.0
}

/// A link that duplicates packets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duplicate(PacketSelection);

impl Duplicate {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a share outside 0 to 1 or a delay outside 0 to 1 s.
    pub fn new(settings: &DuplicateSettings, seed: u64) -> Result<Self, InvalidSetting> {
        PacketSelection::new(Self::NAME, settings.share, settings.later_us, seed).map(Self)
    }
}

effect! {
    Duplicate, DuplicateSettings, link: Box, "duplicate",
    idle: "no packet happened to come twice",
    new: Duplicate::new
}

impl LinkEffect for Duplicate {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        arrive(message);
        let twice = self.0.selects(&message);
        if twice {
            arrive(self.0.delayed(message));
        }
        u32::from(twice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::arrivals;
    use crate::effects::MessageKind;

    #[test]
    fn the_requested_share_is_duplicated() {
        let settings = DuplicateSettings {
            share: 0.5,
            later_us: 20.0,
        };
        let mut duplicate = Duplicate::new(&settings, 4).unwrap();
        let arrived = arrivals(&mut duplicate, MessageKind::Position, &[100; 1_000]);
        let seconds = arrived
            .iter()
            .filter(|message| message.time_ns == 20_100)
            .count();
        assert_eq!(arrived.len() - seconds, 1_000);
        assert!((seconds as f64 - 500.0).abs() < 4.0 * 250_f64.sqrt());
        assert_eq!(
            arrivals(&mut duplicate, MessageKind::Request, &[0; 50]).len(),
            50
        );
    }
}
