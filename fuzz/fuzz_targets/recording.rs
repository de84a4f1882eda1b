//! Runs `properties::recording` on whatever libFuzzer thinks of.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::recording::holds(data));
