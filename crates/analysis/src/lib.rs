//! What clouds are worth: for now, a cloud against the simulated truth.
//!
//! Left out: making clouds (`scanner`), and anything that reads files or clocks.

pub mod truth;
