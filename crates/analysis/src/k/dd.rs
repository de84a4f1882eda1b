//! Numbers of two doubles, about 106 bits: enough for the cosine of an edge.
//!
//! Error-free sums and products after Dekker and Knuth; the product takes the fused multiply-add.

use std::ops::{Add, Mul, Neg, Sub};

/// A sum of two doubles of which the second is at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dd {
    /// The first, which is the sum rounded.
    pub hi: f64,
    /// The second.
    pub lo: f64,
}

/// `a + b` and what rounding took from it: together exact.
#[inline]
pub(super) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// `a * b` and what rounding took from it: together exact unless the rest is below 2^-1074.
#[inline]
pub(super) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl Dd {
    const ONE: Self = Self { hi: 1.0, lo: 0.0 };
    /// To 3e-33.
    const PI: Self = Self {
        hi: std::f64::consts::PI,
        lo: 1.224_646_799_147_353_2e-16,
    };

    /// A double.
    #[must_use]
    pub const fn of(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }

    fn joined((hi, lo): (f64, f64)) -> Self {
        let (hi, lo) = two_sum(hi, lo);
        Self { hi, lo }
    }

    /// `a - b` without rounding.
    #[must_use]
    pub fn difference(a: f64, b: f64) -> Self {
        Self::joined((a, -b))
    }

    fn over(self, divisor: f64) -> Self {
        let high = self.hi / divisor;
        let (product, rest) = two_product(high, divisor);
        let left = self
            - Self {
                hi: product,
                lo: rest,
            };
        Self::joined((high, (left.hi + left.lo) / divisor))
    }

    /// `1 - x2/((n+1)(n+2)) (1 - x2/((n+3)(n+4)) (...))`: the series of the cosine for `n = 0`, of
    /// the sine over its argument for `n = 1`.
    fn series(square: Self, first: u32) -> Self {
        let mut sum = Self::ONE;
        // x2 is at most 0.617: the term left out is below 1e-35.
        for step in (0..16_u32).rev() {
            let n = f64::from(first + 2 * step);
            let factor = square.over((n + 1.0) * (n + 2.0));
            sum = Self::ONE - factor * sum;
        }
        sum
    }

    /// The cosine of `part / whole` of half a turn, within [`COSINE_ERROR`]; mirrored parts have
    /// exactly opposite cosines. `part` is at most `whole`, both below 2^31.
    pub(super) fn cosine(part: u32, whole: u32) -> Self {
        if 2 * part > whole {
            return -Self::cosine(whole.saturating_sub(part), whole);
        }
        let angle =
            |part: u32, whole: u32| (Self::PI * Self::of(f64::from(part))).over(f64::from(whole));
        if 4 * part <= whole {
            let x = angle(part, whole);
            Self::series(x * x, 0)
        } else {
            let x = angle(whole - 2 * part, 2 * whole);
            x * Self::series(x * x, 1)
        }
    }
}

impl Neg for Dd {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Add for Dd {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, rest) = two_sum(self.hi, other.hi);
        let (low, least) = two_sum(self.lo, other.lo);
        let first = Self::joined((high, rest + low));
        Self::joined((first.hi, first.lo + least))
    }
}

impl Sub for Dd {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (high, rest) = two_product(self.hi, other.hi);
        Self::joined((high, rest + (self.hi * other.lo + self.lo * other.hi)))
    }
}

/// Error bound of [`Dd::cosine`]: 2^-98. Thirty operations of 2^-104 each come before the result;
/// a test holds it against fractions.
pub(super) const COSINE_ERROR: f64 = 1.0 / ((1_u128 << 98) as f64);

/// A sum of doubles without any rounding, as components that do not overlap, least first (Shewchuk
/// 1997, grow-expansion).
#[derive(Clone, Copy, Debug)]
pub(super) struct Expansion<const N: usize> {
    parts: [f64; N],
    used: usize,
}

impl<const N: usize> Expansion<N> {
    pub(super) const fn new() -> Self {
        Self {
            parts: [0.0; N],
            used: 0,
        }
    }

    /// Adds one; what does not fit in `N` additions is not taken.
    pub(super) fn add(&mut self, term: f64) {
        let mut carried = term;
        for part in self.parts.iter_mut().take(self.used) {
            let (sum, rest) = two_sum(carried, *part);
            *part = rest;
            carried = sum;
        }
        if let Some(part) = self.parts.get_mut(self.used) {
            *part = carried;
            self.used += 1;
        }
    }

    /// The sum rounded: of the exact sign, and zero only if the sum is zero.
    pub(super) fn rounded(&self) -> f64 {
        self.parts.iter().sum()
    }
}
