//! Tests across crates in virtual time: devices, clocks and links are simulated.

mod bring_up;
mod clocks;
mod data_path;
mod faults;
mod fuzz_regressions;
mod patterns;
mod plan;
mod robot_model;
mod simulate;
mod uncertainty;
