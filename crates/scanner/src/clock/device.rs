//! A device's clock as a function: lines, blended, in one piece or several.

use core::marker::PhantomData;

use units::{Host, Lidar, Span, Stamp};

use super::Arrival;
use super::envelope::BOUND_SDS;
use super::segment::{ClockSegment, Moment, OffsetLine};
use super::stretches::{Joint, Stretch, runs};

/// Maps device time to host time.
///
/// `C` is the device's clock. A clock that is set or restarts in mid-recording has several pieces.
#[derive(Clone, Debug)]
pub struct DeviceClock<C = Lidar> {
    origin_ns: i64,
    /// In order of recording, never empty.
    pieces: Vec<ClockPiece>,
    residual: Span,
    domain: PhantomData<fn() -> C>,
}

/// A stretch over which a device's clock runs without steps.
#[derive(Clone, Debug)]
pub(crate) struct ClockPiece {
    /// First and last arrival, device nanoseconds after the clock's origin.
    pub from_ns: f64,
    pub to_ns: f64,
    /// The last arrival by the device's clock.
    pub end_ns: i64,
    /// Receive time of the first arrival, by the host's clock of that time.
    pub received: Stamp<Host>,
    /// Whole nanoseconds from device time to host time, without the offsets of the lines.
    pub whole: i64,
    /// Sum of the host clock's steps before this piece.
    pub set_by: i64,
    /// Never empty.
    pub lines: Vec<OffsetLine>,
    /// Error bounds along the piece.
    pub cells: Vec<ErrorCell>,
}

/// Error bound of the clock from an instant until the next cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorCell {
    pub from_ns: f64,
    pub bound_ns: f64,
    /// Error of the host's own stamps, which the samples of other devices have too: the host's
    /// clock may have been set or slewed by so much.
    pub host_ns: f64,
    /// Standard deviation of the error.
    pub sd_ns: f64,
}

/// Device times this far outside a piece's arrivals may belong to it: lost packets at its end,
/// later firings of its last packet.
const PIECE_MARGIN_NS: f64 = 5e6;
/// Steps of less are as small as the delays of packets.
const SMALL_STEP_NS: i64 = 10_000_000;
/// Longest time from the stamp of a packet to its last firing.
const PACKET_NS: f64 = 1.4e6;

impl<C: Copy> DeviceClock<C> {
    /// Fits the envelope, in one piece. `None` without arrivals.
    ///
    /// Arrivals need not be in order. Cost: n log n.
    #[must_use]
    pub fn fit(arrivals: &[Arrival<C>]) -> Option<Self> {
        let mut sorted = arrivals.to_vec();
        sorted.sort_unstable_by_key(|a| (a.device, a.host));
        let stretch = Stretch {
            first: sorted.first()?.device,
            last: sorted.last()?.device,
            join: sorted.first()?.device,
            received: sorted.iter().map(|arrival| arrival.host).min()?,
            all: Vec::new(),
            sure: sorted,
        };
        Self::fit_pieces(&[stretch], &[]).map(|(clock, _)| clock)
    }

    /// A clock at the host's rate that passes `moment` at `device`.
    #[must_use]
    pub(crate) fn through(device: Stamp<C>, moment: Moment) -> Self {
        let host = moment.host.as_nanos();
        let line = OffsetLine {
            centre_ns: 0.0,
            offset_ns: moment.rest_ns,
            slope: 0.0,
        };
        Self {
            origin_ns: device.as_nanos(),
            pieces: vec![ClockPiece {
                from_ns: 0.0,
                to_ns: 0.0,
                end_ns: device.as_nanos(),
                received: moment.host,
                whole: host.wrapping_sub(device.as_nanos()),
                set_by: 0,
                lines: vec![line],
                cells: Vec::new(),
            }],
            residual: Span::ZERO,
            domain: PhantomData,
        }
    }

