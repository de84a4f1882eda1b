//! A capture: what was requested, the moves of the axis, the recording, and whether it is complete.

pub mod completeness;
#[cfg(devices)]
pub mod jog;
#[cfg(devices)]
pub mod log_recorder;
pub mod moves;
pub mod request;
#[cfg(devices)]
pub mod run;
#[cfg(devices)]
pub mod run_moves;
pub mod scan_plan;
