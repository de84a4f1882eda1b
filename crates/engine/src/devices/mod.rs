//! Drive and lidar: selection, opening, and simulated devices in their place.

pub mod drive_port;
pub mod drive_session;
pub mod guardian;
pub mod lidar_receiver;
pub mod lidar_sockets;
mod process_threads;
pub mod profile;
pub mod simulated;
pub mod simulated_axis;
pub mod simulated_drive;
mod sleep_inhibitor;
