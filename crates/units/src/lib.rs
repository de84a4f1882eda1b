//! Quantities and clock domains as concrete types, so that degrees and radians, quadcounts and rpm,
//! lidar time and host time cannot be mixed.
//!
//! Time is `i64` nanoseconds throughout: exact for 292 years around its epoch. Angles, lengths and
//! rates are `f64`. There is no trait tower here and no arithmetic between unlike quantities: a
//! conversion that needs a fact (a gear ratio, a clock model) is a method of the type that holds
//! the fact.
#![no_std]

mod angle;
mod gearing;
mod real;
mod time;

pub use angle::{DegPerS, DegPerS2, Degrees, Metres, Radians};
pub use gearing::{Gearing, GearingError, Quadcounts, Rpm, RpmPerS};
pub use real::Real;
pub use time::{Drive, Host, Lidar, Span, Stamp};
