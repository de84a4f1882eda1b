//! Placing all points of a block together: the fast path.
//!
//! The same as [`Alignment::place`] for every point, to a nanosecond and a nanometre: the clock is a straight line while a block
//! fires, the angle a few of them, so both are looked up once and carried on from there in columns of 32 channels. Where
//! that does not hold (the edge of a sweep, the ends of the angle's record, a kink of the clock) the points go one by one.
//! Results depend on the block alone, not on what came before it. Left out: what any of it means.

use cloud::mount::Tilts;
use cloud::{Fields, Order, Points, Spare};
use fearless_simd::{Avx2, Level, Simd};
use lidar::{Layer, Volley};
use units::{Degrees, Host, Span, Stamp};

use crate::clock::{ClockCursor, Tangent};
use crate::scanner::{Alignment, Placed};
use crate::trajectory::{Motion, TrajectoryCursor};

/// Channels of a block.
const N: usize = 32;
/// The most points that one packet makes: 12 blocks of 32 channels, and room to write beyond.
pub(crate) const MOST_POINTS: usize = 16 * N;
/// What rounding may make of a time, twice over.
const EDGE: Span = Span::from_nanos(2);

/// Places volleys by an alignment.
pub(crate) struct VolleyPlacer<'a> {
    alignment: &'a Alignment,
    clock: ClockCursor<'a>,
    trajectory: TrajectoryCursor<'a>,
    spans: SpanCursor<'a>,
    /// About when what comes next arrived, as far as it matters.
    near: Option<Stamp<Host>>,
    /// How far the platform turns from the block's start until each channel fires.
    ahead_rad: [f64; N],
    tilts: Tilts<N>,
    /// Variance of the tilt at each channel, square radians, where it is wanted.
    tilt_variance_rad2: [f64; N],
    /// Wider registers, where the processor has them. They change no result: the operations are the same in the same order.
    avx2: Option<Avx2>,
}

/// When and how a block begins.
struct Pose {
    tangent: Tangent,
    angle: Degrees,
    /// Not before the last channel fires.
    last: Stamp<Host>,
}

/// What becomes of a block.
enum Verdict {
    Place(Pose),
    LeaveOut,
    OneByOne,
}

impl<'a> VolleyPlacer<'a> {
    pub(crate) fn new(alignment: &'a Alignment) -> Self {
        Self {
            alignment,
            clock: alignment.clock.cursor(),
            trajectory: alignment.trajectory.cursor(),
            spans: SpanCursor::new(alignment.spans()),
            near: None,
            ahead_rad: [0.0; N],
            tilts: Tilts::default(),
            tilt_variance_rad2: [0.0; N],
            avx2: Level::new().as_avx2(),
        }
    }

