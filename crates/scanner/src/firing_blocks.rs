//! Placing all points of a block together: the fast path.
//!
//! The same as [`Alignment::place`] for every point, to a nanosecond and a nanometre: the clock is a straight line while a block
//! fires, the angle a few of them, so both are looked up once and carried on from there in columns of 32 channels. Where
//! that does not hold (the edge of a sweep, the ends of the angle's record, a kink of the clock) the points go one by one.
//! Results depend on the block alone, not on what came before it. Left out: what any of it means.

mod rows;
mod spans;

use cloud::mount::Tilt;
use cloud::{Fields, Points, Spare};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use lidar::{FiringBlock, Layer};
use units::{Degrees, Host, Span, Stamp};

use self::rows::{Places, Rows};
use self::spans::{SpanCursor, Within};
use crate::clock::{ClockCursor, Tangent};
use crate::lanes::load;
use crate::scanner::{Alignment, Placed};
use crate::trajectory::{Motion, TrajectoryCursor};

/// Channels of a block.
const N: usize = 32;
/// The most points that a block makes, both returns of a pair of them.
const ROOM: usize = 2 * N;
/// The most points that one packet makes: 12 blocks of 32 channels, and room to write beyond.
pub(crate) const MOST_POINTS: usize = 12 * N + ROOM;
/// What rounding may make of a time, twice over.
const EDGE: Span = Span::from_nanos(2);

/// Places firing blocks by an alignment. Its columns begin where lines of the cache do, so that no register's worth lies across two.
#[repr(C, align(64))]
pub(crate) struct FiringBlockPlacer<'a> {
    /// How far the platform turns from the block's start until each channel fires.
    ahead_rad: [f64; N],
    /// Variance of the tilt at each channel, square radians, where it is wanted.
    tilt_variance_rad2: [f64; N],
    alignment: &'a Alignment,
    clock: ClockCursor<'a>,
    trajectory: TrajectoryCursor<'a>,
    spans: SpanCursor<'a>,
    /// About when what comes next arrived, as far as it matters.
    near: Option<Stamp<Host>>,
    /// The widest registers that the processor has. They change no result: the operations are the same in the same order.
    level: Level,
}

/// When and how a block begins.
struct Pose {
    tangent: Tangent,
    angle: Degrees,
    tilt: Tilt,
    /// Not before the last channel fires.
    last: Stamp<Host>,
}

/// What becomes of a block.
enum Verdict {
    Place(Pose),
    LeaveOut,
    OneByOne,
}

impl<'a> FiringBlockPlacer<'a> {
    pub(crate) fn new(alignment: &'a Alignment) -> Self {
        Self {
            alignment,
            clock: alignment.clock.cursor(),
            trajectory: alignment.trajectory.cursor(),
            spans: SpanCursor::new(alignment.spans()),
            near: None,
            ahead_rad: [0.0; N],
            tilt_variance_rad2: [0.0; N],
            level: Level::new(),
        }
    }

    /// The same with other registers.
    #[cfg(test)]
    fn with_level(alignment: &'a Alignment, level: Level) -> Self {
        Self {
            level,
            ..Self::new(alignment)
        }
    }

    /// Tells about when what comes next arrived.
    pub(crate) fn near(&mut self, host: Stamp<Host>) {
        if self.alignment.clock.is_cut() {
            self.near = Some(host);
            self.clock.near(host);
        }
    }

    /// Adds the points of a firing block to a batch.
    pub(crate) fn place(
        &mut self,
        block: &FiringBlock<'_>,
        batch: &mut Points,
        placed: &mut Placed,
    ) {
        dispatch!(self.level, simd => self.place_by(simd, block, batch, placed));
    }

    #[inline(always)]
    fn place_by<S: Simd>(
        &mut self,
        simd: S,
        block: &FiringBlock<'_>,
        batch: &mut Points,
        placed: &mut Placed,
    ) {
        let (first, second) = block.layers();
        // A second return that is no point is like none.
        let second = second.filter(|second| second.kept() != 0);
        if first.kept() == 0 && second.is_none() {
            return;
        }
        match self.judge(simd, block) {
            Verdict::Place(pose) => {
                if batch.fields().contains(Fields::SD) {
                    self.weigh(block, &pose);
                }
                let Some(mut rows) = batch.spare() else {
                    return;
                };
                let points = match second {
                    None => self.fill(simd, block, [first], &pose, &mut rows),
                    Some(second) => self.fill(simd, block, [first, second], &pose, &mut rows),
                };
                batch.keep(points);
                placed.points += points as u64;
            }
            Verdict::LeaveOut => {
                let returns = first.kept().count_ones();
                let second = second.map_or(0, |second| second.kept().count_ones());
                placed.outside += u64::from(returns + second);
            }
            Verdict::OneByOne => one_by_one(self.alignment, self.near, block, batch, placed),
        }
    }

