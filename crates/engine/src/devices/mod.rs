//! The drive and the lidar: which ones, how they are opened, and the software devices that stand in
//! for them.

pub mod drive_port;
pub mod drive_session;
pub mod lidar_receiver;
pub mod lidar_sockets;
pub mod profile;
pub mod simulated;
pub mod simulated_axis;
pub mod simulated_drive;
