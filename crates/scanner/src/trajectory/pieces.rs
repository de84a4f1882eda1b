//! A piecewise cubic over host time, the form of every method's result.

use units::{Degrees, Host, Real, Span, Stamp};

use crate::clock::Moment;

/// A cubic, valid until the next piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicPiece {
    /// Its start, the origin of its polynomial.
    pub from: Stamp<Host>,
    /// Degrees, degrees per nanosecond, and so on.
    pub deg: [f64; 4],
    /// Standard deviation of the angle along it, degrees, without errors common to a whole scan.
    pub sd_deg: f64,
}

/// Cubics in strictly increasing time, and the end of the last one.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseCubic {
    pieces: Vec<CubicPiece>,
    end: Stamp<Host>,
}

impl CubicPiece {
    /// A straight line that passes `deg` at its start.
    #[must_use]
    pub const fn line(from: Stamp<Host>, deg: f64, deg_per_ns: f64) -> Self {
        Self {
            from,
            deg: [deg, deg_per_ns, 0.0, 0.0],
            sd_deg: 0.0,
        }
    }

    /// The cubic that passes `a` degrees with slope `va` at its start and `b` with `vb` after
    /// `length_ns` (slopes in degrees per nanosecond).
    #[must_use]
    pub fn hermite(
        from: Stamp<Host>,
        length_ns: f64,
        [a, va]: [f64; 2],
        [b, vb]: [f64; 2],
    ) -> Self {
        let h = length_ns;
        let slope = (b - a) / h;
        Self {
            from,
            deg: [
                a,
                va,
                (3.0 * slope - 2.0 * va - vb) / h,
                (va + vb - 2.0 * slope) / (h * h),
            ],
            sd_deg: 0.0,
        }
    }

    /// The piece with a standard deviation.
    #[must_use]
    pub const fn with_sd(self, sd_deg: f64) -> Self {
        Self { sd_deg, ..self }
    }

    /// Degrees, `ns` after its start.
    #[inline(always)]
    pub(crate) fn at<V: Real>(&self, ns: V) -> V {
        let [c0, c1, c2, c3] = self.deg;
        ((ns * c3 + c2) * ns + c1) * ns + c0
    }

    /// Degrees per nanosecond, `ns` after its start.
    #[inline(always)]
    pub(crate) fn rate(&self, ns: f64) -> f64 {
        let [_, c1, c2, c3] = self.deg;
        c1 + ns * (2.0 * c2 + ns * (3.0 * c3))
    }

    /// Greatest magnitude of the rate within `length_ns` of its start, degrees per nanosecond.
    pub(super) fn fastest(&self, length_ns: f64) -> f64 {
        let [_, _, c2, c3] = self.deg;
        // Where the acceleration changes its sign; without one no number, or outside.
        let turn_ns = (-c2 / (3.0 * c3)).clamp(0.0, length_ns);
        let rates = [0.0, turn_ns, length_ns].map(|ns| self.rate(ns).abs());
        rates.into_iter().fold(0.0, f64::max)
    }

    /// Variance of the angle at a rate of `deg_per_ns` and a standard deviation of the instant,
    /// square radians.
    #[inline(always)]
    pub(crate) fn variance_rad2(&self, deg_per_ns: f64, clock_sd_ns: f64) -> f64 {
        let (own, by_clock) = (
            self.sd_deg.to_radians(),
            deg_per_ns.to_radians() * clock_sd_ns,
        );
        own * own + by_clock * by_clock
    }

    /// The coefficients of the polynomial about the instant `ns` after its start.
    #[inline(always)]
    pub(crate) fn about(&self, ns: f64) -> [f64; 4] {
        let [_, _, c2, c3] = self.deg;
        [self.at(ns), self.rate(ns), c2 + 3.0 * c3 * ns, c3]
    }

    pub(crate) fn since(&self, at: Moment) -> f64 {
        at.host.saturating_since(self.from).as_nanos() as f64 + at.rest_ns
    }
}

impl PiecewiseCubic {
    /// `pieces` until `end`. Of several with one start the last is kept; except for the first,
    /// pieces that start at the end or later are dropped. `None` without pieces.
    #[must_use]
    pub fn new(mut pieces: Vec<CubicPiece>, end: Stamp<Host>) -> Option<Self> {
        pieces.sort_by_key(|piece| piece.from);
        let first = pieces.first()?.from;
        pieces.retain(|piece| piece.from < end || piece.from == first);
        pieces.reverse();
        pieces.dedup_by_key(|piece| piece.from);
        pieces.reverse();
        Some(Self {
            pieces,
            end: end.max(first),
        })
    }

    /// First and last instant with an angle.
    #[must_use]
    pub fn span(&self) -> (Stamp<Host>, Stamp<Host>) {
        let first = self.pieces.first().map_or(self.end, |piece| piece.from);
        (first, self.end)
    }

    pub(crate) fn as_slice(&self) -> &[CubicPiece] {
        &self.pieces
    }

