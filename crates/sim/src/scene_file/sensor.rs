//! `[sensor]`: which lidar, how it turns and what it reports.

use serde::Deserialize;
use toml::Spanned;

use super::{Wrong, finite};
use crate::sensor::{Reach, ReturnMode, Sensor};
use crate::simulate::Spin;

/// The section as it is written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Section {
    /// Which.
    model: Model,
    /// The one laser that is used, by its number in the order of firing; all if absent.
    only_laser: Option<Spanned<usize>>,
    /// Whether all lasers of a firing start from one point at one instant.
    ideal: bool,
    /// From where to where it sees, metres; what the model sees if absent.
    range_m: Option<Spanned<[f64; 2]>>,
    /// What it reports.
    returns: Returns,
    /// Turns a minute.
    rpm: Option<Spanned<u32>>,
    /// Azimuth of the first firing, degrees.
    start_deg: Option<Spanned<f64>>,
}

/// The sensors by name.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Model {
    #[default]
    Vlp16,
    HiRes,
    Hdl32e,
    Vlp32c,
    SingleBeam,
}

/// The return modes by name.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Returns {
    #[default]
    Strongest,
    Last,
    Dual,
}

/// What real heads turn at (63-9243: 300 to 1200), and twice as far.
const RPM: std::ops::RangeInclusive<u32> = 1..=2_400;

impl Section {
    pub fn build(&self) -> Result<(Sensor, ReturnMode, Spin), Wrong> {
        let mut sensor = match self.model {
            Model::Vlp16 => Sensor::vlp16(),
            Model::HiRes => Sensor::hi_res(),
            Model::Hdl32e => Sensor::hdl32e(),
            Model::Vlp32c => Sensor::vlp32c(),
            Model::SingleBeam => Sensor::single_beam(),
        };
        if let Some(laser) = &self.only_laser {
            sensor = sensor.only(*laser.get_ref());
            if sensor.used() == 0 {
                let what = format!("this sensor has no laser {} to use", laser.get_ref());
                return Err(Wrong::new(laser.span(), what));
            }
        }
        if self.ideal {
            sensor = sensor.ideal();
        }
        if let Some(range_m) = &self.range_m {
            let [min_m, max_m] = *range_m.get_ref();
            if !(0.0 <= min_m && min_m < max_m && max_m.is_finite()) {
                let what = format!("expected 0 <= from < to in metres, got {min_m} and {max_m}");
                return Err(Wrong::new(range_m.span(), what));
            }
            sensor = sensor.seeing(Reach { min_m, max_m });
        }
        let returns = match self.returns {
            Returns::Strongest => ReturnMode::Strongest,
            Returns::Last => ReturnMode::Last,
            Returns::Dual => ReturnMode::Dual,
        };
        let rpm = match &self.rpm {
            None => 600,
            Some(rpm) if RPM.contains(rpm.get_ref()) => *rpm.get_ref(),
            Some(rpm) => {
                let what = format!("expected 1 to 2400 turns a minute, got {}", rpm.get_ref());
                return Err(Wrong::new(rpm.span(), what));
            }
        };
        let start_deg = match &self.start_deg {
            Some(start_deg) => finite(start_deg, "an azimuth in degrees")?,
            None => 0.0,
        };
        Ok((sensor, returns, Spin { rpm, start_deg }))
    }
}
