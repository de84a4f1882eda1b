//! Payloads in, firing blocks or firings out: order, loss, model, and the one packet that is held
//! back.
//!
//! A packet is decoded when its successor is there, because the rotor's rate in its last block, the
//! length of a gap inside it and sometimes its model are known only then: 1.3 ms of delay. Left
//! out: anything that looks further ahead.

use core::ptr;

use protocol::vlp16::{DATA_LEN, DataPacket, Model, PositionPacket, ReturnMode};
use units::{Host, Lidar, Span, Stamp};

use crate::continuity::{BlindSector, missing};
use crate::fast::UnpackedPacket;
use crate::fast::{BlockReturns, FiringBlock, ReturnLayer};
use crate::fast::{PaceCache, SineTable};
use crate::firing::{Echo, Firing};
use crate::geometry::{Geometry, fits};
use crate::options::Options;
use crate::plan::{AzimuthSteps, BlockTiming, Successor, SuccessorLink, first_azimuth};
use crate::stats::Stats;
use crate::timekeeper::Timekeeper;

/// A packet this much before its predecessor is out of order; further back, the device's clock was
/// set.
const REORDER: Span = Span::from_millis(10);
/// A gap this long is checked against the host's clock before packets are called lost.
const LONG_GAP: Span = Span::from_secs(1);
/// How every block begins.
const BLOCK_FLAG: &[u8] = &[0xFF, 0xEE];

/// Decodes the packets of one sensor.
#[derive(Clone, Debug)]
pub struct Decoder {
    timekeeper: Timekeeper,
    unpacker: PacketDecoder,
    held: Option<PendingPacket>,
    /// The held packet's payload.
    buffer: [u8; DATA_LEN],
    /// First firing of the last packet that was emitted since the clock last stepped.
    emitted: Option<Stamp<Lidar>>,
}

/// What is known of a packet apart from its bytes.
#[derive(Clone, Copy, Debug)]
struct PendingPacket {
    start: Stamp<Lidar>,
    host: Stamp<Host>,
    dual: bool,
    model: Option<&'static Model>,
}

/// Turns a packet and its successor into firings.
#[derive(Clone, Debug)]
struct PacketDecoder {
    options: Options,
    /// Some kilobytes, out of its place while it is used.
    sensor: Option<Box<ModelTables>>,
    blind: Option<BlindSector>,
    stats: Stats,
    turned_cdeg: f64,
    turning_ns: f64,
}

/// A model's tables.
#[derive(Clone, Debug)]
struct ModelTables {
    geometry: Geometry,
    compass: &'static SineTable,
    rotor: PaceCache,
    sorted: UnpackedPacket,
}

