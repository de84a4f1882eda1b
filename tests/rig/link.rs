//! Random delays of a transport, for pumps that run in virtual time.
//!
//! Most delays are uniform in a range; with a given probability a spike adds to them. Order is
//! kept, as on a serial line and a loopback socket.

use units::{Span, Stamp};

use sim::random::Draws;

/// Distribution of delays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkModel {
    /// The shortest delay.
    pub min: Span,
    /// The longest delay without a spike; delays are uniform up to it.
    pub max: Span,
    /// Probability of a spike, 0..=1.
    pub spike_probability: f64,
    /// The longest spike; a spike adds a uniform part of it.
    pub spike: Span,
}

impl LinkModel {
    /// No delay at all.
    pub const NONE: Self = Self {
        min: Span::ZERO,
        max: Span::ZERO,
        spike_probability: 0.0,
        spike: Span::ZERO,
    };

    /// One way of a USB serial link: 0.3 to 1 ms, one in fifty up to 5 ms more.
    pub const USB: Self = Self {
        min: Span::from_micros(300),
        max: Span::from_micros(1_000),
        spike_probability: 0.02,
        spike: Span::from_millis(5),
    };

    /// UDP on a quiet Ethernet port: 40 to 130 us, one in five hundred up to 3 ms more.
    pub const ETHERNET: Self = Self {
        min: Span::from_micros(40),
        max: Span::from_micros(130),
        spike_probability: 0.002,
        spike: Span::from_millis(3),
    };
}

/// One direction of a transport.
#[derive(Clone, Debug)]
pub struct Link {
    model: LinkModel,
    random: Draws,
    last_ns: i64,
}

impl Link {
    /// A link whose delays follow from `seed` and the number of deliveries.
    #[must_use]
    pub const fn new(model: LinkModel, seed: u64) -> Self {
        Self {
            model,
            random: Draws::new(seed),
            last_ns: i64::MIN,
        }
    }

    /// Time of arrival of a message: not before `sent`, and not before earlier messages.
    pub fn deliver<C>(&mut self, sent: Stamp<C>) -> Stamp<C> {
        let LinkModel {
            min,
            max,
            spike_probability,
            spike,
        } = self.model;
        let usual = min.as_nanos().max(0);
        let spread = max.as_nanos().saturating_sub(usual).max(0);
        // Always three draws, so that one parameter does not shift the draws of another.
        let (extent, chance, height) = (self.random.unit(), self.random.unit(), self.random.unit());
        let mut delay = usual.saturating_add((extent * spread as f64) as i64);
        if chance < spike_probability {
            delay = delay.saturating_add((height * spike.as_nanos().max(0) as f64) as i64);
        }
        self.last_ns = self.last_ns.max(sent.as_nanos().saturating_add(delay));
        Stamp::from_nanos(self.last_ns)
    }
}

#[cfg(test)]
mod tests {
    use units::Host;

    use super::*;

    fn at(ns: i64) -> Stamp<Host> {
        Stamp::from_nanos(ns)
    }

    #[test]
    fn delays_stay_within_bounds_and_fill_them() {
        let model = LinkModel {
            spike_probability: 0.0,
            ..LinkModel::USB
        };
        let mut link = Link::new(model, 7);
        let delays: Vec<i64> = (0..10_000)
            .map(|i| 10_000_000 * i)
            .map(|sent| link.deliver(at(sent)).as_nanos() - sent)
            .collect();
        let (least, most) = (delays.iter().min().unwrap(), delays.iter().max().unwrap());
        assert!((300_000..301_000).contains(least), "{least}");
        assert!((999_000..=1_000_000).contains(most), "{most}");
        let mean = delays.iter().sum::<i64>() / 10_000;
        assert!((640_000..660_000).contains(&mean), "{mean}");
    }

    #[test]
    fn spikes_occur_at_the_requested_rate() {
        let mut link = Link::new(LinkModel::USB, 7);
        let late = (0..100_000)
            .map(|i| 10_000_000 * i)
            .filter(|&sent| link.deliver(at(sent)).as_nanos() - sent > 1_000_000)
            .count();
        // 2 % spikes, without those too small to raise a short delay above 1 ms: 2 % x (1 -
        // 0.35/5).
        assert!((1_720..2_000).contains(&late), "{late}");
    }

    #[test]
    fn order_is_kept_and_delays_depend_on_the_seed() {
        let run = |seed| {
            let mut link = Link::new(LinkModel::USB, seed);
            (0..5_000)
                .map(|i| link.deliver(at(1_000 * i)))
                .collect::<Vec<_>>()
        };
        assert!(run(1).is_sorted());
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }

    #[test]
    fn zero_delay_is_exact_and_invalid_delays_never_arrive_early() {
        assert_eq!(Link::new(LinkModel::NONE, 3).deliver(at(55)), at(55));
        let nonsense = LinkModel {
            min: Span::from_millis(-5),
            max: Span::from_millis(-9),
            spike_probability: f64::NAN,
            spike: Span::from_millis(-1),
        };
        assert_eq!(Link::new(nonsense, 3).deliver(at(55)), at(55));
    }
}