    /// The same without wider registers.
    #[cfg(test)]
    fn plain(alignment: &'a Alignment) -> Self {
        Self {
            avx2: None,
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

    /// Adds the points of a volley to a batch.
    pub(crate) fn place(&mut self, volley: &Volley<'_>, batch: &mut Points, placed: &mut Placed) {
        match self.avx2 {
            Some(avx2) => avx2.vectorize(
                #[inline(always)]
                || self.place_by(volley, batch, placed),
            ),
            None => self.place_by(volley, batch, placed),
        }
    }

    #[inline(always)]
    fn place_by(&mut self, volley: &Volley<'_>, batch: &mut Points, placed: &mut Placed) {
        let (first, second) = volley.layers();
        match self.judge(volley) {
            Verdict::Place(pose) => {
                if batch.fields().contains(Fields::SD) {
                    self.weigh(volley, &pose);
                }
                let points = match second {
                    None => self.place_one(volley, first, &pose, batch),
                    Some(second) => self.place_two(volley, [first, second], &pose, batch),
                };
                placed.points += points as u64;
            }
            Verdict::LeaveOut => {
                let returns = first.kept().count_ones();
                let second = second.map_or(0, |second| second.kept().count_ones());
                placed.outside += u64::from(returns + second);
            }
            Verdict::OneByOne => one_by_one(self.alignment, self.near, volley, batch, placed),
        }
    }

    /// Looks up time and angle of a volley.
    #[inline(always)]
    fn judge(&mut self, volley: &Volley<'_>) -> Verdict {
        let Some(tangent) = self.clock.tangent(volley.start, volley.length()) else {
            return Verdict::OneByOne;
        };
        let length_ns = volley.length().as_nanos();
        let stretched_ns = length_ns + (length_ns as f64 * tangent.gain) as i64;
        let start = tangent.at.host;
        let last = start
            .saturating_add(Span::from_nanos(stretched_ns))
            .saturating_add(EDGE);
        match self.spans.within(start, last) {
            Within::None => return Verdict::LeaveOut,
            Within::Some => return Verdict::OneByOne,
            Within::All => {}
        }
        let delays_ns = volley.delays_f64_ns();
        let motion = self
            .trajectory
            .follow(&tangent, last, delays_ns, &mut self.ahead_rad);
        match motion {
            Motion::Unknown => Verdict::LeaveOut,
            Motion::MomentByMoment => Verdict::OneByOne,
            Motion::Known(angle, tilt) => {
                self.tilts.set(tilt, &self.ahead_rad);
                Verdict::Place(Pose {
                    tangent,
                    angle,
                    last,
                })
            }
        }
    }

    /// How well the tilt is known at each channel.
    #[inline(never)]
    fn weigh(&mut self, volley: &Volley<'_>, pose: &Pose) {
        let sd_ns = |after| {
            self.alignment
                .clock_sd_ns(volley.start + Span::from_nanos(after), self.near)
        };
        let mut clock_sd_ns = [sd_ns(0); N];
        // It changes from cell to cell, of which a recording has few.
        if sd_ns(volley.length().as_nanos()).to_bits() != clock_sd_ns[0].to_bits() {
            clock_sd_ns = volley.delays_ns().map(sd_ns);
        }
        self.trajectory.variances(
            &pose.tangent,
            pose.last,
            volley.delays_f64_ns(),
            &clock_sd_ns,
            &mut self.tilt_variance_rad2,
        );
    }

    /// How far each point is expected to be off: [`Alignment::sd_m`] in columns, of points that are placed.
    #[inline(never)]
    fn fill_sd(&self, volley: &Volley<'_>, [x_m, y_m, z_m]: [&[f64; N]; 3], sd_m: &mut [f64; N]) {
        let (mount, tilts) = (&self.alignment.mount, &self.tilts);
        let range_variance_m2 = self.alignment.range_sd_m * self.alignment.range_sd_m;
        let azimuth_variance_rad2 = volley.azimuth_variances_rad2();
        for i in 0..N {
            let [tilt_arm, head_arm] = mount.arms_m2([x_m[i], y_m[i], z_m[i]], tilts.get(i));
            let by_tilt = tilt_arm * self.tilt_variance_rad2[i];
            let by_azimuth = head_arm * azimuth_variance_rad2[i];
            sd_m[i] = (by_tilt + range_variance_m2 + by_azimuth).sqrt();
        }
    }

    /// Places the only return of each channel; how many points that makes.
    #[inline(always)]
    fn place_one(
        &self,
        volley: &Volley<'_>,
        layer: &Layer<'_>,
        pose: &Pose,
        batch: &mut Points,
    ) -> usize {
        let kept = layer.kept();
        if kept == u32::MAX {
            if let Some(mut rows) = batch.spare() {
                self.fill(volley, [layer], pose, &mut rows);
            }
            batch.keep_all(N);
            return N;
        }
        if let Some(mut rows) = batch.spare_beyond() {
            self.fill(volley, [layer], pose, &mut rows);
        }
        let order = Order::of(kept);
        batch.keep(&order);
        order.len()
    }

    /// Places both returns of each channel, of one channel side by side; how many points that makes.
    #[inline(always)]
    fn place_two(
        &self,
        volley: &Volley<'_>,
        layers: [&Layer<'_>; 2],
        pose: &Pose,
        batch: &mut Points,
    ) -> usize {
        if let Some(mut rows) = batch.spare_beyond() {
            self.fill(volley, layers, pose, &mut rows);
        }
        let order = Order::of_pairs(layers[0].kept(), layers[1].kept());
        batch.keep(&order);
        order.len()
    }

    /// Writes every column that is wanted, for all channels whether they have a return or not.
    #[inline(always)]
    fn fill<const L: usize>(
        &self,
        volley: &Volley<'_>,
        layers: [&Layer<'_>; L],
        pose: &Pose,
        rows: &mut Spare<'_, N, L>,
    ) {
        let (mount, tilts) = (&self.alignment.mount, &self.tilts);
        for (i, layer) in layers.into_iter().enumerate() {
            volley.place(
                layer,
                |channel, point| mount.place(point, tilts.get(channel)),
                &mut rows.x_m[i],
                &mut rows.y_m[i],
                &mut rows.z_m[i],
            );
            if let Some(intensity) = &mut rows.intensity {
                layer.reflectivities(&mut intensity[i]);
            }
            if let Some(ring) = &mut rows.ring {
                ring[i] = *volley.rings();
            }
            if let Some(laser) = &mut rows.laser {
                laser[i] = *volley.lasers();
            }
            if let Some(time) = &mut rows.time {
                pose.tangent.times(volley.delays_f64_ns(), &mut time[i]);
            }
            if let Some(device_time) = &mut rows.device_time {
                let start = volley.start.as_nanos();
                for (time, delay) in device_time[i].iter_mut().zip(volley.delays_ns()) {
                    *time = Stamp::from_nanos(start.wrapping_add(*delay));
                }
            }
            if let Some(tilt_deg) = &mut rows.tilt_deg {
                for (tilt_deg, ahead_rad) in tilt_deg[i].iter_mut().zip(&self.ahead_rad) {
                    *tilt_deg = pose.angle.0 + ahead_rad.to_degrees();
                }
            }
            if let Some(sd_m) = &mut rows.sd_m {
                let placed = [&rows.x_m[i], &rows.y_m[i], &rows.z_m[i]];
                self.fill_sd(volley, placed, &mut sd_m[i]);
            }
        }
    }
}

/// Places the points of a volley by the definition.
#[cold]
fn one_by_one(
    alignment: &Alignment,
    near: Option<Stamp<Host>>,
    volley: &Volley<'_>,
    batch: &mut Points,
    placed: &mut Placed,
) {
    for point in volley.firings().flat_map(|firing| firing.points()) {
        match alignment.place_near(&point, near) {
            Some(point) => {
                placed.points += 1;
                batch.push(point);
            }
            None => placed.outside += 1,
        }
    }
}

/// How much of a stretch of time lies within the spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Within {
    All,
    /// Some of it, or perhaps none.
    Some,
    None,
}

/// Follows spans through times that mostly grow.
#[derive(Clone, Debug)]
struct SpanCursor<'a> {
    spans: &'a [(Stamp<Host>, Stamp<Host>)],
    /// Stretch of time for which the last answer holds.
    holds: (Stamp<Host>, Stamp<Host>),
    answer: Within,
}

impl<'a> SpanCursor<'a> {
    const fn new(spans: &'a [(Stamp<Host>, Stamp<Host>)]) -> Self {
        Self {
            spans,
            holds: (Stamp::from_nanos(0), Stamp::from_nanos(-1)),
            answer: Within::None,
        }
    }

    #[inline]
    fn within(&mut self, start: Stamp<Host>, end: Stamp<Host>) -> Within {
        if self.holds.0 <= start && end <= self.holds.1 {
            return self.answer;
        }
        self.search(start, end)
    }

    #[cold]
    fn search(&mut self, start: Stamp<Host>, end: Stamp<Host>) -> Within {
        let around = self
            .spans
            .iter()
            .find(|(from, to)| *from <= start && end <= *to);
        if let Some(span) = around {
            (self.holds, self.answer) = (*span, Within::All);
            return Within::All;
        }
        if self
            .spans
            .iter()
            .any(|(from, to)| *from <= end && start <= *to)
        {
            return Within::Some;
        }
        let ends_before = self
            .spans
            .iter()
            .map(|span| span.1)
            .filter(|to| *to < start)
            .max();
        let begins_after = self
            .spans
            .iter()
            .map(|span| span.0)
            .filter(|from| end < *from)
            .min();
        let nearest = Span::from_nanos(1);
        self.holds = (
            ends_before.map_or(Stamp::from_nanos(i64::MIN), |to| to.saturating_add(nearest)),
            begins_after.map_or(Stamp::from_nanos(i64::MAX), |from| {
                from.saturating_add(-nearest)
            }),
        );
        self.answer = Within::None;
        Within::None
    }
}

#[cfg(test)]
mod tests;
