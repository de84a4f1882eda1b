//! The arithmetic that formulas need, so that one formula serves a single point and a SIMD
//! register.
//!
//! Only sums and products: they are bit-identical for one value and for several.

use core::ops::{Add, Mul, Sub};

/// An `f64`, or a register of several.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
}

impl<T> Real for T where
    T: Copy
        + Add<Output = T>
        + Sub<Output = T>
        + Mul<Output = T>
        + Add<f64, Output = T>
        + Mul<f64, Output = T>
{
}
