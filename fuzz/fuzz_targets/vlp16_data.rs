//! Runs `properties::vlp16_data` on whatever libFuzzer thinks of.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    properties::vlp16_data::holds(data);
});
