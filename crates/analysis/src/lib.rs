<<<<<<< HEAD
//! What clouds are worth: a cloud against the simulated truth, how evenly points lie, and what accuracy costs in time.
//!
//! Left out: making clouds (`scanner`), and anything that reads files or clocks.

pub mod k;
=======
//! What clouds are worth: how densely scans cover what is about them, a cloud against the simulated truth, and what accuracy costs in time.
//!
//! Left out: making clouds (`scanner`), and anything that reads files or clocks.

pub mod density;
>>>>>>> c9fc02a (Density over the bins of an icosahedron, the largest hole, blind spots)
pub mod tradeoff;
pub mod truth;
