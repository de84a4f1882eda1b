#![doc = include_str!("../README.md")]
#![no_std]

mod angle;
mod gearing;
pub mod random;
mod real;
mod short_number;
mod time;

pub use angle::{DegPerS, DegPerS2, Degrees, Metres, Radians};
pub use gearing::{Gearing, GearingError, Quadcounts, Rpm, RpmPerS};
pub use real::Real;
pub use short_number::ShortNumber;
pub use time::{Drive, Host, Lidar, Span, Stamp};
