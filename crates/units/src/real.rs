//! What formulas ask of numbers, so that one formula serves a single point and a register full of them.
//!
//! Left out: any function beyond sums and products. Those are the same to the bit however many numbers go at a time.

use core::ops::{Add, Mul, Sub};

/// An `f64`, or several of them with which one computes as with one.
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
