//! What a scan becomes: columns of points, where the tilt mount puts them, and the sinks that keep them.
//!
//! [`Points`] is a structure of arrays that holds only the columns someone asked for ([`Fields`]); [`mount`] is
//! the paper's Eq. 4-6; a [`Sink`] takes batches of points; [`formats`] are the sinks that write a file.
//!
//! Left out on purpose: where the points come from (`scanner`), opening files (`io`), and reading clouds back.

mod error;
mod fields;
pub mod formats;
mod metadata;
pub mod mount;
mod points;
mod sink;
mod summary;

pub use error::SinkError;
pub use fields::{Column, Fields, MissingColumns};
pub use metadata::Metadata;
pub use points::{Point, Points, Spare};
pub use sink::Sink;
pub use summary::{Bounds, Summary};