    /// Fits a piece to each stretch, with what happened between them. Returns the clock and the
    /// step of (arrival - device time) from each stretch to the next.
    pub(crate) fn fit_pieces(
        stretches: &[Stretch<C>],
        joints: &[Joint],
    ) -> Option<(Self, Vec<Span>)> {
        let origin_ns = stretches.first()?.first.as_nanos();
        let mut fitted: Vec<ClockPiece> = Vec::with_capacity(stretches.len());
        for run in runs(stretches, joints) {
            fitted.extend(run.fit(origin_ns)?);
        }
        let mut pieces: Vec<ClockPiece> = Vec::with_capacity(stretches.len());
        let mut late: Vec<i64> = Vec::new();
        let mut rises = Vec::new();
        let mut set_by = 0i64;
        let mut uncertain_ns = 0.0;
        for (stretch, mut piece) in stretches.iter().zip(fitted) {
            late.extend(stretch.sure.iter().map(|arrival| {
                let host = piece.host(arrival.device, origin_ns);
                arrival.host.saturating_since(host).as_nanos()
            }));
            if let Some(last) = pieces.last() {
                let by_host = joints.get(rises.len()) == Some(&Joint::HostWasSet);
                let (from, to) = if by_host {
                    (stretch.join, stretch.join)
                } else {
                    (Stamp::from_nanos(last.end_ns), stretch.join)
                };
                let before = last
                    .host(from, origin_ns)
                    .saturating_since(Stamp::from_nanos(from.as_nanos()));
                let after = piece
                    .host(to, origin_ns)
                    .saturating_since(Stamp::from_nanos(to.as_nanos()));
                let after = after.saturating_sub(Span::from_nanos(set_by));
                let rise = after.saturating_sub(before);
                if by_host {
                    set_by = set_by.saturating_add(rise.as_nanos());
                    // The size of the step has the errors of both lines.
                    let ends = last.cells.last().into_iter().chain(piece.cells.first());
                    uncertain_ns = ends.map(|cell| cell.bound_ns).sum();
                }
                rises.push(rise);
            }
            piece.whole = piece.whole.wrapping_sub(set_by);
            piece.set_by = set_by;
            for cell in &mut piece.cells {
                cell.bound_ns += uncertain_ns;
                cell.host_ns += uncertain_ns;
                cell.sd_ns = cell.sd_ns.hypot(uncertain_ns / BOUND_SDS);
            }
            pieces.push(piece);
        }
        let clock = Self {
            origin_ns,
            pieces,
            residual: median(late),
            domain: PhantomData,
        };
        Some((clock, rises))
    }

    /// The host time at which the device's clock read `device`.
    #[must_use]
    pub fn host(&self, device: Stamp<C>) -> Stamp<Host> {
        self.moment(device).host
    }

    /// Host time of `device`, with the remainder below a nanosecond.
    #[must_use]
    pub fn moment(&self, device: Stamp<C>) -> Moment {
        self.moment_near(device, None)
    }

    /// Like [`DeviceClock::moment`]. If the device's clock read `device` twice, the result is
    /// the time nearer to `near`, the receive time by the host's clock of that time. After a small
    /// step it follows from the first packet that was received after the step.
    #[must_use]
    pub fn moment_near(&self, device: Stamp<C>, near: Option<Stamp<Host>>) -> Moment {
        self.segment(device, near)
            .moment(device, self.since_origin(device))
    }

    /// Median delay of packets above the envelope: the typical delay of the link beyond its
    /// smallest.
    #[must_use]
    pub fn residual(&self) -> Span {
        self.residual
    }

    /// Greatest error of the clock, without the constant delay: see [`DeviceClock::bound_at`].
    #[must_use]
    pub fn bound(&self) -> Span {
        let cells = self.pieces.iter().flat_map(|piece| &piece.cells);
        span(cells.map(|cell| cell.bound_ns).fold(0.0, f64::max))
    }

    /// Greatest error of the host's own stamps, part of [`DeviceClock::bound`]: the host's clock
    /// may have been set or slewed where all packets came late, and the size of a step that was
    /// found has an error.
    #[must_use]
    pub fn host_bound(&self) -> Span {
        let cells = self.pieces.iter().flat_map(|piece| &piece.cells);
        span(cells.map(|cell| cell.host_ns).fold(0.0, f64::max))
    }

    /// Greatest error of the clock at `device`, without the constant delay.
    ///
    /// A statistical bound that holds along a whole recording in 99 of 100. It contains the wander
    /// of the oscillators across a block and 3.5 standard deviations of its line, which follow from
    /// the density of packets just above it. Where all packets of some seconds are later than
    /// chance allows, it contains their delay: steps too small to be found, and slews too fast to
    /// be followed.
    #[must_use]
    pub fn bound_at(&self, device: Stamp<C>) -> Span {
        let cell = self.cell(device, None);
        cell.map_or(Span::ZERO, |cell| span(cell.bound_ns))
    }

    /// Standard deviation of the clock at `device`, nanoseconds, without the constant delay; see
    /// [`DeviceClock::moment_near`] for `near`.
    ///
    /// It combines the standard deviation of the line with wander and common delays of packets,
    /// which count as uniform errors within [`DeviceClock::bound_at`].
    #[must_use]
    pub fn sd_near_ns(&self, device: Stamp<C>, near: Option<Stamp<Host>>) -> f64 {
        self.cell(device, near).map_or(0.0, |cell| cell.sd_ns)
    }

    fn cell(&self, device: Stamp<C>, near: Option<Stamp<Host>>) -> Option<&ErrorCell> {
        let x = self.since_origin(device);
        let cells = &self.piece(device, near)?.cells;
        let next = cells.partition_point(|cell| cell.from_ns <= x);
        cells.get(next.saturating_sub(1))
    }

