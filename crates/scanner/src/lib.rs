//! The synchroniser: which angle the platform had when a laser fired.
//!
//! [`scanner`] is the whole path on one page; [`clock`], [`steps`], [`polls`], [`trajectory`] and [`sweeps`] are its parts. Nothing here
//! reads a clock or a file: the same records give the same cloud, bit for bit.

pub mod clock;
pub mod config;
pub mod error;
mod firing_blocks;
mod lanes;
mod live;
mod plausible;
pub mod polls;
pub mod scanner;
pub mod steps;
mod stream;
pub mod sweeps;
pub mod tilt;
pub mod tolerance;
pub mod trajectory;
mod uncertainty;

pub use config::{LidarConfig, ScanConfig, SweepPlan};
pub use error::ScanError;
pub use live::Live;
pub use scanner::{Alignment, Placed, Placer, Survey};
pub use tilt::{AngleTable, TableTime, TiltSource};
pub use tolerance::{Accuracy, Choice, OutOfReach, Tolerance};
