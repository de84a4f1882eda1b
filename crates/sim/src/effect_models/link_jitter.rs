//! Link: a minimum delay and an exponential tail; messages keep their order.
//!
//! The defaults are a quiet Ethernet port and a USB serial link. Bursts of load and delays that
//! depend on the amount of data are not included.

use crate::effects::{LinkEffect, LinkMessage, MessageKind};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::random::RandomSource;

/// `[effects.link_jitter]`, microseconds.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct LinkJitterSettings {
    /// Minimum delay of the lidar's packets.
    pub lidar_delay_us: f64,
    /// Mean of their additional delay.
    pub lidar_jitter_us: f64,
    /// Minimum delay of each request to the drive and each answer.
    pub drive_delay_us: f64,
    /// Mean of their additional delay.
    pub drive_jitter_us: f64,
}

impl Default for LinkJitterSettings {
    fn default() -> Self {
        Self {
            lidar_delay_us: 40.0,
            lidar_jitter_us: 30.0,
            drive_delay_us: 300.0,
            drive_jitter_us: 150.0,
        }
    }
}

/// Minimum delay and mean of the tail, nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Delay {
    least_ns: f64,
    tail_ns: f64,
}

/// Links with delays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkJitter {
    lidar: Delay,
    drive: Delay,
    random: RandomSource,
    /// Last arrival: lidar, request, answer.
    last_ns: [i64; 3],
}

/// The longest delay, microseconds.
const MOST_US: f64 = 1e6;

impl LinkJitter {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a delay outside 0 to 1 s.
    pub fn new(settings: &LinkJitterSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let ns =
            |setting, us| Ok(1e3 * SettingCheck(Self::NAME).within(setting, us, 0.0..=MOST_US)?);
        Ok(Self {
            lidar: Delay {
                least_ns: ns("lidar_delay_us", settings.lidar_delay_us)?,
                tail_ns: ns("lidar_jitter_us", settings.lidar_jitter_us)?,
            },
            drive: Delay {
                least_ns: ns("drive_delay_us", settings.drive_delay_us)?,
                tail_ns: ns("drive_jitter_us", settings.drive_jitter_us)?,
            },
            random: RandomSource::new(seed, Self::NAME),
            last_ns: [i64::MIN; 3],
        })
    }
}

effect! {
    LinkJitter, LinkJitterSettings, link: Box, "link_jitter",
    idle: "all its delays are 0",
    new: LinkJitter::new
}

impl LinkEffect for LinkJitter {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        let delay = if message.kind.is_from_lidar() {
            self.lidar
        } else {
            self.drive
        };
        let mut draws = self.random.at(message.number, message.kind.channel());
        let tail = -(1.0 - draws.unit()).ln();
        let takes_ns = (delay.least_ns + delay.tail_ns * tail).round() as i64;
        let [lidar, request, answer] = &mut self.last_ns;
        let last_ns = match message.kind {
            MessageKind::Data | MessageKind::Position => lidar,
            MessageKind::Request => request,
            MessageKind::Answer => answer,
        };
        *last_ns = message.time_ns.saturating_add(takes_ns).max(*last_ns);
        arrive(LinkMessage {
            time_ns: *last_ns,
            ..message
        });
        u32::from(*last_ns != message.time_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::arrivals;

    #[test]
    fn jitter_keeps_the_order_and_the_requested_mean() {
        let mut jitter = LinkJitter::new(&LinkJitterSettings::default(), 5).unwrap();
        let sent: Vec<i64> = (0..20_000).map(|number| number * 1_327_104).collect();
        let arrived = arrivals(&mut jitter, MessageKind::Data, &sent);
        assert_eq!(arrived.len(), sent.len());
        assert!(arrived.is_sorted_by_key(|message| message.time_ns));
        let taken: Vec<i64> = (arrived.iter().zip(&sent))
            .map(|(message, sent)| message.time_ns - sent)
            .collect();
        assert!(taken.iter().all(|&ns| ns >= 40_000));
        let mean_ns = taken.iter().sum::<i64>() as f64 / taken.len() as f64;
        // The standard deviation of an exponential is its mean.
        assert!((mean_ns - 70_000.0).abs() < 4.0 * 30_000.0 / 20_000_f64.sqrt());
        // Messages sent at the same time arrive in order, too.
        let at_once = arrivals(&mut jitter, MessageKind::Answer, &[0; 100]);
        assert!(at_once.is_sorted_by_key(|message| (message.time_ns, message.number)));
    }
}
