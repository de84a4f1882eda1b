//! One point as it goes into the columns and comes out. Left out: how points are kept.

use units::{Degrees, Host, Lidar, Stamp};

/// One point with every column, as it goes in and comes out. A column that its [`Points`](crate::Points) lacks is dropped on the way
/// in and has the default's value on the way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// x (right), y (forward), z (up) in metres.
    pub position_m: [f64; 3],
    /// Calibrated reflectivity, 0..=255.
    pub intensity: u8,
    /// Ring, 0 = lowest elevation.
    pub ring: u8,
    /// Laser number in firing order.
    pub laser: u8,
    /// Time of the firing on the host's clock.
    pub time: Stamp<Host>,
    /// Time of the firing on the lidar's own clock.
    pub device_time: Stamp<Lidar>,
    /// Tilt angle of the platform at the firing.
    pub tilt: Degrees,
    /// How far the point is off, as a root mean square expected, metres.
    pub sd_m: f64,
    /// Which return of its pulse it is, by the numbers of [`crate::Column::Echo`].
    pub echo: u8,
}

impl Default for Point {
    /// Zero in every column.
    fn default() -> Self {
        Self {
            position_m: [0.0; 3],
            intensity: 0,
            ring: 0,
            laser: 0,
            time: Stamp::from_nanos(0),
            device_time: Stamp::from_nanos(0),
            tilt: Degrees(0.0),
            sd_m: 0.0,
            echo: 0,
        }
    }
}
