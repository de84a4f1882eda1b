//! ROS 2 over zenoh: the daemon with a router and subscribers of PyPI's `eclipse-zenoh`, which
//! decode with `rosbags` and read the graph with `zenoh-ros2-sdk`. No ROS installation is needed.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] functions

mod actions;
mod calls;
mod dds_bridge;
mod network;
mod parameters;
mod peer;
#[path = "../daemon/rig.rs"]
#[allow(dead_code)] // other test programs use the rest
mod rig;
mod topics;
