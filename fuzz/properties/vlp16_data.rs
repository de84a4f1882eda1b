//! The data packet and the decoder: for any packets in any order, firings are in order of time,
//! azimuths are within the circle, and every packet is counted.

use std::collections::BTreeSet;

use firmware_sim::vlp16::{DataPacketBuilder, PacketModel, ReturnMode};
use lidar::{Decoder, Duplicates, Firing, Options, Timekeeper};
use protocol::vlp16::models::{HDL_32E, PUCK_HI_RES, VLP_16, VLP_32C};
use protocol::vlp16::{BLOCK_LEN, BLOCKS, DATA_LEN, DataPacket};
use units::{Lidar, Span, Stamp};

use super::input::Input;

/// Decodes a sequence of packets; returns the number of firings.
pub fn holds(data: &[u8]) -> u64 {
    let mut input = Input::new(data);
    let mut sensor = Sensor::new(&mut input);
    let mut decoding = Decoding::new(input.u8());
    while !input.is_empty() {
        let (host_ns, payload) = sensor.packet(&mut input);
        decoding.packet(host_ns, &payload);
    }
    decoding.finish()
}

/// The options of a script, based on the defaults.
fn options(choice: u8, mut options: Options) -> Options {
    options.model = match choice & 7 {
        4 => Some(&VLP_16),
        5 => Some(&PUCK_HI_RES),
        6 => Some(&HDL_32E),
        7 => Some(&VLP_32C),
        _ => None,
    };
    options.vertical_offsets = choice & 8 == 0;
    options.duplicates = if is_all(choice) {
        Duplicates::All
    } else {
        Duplicates::Unique
    };
    options
}

fn is_all(choice: u8) -> bool {
    choice & 16 != 0
}

/// The source of a script's packets.
struct Sensor {
    host_ns: i64,
    stamp_us: u32,
    azimuth_cdeg: u16,
    step_cdeg: u16,
    dual: bool,
    factory: [u8; 2],
    last: Vec<u8>,
}

impl Sensor {
    fn new(input: &mut Input<'_>) -> Self {
        Self {
            host_ns: input.i64(),
            stamp_us: input.u32(),
            azimuth_cdeg: 0,
            step_cdeg: 20,
            dual: false,
            factory: [0x37, 0x22],
            last: Vec::new(),
        }
    }

    /// The next packet of the script, and its arrival time.
    fn packet(&mut self, input: &mut Input<'_>) -> (i64, Vec<u8>) {
        let head = input.u8();
        // Time first: correct, slightly off, or arbitrary.
        let period_us = if self.dual { 664 } else { 1_327 };
        let (device_us, host_ns) = match head & 3 {
            0 => (period_us, i64::from(period_us) * 1_000),
            1 => {
                let us = i32::from(input.u16().cast_signed());
                (us.cast_unsigned(), i64::from(us) * 1_000)
            }
            2 => (input.u32(), i64::from(input.u16()) * 1_000),
            _ => (
                period_us * u32::from(input.u8()),
                i64::from(input.u32().cast_signed()) * 1_000,
            ),
        };
        self.stamp_us = self.stamp_us.wrapping_add(device_us);
        self.host_ns = self.host_ns.wrapping_add(host_ns);
        match head >> 2 & 15 {
            0..=5 => {}
            6 => self.azimuth_cdeg = input.u16() % 36_000,
            7 => self.step_cdeg = input.u16(),
            8 => self.factory[0] = [0x37, 0x38, 0x39, input.u8()][usize::from(head >> 6)],
            9 => self.factory[1] = [0x22, 0x21, 0x28, input.u8()][usize::from(head >> 6)],
            10 => self.dual = !self.dual,
            11 => self.host_ns = input.i64(),
            // The same packet again, another one, or arbitrary bytes.
            12 => return (self.host_ns, self.last.clone()),
            13 => return (self.host_ns, input.short().to_vec()),
            14 => {
                let mut damaged = self.build(head);
                let at = usize::from(input.u16()) % DATA_LEN;
                damaged[at] ^= input.u8();
                return (self.host_ns, damaged);
            }
            _ => {
                let mut gap = self.build(head);
                let (block, azimuth) = (usize::from(input.u8()) % BLOCKS, input.u16());
                let at = block * BLOCK_LEN + 2;
                gap[at..at + 2].copy_from_slice(&azimuth.to_le_bytes());
                return (self.host_ns, gap);
            }
        }
        self.last = self.build(head);
        (self.host_ns, self.last.clone())
    }

    fn build(&mut self, head: u8) -> Vec<u8> {
        let (mode, sequences) = if self.dual {
            (ReturnMode::Dual, 12)
        } else {
            (ReturnMode::Strongest, 24)
        };
        let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, mode);
        let mut one = [(0, 0); 16];
        let mut two = one;
        for (n, laser) in (0..).zip(one.iter_mut()) {
            *laser = (u16::from(head >> (n % 8) & 1) * (500 + n), n as u8);
        }
        two.iter_mut()
            .step_by(3)
            .for_each(|laser| *laser = (501, 7));
        for _ in 0..sequences {
            builder.firing(self.azimuth_cdeg, &one, &two);
            self.azimuth_cdeg = (u32::from(self.azimuth_cdeg) + u32::from(self.step_cdeg / 2))
                .rem_euclid(36_000) as u16;
        }
        let mut packet = builder.finish(0).to_vec();
        packet[1200..1204].copy_from_slice(&self.stamp_us.to_le_bytes());
        packet[1204..].copy_from_slice(&self.factory);
        packet
    }
}

