//! Decoding of payloads into firing blocks or firings: order, loss and model.
//!
//! A packet is decoded when its successor arrives, 1.3 ms later. Only then are the rotor's rate in
//! its last block, the length of a gap inside it and sometimes its model known.

use core::ptr;

use protocol::vlp16::{DATA_LEN, DataPacket, LidarModel, PositionPacket, ReturnMode};
use units::{Host, Lidar, Span, Stamp};

use crate::block_timing::{AzimuthSteps, BlockTiming, Successor, SuccessorLink, first_azimuth};
use crate::continuity::{BlindSector, missing};
use crate::fast::UnpackedPacket;
use crate::fast::{AzimuthSines, PaceCache};
use crate::fast::{BlockReturns, FiringBlock, ReturnLayer};
use crate::firing::{Firing, ReturnKind};
use crate::geometry::{Geometry, fits};
use crate::options::Options;
use crate::stats::Stats;
use crate::timekeeper::Timekeeper;

/// Up to this time before its predecessor a packet is out of order; beyond, the device's clock was
/// set.
const REORDER: Span = Span::from_millis(10);
/// Gaps from this length on are compared with the host's clock before packets count as lost.
const LONG_GAP: Span = Span::from_secs(1);
/// Flag at the start of every block.
const BLOCK_FLAG: &[u8] = &[0xFF, 0xEE];

/// Decodes the packets of one sensor.
#[derive(Clone, Debug)]
pub struct Decoder {
    timekeeper: Timekeeper,
    packet_decoder: PacketDecoder,
    pending: Option<PendingPacket>,
    /// The pending packet's payload.
    buffer: [u8; DATA_LEN],
    /// First firing of the packet emitted last, since the last clock step.
    emitted: Option<Stamp<Lidar>>,
}

/// Facts about a packet other than its bytes.
#[derive(Clone, Copy, Debug)]
struct PendingPacket {
    start: Stamp<Lidar>,
    host: Stamp<Host>,
    dual: bool,
    model: Option<&'static LidarModel>,
}

impl PendingPacket {
    /// Time to fill it, as [`Timekeeper`] has it.
    fn fill(&self) -> Span {
        let fill_ns = self
            .model
            .map_or(0, |model| model.packet_period_ns(self.dual));
        Span::from_nanos(fill_ns.into())
    }
}

/// Decodes a packet with its successor.
#[derive(Clone, Debug)]
struct PacketDecoder {
    options: Options,
    /// Taken out while in use.
    tables: Option<Box<ModelTables>>,
    blind_sector: Option<BlindSector>,
    stats: Stats,
    rotation_cdeg: f64,
    rotation_ns: f64,
}

/// Tables and caches for a model.
#[derive(Clone, Debug)]
struct ModelTables {
    geometry: Geometry,
    sine_table: &'static AzimuthSines,
    pace_cache: PaceCache,
    unpacked: UnpackedPacket,
}

