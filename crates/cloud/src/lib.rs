//! What a scan becomes: columns of points, where the tilt mount puts them, and the sinks that keep
//! them.
//!
//! [`Points`] is a structure of arrays that holds only the columns someone asked for ([`Fields`]);
//! [`mount`] is the paper's Eq. 4-6; a [`Sink`] takes batches of points; [`formats`] are the sinks
//! that write a file, [`messages`] what a scan says in ROS 2's terms; [`read`] reads the positions
//! of a file.
//!
//! Left out on purpose: where the points come from (`scanner`), and opening files (`io`).

mod columns;
mod diagnostic;
mod error;
pub mod formats;
pub mod messages;
mod metadata;
pub mod mount;
mod points;
pub mod read;
mod rows;
mod sink;
mod summary;
mod tilt_track;

pub use columns::{Column, Fields, MissingColumns};
pub use diagnostic::{Diagnostic, DiagnosticLevel};
pub use error::SinkError;
pub use metadata::Metadata;
pub use points::{Point, Points, Spare};
pub use sink::{Companion, Sink};
pub use summary::{Bounds, Summary};
pub use tilt_track::TiltTrack;
