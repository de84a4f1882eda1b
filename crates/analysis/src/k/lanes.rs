//! Numbers in sixteen lanes.

/// Points per leaf and lanes per register.
pub(super) const LANES: usize = 16;

/// Sixteen numbers on a cache line of their own.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct AlignedLanes<T>(pub [T; LANES]);
