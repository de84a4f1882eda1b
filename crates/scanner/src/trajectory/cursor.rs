//! Follows a trajectory through times that mostly grow: the angle at all channels of a block together.
//!
//! Left out: what the angles mean, and blocks at the ends of what is known, which are asked moment by moment.

use cloud::mount::{MOST_AHEAD_RAD, Tilt};
use fearless_simd::prelude::*;
use units::{Degrees, Host, Span, Stamp};

use super::pieces::{Piece, Pieces};
use crate::clock::{Moment, Tangent};
use crate::lanes::{load, store};

/// Follows a trajectory through times that mostly grow.
#[derive(Clone, Debug)]
pub struct TrajectoryCursor<'a> {
    fixed: Option<(Degrees, Tilt)>,
    pieces: &'a [Piece],
    end: Stamp<Host>,
    /// The first piece after the last start.
    next: usize,
    anchor: Anchor,
}

/// A stretch of time from whose start angles are counted, so that sine and cosine are computed once for many blocks. Where it
/// begins and ends depends on the pieces alone.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    /// Place of the piece after its own.
    next: usize,
    from: Stamp<Host>,
    /// Exclusive.
    until: Stamp<Host>,
    angle: Degrees,
    tilt: Tilt,
}

impl Anchor {
    const NONE: Self = Self {
        next: 0,
        from: Stamp::from_nanos(0),
        until: Stamp::from_nanos(0),
        angle: Degrees(0.0),
        tilt: Tilt::LEVEL,
    };

    #[inline(always)]
    fn holds(&self, next: usize, host: Stamp<Host>) -> bool {
        self.next == next && self.from <= host && host < self.until
    }

    /// The one that `host`, within a piece that goes until `end`, belongs to.
    #[cold]
    fn new(next: usize, piece: &Piece, end: Stamp<Host>, host: Stamp<Host>) -> Self {
        let whole_ns = end.saturating_since(piece.from).as_nanos().max(1);
        let fastest = piece.fastest(whole_ns as f64).to_radians();
        // As a number held to the range of the integer, at a rate of 0 too.
        let length_ns = ((MOST_AHEAD_RAD / 2.0 / fastest) as i64).clamp(1, whole_ns);
        let part = host.saturating_since(piece.from).as_nanos() / length_ns;
        let ahead = Span::from_nanos(part * length_ns);
        let angle = Degrees(piece.at(ahead.as_nanos() as f64));
        let from = piece.from.saturating_add(ahead);
        Self {
            next,
            from,
            until: from.saturating_add(Span::from_nanos(length_ns)).min(end),
            angle,
            tilt: Tilt::new(angle),
        }
    }
}

/// The angle over some instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// There is none at any of them.
    Unknown,
    /// Ask moment by moment: at some of them there may be none, or it goes farther than [`MOST_AHEAD_RAD`].
    MomentByMoment,
    /// From this it is counted.
    Known(Degrees, Tilt),
}

/// What rounding may make of an instant, twice over.
const EDGE: Span = Span::from_nanos(2);

impl<'a> TrajectoryCursor<'a> {
    pub(super) fn fixed(angle: Degrees) -> Self {
        Self {
            fixed: Some((angle, Tilt::new(angle))),
            pieces: &[],
            end: Stamp::from_nanos(0),
            next: 0,
            anchor: Anchor::NONE,
        }
    }

    pub(super) fn of(pieces: &'a Pieces) -> Self {
        Self {
            fixed: None,
            pieces: pieces.as_slice(),
            end: pieces.span().1,
            next: 0,
            anchor: Anchor::NONE,
        }
    }

