//! Tilt of the platform during a scan, for sinks that store it.

use units::{Degrees, Host, Stamp};

use crate::mount::Mount;

/// Tilt of the platform during a scan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TiltTrack {
    /// Mount of the lidar; `None` for a fixed platform, whose points are in the lidar's frame.
    pub mount: Option<Mount>,
    /// Measured angles, in order of time.
    pub samples: Vec<(Stamp<Host>, Degrees)>,
    /// Begin and end of each sweep, in order of time; empty if unknown.
    pub sweeps: Vec<(Stamp<Host>, Stamp<Host>)>,
}
