//! Synchroniser of lidar and tilt drive: the platform's angle at the instant each laser fired.
//!
//! [`scanner`] is the data path in one reading: [`align`] finds clock, angles, sweeps and
//! trajectory in the records of a log, [`place()`] turns its firings into points. [`Live`] does
//! both while records come in. Nothing here reads a clock or a file: the same records give the same
//! cloud.
//!
//! ```
//! use cloud::Points;
//! use scanner::{Accuracy, ScanConfig, TiltSource};
//! # fn records() -> Vec<drive::record::Record<'static>> { Vec::new() }
//!
//! fn scan(sink: &mut Points) -> Result<u64, Box<dyn std::error::Error>> {
//!     let config = ScanConfig::default();
//!     let options = lidar::Options::default();
//!     let alignment =
//!         scanner::align(records(), &config, options.clone(), &TiltSource::Log, Accuracy::Best)?;
//!     let (counts, _) = scanner::place(records(), &alignment, options, sink)?;
//!     Ok(counts.points)
//! }
//! # assert!(scan(&mut Points::default()).is_err());
//! ```

mod alignment;
mod angles;
mod calibration;
pub mod clock;
pub mod clock_steps;
pub mod config;
pub mod error;
mod fast;
mod live;
mod placer;
mod receive_order;
mod residuals;
mod sample_gaps;
pub mod scanner;
mod survey;
pub mod sweeps;
mod tilt_source;
pub mod tolerance;
pub mod trajectory;

pub use alignment::{Alignment, PlacementCounts};
pub use angles::{AngleSample, AngleTable, AngleTableError, TableTime};
pub use config::{RangeAccuracy, ScanConfig, SweepPlan};
pub use error::ScanError;
pub use live::Live;
pub use placer::{Placer, revolution_of};
pub use receive_order::ReceiveOrder;
pub use residuals::ResidualInterval;
pub use sample_gaps::SampleGaps;
pub use scanner::{align, place};
pub use survey::Survey;
pub use tilt_source::TiltSource;
pub use tolerance::{Accuracy, MethodChoice, Tolerance, UnreachableTolerance};
