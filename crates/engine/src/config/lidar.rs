//! The lidar of the configuration.

use protocol::vlp16::{Model, models};
use scanner::config::LidarConfig;
use serde::Deserialize;

use crate::lidars::{self, LidarSheet};

/// A lidar model, by the name that `--lidar` and `--model` take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LidarName {
    /// VLP-16, Puck, Puck LITE.
    #[default]
    Vlp16,
    /// Puck Hi-Res.
    HiRes,
    /// HDL-32E.
    Hdl32e,
    /// VLP-32C, Ultra Puck.
    Vlp32c,
}

impl LidarName {
    /// Its data sheet.
    #[must_use]
    pub const fn sheet(self) -> &'static LidarSheet {
        match self {
            Self::Vlp16 => &lidars::VLP_16,
            Self::HiRes => &lidars::HI_RES,
            Self::Hdl32e => &lidars::HDL_32E,
            Self::Vlp32c => &lidars::VLP_32C,
        }
    }

    /// The model.
    #[must_use]
    pub const fn model(self) -> &'static Model {
        match self {
            Self::Vlp16 => &models::VLP_16,
            Self::HiRes => &models::PUCK_HI_RES,
            Self::Hdl32e => &models::HDL_32E,
            Self::Vlp32c => &models::VLP_32C,
        }
    }
}

/// The lidar on the platform. Captures find its model and rate in its packets; before, they expect
/// these.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct LidarSettings {
    /// Its model.
    pub model: LidarName,
    /// Revolutions per minute, as set on its own page.
    pub rpm: u32,
    /// Standard deviation of a range, including quantisation, metres; the data sheet's without it.
    pub range_sd_m: Option<f64>,
}

impl Default for LidarSettings {
    /// A VLP-16 with factory settings.
    fn default() -> Self {
        Self {
            model: LidarName::Vlp16,
            rpm: 600,
            range_sd_m: None,
        }
    }
}

impl LidarSettings {
    /// Its accuracy, which logs state.
    #[must_use]
    pub fn accuracy(&self) -> LidarConfig {
        // The same at all ranges for these lidars.
        let usual_m = self.model.sheet().range_sd_m(0.0);
        LidarConfig {
            range_sd_m: self.range_sd_m.unwrap_or(usual_m),
        }
    }
}
