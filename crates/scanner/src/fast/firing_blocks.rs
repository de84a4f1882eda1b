//! Places all points of a firing block together.
//!
//! Equal to [`Alignment::place`] for every point within a nanosecond and a nanometre. While a block
//! fires the clock is a straight line and the angle a cubic, so both are looked up once per block
//! and extrapolated to its 32 channels. Where that does not hold (edges of a sweep, ends of the
//! trajectory, kinks of the clock) the points are placed one by one. Results depend on the block
//! alone, not on the blocks before it.

use std::ops::Range;

use cloud::mount::Tilt;
use cloud::{Fields, Points, Spare};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use lidar::{Firing, FiringBlock, ReturnLayer};
use units::{Degrees, Host, Span, Stamp};

use super::clock_cursor::{ClockCursor, Tangent};
use super::compress::{CompressedRows, Destinations};
use super::lanes::{BLOCK_ROWS, CHANNELS, load};
use super::spans::{Coverage, SpanCursor};
use super::trajectory_cursor::{BlockAngle, TrajectoryCursor};
use crate::alignment::{Alignment, PlacementCounts};

/// Greatest number of points of one packet: 12 blocks of 32 channels, and rows written beyond them.
pub(crate) const MAX_PACKET_POINTS: usize = 12 * CHANNELS + BLOCK_ROWS;
/// Twice the rounding error of a time.
const ROUNDING_MARGIN: Span = Span::from_nanos(2);

/// Places firing blocks. Its columns are aligned to cache lines, so that no register spans two.
#[repr(C, align(64))]
pub(crate) struct FiringBlockPlacer<'a> {
    /// Tilt of each channel relative to the block's pose.
    ahead_rad: [f64; CHANNELS],
    /// Variance of the tilt at each channel, if points have the column `sd`.
    tilt_variance_rad2: [f64; CHANNELS],
    alignment: &'a Alignment,
    clock: ClockCursor<'a>,
    trajectory: TrajectoryCursor<'a>,
    spans: SpanCursor<'a>,
    /// Approximate receive time of the next blocks, if device times occur twice.
    received: Option<Stamp<Host>>,
    /// Widest registers of the processor. The width changes no result: operations and their order
    /// are the same.
    level: Level,
}

/// Time and tilt at the beginning of a block.
struct Pose {
    tangent: Tangent,
    angle: Degrees,
    tilt: Tilt,
    /// An instant not before the last channel fires.
    last: Stamp<Host>,
}

/// Method to place a block.
enum BlockPlacement {
    Together(Pose),
    Outside,
    OneByOne,
}

/// Returns in a block.
pub(crate) fn returns(block: &FiringBlock<'_>) -> u64 {
    let (first, second) = block.layers();
    let second = second.map_or(0, |second| second.kept().count_ones());
    u64::from(first.kept().count_ones() + second)
}

impl<'a> FiringBlockPlacer<'a> {
    pub(crate) fn new(alignment: &'a Alignment) -> Self {
        Self {
            alignment,
            clock: ClockCursor::new(&alignment.clock),
            trajectory: TrajectoryCursor::new(&alignment.trajectory),
            spans: SpanCursor::new(&alignment.spans),
            received: None,
            ahead_rad: [0.0; CHANNELS],
            tilt_variance_rad2: [0.0; CHANNELS],
            level: Level::new(),
        }
    }

    /// A placer that uses the registers of `level`.
    #[cfg(test)]
    fn with_level(alignment: &'a Alignment, level: Level) -> Self {
        Self {
            level,
            ..Self::new(alignment)
        }
    }

    /// Notes the arrival of a block's packet, which a decoder emits when the next one arrives.
    #[inline(always)]
    fn received(&mut self, host: Stamp<Host>) {
        if self.alignment.clock.is_cut() && self.received != Some(host) {
            self.received = Some(host);
            self.clock.received(host);
        }
    }

    /// Adds the points of a firing block to a batch.
    pub(crate) fn place(
        &mut self,
        block: &FiringBlock<'_>,
        batch: &mut Points,
        counts: &mut PlacementCounts,
    ) {
        dispatch!(self.level, simd => self.place_by(simd, block, batch, counts));
    }

