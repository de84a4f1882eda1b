//! Lidars that the axis may tilt, by their data sheets.

use analysis::plan::{PlanLaser, PlanLidar};
use firmware_sim::vlp16::DISTANCE_UNIT_MM;
use protocol::vlp16::{LidarModel, models};
use scanner::RangeAccuracy;
use sim::patterns::{PlanarFront, SensorName};

/// A lidar by its data sheet.
#[derive(Debug)]
pub struct LidarSheet {
    /// The name that `--lidar` takes.
    pub name: &'static str,
    /// Name by the maker.
    pub title: &'static str,
    /// Its packets, where velomotion reads them.
    pub model: Option<&'static LidarModel>,
    /// Its lasers, rates, aperture and ranges.
    pub sensor: SensorName,
    /// Steps of its ranges, metres.
    range_step_m: f64,
    /// Source of the standard deviation of its ranges.
    pub source: &'static str,
}

/// VLP-16.
pub static VLP_16: LidarSheet = LidarSheet {
    source: "its manual's 3 cm as three standard deviations",
    ..of_model("vlp16", &models::VLP_16, SensorName::Vlp16)
};
/// Puck Hi-Res.
pub static HI_RES: LidarSheet = LidarSheet {
    source: "its manual's 3 cm as three standard deviations",
    ..of_model("hi-res", &models::PUCK_HI_RES, SensorName::HiRes)
};
/// HDL-32E.
pub static HDL_32E: LidarSheet = LidarSheet {
    source: "its manual's 2 cm as three standard deviations",
    ..of_model("hdl32e", &models::HDL_32E, SensorName::Hdl32e)
};
/// VLP-32C.
pub static VLP_32C: LidarSheet = LidarSheet {
    source: "its manual's 3 cm as three standard deviations",
    ..of_model("vlp32c", &models::VLP_32C, SensorName::Vlp32c)
};
/// HDL-64E S2.
pub static HDL_64E: LidarSheet = LidarSheet {
    name: "hdl64e",
    title: "HDL-64E",
    model: None,
    sensor: SensorName::Hdl64e,
    range_step_m: 0.002,
    source: "its data sheet's 2 cm, one sigma",
};
/// Hokuyo UTM-30LX.
static UTM_30LX: LidarSheet = LidarSheet {
    name: "utm30lx",
    title: "UTM-30LX",
    model: None,
    sensor: SensorName::Utm30lx,
    range_step_m: 0.001,
    source: "its data sheet's repeated accuracy: sigma 10 mm up to 10 m, 30 mm beyond",
};
/// SICK LMS151.
static LMS_151: LidarSheet = LidarSheet {
    name: "lms151",
    title: "LMS151",
    model: None,
    sensor: SensorName::Lms151,
    range_step_m: 0.001,
    source: "its maker's typical statistical error of 12 mm",
};

/// All of them.
pub static LIDARS: [&LidarSheet; 7] = [
    &VLP_16, &HI_RES, &HDL_32E, &VLP_32C, &HDL_64E, &UTM_30LX, &LMS_151,
];

/// Names of those whose packets velomotion reads.
pub static CAPTURED: [&str; 4] = [VLP_16.name, HI_RES.name, HDL_32E.name, VLP_32C.name];

/// Range up to which the first standard deviation holds, metres.
const NEAR_M: f64 = 10.0;
/// Steps of the azimuths of rotating heads on the wire, degrees (VLP-16 manual 63-9243).
const AZIMUTH_STEP_DEG: f64 = 0.01;

const fn of_model(
    name: &'static str,
    model: &'static LidarModel,
    sensor: SensorName,
) -> LidarSheet {
    LidarSheet {
        name,
        title: model.name,
        model: Some(model),
        sensor,
        range_step_m: model.distance_unit_m,
        source: "",
    }
}

/// A rate at which a lidar's head cannot rotate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {expected} for the {lidar}, got {rpm}")]
pub struct UnsupportedRate {
    expected: &'static str,
    lidar: &'static str,
    rpm: u32,
}

impl PartialEq for LidarSheet {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl LidarSheet {
    /// The lidar of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        LIDARS.into_iter().find(|lidar| lidar.name == name)
    }

