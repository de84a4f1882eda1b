//! The ROS 2 bridge of a daemon, in builds with the feature `ros2`.

use std::sync::Arc;

use engine::config::ros2::Ros2;
use engine::failure::{Failure, Kind};

use crate::state::DaemonState;

/// Stops the bridge; false if its thread had panicked.
pub type StopBridge = Box<dyn FnOnce() -> bool + Send>;

/// Refuses a configuration with ROS 2 in a build without it.
///
/// # Errors
/// [`Kind::Usage`].
pub fn check(settings: Option<&Ros2>) -> Result<(), Failure> {
    if settings.is_none() || cfg!(feature = "ros2") {
        return Ok(());
    }
    Err(Failure::new(
        Kind::Usage,
        "[daemon.ros2] is configured, and this velomotion was built without ROS 2",
    )
    .help(
        "install the package, which has it, or build with: cargo build --release --features ros2;\n\
         or take [daemon.ros2] out of the configuration",
    ))
}

/// Starts the bridge where it is configured.
///
/// # Errors
/// As [`check`], and as the bridge's own start.
pub fn start(state: &Arc<DaemonState>) -> Result<Option<StopBridge>, Failure> {
    check(state.settings().ros2.as_ref())?;
    #[cfg(feature = "ros2")]
    if let Some(settings) = &state.settings().ros2 {
        let scans: Arc<dyn ros2::ScanService> = Arc::new(BridgeScans(Arc::clone(state)));
        let counts = Arc::clone(&state.ros2);
        let bridge = ros2::Bridge::start(&scans, settings.clone(), counts)?;
        return Ok(Some(Box::new(move || bridge.stop())));
    }
    Ok(None)
}

/// The scans of a daemon, for the bridge.
#[cfg(feature = "ros2")]
struct BridgeScans(Arc<DaemonState>);

#[cfg(feature = "ros2")]
impl ros2::ScanService for BridgeScans {
    fn devices(&self) -> &Arc<engine::service::DeviceService> {
        &self.0.service
    }

    fn start_capture(
        &self,
        request: &engine::capture_request::CaptureRequest,
        stop: &engine::service::StopSignal,
    ) -> Result<String, Failure> {
        crate::http::captures::start(&self.0, request, stop)
            .map_err(crate::http::refusal::Refusal::into_failure)
    }

    fn start_move(
        &self,
        request: engine::capture::jog::JogRequest,
        stop: &engine::service::StopSignal,
    ) -> Result<ros2::MoveEnd, Failure> {
        let refused = |error| crate::http::refusal::Refusal::from(error).into_failure();
        self.0.service.jog(request, Some(stop)).map_err(refused)
    }

    fn scan(&self, id: &str) -> Option<engine::service::scan_record::ScanView> {
        self.0.scans.view(id)
    }

    fn log(&self, scan: &str) -> std::path::PathBuf {
        self.0.log(scan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_without_ros_2_refuses_its_configuration() {
        assert!(check(None).is_ok());
        let checked = check(Some(&Ros2::default()));
        match cfg!(feature = "ros2") {
            true => assert!(checked.is_ok()),
            false => {
                let failure = checked.unwrap_err();
                assert_eq!(failure.kind, Kind::Usage);
                assert!(failure.help.unwrap().contains("--features ros2"));
            }
        }
    }
}