/// A decoder and the expected counts.
struct Decoding {
    decoder: Decoder,
    timekeeper: Timekeeper,
    /// Packet times of the timekeeper alone.
    fired: BTreeSet<i64>,
    /// Valid packets without a time from the timekeeper, and packets emitted at another time.
    untimed: u64,
    unexpected: u64,
    last: Option<Stamp<Lidar>>,
    backwards: u64,
    given: u64,
    sound: u64,
    emitted: u64,
    firings: u64,
    returns: u64,
    all_returns: bool,
}

impl Decoding {
    fn new(choice: u8) -> Self {
        let options = || options(choice, Options::default());
        Self {
            all_returns: is_all(choice),
            timekeeper: Timekeeper::new(options()),
            decoder: Decoder::new(options()),
            fired: BTreeSet::new(),
            untimed: 0,
            unexpected: 0,
            last: None,
            backwards: 0,
            given: 0,
            sound: 0,
            emitted: 0,
            firings: 0,
            returns: 0,
        }
    }

    fn packet(&mut self, host_ns: i64, payload: &[u8]) {
        let host = Stamp::from_nanos(host_ns);
        let sound = DataPacket::new(payload).is_ok();
        match self.timekeeper.packet(host, payload) {
            Some(timing) => {
                assert!(sound && timing.fill > Span::ZERO);
                self.fired.insert(timing.first_firing.as_nanos());
            }
            None => self.untimed += u64::from(sound),
        }
        self.given += 1;
        self.sound += u64::from(sound);
        let mut seen = Vec::new();
        self.decoder
            .packet(host, payload, &mut |firing| seen.push(Seen::of(firing)));
        self.take(&seen);
    }

    fn take(&mut self, seen: &[Seen]) {
        if let Some(first) = seen.first() {
            self.emitted += 1;
            // A packet whose model follows from the next packet has no time before.
            self.unexpected += u64::from(!self.fired.contains(&first.start.as_nanos()));
            assert!(self.unexpected <= self.untimed, "{first:?}");
        }
        // Within a packet and between packets. Overlapping packets (two sensors on one port)
        // interleave.
        let mut ascending = seen.iter().zip(seen.iter().skip(1));
        assert!(ascending.all(|(a, b)| a.start < b.start), "{seen:?}");
        if let Some(first) = seen.first() {
            self.backwards += u64::from(self.last.is_some_and(|last| first.start < last));
            self.last = Some(first.start);
        }
        for firing in seen {
            self.firings += 1;
            self.returns += firing.returns;
        }
        let stats = self.decoder.stats();
        assert!(
            self.backwards <= stats.clock_steps,
            "time ran backwards {} times, {} clock steps: {seen:?}",
            self.backwards,
            stats.clock_steps
        );
    }

    fn finish(mut self) -> u64 {
        let mut seen = Vec::new();
        self.decoder
            .finish(&mut |firing| seen.push(Seen::of(firing)));
        self.take(&seen);
        let stats = self.decoder.stats();
        assert_eq!(stats.data, self.sound);
        assert_eq!(
            stats.data + stats.position + stats.malformed + stats.other,
            self.given
        );
        assert_eq!(
            self.emitted + stats.unidentified + stats.duplicates + stats.late,
            stats.data,
            "{stats:?}"
        );
        assert_eq!(stats.firings, self.firings);
        assert!(stats.unique_returns <= stats.returns);
        let expected = if self.all_returns {
            stats.returns
        } else {
            stats.unique_returns
        };
        assert_eq!(self.returns, expected);
        assert!(stats.rpm.is_none_or(f64::is_finite));
        assert!(stats.duration >= Span::ZERO);
        assert_eq!(stats.malformed > 0, stats.first_malformed.is_some());
        self.firings
    }
}

/// The stored part of a firing.
#[derive(Debug)]
struct Seen {
    start: Stamp<Lidar>,
    returns: u64,
}

impl Seen {
    fn of(firing: &Firing<'_>) -> Self {
        assert!(
            (0.0..360.0).contains(&firing.azimuth_deg),
            "{}",
            firing.azimuth_deg
        );
        assert!(firing.azimuth_rate_deg_s.is_finite());
        let lasers = firing.model.lasers.len();
        let mut returns = 0;
        for (seen, point) in firing.returns().zip(firing.points()) {
            returns += 1;
            assert!(usize::from(seen.laser) < lasers && usize::from(point.ring) < lasers);
            assert!(seen.distance_raw > 0 && point.range_m > 0.0);
            assert!(point.time >= firing.start);
            assert!(point.position_m.iter().all(|axis| axis.is_finite()));
        }
        Self {
            start: firing.start,
            returns,
        }
    }
}
