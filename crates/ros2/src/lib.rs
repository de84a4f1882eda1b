//! The ROS 2 bridge: clouds, raw packets, the tilt joint, transforms, diagnostics, and services
//! that begin and stop a capture, in the format of `rmw_zenoh` and without an installation of ROS
//! (docs/src/ros2.md).
//!
//! Five threads: one follows events, one queues finished scans, one sends their clouds, one sends
//! packets, one answers calls. Nothing waits for them: what the network does not take is left out
//! and counted. ROS 2's parameters, actions, time from `/clock`, and DDS are left out.
//!
//! ```
//! # #[cfg(feature = "zenoh")]
//! for (name, meaning, count) in ros2::Counts::default().counters() {
//!     println!("{name} {count}: {meaning}");
//! }
//! ```
#![cfg(feature = "zenoh")]

mod bridge;
mod calls;
mod clouds;
mod counts;
mod events;
mod latched;
mod link;
mod packets;
mod rmw;

use std::path::PathBuf;
use std::sync::Arc;

use engine::capture_request::CaptureRequest;
use engine::config::ros2::Ros2 as Ros2Config;
use engine::failure::Failure;
use engine::service::DeviceService;

pub use bridge::Bridge;
pub use counts::Counts;

/// The store of scans: a daemon.
pub trait ScanService: Send + Sync {
    /// The devices.
    fn devices(&self) -> &Arc<DeviceService>;

    /// Begins a capture and returns the scan's id.
    ///
    /// # Errors
    /// Why it cannot be begun.
    fn start_capture(&self, request: &CaptureRequest) -> Result<String, Failure>;

    /// The log of a scan.
    fn log(&self, scan: &str) -> PathBuf;
}

/// State of all threads of the bridge.
pub(crate) struct Context {
    pub(crate) scans: Arc<dyn ScanService>,
    pub(crate) settings: Ros2Config,
    pub(crate) counts: Arc<Counts>,
    pub(crate) stop: bridge::StopFlag,
}

impl Context {
    pub(crate) fn devices(&self) -> &Arc<DeviceService> {
        self.scans.devices()
    }
}