    /// Drift of the device's clock against the host's at the middle of the recording, parts per
    /// million; positive if the device's seconds are long.
    #[must_use]
    pub fn drift_ppm(&self) -> f64 {
        let longest = self
            .pieces
            .iter()
            .max_by(|a, b| a.length_ns().total_cmp(&b.length_ns()));
        let line = longest.and_then(|piece| piece.lines.get(piece.lines.len() / 2));
        line.map_or(0.0, |line| line.slope * 1e6)
    }

    /// Greatest error of [`DeviceClock::drift_ppm`]: both ends of the longest piece may be off.
    #[must_use]
    pub fn drift_bound_ppm(&self) -> f64 {
        let lengths_ns = self.pieces.iter().map(ClockPiece::length_ns);
        let longest_ns = lengths_ns.fold(0.0, f64::max);
        let bound_ns = self.bound().as_secs_f64() * 1e9;
        2.0 * bound_ns / longest_ns.max(1.0) * 1e6
    }

    /// Whether the clock has several pieces.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.pieces.len() > 1
    }

    #[inline(always)]
    pub(crate) fn since_origin(&self, device: Stamp<C>) -> f64 {
        device.as_nanos().saturating_sub(self.origin_ns) as f64
    }

    /// The piece that contains `device`, or the nearest one.
    fn piece(&self, device: Stamp<C>, near: Option<Stamp<Host>>) -> Option<&ClockPiece> {
        if let [only] = self.pieces.as_slice() {
            return Some(only);
        }
        let x = self.since_origin(device);
        let outside_ns = |piece: &ClockPiece| {
            // The last packet has firings after its stamp, the first has none before.
            (piece.from_ns - x + PIECE_MARGIN_NS * f64::from(x < piece.from_ns))
                .max(x - piece.to_ns - PACKET_NS)
                .max(0.0)
        };
        let host = |piece: &ClockPiece| piece.segment(x).moment(device, x).host;
        let distance = |piece: &ClockPiece| {
            near.map_or(0, |near| {
                let recorded = host(piece).saturating_add(Span::from_nanos(piece.set_by));
                near.saturating_since(recorded).as_nanos().saturating_abs()
            })
        };
        let is_later = |a: &ClockPiece, b: &ClockPiece| {
            let apart = host(a).saturating_since(host(b)).as_nanos();
            match near {
                // Packets are late by as much as the clock was set.
                Some(near) if apart.abs() < SMALL_STEP_NS => near >= b.received,
                _ => distance(b) < distance(a),
            }
        };
        self.pieces.iter().reduce(|a, b| {
            let outside = outside_ns(b).total_cmp(&outside_ns(a));
            match outside.is_lt() || (outside.is_eq() && is_later(a, b)) {
                true => b,
                false => a,
            }
        })
    }

    /// The segment that contains `device`.
    #[inline(never)]
    pub(crate) fn segment(&self, device: Stamp<C>, near: Option<Stamp<Host>>) -> ClockSegment {
        let Some(piece) = self.piece(device, near) else {
            return ClockSegment::NONE;
        };
        let mut segment = piece.segment(self.since_origin(device));
        if self.is_cut() {
            let (mut from, mut to) = (
                piece.from_ns - PIECE_MARGIN_NS,
                piece.to_ns + PIECE_MARGIN_NS,
            );
            for other in &self.pieces {
                if other.from_ns > piece.to_ns {
                    to = to.min(other.from_ns);
                } else if other.to_ns < piece.from_ns && other.to_ns > from {
                    from = piece.from_ns;
                }
            }
            segment.from_ns = segment.from_ns.max(from);
            segment.to_ns = segment.to_ns.min(to);
        }
        segment
    }
}

impl ClockPiece {
    fn host<C>(&self, device: Stamp<C>, origin_ns: i64) -> Stamp<Host> {
        let x = device.as_nanos().saturating_sub(origin_ns) as f64;
        self.segment(x).moment(device, x).host
    }

    fn length_ns(&self) -> f64 {
        self.to_ns - self.from_ns
    }

    /// The segment that contains `x`: between the centres of two lines, or outside all of them.
    fn segment(&self, x: f64) -> ClockSegment {
        let next = self.lines.partition_point(|line| line.centre_ns <= x);
        let before = next.checked_sub(1).and_then(|i| self.lines.get(i)).copied();
        let after = self.lines.get(next).copied();
        let from_ns = before.map_or(f64::NEG_INFINITY, |line| line.centre_ns);
        let to_ns = after.map_or(f64::INFINITY, |line| line.centre_ns);
        ClockSegment {
            whole: self.whole,
            from_ns,
            to_ns,
            first: before.or(after).unwrap_or(OffsetLine::NONE),
            second: before.and(after),
            blend_ns: (from_ns, to_ns),
        }
    }
}

fn median(mut values: Vec<i64>) -> Span {
    let middle = values.len() / 2;
    if values.is_empty() {
        return Span::ZERO;
    }
    Span::from_nanos(*values.select_nth_unstable(middle).1)
}

pub(super) fn span(ns: f64) -> Span {
    Span::from_nanos(ns.ceil() as i64)
}
