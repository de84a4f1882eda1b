//! Runs `properties::sdo` on libFuzzer's inputs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::sdo::holds(data));
