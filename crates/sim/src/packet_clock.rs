//! Packets of a free-running device over three kinds of link, for measurements of clock estimates.
//!
//! An oscillator with a constant rate and a slow wander, packets at the VLP-16's period, and a link
//! that delays each of them. The true times are included.

use units::{Host, Lidar, Stamp};

use crate::random::Draws;

/// Period of a VLP-16's packets in single-return mode: 24 firings of 55.296 us (manual, section
/// 9.3).
pub const PACKET_NS: i64 = 1_327_104;

/// Kinds of link by their delays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrivalLink {
    /// A dedicated Ethernet port: 22 us on average, one packet in a thousand up to 17 ms more.
    QuietNic,
    /// The same with interrupt coalescing: arrivals every 125 us, one in a thousand up to 16 ms
    /// later.
    Coalescing,
    /// An adapter on a busy USB: polled every millisecond, then 105 us on average, one in 250 up to
    /// 20 ms more.
    BusyUsb,
}

/// The device's oscillator against the host's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// Constant part of the rate, parts per million; positive where the device is slow.
    pub drift_ppm: f64,
    /// Multiple of the usual wander: +-45 us over 700 s and +-12 us over 160 s, at most 0.9 ppm
    /// together.
    pub wander: f64,
}

/// Times of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TimedPacket {
    /// Reading of the device's clock.
    pub device: Stamp<Lidar>,
    /// Host time at that reading, the minimum delay of the link included.
    pub truth: Stamp<Host>,
    /// Time of arrival.
    pub arrival: Stamp<Host>,
}

/// An endless series of packets.
#[derive(Clone, Debug)]
pub struct PacketClock {
    link: ArrivalLink,
    oscillator: Oscillator,
    random: Draws,
    phases: [f64; 2],
    tick: f64,
    begin: (i64, i64),
    number: i64,
    last_ns: i64,
}

/// Periods and amplitudes of the wander.
const WANDER_S_US: [(f64, f64); 2] = [(700.0, 45.0), (160.0, 12.0)];
const COALESCED_NS: f64 = 125e3;

impl ArrivalLink {
    /// All three.
    pub const ALL: [Self; 3] = [Self::QuietNic, Self::Coalescing, Self::BusyUsb];

    /// The name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::QuietNic => "quiet NIC",
            Self::Coalescing => "125 us coalescing",
            Self::BusyUsb => "busy USB-Ethernet",
        }
    }

    /// Probability of a spike and its largest delay, nanoseconds.
    const fn spike(self) -> (f64, f64) {
        match self {
            Self::QuietNic => (0.001, 17e6),
            Self::Coalescing => (0.001, 16e6),
            Self::BusyUsb => (0.004, 20e6),
        }
    }
}

impl PacketClock {
    /// Packets from host time `begin`, when the device reads `device`; everything else follows from
    /// `seed`.
    #[must_use]
    pub fn new(
        link: ArrivalLink,
        oscillator: Oscillator,
        device: Stamp<Lidar>,
        begin: Stamp<Host>,
        seed: u64,
    ) -> Self {
        let mut random = Draws::new(seed);
        let turn = core::f64::consts::TAU;
        let phases = [turn * random.unit(), turn * random.unit()];
        Self {
            link,
            oscillator,
            phases,
            tick: COALESCED_NS * random.unit(),
            random,
            begin: (device.as_nanos(), begin.as_nanos()),
            number: 0,
            last_ns: i64::MIN,
        }
    }

    /// Lead of the host's clock over the device's, `since_ns` after the start.
    fn ahead_ns(&self, since_ns: f64) -> f64 {
        let wander = WANDER_S_US.iter().zip(self.phases);
        let wander_us: f64 = wander
            .map(|((period_s, us), phase)| {
                let angle = core::f64::consts::TAU * since_ns * 1e-9 / period_s + phase;
                us * (angle.sin() - phase.sin())
            })
            .sum();
        self.oscillator.drift_ppm * 1e-6 * since_ns + self.oscillator.wander * wander_us * 1e3
    }

