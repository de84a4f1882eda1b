//! From a log or recording to a cloud and a report.

pub mod contents;
mod copies;
pub mod decoder_options;
pub mod diagnostics;
mod failures;
pub mod frames;
mod georeference;
pub mod lidar_copy;
pub mod live;
pub mod log_view;
pub mod replay;
pub mod report;
mod satellite;
pub mod source;
pub mod statistics;
pub mod tilt_table;
pub mod utc;
mod warnings;

pub use failures::scan_failure;
