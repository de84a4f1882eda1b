//! Wire: a receiver that takes the lidar's packets out of its buffer only now and then, and stamps them when it does.
//!
//! Recordings made on some hosts show arrivals in heaps 15.6 ms apart, the tick of a timer. Left out: a buffer that overflows, and heaps of the drive's
//! answers: the host waits for those one by one.

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Effect, Listed, Parcel, Wire};

/// `[effects.batching]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct BatchingSettings {
    /// From one look into the buffer to the next, milliseconds; 15.625 unless said.
    pub period_ms: f64,
}

impl Default for BatchingSettings {
    fn default() -> Self {
        Self { period_ms: 15.625 }
    }
}

/// A receiver that batches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batching {
    period_ns: i64,
}

impl Batching {
    /// What the scene file calls it.
    pub const NAME: &'static str = "batching";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for a period that is not within 1 us and 10 s.
    pub fn new(settings: &BatchingSettings) -> Result<Self, Unfit> {
        let ms = Check(Self::NAME).within("period_ms", settings.period_ms, 1e-3..=1e4)?;
        Ok(Self {
            period_ns: (ms * 1e6).round() as i64,
        })
    }
}

impl Settings for BatchingSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(Batching::new(self)?);
        asked.wire.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for Batching {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "no packet of the lidar had to wait"
    }
}

impl Wire for Batching {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let wait_ns = match parcel.kind.is_lidars() {
            true => (-parcel.leaves_ns).rem_euclid(self.period_ns.max(1)),
            false => 0,
        };
        arrive(Parcel {
            leaves_ns: parcel.leaves_ns.saturating_add(wait_ns),
            ..parcel
        });
        u32::from(wait_ns > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParcelKind;
    use crate::effects::testing::arrivals;

    #[test]
    fn packets_wait_for_the_next_look() {
        let mut batching = Batching::new(&BatchingSettings { period_ms: 10.0 }).unwrap();
        let times = |arrived: Vec<Parcel>| -> Vec<i64> {
            arrived.iter().map(|parcel| parcel.leaves_ns).collect()
        };
        let sent = [0, 1, 9_999_999, 10_000_000, 10_000_001];
        let lidars = times(arrivals(&mut batching, ParcelKind::Data, &sent));
        assert_eq!(lidars, [0, 10_000_000, 10_000_000, 10_000_000, 20_000_000]);
        assert_eq!(
            times(arrivals(&mut batching, ParcelKind::Answer, &sent)),
            sent
        );
    }
}