    #[inline(always)]
    fn place_by<S: Simd>(
        &mut self,
        simd: S,
        block: &FiringBlock<'_>,
        batch: &mut Points,
        counts: &mut PlacementCounts,
    ) {
        let (first, second) = block.layers();
        // A second layer without points is the same as none.
        let second = second.filter(|second| second.kept() != 0);
        if first.kept() == 0 && second.is_none() {
            return;
        }
        self.received(block.began);
        match self.placement(simd, block) {
            BlockPlacement::Together(pose) => {
                if batch.fields().contains(Fields::SD) {
                    self.find_tilt_variances(block, &pose);
                }
                let Some(mut rows) = batch.spare() else {
                    return;
                };
                let points = match second {
                    None => self.fill(simd, block, [first], &pose, &mut rows),
                    Some(second) => self.fill(simd, block, [first, second], &pose, &mut rows),
                };
                batch.keep(points);
                counts.points += points as u64;
            }
            BlockPlacement::Outside => counts.outside += returns(block),
            BlockPlacement::OneByOne => one_by_one(
                self.alignment,
                self.received,
                block.firings(),
                batch,
                counts,
            ),
        }
    }

    /// Adds the points of some firings of a block, by the definition.
    pub(crate) fn place_firings(
        &mut self,
        block: &FiringBlock<'_>,
        firings: Range<usize>,
        batch: &mut Points,
        counts: &mut PlacementCounts,
    ) {
        self.received(block.began);
        let firings = block.firings().take(firings.end).skip(firings.start);
        one_by_one(self.alignment, self.received, firings, batch, counts);
    }

    /// Looks up time and angle of a block.
    #[inline(always)]
    fn placement<S: Simd>(&mut self, simd: S, block: &FiringBlock<'_>) -> BlockPlacement {
        // A calibration's tilt is no cubic.
        if self.alignment.calibration.is_some() {
            return BlockPlacement::OneByOne;
        }
        let Some(tangent) = self.clock.tangent(block.start, block.length()) else {
            return BlockPlacement::OneByOne;
        };
        let start = tangent.at.host;
        let last = start
            .saturating_add(tangent.stretched(block.length()))
            .saturating_add(ROUNDING_MARGIN);
        match self.spans.within(start, last) {
            Coverage::None => return BlockPlacement::Outside,
            Coverage::Some => return BlockPlacement::OneByOne,
            Coverage::All => {}
        }
        let delays_ns = block.delays_f64_ns();
        let motion = self
            .trajectory
            .follow(simd, &tangent, last, delays_ns, &mut self.ahead_rad);
        match motion {
            BlockAngle::Unknown => BlockPlacement::Outside,
            BlockAngle::OneByOne => BlockPlacement::OneByOne,
            BlockAngle::Known(angle, tilt) => BlockPlacement::Together(Pose {
                tangent,
                angle,
                tilt,
                last,
            }),
        }
    }

    /// Finds the variance of the tilt at each channel.
    #[inline(never)]
    fn find_tilt_variances(&mut self, block: &FiringBlock<'_>, pose: &Pose) {
        let sd_ns = |after| {
            self.alignment
                .clock_sd_ns(block.start + Span::from_nanos(after), self.received)
        };
        let mut clock_sd_ns = [sd_ns(0); CHANNELS];
        // It changes from cell to cell of the clock, of which a recording has few.
        if sd_ns(block.length().as_nanos()).to_bits() != clock_sd_ns[0].to_bits() {
            clock_sd_ns = block.delays_ns().map(sd_ns);
        }
        self.trajectory.variances(
            &pose.tangent,
            pose.last,
            block.delays_f64_ns(),
            &clock_sd_ns,
            &mut self.tilt_variance_rad2,
        );
    }

