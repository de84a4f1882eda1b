//! `cfg(devices)`: the feature of this name, on Linux.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is_wanted = std::env::var_os("CARGO_FEATURE_DEVICES").is_some();
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if is_wanted && system == "linux" {
        println!("cargo::rustc-cfg=devices");
    }
}
