//! A requested capture, as clients, configuration and stored scans write it.

use scanner::{Accuracy, Tolerance};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::failure::{Failure, Kind};

/// A requested capture. Absent values default to those of the axis or the device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
#[schema(example = json!({"speed_deg_s": 56.25, "from_deg": 0, "to_deg": -45, "both_ways": true, "name": "hall"}))]
pub struct CaptureRequest {
    /// Cruise speed of the tilt axis, degrees per second.
    pub speed_deg_s: f64,
    /// Angle where the sweep starts, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_deg: Option<f64>,
    /// Angle where the sweep ends, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_deg: Option<f64>,
    /// Acceleration, degrees per second squared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accel_deg_s2: Option<f64>,
    /// Number of sweeps; 2 if `both_ways`, else 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 10_000)]
    #[param(minimum = 1, maximum = 10_000)]
    pub sweeps: Option<u32>,
    /// Whether the return move is a sweep too.
    #[serde(default)]
    pub both_ways: bool,
    /// Tolerated point error at a distance, such as `2mm@20m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<String>,
    /// Name of the scan, if it is stored by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(pattern = "^[A-Za-z0-9_-]{1,60}$")]
    #[param(pattern = "^[A-Za-z0-9_-]{1,60}$")]
    pub name: Option<String>,
}

/// Upper limit of the sweeps per capture.
pub const MAX_SWEEPS: u32 = 10_000;

impl CaptureRequest {
    /// Number of sweeps, the default included.
    #[must_use]
    pub fn sweep_count(&self) -> u32 {
        self.sweeps.unwrap_or(if self.both_ways { 2 } else { 1 })
    }

    /// Requested accuracy of the cloud.
    ///
    /// # Errors
    /// [`Kind::Usage`] for an invalid tolerance.
    pub fn accuracy(&self) -> Result<Accuracy, Failure> {
        let Some(text) = &self.tolerance else {
            return Ok(Accuracy::Best);
        };
        let tolerance: Result<Tolerance, _> = text.parse();
        tolerance.map(Accuracy::Within).map_err(|error| {
            Failure::new(Kind::Usage, format!("tolerance: {error}"))
                .help("give a length at a distance, such as 2mm@20m")
        })
    }
}