    /// Looks up time and angle of a firing block.
    #[inline(always)]
    fn judge<S: Simd>(&mut self, simd: S, block: &FiringBlock<'_>) -> Verdict {
        let Some(tangent) = self.clock.tangent(block.start, block.length()) else {
            return Verdict::OneByOne;
        };
        let start = tangent.at.host;
        let last = start
            .saturating_add(tangent.stretched(block.length()))
            .saturating_add(EDGE);
        match self.spans.within(start, last) {
            Within::None => return Verdict::LeaveOut,
            Within::Some => return Verdict::OneByOne,
            Within::All => {}
        }
        let delays_ns = block.delays_f64_ns();
        let motion = self
            .trajectory
            .follow(simd, &tangent, last, delays_ns, &mut self.ahead_rad);
        match motion {
            Motion::Unknown => Verdict::LeaveOut,
            Motion::MomentByMoment => Verdict::OneByOne,
            Motion::Known(angle, tilt) => Verdict::Place(Pose {
                tangent,
                angle,
                tilt,
                last,
            }),
        }
    }

    /// How well the tilt is known at each channel.
    #[inline(never)]
    fn weigh(&mut self, block: &FiringBlock<'_>, pose: &Pose) {
        let sd_ns = |after| {
            self.alignment
                .clock_sd_ns(block.start + Span::from_nanos(after), self.near)
        };
        let mut clock_sd_ns = [sd_ns(0); N];
        // It changes from cell to cell, of which a recording has few.
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

    /// Writes every column that is wanted, as many channels at a time as a register holds; how many points that makes.
    ///
    /// Of two layers both returns of a channel stand side by side, the first layer's first.
    #[inline(always)]
    fn fill<S: Simd, const L: usize>(
        &self,
        simd: S,
        block: &FiringBlock<'_>,
        layers: [&Layer<'_>; L],
        pose: &Pose,
        to: &mut Spare<'_, ROOM>,
    ) -> usize {
        let mount = &self.alignment.mount;
        let kept = Rows::kept(layers);
        for channel in (0..N).step_by(S::f64s::LEN) {
            let of = |column: &[f64; N]| load(simd, column, channel);
            let places: Places<S, L> = kept.places(simd, channel);
            let (heading, ahead_rad) = (block.heading(of), of(&self.ahead_rad));
            let tilt = pose.tilt.ahead(ahead_rad);
            let [mut x_m, mut y_m, mut z_m] = [[ahead_rad; L]; 3];
            for layer in 0..L {
                let point = block.place(of(layers[layer].counts()), heading, of);
                [x_m[layer], y_m[layer], z_m[layer]] = mount.place(point, tilt);
            }
            places.put(to.x_m, x_m);
            places.put(to.y_m, y_m);
            places.put(to.z_m, z_m);
            if let Some(tilt_deg) = &mut to.tilt_deg {
                let degrees = ahead_rad * 1_f64.to_degrees() + pose.angle.0;
                places.put(tilt_deg, [degrees; L]);
            }
            let delays_ns = of(block.delays_f64_ns());
            if let Some(time) = &mut to.time {
                let nanos = pose.tangent.nanos(simd, delays_ns);
                places.put_times(time, [nanos; L]);
            }
            if let Some(device_time) = &mut to.device_time {
                let nanos = Tangent::of_device(block.start).nanos(simd, delays_ns);
                places.put_times(device_time, [nanos; L]);
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
                places.put(sd_m, sds);
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

/// Places the points of a firing block by the definition.
#[cold]
fn one_by_one(
    alignment: &Alignment,
    near: Option<Stamp<Host>>,
    block: &FiringBlock<'_>,
    batch: &mut Points,
    placed: &mut Placed,
) {
    for point in block.firings().flat_map(|firing| firing.points()) {
        match alignment.place_near(&point, near) {
            Some(point) => {
                placed.points += 1;
                batch.push(point);
            }
            None => placed.outside += 1,
        }
    }
}

#[cfg(test)]
mod tests;
