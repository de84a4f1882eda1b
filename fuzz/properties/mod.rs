//! Properties of arbitrary input: one module per fuzz target, each with a function `holds` that
//! panics on a violation.
//!
//! The fuzz targets run them on libFuzzer's inputs, `tests/virtual/fuzz_regressions.rs` on past
//! findings with stable Rust. An input is read as a script ([`input::Input`]): a mode, then steps.
//! libFuzzer limits the memory.

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
