//! Tilt of the platform during a scan, for sinks that store it.

use units::{Degrees, Host, Metres, Stamp};

/// Tilt of the platform during a scan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TiltTrack {
    /// Height of the lidar's origin above the tilt axis, metres; `None` for a fixed platform, whose
    /// points are in the lidar's frame.
    pub mount: Option<Metres>,
    /// Measured angles, in order of time.
    pub samples: Vec<(Stamp<Host>, Degrees)>,
    /// Begin and end of each sweep, in order of time; empty if unknown.
    pub sweeps: Vec<(Stamp<Host>, Stamp<Host>)>,
}
