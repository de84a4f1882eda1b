//! ROS 2 by zenoh, as ROS 2's own `rmw_zenoh` speaks it, with no ROS installed: clouds, the tilt joint, transforms, diagnostics, and services
//! that begin and stop a capture (docs/src/ros2.md).
//!
//! Behind the feature `ros2`, but for the configuration and the counters. Three threads: one follows the daemon's events, one sends clouds of scans
//! that are over, one answers calls. None is waited for: what the network does not take is left out and counted. Left out: ROS 2's
//! parameters, actions, time from `/clock`, and DDS.

pub mod counts;

#[cfg(feature = "ros2")]
mod calls;
#[cfg(feature = "ros2")]
mod clouds;
#[cfg(feature = "ros2")]
mod events;
#[cfg(feature = "ros2")]
mod latched;
#[cfg(feature = "ros2")]
mod link;
#[cfg(feature = "ros2")]
mod rmw;
#[cfg(feature = "ros2")]
mod threads;

use std::sync::Arc;

use super::shared::Shared;
use engine::failure::{Failure, Kind};

#[cfg(feature = "ros2")]
pub use threads::Ros2;

/// Never there in this build.
#[cfg(not(feature = "ros2"))]
pub enum Ros2 {}

#[cfg(not(feature = "ros2"))]
impl Ros2 {
    /// Ends it; whether all went well.
    pub fn stop(self) -> bool {
        match self {}
    }
}

/// Whether the configuration asks for what this build has.
///
/// # Errors
/// [`Kind::Usage`] in a build without ROS 2.
pub fn check(settings: Option<&engine::config::ros2::Ros2>) -> Result<(), Failure> {
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

/// Begins to send, where the configuration asks for it. A router that is not there is waited for.
///
/// # Errors
/// [`Kind::Usage`] where `[daemon.ros2.capture]` cannot be, [`Kind::NoDevice`] where there is no thread for it.
pub fn start(shared: &Arc<Shared>) -> Result<Option<Ros2>, Failure> {
    check(shared.settings().ros2.as_ref())?;
    #[cfg(feature = "ros2")]
    if let Some(settings) = &shared.settings().ros2 {
        return Ros2::start(shared, settings.clone()).map(Some);
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_without_it_says_so() {
        assert!(check(None).is_ok());
        let asked = check(Some(&engine::config::ros2::Ros2::default()));
        match cfg!(feature = "ros2") {
            true => assert!(asked.is_ok()),
            false => {
                let failure = asked.unwrap_err();
                assert_eq!(failure.kind, Kind::Usage);
                assert!(failure.help.unwrap().contains("--features ros2"));
            }
        }
    }
}
