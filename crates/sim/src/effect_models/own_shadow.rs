//! View: parts of the scanner block its view. Its bracket hides azimuths of the lidar, at all tilts
//! or at some; its base hides everything below.
//!
//! A hidden beam is emitted without a return, because the bracket is nearer than the minimum range
//! (1 m, 63-9243). Sectors are in the lidar's own azimuths, as the bracket tilts with it. Scattered
//! light of the bracket is not included.

use crate::effects::ViewEffect;
use crate::firing::SimulatedFiring;
use std::sync::Arc;

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.own_shadow]`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct OwnShadowSettings {
    /// Sectors that the bracket hides.
    pub sectors: Vec<ShadowSector>,
    /// Beams below this angle to the horizon in the frame of the base are hidden, degrees; absent:
    /// none.
    pub below_deg: Option<f64>,
}

/// A hidden part of the view.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ShadowSector {
    /// Azimuth of its begin, 0 to 360 degrees, clockwise.
    pub azimuth_from_deg: f64,
    /// Azimuth of its end, exclusive; across 0 where it is less than the begin.
    pub azimuth_to_deg: f64,
    /// Lowest tilt at which it is hidden, degrees; default -360.
    #[serde(default = "lowest_tilt")]
    pub tilt_from_deg: f64,
    /// Highest tilt, degrees; default 360.
    #[serde(default = "all_the_way_up")]
    pub tilt_to_deg: f64,
}

const fn lowest_tilt() -> f64 {
    -360.0
}

const fn all_the_way_up() -> f64 {
    360.0
}

/// The scanner's shadow.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnShadow {
    sectors: Vec<ShadowSector>,
    /// Sine of the elevation below which beams are hidden.
    below: Option<f64>,
}

impl OwnShadow {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for angles out of range.
    pub fn new(settings: &OwnShadowSettings) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        for sector in &settings.sectors {
            check.within("azimuth_from_deg", sector.azimuth_from_deg, 0.0..=360.0)?;
            check.within("azimuth_to_deg", sector.azimuth_to_deg, 0.0..=360.0)?;
            check.within("tilt_from_deg", sector.tilt_from_deg, -360.0..=360.0)?;
            let tilts = sector.tilt_from_deg..=360.0;
            check.within("tilt_to_deg", sector.tilt_to_deg, tilts)?;
        }
        let below = settings.below_deg;
        let below = below.map(|deg| check.within("below_deg", deg, -90.0..=90.0));
        Ok(Self {
            sectors: settings.sectors.clone(),
            below: below.transpose()?.map(|deg| deg.to_radians().sin()),
        })
    }
}

impl ShadowSector {
    fn hides(&self, azimuth_deg: f64, tilt_deg: f64) -> bool {
        (self.tilt_from_deg..=self.tilt_to_deg).contains(&tilt_deg)
            && (azimuth_deg - self.azimuth_from_deg).rem_euclid(360.0) < self.width_deg()
    }

    /// From one azimuth clockwise to the other; 0 to 360 is the full circle.
    pub(crate) fn width_deg(&self) -> f64 {
        match self.azimuth_to_deg - self.azimuth_from_deg {
            360.0 => 360.0,
            width_deg => width_deg.rem_euclid(360.0),
        }
    }
}

effect! {
    OwnShadow, OwnShadowSettings, firings.view: Arc, "own_shadow",
    idle: "no beam goes where the scanner stands in its way",
    new: |settings, _| OwnShadow::new(settings)
}

impl ViewEffect for OwnShadow {
    fn hide(&self, firing: &mut SimulatedFiring) -> u32 {
        let before = firing.alive;
        let (azimuth, tilt) = (firing.azimuth_deg, firing.tilt.angle_deg);
        if self
            .sectors
            .iter()
            .any(|sector| sector.hides(azimuth, tilt))
        {
            firing.alive = 0;
        } else if let Some(below) = self.below {
            let lasers = firing.directions.iter().enumerate().take(firing.lasers);
            let hidden = lasers.filter(|(_, direction)| direction.z < below);
            firing.alive &= !hidden.fold(0, |bits, (laser, _)| bits | 1 << laser);
        }
        (before & !firing.alive).count_ones()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::firing;

    #[test]
    fn from_0_to_360_is_the_full_circle() {
        let width = |from: f64, to: f64| {
            let sector = ShadowSector {
                azimuth_from_deg: from,
                azimuth_to_deg: to,
                tilt_from_deg: -45.0,
                tilt_to_deg: 0.0,
            };
            sector.width_deg()
        };
        assert_eq!(width(0.0, 360.0), 360.0);
        assert_eq!(width(350.0, 10.0), 20.0);
        assert_eq!(width(10.0, 10.0), 0.0);
    }

    #[test]
    fn a_sector_blocks_its_azimuths_at_its_tilts() {
        let sector = ShadowSector {
            azimuth_from_deg: 350.0,
            azimuth_to_deg: 10.0,
            tilt_from_deg: -45.0,
            tilt_to_deg: -30.0,
        };
        let shadow = OwnShadow::new(&OwnShadowSettings {
            sectors: vec![sector],
            below_deg: None,
        })
        .unwrap();
        for (azimuth, tilt, hidden) in [
            (350.0, -40.0, 16),
            (0.0, -30.0, 16),
            (9.9, -45.0, 16),
            (10.0, -40.0, 0),
            (180.0, -40.0, 0),
            (0.0, -29.9, 0),
        ] {
            let mut firing = firing(azimuth, tilt);
            assert_eq!(shadow.hide(&mut firing), hidden, "{azimuth} {tilt}");
            assert_eq!(firing.alive.count_ones(), 16 - hidden);
        }
    }

    #[test]
    fn the_base_blocks_beams_below_it() {
        let shadow = OwnShadow::new(&OwnShadowSettings {
            sectors: Vec::new(),
            below_deg: Some(-40.0),
        })
        .unwrap();
        // Level: no beam is below -15 degrees. At -45 degrees of tilt the beams to one side go down
        // 30 to 60 degrees.
        assert_eq!(shadow.hide(&mut firing(90.0, 0.0)), 0);
        let mut steep = firing(270.0, -45.0);
        let lower = |firing: &SimulatedFiring| {
            let down = |laser: &usize| firing.directions[*laser].z < (-40.0_f64).to_radians().sin();
            firing.alive().filter(down).count()
        };
        let hidden = lower(&steep) as u32 + lower(&firing(90.0, -45.0)) as u32;
        let mut other = firing(90.0, -45.0);
        assert!(hidden > 8);
        assert_eq!(shadow.hide(&mut steep) + shadow.hide(&mut other), hidden);
        assert_eq!(lower(&steep), 0);
    }
}
