//! The lidar of the configuration.

use scanner::config::RangeAccuracy;
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::lidars::{self, CAPTURED, LidarSheet};

/// The lidar on the platform. Captures find its model and rate in its packets; before, they expect
/// these.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct LidarSettings {
    /// Its model.
    #[serde(rename = "model", deserialize_with = "captured")]
    pub sheet: &'static LidarSheet,
    /// Revolutions per minute, as set on its own page.
    pub rpm: u32,
    /// Standard deviation of a range, including quantisation, metres; the data sheet's without it.
    pub range_sd_m: Option<f64>,
}

impl Default for LidarSettings {
    /// A VLP-16 with factory settings.
    fn default() -> Self {
        Self {
            sheet: &lidars::VLP_16,
            rpm: 600,
            range_sd_m: None,
        }
    }
}

impl LidarSettings {
    /// Its accuracy, which logs state.
    #[must_use]
    pub fn accuracy(&self) -> RangeAccuracy {
        // The same at all ranges for these lidars.
        let usual_m = self.sheet.range_sd_m(0.0);
        RangeAccuracy {
            range_sd_m: self.range_sd_m.unwrap_or(usual_m),
        }
    }
}

/// Reads the name of a lidar that velomotion captures.
fn captured<'de, D: Deserializer<'de>>(name: D) -> Result<&'static LidarSheet, D::Error> {
    let name = String::deserialize(name)?;
    LidarSheet::named(&name)
        .filter(|sheet| sheet.model.is_some())
        .ok_or_else(|| Error::unknown_variant(&name, &CAPTURED))
}