    fn delay_ns(&mut self, ready_ns: f64) -> f64 {
        let (chance, height) = self.link.spike();
        // Always four draws per packet.
        let (extent, tail, spiked, high) = (
            self.random.unit(),
            -(1.0 - self.random.unit()).ln(),
            self.random.unit() < chance,
            self.random.unit(),
        );
        let usual = match self.link {
            ArrivalLink::QuietNic => 22e3 * tail,
            ArrivalLink::Coalescing => {
                let there = ready_ns + 22e3 * tail - self.tick;
                (there / COALESCED_NS).ceil() * COALESCED_NS + self.tick - ready_ns
            }
            ArrivalLink::BusyUsb => 1e6 * extent + 105e3 * tail,
        };
        usual + if spiked { high * height } else { 0.0 }
    }
}

impl Iterator for PacketClock {
    type Item = TimedPacket;

    fn next(&mut self) -> Option<TimedPacket> {
        let since = self.number.checked_mul(PACKET_NS)?;
        self.number += 1;
        let ahead = self.ahead_ns(since as f64);
        let truth = self
            .begin
            .1
            .saturating_add(since)
            .saturating_add(ahead.round() as i64);
        let delay = self.delay_ns(since as f64 + ahead);
        // A link keeps the order.
        self.last_ns = self.last_ns.max(truth.saturating_add(delay as i64));
        Some(TimedPacket {
            device: Stamp::from_nanos(self.begin.0.saturating_add(since)),
            truth: Stamp::from_nanos(truth),
            arrival: Stamp::from_nanos(self.last_ns),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late_us(link: ArrivalLink) -> Vec<f64> {
        let oscillator = Oscillator {
            drift_ppm: 50.0,
            wander: 1.0,
        };
        let begin = Stamp::from_nanos(4_102_444_800_000_000_000);
        let packets = PacketClock::new(link, oscillator, Stamp::from_nanos(7), begin, 3);
        packets
            .take(200_000)
            .map(|p| (p.arrival - p.truth).as_micros_f64())
            .collect()
    }

    #[test]
    fn delays_match_the_link() {
        // Mean and largest delay, including packets held up by a spike.
        for (link, mean_us, worst_us) in [
            (ArrivalLink::QuietNic, 66.0, 17_000.0),
            (ArrivalLink::Coalescing, 125.0, 16_100.0),
            (ArrivalLink::BusyUsb, 808.0, 21_000.0),
        ] {
            let late = late_us(link);
            let mean = late.iter().sum::<f64>() / late.len() as f64;
            let worst = late.iter().copied().fold(0.0, f64::max);
            assert!((mean / mean_us - 1.0).abs() < 0.1, "{link:?}: {mean}");
            assert!((worst / worst_us - 1.0).abs() < 0.1, "{link:?}: {worst}");
            assert!(late.iter().all(|late| *late >= 0.0));
        }
    }

    #[test]
    fn few_packets_of_a_busy_link_arrive_promptly() {
        let late = late_us(ArrivalLink::BusyUsb);
        let within = |us: f64| late.iter().filter(|late| **late < us).count() as f64;
        // Two stages: ten times the delay, a hundred times the packets.
        let ratio = within(50.0) / within(5.0);
        assert!((60.0..160.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn the_oscillator_drifts_and_wanders() {
        let oscillator = Oscillator {
            drift_ppm: -50.0,
            wander: 1.0,
        };
        let zero = Stamp::from_nanos(0);
        let packets = PacketClock::new(
            ArrivalLink::QuietNic,
            oscillator,
            zero,
            Stamp::from_nanos(0),
            1,
        );
        let off = |p: &TimedPacket| {
            let device_us = p.device.as_nanos() as f64 * 1e-3;
            p.truth.as_nanos() as f64 * 1e-3 - device_us * (1.0 - 50e-6)
        };
        let off: Vec<f64> = packets.take(450_000).map(|p| off(&p)).collect();
        let span =
            off.iter().copied().fold(0.0, f64::max) - off.iter().copied().fold(0.0, f64::min);
        assert!((60.0..115.0).contains(&span), "{span}");
    }
}
