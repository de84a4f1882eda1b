//! Runs `properties::slcan` on libFuzzer's inputs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| properties::slcan::holds(data));
