//! Runs `properties::vlp16_position` on libFuzzer's inputs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::vlp16_position::holds(data));
