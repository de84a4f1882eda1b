//! What clouds are worth: how densely and how evenly scans cover what is about them, a cloud against the simulated truth, and what accuracy costs in time.
//!
//! Left out: making clouds (`scanner`), and anything that reads files or clocks.

pub mod density;
pub mod device;
mod draw;
pub mod figures;
pub mod k;
pub mod tradeoff;
pub mod truth;
