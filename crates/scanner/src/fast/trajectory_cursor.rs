//! Evaluates a trajectory along mostly increasing times, at all channels of a block together.

use cloud::mount::{MOST_AHEAD_RAD, Tilt};
use fearless_simd::prelude::*;
use units::{Degrees, Host, Span, Stamp};

use super::clock_cursor::Tangent;
use super::lanes::{CHANNELS, load, store};
use crate::clock::Moment;
use crate::trajectory::{CubicPiece, Curve, Trajectory};

/// Follows a trajectory through mostly increasing times.
#[derive(Clone, Debug)]
pub(super) struct TrajectoryCursor<'a> {
    fixed: Option<(Degrees, Tilt)>,
    pieces: &'a [CubicPiece],
    end: Stamp<Host>,
    /// The first piece after the last start.
    next: usize,
    anchor: Anchor,
}

/// An interval with a reference angle at its start, whose sine and cosine serve many blocks. Its
/// limits depend on the pieces alone.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    /// Index of the piece after its own.
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

    /// The anchor of `host` within `piece`, which ends at `end`.
    #[cold]
    fn new(next: usize, piece: &CubicPiece, end: Stamp<Host>, host: Stamp<Host>) -> Self {
        let whole_ns = end.saturating_since(piece.from).as_nanos().max(1);
        let fastest = fastest(&piece.deg, whole_ns as f64).to_radians();
        // The cast saturates, also at a rate of 0.
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

/// The angle over the instants of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BlockAngle {
    /// Unknown at all of them.
    Unknown,
    /// Unknown at some of them, or farther from the reference than [`MOST_AHEAD_RAD`].
    OneByOne,
    /// Known at all of them, relative to this reference.
    Known(Degrees, Tilt),
}

/// Twice the rounding error of an instant.
const ROUNDING_MARGIN: Span = Span::from_nanos(2);

impl<'a> TrajectoryCursor<'a> {
    pub(super) fn new(trajectory: &'a Trajectory) -> Self {
        let (fixed, pieces, end) = match trajectory.curve() {
            Curve::Fixed(angle) => (
                Some((*angle, Tilt::new(*angle))),
                [].as_slice(),
                Stamp::from_nanos(0),
            ),
            Curve::Piecewise(pieces) => (None, pieces.as_slice(), pieces.span().1),
        };
        Self {
            fixed,
            pieces,
            end,
            next: 0,
            anchor: Anchor::NONE,
        }
    }

    /// The angles `delays_ns` of device time after a tangent's start, none of them after `last`: a
    /// reference angle, and in `ahead_rad` the distance from it at each channel.
    #[inline(always)]
    pub(super) fn follow<S: Simd>(
        &mut self,
        simd: S,
        tangent: &Tangent,
        last: Stamp<Host>,
        delays_ns: &[f64; CHANNELS],
        ahead_rad: &mut [f64; CHANNELS],
    ) -> BlockAngle {
        let at = tangent.at;
        if let Some((angle, tilt)) = self.fixed {
            ahead_rad.fill(0.0);
            return BlockAngle::Known(angle, tilt);
        }
        self.seek(at);
        let (before, coming) = self.pieces.split_at_checked(self.next).unwrap_or_default();
        let Some(piece) = before
            .last()
            .filter(|_| last.saturating_add(ROUNDING_MARGIN) < self.end)
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
            return BlockAngle::OneByOne;
        }
        evaluate(simd, &about, anchor.angle, stretch, delays_ns, ahead_rad);
        if until <= last.saturating_add(ROUNDING_MARGIN)
            && !cross(
                simd,
                coming,
                anchor,
                &Crossing { at, last, stretch },
                delays_ns,
                ahead_rad,
            )
        {
            return BlockAngle::OneByOne;
        }
        BlockAngle::Known(anchor.angle, anchor.tilt)
    }

    /// Variances of the angles that [`TrajectoryCursor::follow`] last found, square radians, by the
    /// clock's standard deviation at each ([`Trajectory::variance_rad2`]).
    pub(super) fn variances(
        &self,
        tangent: &Tangent,
        last: Stamp<Host>,
        delays_ns: &[f64; CHANNELS],
        clock_sd_ns: &[f64; CHANNELS],
        variance_rad2: &mut [f64; CHANNELS],
    ) {
        variance_rad2.fill(0.0);
        let (before, coming) = self.pieces.split_at_checked(self.next).unwrap_or_default();
        let here = before.last().into_iter();
        let soon = coming
            .iter()
            .take_while(|piece| piece.from <= last.saturating_add(ROUNDING_MARGIN));
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

    /// Whether all of a block is outside the trajectory.
    #[cold]
    fn at_the_ends(
        &self,
        at: Moment,
        last: Stamp<Host>,
        coming: Option<&CubicPiece>,
    ) -> BlockAngle {
        let is_early = coming.is_some_and(|first| {
            self.next == 0 && last.saturating_add(ROUNDING_MARGIN) < first.from
        });
        if is_early || self.end < at.host || self.pieces.is_empty() {
            BlockAngle::Unknown
        } else {
            BlockAngle::OneByOne
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

/// An upper bound of the speed over `length_ns`.
#[inline(always)]
fn fastest(about: &[f64; 4], length_ns: f64) -> f64 {
    let [_, c1, c2, c3] = about;
    c1.abs() + length_ns * (2.0 * c2.abs() + length_ns * 3.0 * c3.abs())
}

/// Evaluates the polynomial `about` a block's start at each delay, relative to `angle`.
#[inline(always)]
fn evaluate<S: Simd>(
    simd: S,
    about: &[f64; 4],
    angle: Degrees,
    stretch: f64,
    delays_ns: &[f64; CHANNELS],
    ahead_rad: &mut [f64; CHANNELS],
) {
    let [c0, c1, c2, c3] = in_radians(about, angle, stretch);
    for at in (0..CHANNELS).step_by(S::f64s::LEN) {
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

/// The times of a block that extends into the next pieces.
struct Crossing {
    at: Moment,
    last: Stamp<Host>,
    stretch: f64,
}

/// Evaluates the pieces that begin within a block at the channels that fire in them. Returns
/// whether all angles are near the anchor.
#[inline(always)]
fn cross<S: Simd>(
    simd: S,
    coming: &[CubicPiece],
    anchor: &Anchor,
    block: &Crossing,
    delays_ns: &[f64; CHANNELS],
    ahead_rad: &mut [f64; CHANNELS],
) -> bool {
    let mut near = S::mask64s::splat(simd, true);
    for piece in coming {
        if piece.from > block.last.saturating_add(ROUNDING_MARGIN) {
            break;
        }
        let passed_ns =
            piece.from.saturating_since(block.at.host).as_nanos() as f64 - block.at.rest_ns;
        for at in (0..CHANNELS).step_by(S::f64s::LEN) {
            let ns = load(simd, delays_ns, at) * block.stretch + -passed_ns;
            let there = (piece.at(ns) + -anchor.angle.0) * 1_f64.to_radians();
            let ahead = ns.simd_ge(0.0).select(there, load(simd, ahead_rad, at));
            near &= ahead.abs().simd_le(MOST_AHEAD_RAD);
            store(ahead, ahead_rad, at);
        }
    }
    near.all_true()
}
