//! Hard cases, each a test of its own: what goes wrong in practice with these devices, checked
//! against closed form.
//!
//! For the lidar packets come from the software sensor's output stage and go through the public
//! decoder, nothing else; every expected time, angle and count is computed from the rotor's motion,
//! not from another decoder. For clocks that are set, whole captures of the virtual rig are held
//! against its truth.

mod angles;
mod clocks;
mod lidar;
mod scans;
