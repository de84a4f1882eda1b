//! The ROS 2 bridge: clouds, raw packets, the tilt joint, transforms, diagnostics, parameters, and
//! services and actions that capture and move the axis, in the format of `rmw_zenoh` or of
//! `zenoh-bridge-ros2dds`, without an installation of ROS (docs/src/ros2.md).
//!
//! Seven threads: one follows events, one queues finished scans, one sends their clouds, one sends
//! packets, one answers calls of services, one those of actions, one those of parameters; and one
//! for each goal under way. Nothing waits for them: what the network does not take is left out and
//! counted. Time from `/clock` and events of parameters are left out.
//!
//! ```
//! # #[cfg(feature = "zenoh")]
//! for (name, meaning, count) in ros2::Counts::default().counters() {
//!     println!("{name} {count}: {meaning}");
//! }
//! ```
#![cfg(feature = "zenoh")]

mod actions;
mod bridge;
mod calls;
mod clouds;
mod counts;
mod dds_bridge;
mod events;
mod goal_request;
mod goals;
mod latched;
mod link;
mod packets;
mod parameters;
mod rmw;

use std::path::PathBuf;
use std::sync::Arc;

use engine::capture::jog::JogRequest;
use engine::capture::plan::CapturePlan;
use engine::capture_request::CaptureRequest;
use engine::config::ros2::Ros2 as Ros2Config;
use engine::config::{Config, Device};
use engine::failure::Failure;
use engine::service::axis_report::AxisReport;
use engine::service::scan_record::{ScanView, check_name};
use engine::service::{DeviceService, StopSignal};
use tokio::sync::oneshot;

pub use bridge::Bridge;
pub use counts::Counts;

/// The end of a move of the axis.
pub type MoveEnd = oneshot::Receiver<Result<AxisReport, Failure>>;

/// The store of scans: a daemon.
pub trait ScanService: Send + Sync {
    /// The devices.
    fn devices(&self) -> &Arc<DeviceService>;

    /// Begins a capture that `stop` stops, and returns the scan's id.
    ///
    /// # Errors
    /// Why it cannot be begun.
    fn start_capture(&self, request: &CaptureRequest, stop: &StopSignal)
    -> Result<String, Failure>;

    /// Begins a move of the axis outside a capture, which `stop` stops. It goes on if the receiver
    /// is dropped.
    ///
    /// # Errors
    /// Why it cannot be begun.
    fn start_move(&self, request: JogRequest, stop: &StopSignal) -> Result<MoveEnd, Failure>;

    /// A scan.
    fn scan(&self, id: &str) -> Option<ScanView>;

    /// The log of a scan.
    fn log(&self, scan: &str) -> PathBuf;
}

/// State of all threads of the bridge.
pub(crate) struct Context {
    pub(crate) scans: Arc<dyn ScanService>,
    pub(crate) settings: Ros2Config,
    pub(crate) parameters: parameters::NodeParameters,
    pub(crate) counts: Arc<Counts>,
    pub(crate) stop: bridge::StopFlag,
}

impl Context {
    pub(crate) fn devices(&self) -> &Arc<DeviceService> {
        self.scans.devices()
    }
}

/// Checks a capture as the daemon does before it begins one for a client of HTTP.
pub(crate) fn check_capture(
    request: &CaptureRequest,
    config: &Config,
    device: (&str, &Device),
) -> Result<(), Failure> {
    request.name.as_deref().map_or(Ok(()), check_name)?;
    CapturePlan::of(request, config, device, "cloud".into(), "log".into()).map(drop)
}
