//! What keeps the real world from being ideal: one file each, and each absent unless a configuration asks for it.
//!
//! A servo's lag is the drive's own ([`firmware_sim::epos2::Servo`]), as its encoder shows it.

mod gear_ripple;

pub use gear_ripple::GearRipple;
