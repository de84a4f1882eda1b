//! Ripley's K function of directions: how many pairs are how far apart.
//!
//! [`exact()`] counts every pair, in whole numbers, and says on which side of an edge a pair lies by real numbers, not rounded ones ([`Edges`]).
//! [`turned()`] does the same for scans of turned frames, from one of them. [`sampled()`] and [`gridded()`] are faster and say how far they may be off:
//! by a confidence interval, and by a proof. [`choose()`] takes the cheapest that is good enough. [`harmonics()`] is faster still, and does not know how far it is off.
//! Left out: where the directions come from, pictures, files.

mod cells;
mod choose;
mod counts;
mod curve;
mod dd;
mod edges;
mod error;
mod estimate;
mod exact;
mod harmonics;
mod lanes;
mod leaf_pair;
mod leaves_by_edge_count;
mod outline;
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
pub use edges::{Edges, LEAST_COORDINATE, MOST_BINS, ON_EDGE};
pub use error::{KError, UNIT_WITHIN};
pub use estimate::{ErrorBound, Estimate};
pub use exact::{exact, exact_by};
pub use harmonics::{MOST_DEGREE, harmonics};
pub use plain::plain;
pub use registers::Registers;
pub use sampled::{Sampling, sampled};
pub use turned::{FrameRotation, MOST_FRAMES, TURNED_WITHIN, turned, turned_by};
