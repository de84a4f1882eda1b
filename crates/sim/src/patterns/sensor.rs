//! The sensors of patterns and scenes by name, and their rates.

use serde::Deserialize;

use crate::sensor::{DetectionRange, LidarSensor};

/// Sensors of patterns and scenes.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SensorName {
    /// VLP-16, 16 lasers.
    #[default]
    Vlp16,
    /// Puck Hi-Res, 16 lasers.
    HiRes,
    /// HDL-32E, 32 lasers.
    Hdl32e,
    /// VLP-32C, 32 lasers.
    Vlp32c,
    /// HDL-64E, 64 lasers.
    Hdl64e,
    /// Hokuyo UTM-30LX: one level laser, 270 degrees.
    Utm30lx,
    /// SICK LMS151: one level laser, 270 degrees.
    Lms151,
    /// One level laser with the rates and the range of a VLP-16: the paper's RSBL.
    SingleBeam,
}

impl SensorName {
    /// The sensor in a scene.
    #[must_use]
    pub fn sensor(self) -> LidarSensor {
        match self {
            Self::Vlp16 => LidarSensor::vlp16(),
            Self::HiRes => LidarSensor::hi_res(),
            Self::Hdl32e => LidarSensor::hdl32e(),
            Self::Vlp32c => LidarSensor::vlp32c(),
            Self::Hdl64e => LidarSensor::hdl64e(),
            Self::Utm30lx => LidarSensor::utm30lx(),
            Self::Lms151 => LidarSensor::lms151(),
            Self::SingleBeam => LidarSensor::single_beam(),
        }
    }

    /// Elevations of its lasers in firing order, degrees.
    #[must_use]
    pub fn elevations_deg(self) -> Vec<f64> {
        match self {
            // That of a scene is a laser of a VLP-16, 1 degree below level.
            Self::SingleBeam => vec![0.0],
            _ => {
                let beams = self.sensor().beams;
                beams.iter().map(|beam| beam.elevation_deg).collect()
            }
        }
    }

    /// Usual revolutions per minute: the paper's 20 frames per second; 10 of an HDL-64E; those of
    /// the data sheets.
    #[must_use]
    pub const fn usual_rpm(self) -> f64 {
        match self {
            Self::Hdl64e => 600.0,
            Self::Utm30lx => 2_400.0,
            Self::Lms151 => 1_500.0,
            _ => 1_200.0,
        }
    }

    /// Standard deviations of a range from shot to shot, up to 10 m and beyond, metres.
    ///
    /// Of the manuals and data sheets: a bound without a definition ("+-3 cm, typical") counts as
    /// three standard deviations. In recordings of three VLP-16s ranges spread by 7 to 13 mm about
    /// local planes, of an HDL-32E by 5.
    #[must_use]
    pub const fn range_sd_m(self) -> [f64; 2] {
        match self {
            Self::Vlp16 | Self::HiRes | Self::Vlp32c | Self::SingleBeam => [0.01; 2],
            Self::Hdl32e => [0.02 / 3.0; 2],
            Self::Hdl64e => [0.02; 2],
            Self::Utm30lx => [0.01, 0.03],
            Self::Lms151 => [0.012; 2],
        }
    }

    /// Steps of azimuth per second. The paper has 0.4 degrees at 20 frames per second for all,
    /// close to the 18,084 firings of a VLP-16. The HDL-64E S2 has 1.333 million points per second,
    /// the planar scanners 1440 steps per revolution.
    #[must_use]
    pub const fn steps_per_s(self) -> f64 {
        match self {
            Self::Hdl64e => 1_333_000.0 / 64.0,
            Self::Utm30lx => 1_440.0 * 40.0,
            Self::Lms151 => 1_440.0 * 25.0,
            _ => 18_000.0,
        }
    }

    /// Whether its head can rotate at a rate, revolutions per minute.
    ///
    /// The manuals of the 16 and 32 lasers have 300 to 1200 in steps of 60 (63-9243, section 8.3),
    /// that of the HDL-64E S2 300 to 900; planar scanners have one rate, an LMS151 two.
    ///
    /// # Errors
    /// The rates that it has.
    pub fn check_rpm(self, rpm: f64) -> Result<(), &'static str> {
        let within = |least: f64, most: f64| (least..=most).contains(&rpm);
        let (accepted, expected) = match self {
            Self::Hdl64e => (within(300.0, 900.0), "300 to 900 rpm"),
            Self::Utm30lx => (rpm == 2_400.0, "2400 rpm"),
            Self::Lms151 => (rpm == 1_500.0 || rpm == 3_000.0, "1500 or 3000 rpm"),
            _ => (
                within(300.0, 1_200.0) && rpm % 60.0 == 0.0,
                "300 to 1200 rpm in steps of 60",
            ),
        };
        accepted.then_some(()).ok_or(expected)
    }

    /// Angle that a planar scanner sees, degrees, half of it to either side of its front; `None`
    /// for a head that rotates.
    #[must_use]
    pub fn aperture_deg(self) -> Option<f64> {
        self.sensor().aperture_deg
    }

    /// The range of detection by the manual or data sheet.
    #[must_use]
    pub fn range(self) -> DetectionRange {
        self.sensor().range()
    }
}