impl Decoder {
    /// A decoder for one sensor.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self {
            timekeeper: Timekeeper::new(options.clone()),
            unpacker: PacketDecoder {
                options,
                sensor: None,
                blind: None,
                stats: Stats::default(),
                turned_cdeg: 0.0,
                turning_ns: 0.0,
            },
            held: None,
            buffer: [0; DATA_LEN],
            emitted: None,
        }
    }

    /// Takes a UDP payload that arrived at `host` and emits what it completes: the firings of the
    /// packet before it.
    ///
    /// Nothing is an error here: payloads that are no data packets are counted in [`Stats`].
    pub fn packet(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        emit: &mut impl FnMut(&Firing<'_>),
    ) {
        self.firing_blocks(host, payload, &mut |block| one_by_one(block, emit));
    }

    /// Emits the packet held back. The decoder can go on with packets of the same sensor
    /// afterwards.
    pub fn finish(&mut self, emit: &mut impl FnMut(&Firing<'_>)) {
        self.finish_firing_blocks(&mut |block| one_by_one(block, emit));
    }

    /// As [`Decoder::packet`], the firings of a block at a time.
    pub fn firing_blocks(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let stats = &mut self.unpacker.stats;
        match DataPacket::new(payload) {
            Ok(packet) => self.data(host, payload, &packet, emit),
            Err(error) if payload.len() == DATA_LEN || payload.starts_with(BLOCK_FLAG) => {
                stats.malformed += 1;
                stats.first_malformed.get_or_insert(error);
            }
            Err(_) => match PositionPacket::new(payload) {
                Ok(position) => {
                    stats.position += 1;
                    stats.pps = Some(position.pps());
                }
                Err(_) => stats.other += 1,
            },
        }
    }

    /// As [`Decoder::finish`], the firings of a block at a time.
    pub fn finish_firing_blocks(&mut self, emit: &mut impl FnMut(&FiringBlock<'_>)) {
        if let Some(held) = self.held.take() {
            self.emitted = Some(held.start);
            if let Ok(packet) = DataPacket::new(&self.buffer) {
                self.unpacker.unpack(&packet, held, None, emit);
            }
        }
    }

    /// What was seen so far.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.unpacker.stats
    }

    fn data(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        packet: &DataPacket<'_>,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let known = self.timekeeper.observe(host, packet);
        let stats = &mut self.unpacker.stats;
        stats.data += 1;
        stats.product = Some(packet.product());
        stats.return_mode = Some(packet.return_mode());
        if let Some(conflict) = known.conflict {
            stats.report(conflict);
            if let Some(held) = &mut self.held {
                held.model = known.model;
            }
        }
        let new = PendingPacket {
            start: known.start,
            host,
            dual: known.dual,
            model: known.model,
        };
        let Some(held) = self.held else {
            self.hold(new, payload);
            return;
        };
        let ahead = new.start.saturating_since(held.start);
        if ahead == Span::ZERO && payload == self.buffer {
            stats.duplicates += 1;
        } else if ahead < Span::ZERO && -REORDER <= ahead {
            self.out_of_order(packet, new, held, emit);
        } else {
            self.in_order(packet, new, held, emit);
            self.hold(new, payload);
        }
    }

    fn hold(&mut self, packet: PendingPacket, payload: &[u8]) {
        if let Ok(payload) = payload.try_into() {
            self.buffer = payload;
            self.held = Some(packet);
        }
    }

    /// Emits the held packet, `next` being the one after it.
    fn in_order(
        &mut self,
        packet: &DataPacket<'_>,
        new: PendingPacket,
        held: PendingPacket,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let Ok(before) = DataPacket::new(&self.buffer) else {
            return;
        };
        let ahead = new.start.saturating_since(held.start);
        let waited = new.host.saturating_since(held.host);
        let stepped = ahead < Span::ZERO || (ahead >= LONG_GAP && waited < ahead.half());
        let next = (!stepped).then_some(Successor {
            azimuth_cdeg: first_azimuth(packet),
            after: ahead,
        });
        self.emitted = next.map(|_| held.start);
        if stepped {
            self.unpacker.stats.clock_steps += 1;
        }
        self.unpacker.unpack(&before, held, next, emit);
    }

    /// Emits a packet that arrived after the one that follows it, which stays held.
    fn out_of_order(
        &mut self,
        packet: &DataPacket<'_>,
        new: PendingPacket,
        held: PendingPacket,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let stats = &mut self.unpacker.stats;
        if self.emitted.is_some_and(|emitted| new.start <= emitted) {
            stats.late += 1;
            return;
        }
        let Ok(after) = DataPacket::new(&self.buffer) else {
            return;
        };
        stats.reordered += 1;
        let (lost, duration) = (stats.lost_packets, stats.duration);
        let next = Successor {
            azimuth_cdeg: first_azimuth(&after),
            after: held.start.saturating_since(new.start),
        };
        self.unpacker.unpack(packet, new, Some(next), emit);
        if self.emitted.replace(new.start).is_some() {
            // The packet before it counted the gap that it fills, and all of the time.
            let stats = &mut self.unpacker.stats;
            stats.lost_packets = lost.saturating_sub(1);
            stats.duration = duration;
        }
    }
}

impl PacketDecoder {
    /// Emits the firings of a packet. `next` is its successor by device time, if that is known.
    fn unpack(
        &mut self,
        packet: &DataPacket<'_>,
        held: PendingPacket,
        next: Option<Successor>,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let Some(model) = held.model else {
            self.stats.unidentified += 1;
            return;
        };
        let steps = AzimuthSteps::new(packet, model, held.dual);
        let link = steps.link(next);
        self.learn(&steps, link.measured);
        self.tally(model, &steps, link, next);
        let (slots, blocks) = steps.slots(link);
        let mut sensor = match self.sensor.take() {
            Some(sensor) if ptr::eq(sensor.geometry.model, model) => sensor,
            _ => self.sensor_of(model),
        };
        sensor.sorted.set(packet);
        for (i, slot) in slots.iter().take(blocks).enumerate() {
            self.unpack_block(packet, held, &mut sensor, i, slot, emit);
        }
        self.sensor = Some(sensor);
    }

    fn sensor_of(&mut self, model: &'static Model) -> Box<ModelTables> {
        let corrections = self.options.corrections.as_deref();
        let fitting = corrections.filter(|corrections| fits(corrections, model));
        self.stats.corrections_refused = match (corrections, fitting) {
            (Some(corrections), None) => Some(corrections.lasers.len()),
            _ => None,
        };
        let geometry = Geometry::new(model, self.options.vertical_offsets, fitting);
        let rotor = PaceCache::new(&geometry.fan);
        Box::new(ModelTables {
            geometry,
            compass: SineTable::get(),
            rotor,
            sorted: UnpackedPacket::new(),
        })
    }

    /// Emits one block, or one pair.
    #[inline(always)]
    fn unpack_block(
        &mut self,
        packet: &DataPacket<'_>,
        held: PendingPacket,
        sensor: &mut ModelTables,
        i: usize,
        slot: &BlockTiming,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let first = if held.dual { 2 * i } else { i };
        let layer = |i: usize| {
            let (block, sorted) = (packet.block(i)?, sensor.sorted.blocks.get(i)?);
            Some(ReturnLayer::new(block.raw_channels(), sorted))
        };
        let Some(even) = layer(first) else {
            return;
        };
        let returns = match layer(first + 1) {
            // No block follows the last one; a pair always has both.
            Some(odd) if held.dual => BlockReturns::two(even, odd, self.options.duplicates),
            _ => BlockReturns::one(even, single_echo(packet.return_mode())),
        };
        let (seen, unique) = returns.count();
        self.stats.returns += seen;
        self.stats.unique_returns += unique;
        self.stats.firings += sensor.geometry.model.firings_per_block as u64;
        let ahead = sensor.rotor.ahead(&sensor.geometry.fan, slot.pace_cdeg);
        emit(&FiringBlock {
            start: held.start + slot.after,
            azimuth_cdeg: slot.azimuth_cdeg,
            pace_cdeg: slot.pace_cdeg,
            geometry: &sensor.geometry,
            azimuth: sensor.compass.azimuth(slot.azimuth_cdeg),
            ahead,
            returns,
        });
    }

    /// Keeps where the sensor looks away, until it fires there again.
    fn learn(&mut self, steps: &AzimuthSteps, measured: bool) {
        if measured && let Some(blind) = steps.jump() {
            self.blind = Some(blind);
        } else if self.blind.is_some_and(|b| b.hides(steps.last_azimuth())) {
            self.blind = None;
        }
    }

    fn tally(
        &mut self,
        model: &'static Model,
        steps: &AzimuthSteps,
        link: SuccessorLink,
        next: Option<Successor>,
    ) {
        let stats = &mut self.stats;
        stats.model = Some(model);
        let length_ns = next.map_or(steps.fill_ns(), |next| next.after.as_nanos());
        stats.duration = Span::from_nanos(stats.duration.as_nanos().saturating_add(length_ns));
        if let Some(next) = next {
            stats.lost_packets = stats.lost_packets.saturating_add(missing(
                steps,
                next,
                steps.jump().or(self.blind),
            ));
        }
        let (turned_cdeg, periods) = steps.turned(link);
        self.turned_cdeg += turned_cdeg;
        self.turning_ns += f64::from(model.block_period_ns()) * periods;
        if self.turning_ns > 0.0 {
            let turns_per_ns = self.turned_cdeg / 36_000.0 / self.turning_ns;
            stats.rpm = Some(turns_per_ns * 60e9);
        }
    }
}

fn one_by_one(block: &FiringBlock<'_>, emit: &mut impl FnMut(&Firing<'_>)) {
    for firing in block.firings() {
        emit(&firing);
    }
}

/// What the returns of a packet without pairs are.
const fn single_echo(mode: ReturnMode) -> Echo {
    match mode {
        ReturnMode::Strongest => Echo::Strongest,
        ReturnMode::Last => Echo::Last,
        ReturnMode::Dual | ReturnMode::Unknown(_) => Echo::Unknown,
    }
}
