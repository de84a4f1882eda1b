//! Hard cases, one test each: real problems of these devices, checked against closed form.
//!
//! Lidar packets come from the simulated sensor's output stage and go through the public decoder.
//! Every expected time, angle and count follows from the rotor's motion, not from another decoder.
//! For clocks that are set, whole captures of the virtual rig are compared with its truth.

mod angles;
mod clocks;
mod lidar;
mod scans;
