//! Runs `properties::vlp16_data` on libFuzzer's inputs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    properties::vlp16_data::holds(data);
});
