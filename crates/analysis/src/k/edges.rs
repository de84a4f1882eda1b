//! Edges between bins of angle, and an exact test of the side of an edge on which a pair lies.
//!
//! Bins are found by comparing cosines; no arc cosine is taken.

use glam::DVec3;

use super::KError;
use super::dd::{COSINE_ERROR, Dd, Expansion, two_product};

/// The largest number of bins.
pub const MOST_BINS: usize = 32_768;

/// Distance of a dot product in f64 from the cosine of an edge below which a pair counts as on the
/// edge. Coordinates rounded to f64 move a dot product by 4e-16, and its own arithmetic by another
/// 4e-16.
pub const ON_EDGE: f64 = 2e-15;

/// Coordinates below this count as zero in the exact test, so that products of two keep all their
/// bits.
pub const LEAST_COORDINATE: f64 = 1e-120;

/// Error of a dot product and an edge in f64: 3 x 2^-53 for products and sums, 2^-53 for the edge,
/// and room for lengths that are off by [`super::UNIT_WITHIN`].
pub(super) const F64_BAND: f64 = 1e-15;

/// Bins of equal angle from 0 to 180 degrees.
///
/// With `t_j = j pi / bins`, a pair of directions `a`, `b` belongs to the least bin `j >= 1` for
/// which `a.b >= cos t_j`; the last bin takes the rest. So a pair exactly on an edge belongs to the
/// bin of smaller angles. `a.b` is the dot product in real numbers of the coordinates as given,
/// `cos t_j` the real cosine: nothing is rounded in the definition, and a comparison that rounding
/// could turn is decided without it. Bins are counted from 0 in slices.
#[derive(Clone, Debug, PartialEq)]
pub struct Edges {
    bins: usize,
    inner: Vec<BinEdge>,
    /// Cosines of the inner edges in f32.
    cosines_f32: Vec<f32>,
}

/// An inner edge.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BinEdge {
    cosine: Dd,
    /// Bound on the error of the cosine.
    slack: f64,
}

impl Edges {
    /// Bins of equal angle.
    ///
    /// # Errors
    /// [`KError::Bins`] for no bins and for more than [`MOST_BINS`].
    pub fn equal(bins: usize) -> Result<Self, KError> {
        let whole = u32::try_from(bins).ok();
        let whole = whole.filter(|_| (1..=MOST_BINS).contains(&bins));
        let whole = whole.ok_or(KError::Bins { got: bins })?;
        let inner: Vec<BinEdge> = (1..whole).map(|part| BinEdge::new(part, whole)).collect();
        Ok(Self {
            bins,
            cosines_f32: inner.iter().map(|edge| edge.cosine.hi as f32).collect(),
            inner,
        })
    }

    /// Number of bins.
    #[must_use]
    pub const fn bins(&self) -> usize {
        self.bins
    }

    /// The upper edges `t_j` of all bins in radians; the last is pi.
    #[must_use]
    pub fn upper_rad(&self) -> Vec<f64> {
        let of = |j: usize| j as f64 * std::f64::consts::PI / self.bins as f64;
        (1..=self.bins).map(of).collect()
    }

    /// Cosine of the upper edge of a bin, rounded to f64; -1 for the last bin.
    #[must_use]
    pub fn cosine(&self, bin: usize) -> f64 {
        self.inner.get(bin).map_or(-1.0, |edge| edge.cosine.hi)
    }

    /// Cosines of the inner edges in f32, one fewer than bins.
    pub(super) fn cosines_f32(&self) -> &[f32] {
        &self.cosines_f32
    }

    /// The bin of a pair of directions.
    ///
    /// # Errors
    /// [`KError::Undecided`] if 98 bits of an irrational cosine do not decide.
    pub fn bin(&self, a: DVec3, b: DVec3) -> Result<usize, KError> {
        let dot = dot(a, b);
        // The pair is beyond edges whose cosine is above the dot product by more than the error.
        let mut bin = self
            .inner
            .partition_point(|edge| edge.cosine.hi > dot + F64_BAND);
        while bin + 1 < self.bins && !self.reaches(bin, a, b)? {
            bin += 1;
        }
        Ok(bin)
    }

    /// Whether `a.b >= cos t` for the upper edge of a bin, counted from 0. No pair is beyond the
    /// last.
    ///
    /// # Errors
    /// [`KError::Undecided`].
    #[inline]
    pub fn reaches(&self, bin: usize, a: DVec3, b: DVec3) -> Result<bool, KError> {
        let Some(edge) = self.inner.get(bin) else {
            return Ok(true);
        };
        let above = dot(a, b) - edge.cosine.hi;
        if above.abs() > F64_BAND {
            return Ok(above > 0.0);
        }
        edge.reached_exactly(a, b).ok_or(KError::Undecided {
            bin,
            first: a.to_array(),
            second: b.to_array(),
        })
    }

    /// Whether a pair lies on the upper edge of a bin within rounding ([`ON_EDGE`]).
    #[inline]
    pub(super) fn is_on(&self, bin: usize, a: DVec3, b: DVec3) -> bool {
        let edge = self.inner.get(bin);
        edge.is_some_and(|edge| (dot(a, b) - edge.cosine.hi).abs() <= ON_EDGE)
    }
}

impl BinEdge {
    /// `cos(part / whole pi)`. It is rational only for 0, 1/3, 1/2, 2/3 and 1 (Niven 1956); those
    /// are exact.
    fn new(part: u32, whole: u32) -> Self {
        let exact = |cosine: f64| Self {
            cosine: Dd::of(cosine),
            slack: 0.0,
        };
        if 3 * part == whole {
            exact(0.5)
        } else if 2 * part == whole {
            exact(0.0)
        } else if 3 * part == 2 * whole {
            exact(-0.5)
        } else {
            Self {
                cosine: Dd::cosine(part, whole),
                slack: COSINE_ERROR,
            }
        }
    }

    /// The comparison without rounding: an exact sum of three products and the cosine, two parts
    /// each.
    #[cold]
    fn reached_exactly(&self, a: DVec3, b: DVec3) -> Option<bool> {
        let kept = |c: f64| if c.abs() < LEAST_COORDINATE { 0.0 } else { c };
        let mut sum = Expansion::<8>::new();
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            let (product, rest) = two_product(kept(a), kept(b));
            sum.add(rest);
            sum.add(product);
        }
        sum.add(-self.cosine.lo);
        sum.add(-self.cosine.hi);
        let above = sum.rounded();
        // Twice the error bound, since the rounded sum is off by less than half of it.
        let is_decided = self.slack == 0.0 || above.abs() > 2.0 * self.slack;
        is_decided.then_some(above >= 0.0)
    }
}

/// The dot product in f64, in the one order of operations that this module uses.
#[inline]
pub(super) fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
