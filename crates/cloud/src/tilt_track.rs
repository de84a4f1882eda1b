//! How the platform tilted during a scan, for sinks that keep it beside the points.

use units::{Degrees, Host, Metres, Stamp};

/// How the platform tilted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TiltTrack {
    /// Height of the lidar's origin above the tilt axis, metres; `None` where the platform does not
    /// tilt and points are in the lidar's frame.
    pub mount: Option<Metres>,
    /// Every measured angle that the points' tilt goes by, in the order of time.
    pub samples: Vec<(Stamp<Host>, Degrees)>,
    /// When each sweep begins and ends, in the order of time; empty where sweeps are not known.
    pub sweeps: Vec<(Stamp<Host>, Stamp<Host>)>,
}
