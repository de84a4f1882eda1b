//! Link: a receiver that reads the lidar's packets periodically and stamps them then.
//!
//! Recordings of some hosts show arrivals in groups 15.6 ms apart, the tick of a timer. Answers of
//! the drive are not affected, because the host waits for each.

use crate::effects::{LinkEffect, LinkMessage};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.batching]`: a receiver that batches.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct Batching {
    /// Period of reading, milliseconds; default 15.625.
    pub period_ms: f64,
}

impl Default for Batching {
    fn default() -> Self {
        Self { period_ms: 15.625 }
    }
}

impl Batching {
    /// Checks that the period is within 1 us to 10 s.
    fn checked(self) -> Result<Self, InvalidSetting> {
        SettingCheck(Self::NAME).within("period_ms", self.period_ms, 1e-3..=1e4)?;
        Ok(self)
    }
}

effect! {
    Batching, Batching, link: Box, "batching",
    idle: "no packet of the lidar had to wait",
    new: |batching, _| batching.checked()
}

impl LinkEffect for Batching {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        let period_ns = (self.period_ms * 1e6).round() as i64;
        let wait_ns = match message.kind.is_from_lidar() {
            true => (-message.time_ns).rem_euclid(period_ns.max(1)),
            false => 0,
        };
        arrive(LinkMessage {
            time_ns: message.time_ns.saturating_add(wait_ns),
            ..message
        });
        u32::from(wait_ns > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::arrivals;
    use crate::effects::MessageKind;

    #[test]
    fn packets_wait_for_the_next_poll() {
        let mut batching = Batching { period_ms: 10.0 }.checked().unwrap();
        let times = |arrived: Vec<LinkMessage>| -> Vec<i64> {
            arrived.iter().map(|message| message.time_ns).collect()
        };
        let sent = [0, 1, 9_999_999, 10_000_000, 10_000_001];
        let lidars = times(arrivals(&mut batching, MessageKind::Data, &sent));
        assert_eq!(lidars, [0, 10_000_000, 10_000_000, 10_000_000, 20_000_000]);
        assert_eq!(
            times(arrivals(&mut batching, MessageKind::Answer, &sent)),
            sent
        );
    }
}
