//! A capture: what was requested, the moves of the axis, the recording, and whether it is complete.

#[cfg(devices)]
pub mod capture_log;
pub mod completeness;
#[cfg(devices)]
pub mod jog;
pub mod moves;
pub mod plan;
#[cfg(devices)]
pub mod run;
#[cfg(devices)]
pub mod run_moves;
pub mod scan_planner;
