//! Runs `properties::serial_frame` on libFuzzer's inputs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::serial_frame::holds(data));