    /// The pieces from the one that contains `from` until `to`, with their lengths in nanoseconds.
    pub(super) fn within(
        &self,
        from: Stamp<Host>,
        to: Stamp<Host>,
    ) -> impl Iterator<Item = (&CubicPiece, f64)> {
        let first = self.pieces.partition_point(|piece| piece.from <= from);
        let first = first.saturating_sub(1);
        let ends = self.pieces.iter().skip(first + 1).map(|piece| piece.from);
        let pieces = self.pieces.iter().skip(first);
        let with_ends = pieces.zip(ends.chain([self.end]));
        with_ends
            .take_while(move |(piece, _)| piece.from <= to)
            .map(|(piece, end)| {
                let length = end.saturating_since(piece.from).max(Span::ZERO);
                (piece, length.as_nanos() as f64)
            })
    }

    /// The piece at an instant; `None` before the first and after the end, to the nanosecond.
    #[must_use]
    pub fn piece(&self, at: Moment) -> Option<&CubicPiece> {
        let (first, end) = self.span();
        if at.host < first || end < at.host {
            return None;
        }
        // The instant may be up to half a nanosecond before the first piece's start.
        let past = self.pieces.partition_point(|piece| at.reaches(piece.from));
        self.pieces.get(past.saturating_sub(1))
    }

    /// The angle at an instant; `None` before the first piece and after the end.
    #[must_use]
    pub fn angle(&self, at: Moment) -> Option<Degrees> {
        let piece = self.piece(at)?;
        Some(Degrees(piece.at(piece.since(at))))
    }

    /// The angle with a correction fitted to its residuals, whose error is that of the sum.
    pub(super) fn corrected(&self, other: &Self) -> Option<Self> {
        let starts = self.pieces.iter().chain(&other.pieces);
        let sums = starts.filter_map(|piece| {
            let at = Moment {
                host: piece.from,
                rest_ns: 0.0,
            };
            let (a, b) = (self.piece(at)?, other.piece(at)?);
            let [about_a, about_b] = [a, b].map(|p| p.about(p.since(at)));
            Some(CubicPiece {
                from: piece.from,
                deg: std::array::from_fn(|k| about_a[k] + about_b[k]),
                sd_deg: b.sd_deg,
            })
        });
        Self::new(sums.collect(), self.end)
    }

    /// Replaces the pieces within the time of `other`.
    pub(super) fn replace(&mut self, other: &Self) {
        let (from, to) = other.span();
        let (first, end) = self.span();
        let after = (to < end)
            .then(|| {
                self.piece(Moment {
                    host: to,
                    rest_ns: 0.0,
                })
            })
            .flatten()
            .map(|piece| {
                let ns = to.saturating_since(piece.from).as_nanos() as f64;
                CubicPiece {
                    from: to,
                    deg: piece.about(ns),
                    sd_deg: piece.sd_deg,
                }
            });
        let low = self.pieces.partition_point(|piece| piece.from < from);
        let high = self.pieces.partition_point(|piece| piece.from <= to);
        let new = other.pieces.iter().copied().chain(after);
        self.pieces.splice(low..high.max(low), new);
        self.end = end.max(to);
        debug_assert!(first.min(from) == self.span().0);
    }

    /// Moves the curve in time.
    pub(super) fn shift(&mut self, by: Span) {
        for piece in &mut self.pieces {
            piece.from = piece.from.saturating_add(by);
        }
        self.end = self.end.saturating_add(by);
    }

    /// Raises the deviations of the pieces within a span to at least `sd_deg`.
    pub(super) fn raise_sd(&mut self, (from, to): (Stamp<Host>, Stamp<Host>), sd_deg: f64) {
        let low = self.pieces.partition_point(|piece| piece.from <= from);
        let high = self.pieces.partition_point(|piece| piece.from <= to);
        for piece in self
            .pieces
            .get_mut(low.saturating_sub(1)..high)
            .unwrap_or_default()
        {
            piece.sd_deg = piece.sd_deg.max(sd_deg);
        }
    }

    /// Adds an error of time `sd_ns` to each piece's deviation, at the speed in its middle.
    pub(super) fn widen(&mut self, sd_ns: f64) {
        let starts = self.pieces.iter().skip(1).map(|piece| piece.from);
        let ends: Vec<Stamp<Host>> = starts.chain([self.end]).collect();
        for (piece, end) in self.pieces.iter_mut().zip(ends) {
            let half_ns = end.saturating_since(piece.from).half().as_nanos() as f64;
            piece.sd_deg = piece.sd_deg.hypot(piece.rate(half_ns) * sd_ns);
        }
    }

    /// Drops pieces that end before `host`.
    pub(crate) fn drop_before(&mut self, host: Stamp<Host>) {
        let past = self.pieces.partition_point(|piece| piece.from <= host);
        self.pieces.drain(..past.saturating_sub(1));
    }

    /// Continues with `piece` until `end`, in place of pieces that do not start earlier.
    pub(crate) fn append(&mut self, piece: CubicPiece, end: Stamp<Host>) {
        while self.pieces.len() > 1
            && self
                .pieces
                .last()
                .is_some_and(|last| last.from >= piece.from)
        {
            self.pieces.pop();
        }
        self.pieces.push(piece);
        self.end = self.end.max(end);
    }
}