impl Decoder {
    /// Creates a decoder for one sensor.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self {
            timekeeper: Timekeeper::new(options.clone()),
            packet_decoder: PacketDecoder {
                options,
                tables: None,
                blind_sector: None,
                stats: Stats::default(),
                rotation_cdeg: 0.0,
                rotation_ns: 0.0,
            },
            pending: None,
            buffer: [0; DATA_LEN],
            emitted: None,
        }
    }

    /// Decodes a UDP payload that arrived at `host` and emits the firings of the packet before it.
    ///
    /// Other payloads are counted in [`Stats`]; none is an error.
    pub fn packet(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        emit: &mut impl FnMut(&Firing<'_>),
    ) {
        self.decode_blocks(host, payload, &mut |block| one_by_one(block, emit));
    }

    /// Emits the pending packet. Further packets of the same sensor may follow.
    pub fn finish(&mut self, emit: &mut impl FnMut(&Firing<'_>)) {
        self.finish_blocks(&mut |block| one_by_one(block, emit));
    }

    /// Like [`Decoder::packet`], but emits the firings of a block together.
    pub fn decode_blocks(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let stats = &mut self.packet_decoder.stats;
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

    /// Like [`Decoder::finish`], but emits the firings of a block together.
    pub fn finish_blocks(&mut self, emit: &mut impl FnMut(&FiringBlock<'_>)) {
        if let Some(pending) = self.pending.take() {
            self.emitted = Some(pending.start);
            if let Ok(packet) = DataPacket::new(&self.buffer) {
                self.packet_decoder.decode(&packet, pending, None, emit);
            }
        }
    }

    /// Statistics so far.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.packet_decoder.stats
    }

    fn data(
        &mut self,
        host: Stamp<Host>,
        payload: &[u8],
        packet: &DataPacket<'_>,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let facts = self.timekeeper.observe(host, packet);
        let stats = &mut self.packet_decoder.stats;
        stats.data += 1;
        stats.product = Some(packet.product());
        stats.return_mode = Some(packet.return_mode());
        if let Some(conflict) = facts.conflict {
            stats.report(conflict);
            if let Some(pending) = &mut self.pending {
                pending.model = facts.model;
            }
        }
        let new = PendingPacket {
            start: facts.start,
            host,
            dual: facts.dual,
            model: facts.model,
        };
        let Some(pending) = self.pending else {
            self.set_pending(new, payload);
            return;
        };
        let ahead = new.start.saturating_since(pending.start);
        if ahead == Span::ZERO && payload == self.buffer {
            stats.duplicates += 1;
        } else if ahead < Span::ZERO && -REORDER <= ahead {
            self.out_of_order(packet, new, pending, emit);
        } else {
            self.in_order(packet, new, pending, emit);
            self.set_pending(new, payload);
        }
    }

    fn set_pending(&mut self, packet: PendingPacket, payload: &[u8]) {
        if let Ok(payload) = payload.try_into() {
            self.buffer = payload;
            self.pending = Some(packet);
        }
    }

    /// Emits the pending packet, which `packet` follows.
    fn in_order(
        &mut self,
        packet: &DataPacket<'_>,
        new: PendingPacket,
        pending: PendingPacket,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let Ok(before) = DataPacket::new(&self.buffer) else {
            return;
        };
        let ahead = new.start.saturating_since(pending.start);
        let waited = new.host.saturating_since(pending.host);
        let stepped = ahead < Span::ZERO || (ahead >= LONG_GAP && waited < ahead.half());
        let next = (!stepped).then_some(Successor {
            azimuth_cdeg: first_azimuth(packet),
            after: ahead,
        });
        self.emitted = next.map(|_| pending.start);
        if stepped {
            self.packet_decoder.stats.clock_steps += 1;
        }
        self.packet_decoder.decode(&before, pending, next, emit);
    }

    /// Emits a packet that arrived after its successor, which stays pending.
    fn out_of_order(
        &mut self,
        packet: &DataPacket<'_>,
        new: PendingPacket,
        pending: PendingPacket,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let stats = &mut self.packet_decoder.stats;
        if self.emitted.is_some_and(|emitted| new.start <= emitted) {
            stats.late += 1;
            return;
        }
        let Ok(after) = DataPacket::new(&self.buffer) else {
            return;
        };
        stats.reordered += 1;
        let (lost, gaps, duration) = (stats.lost_packets, stats.gaps.len(), stats.duration);
        let next = Successor {
            azimuth_cdeg: first_azimuth(&after),
            after: pending.start.saturating_since(new.start),
        };
        self.packet_decoder.decode(packet, new, Some(next), emit);
        if self.emitted.replace(new.start).is_some() {
            // The packet before it counted this packet as lost, and its time.
            let stats = &mut self.packet_decoder.stats;
            stats.take_back_lost(lost, gaps);
            stats.duration = duration;
        }
    }
}

impl PacketDecoder {
    /// Emits the firings of a packet. `next` is its successor by device time, if known.
    fn decode(
        &mut self,
        packet: &DataPacket<'_>,
        pending: PendingPacket,
        next: Option<Successor>,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let Some(model) = pending.model else {
            self.stats.unidentified += 1;
            return;
        };
        let steps = AzimuthSteps::new(packet, model, pending.dual);
        let link = steps.link(next);
        self.update_blind_sector(&steps, link.measured);
        self.count(model, &steps, link, next);
        let (slots, blocks) = steps.slots(link);
        let mut tables = match self.tables.take() {
            Some(tables) if ptr::eq(tables.geometry.model, model) => tables,
            _ => self.tables_for(model),
        };
        tables.unpacked.set(packet);
        for (i, slot) in slots.iter().take(blocks).enumerate() {
            self.decode_block(packet, pending, &mut tables, i, slot, emit);
        }
        self.tables = Some(tables);
    }

    fn tables_for(&mut self, model: &'static LidarModel) -> Box<ModelTables> {
        let corrections = self.options.corrections.as_deref();
        let fitting = corrections.filter(|corrections| fits(corrections, model));
        self.stats.corrections_refused = match (corrections, fitting) {
            (Some(corrections), None) => Some(corrections.lasers.len()),
            _ => None,
        };
        let geometry = Geometry::new(model, self.options.vertical_offsets, fitting);
        let pace_cache = PaceCache::new(&geometry.channels);
        Box::new(ModelTables {
            geometry,
            sine_table: AzimuthSines::get(),
            pace_cache,
            unpacked: UnpackedPacket::new(),
        })
    }

    /// Emits one block, or one pair of a dual-return packet.
    #[inline(always)]
    fn decode_block(
        &mut self,
        packet: &DataPacket<'_>,
        pending: PendingPacket,
        tables: &mut ModelTables,
        i: usize,
        slot: &BlockTiming,
        emit: &mut impl FnMut(&FiringBlock<'_>),
    ) {
        let first = if pending.dual { 2 * i } else { i };
        let layer = |i: usize| {
            let (block, unpacked) = (packet.block(i)?, tables.unpacked.blocks.get(i)?);
            Some(ReturnLayer::new(block.raw_channels(), unpacked))
        };
        let Some(even) = layer(first) else {
            return;
        };
        let returns = match layer(first + 1) {
            // The last block has no successor; a pair is always complete.
            Some(odd) if pending.dual => BlockReturns::two(even, odd, self.options.duplicates),
            _ => BlockReturns::one(even, single_echo(packet.return_mode())),
        };
        let (seen, unique) = returns.count();
        self.stats.returns += seen;
        self.stats.unique_returns += unique;
        self.stats.firings += tables.geometry.model.firings_per_block as u64;
        let offsets = tables
            .pace_cache
            .offsets(&tables.geometry.channels, slot.step_per_block_cdeg);
        emit(&FiringBlock {
            start: pending.start + slot.after,
            began: pending.host.saturating_add(-pending.fill()),
            azimuth_cdeg: slot.azimuth_cdeg,
            step_per_block_cdeg: slot.step_per_block_cdeg,
            geometry: &tables.geometry,
            azimuth: tables.sine_table.azimuth(slot.azimuth_cdeg),
            offsets,
            returns,
        });
    }

    /// Updates the blind sector, which is reset when the sensor fires there.
    fn update_blind_sector(&mut self, steps: &AzimuthSteps, measured: bool) {
        if measured && let Some(blind_sector) = steps.jump() {
            self.blind_sector = Some(blind_sector);
        } else if self
            .blind_sector
            .is_some_and(|sector| sector.contains(steps.last_azimuth()))
        {
            self.blind_sector = None;
        }
    }

    fn count(
        &mut self,
        model: &'static LidarModel,
        steps: &AzimuthSteps,
        link: SuccessorLink,
        next: Option<Successor>,
    ) {
        let stats = &mut self.stats;
        stats.model = Some(model);
        let begin_ns = stats.duration.as_nanos();
        let length_ns = next.map_or(steps.fill_ns(), |next| next.after.as_nanos());
        stats.duration = Span::from_nanos(stats.duration.as_nanos().saturating_add(length_ns));
        if let Some(next) = next {
            let lost = missing(steps, next, steps.jump().or(self.blind_sector));
            let packet_end = Span::from_nanos(begin_ns.saturating_add(steps.fill_ns()));
            stats.add_lost(packet_end, lost);
        }
        let (rotation_cdeg, periods) = steps.rotation_and_periods(link);
        self.rotation_cdeg += rotation_cdeg;
        self.rotation_ns += f64::from(model.block_period_ns()) * periods;
        if self.rotation_ns > 0.0 {
            let revolutions_per_ns = self.rotation_cdeg / 36_000.0 / self.rotation_ns;
            stats.rpm = Some(revolutions_per_ns * 60e9);
        }
    }
}

fn one_by_one(block: &FiringBlock<'_>, emit: &mut impl FnMut(&Firing<'_>)) {
    for firing in block.firings() {
        emit(&firing);
    }
}

/// Kind of the returns in a packet without pairs.
const fn single_echo(mode: ReturnMode) -> ReturnKind {
    match mode {
        ReturnMode::Strongest => ReturnKind::Strongest,
        ReturnMode::Last => ReturnKind::Last,
        ReturnMode::Dual | ReturnMode::Unknown(_) => ReturnKind::Unknown,
    }
}