    /// The lidar of a model of packets.
    #[must_use]
    pub fn of(model: &LidarModel) -> Option<&'static Self> {
        let is_its = |lidar: &&'static Self| lidar.model.is_some_and(|its| its == model);
        LIDARS.into_iter().find(is_its)
    }

    /// Its usual rate, revolutions per minute: that of velomotion's rotating heads, or the data
    /// sheet's.
    #[must_use]
    pub const fn usual_rpm(&self) -> u32 {
        match self.model {
            Some(_) => 600,
            None => self.sensor.usual_rpm() as u32,
        }
    }

    /// Whether its head can rotate at a rate, revolutions per minute.
    ///
    /// # Errors
    /// [`UnsupportedRate`] with the rates that it has.
    pub fn check_rpm(&self, rpm: u32) -> Result<(), UnsupportedRate> {
        let checked = self.sensor.check_rpm(f64::from(rpm));
        checked.map_err(|expected| UnsupportedRate {
            expected,
            lidar: self.title,
            rpm,
        })
    }

    /// Standard deviation of a range from shot to shot, quantisation included, metres.
    #[must_use]
    pub const fn range_sd_m(&self, range_m: f64) -> f64 {
        let [near, far] = self.sensor.range_sd_m();
        if range_m > NEAR_M { far } else { near }
    }

    /// The lidar as the planner sees it, tilted.
    pub(crate) fn plan_lidar(&self, d_m: f64) -> PlanLidar {
        let level = |elevation_deg: f64| PlanLaser {
            elevation_deg,
            height_m: 0.0,
            azimuth_deg: 0.0,
            delay_s: 0.0,
        };
        let lidar = PlanLidar {
            name: self.title.to_owned(),
            lasers: Vec::new(),
            firing_period_s: 1.0 / self.sensor.steps_per_s(),
            packet_period_s: None,
            range_step_m: self.range_step_m,
            azimuth_step_deg: AZIMUTH_STEP_DEG,
            azimuths_deg: None,
            d_m,
        };
        if let Some(model) = self.model {
            let lasers = model.lasers.iter().map(|laser| PlanLaser {
                height_m: laser.vertical_offset_m,
                azimuth_deg: laser.azimuth_offset_deg,
                delay_s: f64::from(laser.delay_ns) * 1e-9,
                ..level(laser.elevation_deg)
            });
            return PlanLidar {
                lasers: lasers.collect(),
                firing_period_s: f64::from(model.firing_period_ns) * 1e-9,
                packet_period_s: Some(f64::from(model.packet_period_ns(false)) * 1e-9),
                ..lidar
            };
        }
        let lasers = self
            .sensor
            .elevations_deg()
            .into_iter()
            .map(level)
            .collect();
        let Some(aperture_deg) = self.sensor.aperture_deg() else {
            return PlanLidar { lasers, ..lidar };
        };
        // Tilted, the front is across the axis.
        let front_deg = PlanarFront::Pitch.azimuth_deg();
        PlanLidar {
            lasers,
            // A planar scanner fires at fixed azimuths.
            azimuth_step_deg: 0.0,
            azimuths_deg: Some([
                front_deg - 0.5 * aperture_deg,
                front_deg + 0.5 * aperture_deg,
            ]),
            ..lidar
        }
    }
}

/// Accuracy of the simulated lidar: ranges are quantised and have no other error.
#[must_use]
pub fn simulated() -> RangeAccuracy {
    let step_m = f64::from(DISTANCE_UNIT_MM) * 1e-3;
    RangeAccuracy {
        range_sd_m: step_m / f64::sqrt(12.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_agree_with_the_tables_of_patterns() {
        for lidar in LIDARS {
            assert_eq!(LidarSheet::named(lidar.name), Some(lidar));
            assert_eq!(lidar.model.is_some(), CAPTURED.contains(&lidar.name));
            assert_eq!(
                lidar.model.and_then(LidarSheet::of),
                lidar.model.map(|_| lidar)
            );
            let planned = lidar.plan_lidar(0.06);
            let mut found: Vec<f64> = planned
                .lasers
                .iter()
                .map(|laser| laser.elevation_deg)
                .collect();
            let mut expected = lidar.sensor.elevations_deg();
            found.sort_by(f64::total_cmp);
            expected.sort_by(f64::total_cmp);
            assert_eq!(found, expected, "{}", lidar.name);
            assert!(lidar.range_sd_m(5.0) > lidar.range_step_m / 12_f64.sqrt());
            assert!(!lidar.source.is_empty());
            assert_eq!(lidar.sensor.check_rpm(lidar.sensor.usual_rpm()), Ok(()));
        }
        // 270 degrees in steps of a quarter, once per revolution of 25 ms.
        let utm = UTM_30LX.plan_lidar(0.06);
        assert!((utm.firing_period_s * 1_440.0 - 0.025).abs() < 1e-12);
        assert_eq!(utm.azimuths_deg, Some([-225.0, 45.0]));
        assert_eq!(
            (UTM_30LX.range_sd_m(10.0), UTM_30LX.range_sd_m(20.0)),
            (0.01, 0.03)
        );
    }

    #[test]
    fn rates_that_a_lidar_does_not_run_at_are_refused() {
        for (lidar, rpm, accepted) in [
            (&VLP_16, 600, true),
            (&VLP_16, 1_200, true),
            (&VLP_16, 601, false),
            (&VLP_16, 240, false),
            (&VLP_16, 1_260, false),
            (&HDL_64E, 900, true),
            (&HDL_64E, 901, false),
            (&UTM_30LX, 2_400, true),
            (&UTM_30LX, 600, false),
            (&LMS_151, 3_000, true),
        ] {
            let checked = lidar.sensor.check_rpm(f64::from(rpm));
            assert_eq!(
                checked.is_ok(),
                accepted,
                "{} {rpm}: {checked:?}",
                lidar.name
            );
        }
    }
}
