//! Ripley's K function of directions: the number of pairs by angle.
//!
//! [`exact()`] counts every pair in whole numbers; the side of an edge on which a pair lies is
//! decided without rounding ([`Edges`]). [`turned()`] does the same for scans whose frames are
//! rotated copies of one frame. [`sampled()`] is faster and has a confidence interval, and so has
//! [`drawn()`], which needs no points in memory. [`choose()`] takes the cheapest that is good
//! enough.

mod cells;
mod choose;
mod counts;
mod curve;
mod dd;
mod drawn;
mod edges;
mod error;
mod estimate;
mod exact;
mod lanes;
mod leaf_pair;
mod leaves_by_edge_count;
mod outline;
#[cfg(test)]
mod plain;
mod reach;
mod registers;
mod sampled;
mod sign_mask;
#[cfg(test)]
mod tests;
mod tree;
mod turned;

pub use choose::{EXACT_BELOW, KMethod, choose, estimate};
pub use counts::PairCounts;
pub use curve::KCurve;
pub use dd::Dd;
pub use drawn::drawn;
pub use edges::{Edges, LEAST_COORDINATE, MOST_BINS, ON_EDGE};
pub use error::{KError, UNIT_WITHIN};
pub use estimate::Estimate;
pub use exact::{exact, exact_by};
pub use registers::Registers;
pub use sampled::{Sampling, sampled};
pub use turned::{FrameRotation, MOST_FRAMES, TURNED_WITHIN, turned, turned_by};