    /// The angle at moments that are `delays_ns` after a tangent's start by the lidar's clock, none of them after `last`: some
    /// angle, and in `ahead_rad` how far it was on from there at each.
    #[inline(always)]
    pub fn follow<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        tangent: &Tangent,
        last: Stamp<Host>,
        delays_ns: &[f64; N],
        ahead_rad: &mut [f64; N],
    ) -> Motion {
        let at = tangent.at;
        if let Some((angle, tilt)) = self.fixed {
            ahead_rad.fill(0.0);
            return Motion::Known(angle, tilt);
        }
        self.seek(at);
        let (before, coming) = self.pieces.split_at_checked(self.next).unwrap_or_default();
        let Some(piece) = before
            .last()
            .filter(|_| last.saturating_add(EDGE) < self.end)
        else {
            return self.at_the_ends(at, last, coming.first());
        };
        let until = coming.first().map_or(self.end, |piece| piece.from);
        if !self.anchor.holds(self.next, at.host) {
            self.anchor = Anchor::new(self.next, piece, until, at.host);
        }
        let anchor = &self.anchor;
        let stretch = 1.0 + tangent.gain;
        let length_ns = last.saturating_since(at.host).as_nanos() as f64;
        let about = piece.about(piece.since(at));
        if fastest(&about, length_ns).to_radians() * length_ns > MOST_AHEAD_RAD / 2.0 {
            return Motion::MomentByMoment;
        }
        carry_on(simd, &about, anchor.angle, stretch, delays_ns, ahead_rad);
        if until <= last.saturating_add(EDGE)
            && !cross(
                simd,
                coming,
                anchor,
                &Crossing { at, last, stretch },
                delays_ns,
                ahead_rad,
            )
        {
            return Motion::MomentByMoment;
        }
        Motion::Known(anchor.angle, anchor.tilt)
    }

    /// Variances of the angles that [`TrajectoryCursor::follow`] last gave, square radians, where the clock has a standard deviation
    /// at each ([`super::Trajectory::variance_rad2`]).
    pub fn variances<const N: usize>(
        &self,
        tangent: &Tangent,
        last: Stamp<Host>,
        delays_ns: &[f64; N],
        clock_sd_ns: &[f64; N],
        variance_rad2: &mut [f64; N],
    ) {
        variance_rad2.fill(0.0);
        let (before, coming) = self.pieces.split_at_checked(self.next).unwrap_or_default();
        let here = before.last().into_iter();
        let soon = coming
            .iter()
            .take_while(|piece| piece.from <= last.saturating_add(EDGE));
        let (at, stretch) = (tangent.at, 1.0 + tangent.gain);
        for (i, piece) in here.chain(soon).enumerate() {
            let since_ns = piece.since(at);
            let channels = variance_rad2.iter_mut().zip(delays_ns).zip(clock_sd_ns);
            for ((variance, delay), clock_sd_ns) in channels {
                let ns = delay * stretch + since_ns;
                let there = piece.variance_rad2(piece.rate(ns), *clock_sd_ns);
                *variance = if i == 0 || ns >= 0.0 {
                    there
                } else {
                    *variance
                };
            }
        }
    }

    /// Whether all of a block is outside of what is known.
    #[cold]
    fn at_the_ends(&self, at: Moment, last: Stamp<Host>, coming: Option<&Piece>) -> Motion {
        let is_early =
            coming.is_some_and(|first| self.next == 0 && last.saturating_add(EDGE) < first.from);
        if is_early || self.end < at.host || self.pieces.is_empty() {
            Motion::Unknown
        } else {
            Motion::MomentByMoment
        }
    }

    /// Makes `next` the first piece after `at`.
    #[inline]
    fn seek(&mut self, at: Moment) {
        let is_past = |i: usize| {
            self.pieces
                .get(i)
                .is_some_and(|piece| at.reaches(piece.from))
        };
        if self
            .next
            .checked_sub(1)
            .is_some_and(|before| !is_past(before))
        {
            self.next = self.pieces.partition_point(|piece| at.reaches(piece.from));
        }
        while is_past(self.next) {
            self.next += 1;
        }
    }
}

/// Not exceeded by the speed over `length_ns`.
#[inline(always)]
fn fastest(about: &[f64; 4], length_ns: f64) -> f64 {
    let [_, c1, c2, c3] = about;
    c1.abs() + length_ns * (2.0 * c2.abs() + length_ns * 3.0 * c3.abs())
}

/// The polynomial `about` a block's start at each delay, counted from `angle`.
#[inline(always)]
fn carry_on<S: Simd, const N: usize>(
    simd: S,
    about: &[f64; 4],
    angle: Degrees,
    stretch: f64,
    delays_ns: &[f64; N],
    ahead_rad: &mut [f64; N],
) {
    let [c0, c1, c2, c3] = in_radians(about, angle, stretch);
    for at in (0..N).step_by(S::f64s::LEN) {
        let delay = load(simd, delays_ns, at);
        let cubic = ((delay * c3 + c2) * delay + c1) * delay + c0;
        store(cubic, ahead_rad, at);
    }
}

#[inline(always)]
fn in_radians([c0, c1, c2, c3]: &[f64; 4], angle: Degrees, stretch: f64) -> [f64; 4] {
    [
        (c0 - angle.0).to_radians(),
        c1.to_radians() * stretch,
        c2.to_radians() * stretch * stretch,
        c3.to_radians() * stretch * stretch * stretch,
    ]
}

/// A block that reaches into the next pieces.
struct Crossing {
    at: Moment,
    last: Stamp<Host>,
    stretch: f64,
}

/// Takes the pieces that begin within a block for the channels that fire in them; whether all stay near the anchor.
#[inline(always)]
fn cross<S: Simd, const N: usize>(
    simd: S,
    coming: &[Piece],
    anchor: &Anchor,
    block: &Crossing,
    delays_ns: &[f64; N],
    ahead_rad: &mut [f64; N],
) -> bool {
    let mut near = S::mask64s::splat(simd, true);
    for piece in coming {
        if piece.from > block.last.saturating_add(EDGE) {
            break;
        }
        let passed_ns =
            piece.from.saturating_since(block.at.host).as_nanos() as f64 - block.at.rest_ns;
        for at in (0..N).step_by(S::f64s::LEN) {
            let ns = load(simd, delays_ns, at) * block.stretch + -passed_ns;
            let there = (piece.at(ns) + -anchor.angle.0) * 1_f64.to_radians();
            let ahead = ns.simd_ge(0.0).select(there, load(simd, ahead_rad, at));
            near &= ahead.abs().simd_le(MOST_AHEAD_RAD);
            store(ahead, ahead_rad, at);
        }
    }
    near.all_true()
}
