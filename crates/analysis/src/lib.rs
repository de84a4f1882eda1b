//! Scan patterns and their quality: density, gaps, the K function, accuracy against the simulated
//! truth, plans of scans, and trade-offs of accuracy and time.
//!
//! All functions are pure; files and clocks belong to the callers.
//!
//! ```
//! use analysis::k::{Edges, KCurve, exact};
//! use glam::DVec3;
//!
//! // The six directions along the axes: each is 90 degrees from four others.
//! let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
//! let edges = Edges::equal(3)?;
//! let counts = exact(&axes, &edges, std::num::NonZeroUsize::MIN)?;
//! assert_eq!(counts.counts, [0, 12, 3]);
//!
//! let curve = KCurve::new(&counts.into(), 10.0);
//! assert!(curve.d[0] < 0.0); // fewer close pairs than random directions have
//! # Ok::<(), analysis::k::KError>(())
//! ```

pub mod cloud_statistics;
pub mod density;
mod draw;
pub mod figures;
pub mod k;
mod noise;
pub mod plan;
pub mod tilted_sensor;
pub mod tradeoff;
pub mod truth;
