//! Runs `properties::serial_frame` on whatever libFuzzer thinks of.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::serial_frame::holds(data));