    /// Writes every column of the batch, as many channels at a time as a register holds, and
    /// returns the number of points.
    ///
    /// Both returns of a channel are adjacent, that of the first layer first.
    #[inline(always)]
    fn fill<S: Simd, const L: usize>(
        &self,
        simd: S,
        block: &FiringBlock<'_>,
        layers: [&ReturnLayer<'_>; L],
        pose: &Pose,
        to: &mut Spare<'_, BLOCK_ROWS>,
    ) -> usize {
        let mount = &self.alignment.mount;
        let kept = CompressedRows::kept(layers);
        for channel in (0..CHANNELS).step_by(S::f64s::LEN) {
            let of = |column: &[f64; CHANNELS]| load(simd, column, channel);
            let destinations: Destinations<S, L> = kept.destinations(simd, channel);
            let (heading, ahead_rad) = (block.heading(of), of(&self.ahead_rad));
            let tilt = pose.tilt.ahead(ahead_rad);
            let [mut x_m, mut y_m, mut z_m] = [[ahead_rad; L]; 3];
            for layer in 0..L {
                let point = block.place(of(layers[layer].counts()), heading, of);
                [x_m[layer], y_m[layer], z_m[layer]] = mount.place(point, tilt);
            }
            destinations.put(to.x_m, x_m);
            destinations.put(to.y_m, y_m);
            destinations.put(to.z_m, z_m);
            if let Some(tilt_deg) = &mut to.tilt_deg {
                let degrees = ahead_rad * 1_f64.to_degrees() + pose.angle.0;
                destinations.put(tilt_deg, [degrees; L]);
            }
            let delays_ns = of(block.delays_f64_ns());
            if let Some(time) = &mut to.time {
                let nanos = pose.tangent.nanos(simd, delays_ns);
                destinations.put_times(time, [nanos; L]);
            }
            if let Some(device_time) = &mut to.device_time {
                let nanos = Tangent::of_device(block.start).nanos(simd, delays_ns);
                destinations.put_times(device_time, [nanos; L]);
            }
            if let Some(sd_m) = &mut to.sd_m {
                let tilt_variance = of(&self.tilt_variance_rad2);
                let azimuth_variance = of(block.azimuth_variances_rad2());
                let range_variance = self.alignment.range_sd_m * self.alignment.range_sd_m;
                let mut sds = [ahead_rad; L];
                for (layer, sd) in sds.iter_mut().enumerate() {
                    let point = [x_m[layer], y_m[layer], z_m[layer]];
                    let [tilt_arm, head_arm] = mount.arms_m2(point, tilt);
                    let by_tilt = tilt_arm * tilt_variance;
                    *sd = (by_tilt + range_variance + head_arm * azimuth_variance).sqrt();
                }
                destinations.put(sd_m, sds);
            }
        }
        if let Some(intensity) = &mut to.intensity {
            let mut reflectivities = [block.rings(); L];
            for (to, layer) in reflectivities.iter_mut().zip(layers) {
                *to = layer.reflectivities();
            }
            kept.put_bytes(simd, intensity, reflectivities);
        }
        if let Some(ring) = &mut to.ring {
            kept.put_bytes(simd, ring, [block.rings(); L]);
        }
        if let Some(laser) = &mut to.laser {
            kept.put_bytes(simd, laser, [block.lasers(); L]);
        }
        if let Some(echo) = &mut to.echo {
            let codes = block.echo_codes();
            let mut of = [&codes[0]; L];
            for (of, codes) in of.iter_mut().zip(&codes) {
                *of = codes;
            }
            kept.put_bytes(simd, echo, of);
        }
        kept.count()
    }
}

/// Places the points of firings by the definition.
#[cold]
fn one_by_one<'f>(
    alignment: &Alignment,
    received: Option<Stamp<Host>>,
    firings: impl Iterator<Item = Firing<'f>>,
    batch: &mut Points,
    counts: &mut PlacementCounts,
) {
    for point in firings.flat_map(|firing| firing.points()) {
        match alignment.place_received(&point, received) {
            Some(point) => {
                counts.points += 1;
                batch.push(point);
            }
            None => counts.outside += 1,
        }
    }
}

#[cfg(test)]
mod tests;
