//! What clouds are worth: a cloud against the simulated truth, how evenly points lie, and what accuracy costs in time.
//!
//! Left out: making clouds (`scanner`), and anything that reads files or clocks.

pub mod k;
pub mod tradeoff;
pub mod truth;
