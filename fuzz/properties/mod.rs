//! What must hold for any bytes at all: one module a fuzz target, and one function `holds` in each,
//! which panics where it does not.
//!
//! The fuzz targets run these on what libFuzzer thinks of, `tests/virtual/fuzz_regressions.rs` on
//! what was once found, so that findings stay found on stable Rust. An input is read as a script
//! ([`input::Input`]): a mode, then steps. Left out: memory, which libFuzzer limits from outside.

pub mod can_frames;
pub mod drive_link;
mod drive_log;
mod drive_marks;
pub mod input;
pub mod recording;
pub mod sdo;
pub mod serial_frame;
pub mod slcan;
pub mod vlp16_data;
pub mod vlp16_position;
