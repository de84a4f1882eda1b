//! Wire: packets and answers take their time, a least one and an exponential tail, and keep their order.
//!
//! The tail is that of a host that is busy now and then; what was sent later never overtakes. The defaults are a quiet Ethernet port and a USB
//! serial link. Left out: bursts of load, and delays that depend on how much is sent.

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Effect, Listed, Parcel, ParcelKind, Wire};
use crate::random::Source;

/// `[effects.link_jitter]`, microseconds.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct LinkJitterSettings {
    /// The least that the lidar's packets take.
    pub lidar_delay_us: f64,
    /// What they take more in the mean.
    pub lidar_jitter_us: f64,
    /// The least that a request or an answer of the drive takes, each.
    pub drive_delay_us: f64,
    /// What it takes more in the mean.
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

/// Least delay and mean of the tail, nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Delay {
    least_ns: f64,
    tail_ns: f64,
}

/// Links that take time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkJitter {
    lidar: Delay,
    drive: Delay,
    random: Source,
    /// When the last arrived: lidar, request, answer.
    last_ns: [i64; 3],
}

/// The longest delay, microseconds.
const MOST_US: f64 = 1e6;

impl LinkJitter {
    /// What the scene file calls it.
    pub const NAME: &'static str = "link_jitter";

    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for a delay below 0 or above a second.
    pub fn new(settings: &LinkJitterSettings, seed: u64) -> Result<Self, Unfit> {
        let ns = |setting, us| Ok(1e3 * Check(Self::NAME).within(setting, us, 0.0..=MOST_US)?);
        Ok(Self {
            lidar: Delay {
                least_ns: ns("lidar_delay_us", settings.lidar_delay_us)?,
                tail_ns: ns("lidar_jitter_us", settings.lidar_jitter_us)?,
            },
            drive: Delay {
                least_ns: ns("drive_delay_us", settings.drive_delay_us)?,
                tail_ns: ns("drive_jitter_us", settings.drive_jitter_us)?,
            },
            random: Source::new(seed, Self::NAME),
            last_ns: [i64::MIN; 3],
        })
    }
}

impl Settings for LinkJitterSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(LinkJitter::new(self, seed)?);
        asked.wire.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for LinkJitter {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "all its delays are 0"
    }
}

impl Wire for LinkJitter {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let delay = if parcel.kind.is_lidars() {
            self.lidar
        } else {
            self.drive
        };
        let mut draws = self.random.at(parcel.number, parcel.kind.channel());
        let tail = -(1.0 - draws.unit()).ln();
        let takes_ns = (delay.least_ns + delay.tail_ns * tail).round() as i64;
        let [lidar, request, answer] = &mut self.last_ns;
        let last_ns = match parcel.kind {
            ParcelKind::Data | ParcelKind::Position => lidar,
            ParcelKind::Request => request,
            ParcelKind::Answer => answer,
        };
        *last_ns = parcel.leaves_ns.saturating_add(takes_ns).max(*last_ns);
        arrive(Parcel {
            leaves_ns: *last_ns,
            ..parcel
        });
        u32::from(*last_ns != parcel.leaves_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::arrivals;

    #[test]
    fn nothing_overtakes_and_the_mean_is_as_asked() {
        let mut jitter = LinkJitter::new(&LinkJitterSettings::default(), 5).unwrap();
        let sent: Vec<i64> = (0..20_000).map(|number| number * 1_327_104).collect();
        let arrived = arrivals(&mut jitter, ParcelKind::Data, &sent);
        assert_eq!(arrived.len(), sent.len());
        assert!(arrived.is_sorted_by_key(|parcel| parcel.leaves_ns));
        let taken: Vec<i64> = (arrived.iter().zip(&sent))
            .map(|(parcel, sent)| parcel.leaves_ns - sent)
            .collect();
        assert!(taken.iter().all(|&ns| ns >= 40_000));
        let mean_ns = taken.iter().sum::<i64>() as f64 / taken.len() as f64;
        // An exponential's standard deviation is its mean.
        assert!((mean_ns - 70_000.0).abs() < 4.0 * 30_000.0 / 20_000_f64.sqrt());
        // Sent all at once they arrive in order, too.
        let at_once = arrivals(&mut jitter, ParcelKind::Answer, &[0; 100]);
        assert!(at_once.is_sorted_by_key(|parcel| (parcel.leaves_ns, parcel.number)));
    }
}
