//! `velomotion daemon`: serves the devices over HTTP, keeps scans on disk and makes their clouds.
//! Without devices the crate is the server of `velomotion view` alone.
//!
//! The device thread belongs to [`engine::service`]. Threads of the daemon make clouds and monitor
//! disk and lidar; a small runtime serves HTTP.
//!
//! ```
//! # #[cfg(devices)]
//! // Where the socket of this user's daemon or command is, through which others stop its axis.
//! println!("{}", daemon::sockets::folder().display());
//! ```

#[cfg(devices)]
pub mod client;
#[cfg(devices)]
pub mod cloud_builder;
#[cfg(devices)]
pub mod disk_quota;
#[cfg(devices)]
pub mod health_monitor;
pub mod http;
pub mod limits;
#[cfg(devices)]
pub mod local;
#[cfg(devices)]
pub mod plan;
#[cfg(devices)]
pub mod ros2_bridge;
#[cfg(devices)]
pub mod scans;
#[cfg(devices)]
mod service;
#[cfg(devices)]
pub mod sockets;
#[cfg(devices)]
pub mod state;
#[cfg(devices)]
pub mod thumbnail;

#[cfg(devices)]
pub use service::{Daemon, Options};
