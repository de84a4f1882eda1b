//! Point clouds: columns of points, the geometry of the tilt mount, and sinks that keep them.
//!
//! [`Points`] is a structure of arrays with the requested columns ([`Fields`]). [`mount`] is Eq.
//! 4-6 of the paper. A [`Sink`] takes batches of points; [`formats`] are sinks that write files,
//! [`messages`] encodes a scan as ROS 2 messages, [`read`] reads the points of a file.
//!
//! ```
//! use std::io::Cursor;
//!
//! use cloud::formats::Format;
//! use cloud::{Fields, Metadata, Point, Points, Sink};
//!
//! # fn main() -> Result<(), cloud::SinkError> {
//! let mut points = Points::new(Fields::FILE);
//! points.push(Point { position_m: [1.0, 2.0, 3.0], intensity: 40, ..Point::default() });
//!
//! let mut file = Format::Ply.writer(Cursor::new(Vec::new()), points.fields());
//! file.begin(&Metadata::default())?;
//! file.points(&points)?;
//! assert_eq!(file.finish()?.points, 1);
//! # Ok(())
//! # }
//! ```

mod columns;
mod diagnostic;
mod east_north_up;
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
#[cfg(test)]
mod tests;
mod tilt_track;

pub use columns::{Column, Fields, MissingColumns};
pub use diagnostic::{Diagnostic, DiagnosticLevel};
pub use east_north_up::EastNorthUp;
pub use error::SinkError;
pub use metadata::Metadata;
pub use points::{Point, Points, Spare};
pub use sink::{Companion, Revolution, Sink};
pub use summary::{Bounds, Summary};
pub use tilt_track::TiltTrack;
