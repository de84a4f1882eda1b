//! The virtual-time rig.
