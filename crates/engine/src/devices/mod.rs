//! Drive and lidar: selection, opening, and simulated devices in their place.

#[cfg(devices)]
pub mod drive_port;
#[cfg(devices)]
pub mod drive_session;
#[cfg(devices)]
pub mod guardian;
#[cfg(devices)]
pub mod lidar_receiver;
#[cfg(devices)]
pub mod lidar_sockets;
#[cfg(devices)]
mod process_threads;
pub mod profile;
#[cfg(devices)]
pub mod simulated;
#[cfg(devices)]
pub mod simulated_axis;
#[cfg(devices)]
pub mod simulated_drive;
#[cfg(devices)]
mod sleep_inhibitor;
