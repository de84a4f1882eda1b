//! A capture: what was requested, the moves of the axis, the recording, and whether it is complete.

pub mod completeness;
pub mod jog;
pub mod log_recorder;
pub mod moves;
pub mod request;
pub mod run;
pub mod scan_plan;
