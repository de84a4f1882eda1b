//! View: the scanner stands in its own way. Its frame hides azimuths of the lidar, at all tilts or at some; what it stands on hides what is below.
//!
//! A beam that is hidden fires but never returns: the frame is nearer than the sensor's least range (1 m, 63-9243). A sector is a sector of the
//! lidar's own azimuths, as the frame turns with it, or is passed by at some tilts only. Left out: the shape of the frame, and light that it scatters.

use std::sync::Arc;

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Effect, Listed, View};
use crate::simulate::Firing;

/// `[effects.own_shadow]`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct OwnShadowSettings {
    /// What the frame hides.
    pub sectors: Vec<ShadowSector>,
    /// Beams that go lower than this in the frame of the base, degrees above the horizon, meet what the scanner stands on: none by default.
    pub below_deg: Option<f64>,
}

/// A part of the view that is hidden.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ShadowSector {
    /// Lidar's azimuth where it begins, 0 to 360 degrees; it goes on clockwise.
    pub azimuth_from_deg: f64,
    /// Where it ends, not included; over 0 where that is less.
    pub azimuth_to_deg: f64,
    /// It hides at tilts from here, -360 (all) unless said, degrees.
    #[serde(default = "all_the_way_down")]
    pub tilt_from_deg: f64,
    /// To here, 360 unless said.
    #[serde(default = "all_the_way_up")]
    pub tilt_to_deg: f64,
}

const fn all_the_way_down() -> f64 {
    -360.0
}

const fn all_the_way_up() -> f64 {
    360.0
}

/// The scanner's shadow.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnShadow {
    sectors: Vec<ShadowSector>,
    /// Sine of the elevation below which nothing is seen.
    below: Option<f64>,
}

impl OwnShadow {
    /// What the scene file calls it.
    pub const NAME: &'static str = "own_shadow";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for angles out of their range.
    pub fn new(settings: &OwnShadowSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        for sector in &settings.sectors {
            check.within("azimuth_from_deg", sector.azimuth_from_deg, 0.0..=360.0)?;
            check.within("azimuth_to_deg", sector.azimuth_to_deg, 0.0..=360.0)?;
            check.within("tilt_from_deg", sector.tilt_from_deg, -360.0..=360.0)?;
            let tilts = sector.tilt_from_deg..=360.0;
            check.within("tilt_to_deg", sector.tilt_to_deg, tilts)?;
        }
        let below = match settings.below_deg {
            Some(deg) => Some(check.within("below_deg", deg, -90.0..=90.0)?),
            None => None,
        };
        Ok(Self {
            sectors: settings.sectors.clone(),
            below: below.map(|deg| deg.to_radians().sin()),
        })
    }
}

impl ShadowSector {
    fn hides(&self, azimuth_deg: f64, tilt_deg: f64) -> bool {
        let width_deg = (self.azimuth_to_deg - self.azimuth_from_deg).rem_euclid(360.0);
        (self.tilt_from_deg..=self.tilt_to_deg).contains(&tilt_deg)
            && (azimuth_deg - self.azimuth_from_deg).rem_euclid(360.0) < width_deg
    }
}

impl Settings for OwnShadowSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Arc::new(OwnShadow::new(self)?);
        asked.firings.view.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for OwnShadow {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "no beam goes where the scanner stands in its way"
    }
}

impl Absorb for OwnShadow {}

impl View for OwnShadow {
    fn look(&self, firing: &mut Firing) -> u32 {
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
    use crate::effects::testing::firing;

    #[test]
    fn a_sector_hides_its_azimuths_at_its_tilts() {
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
            assert_eq!(shadow.look(&mut firing), hidden, "{azimuth} {tilt}");
            assert_eq!(firing.alive.count_ones(), 16 - hidden);
        }
    }

    #[test]
    fn what_it_stands_on_hides_what_is_below() {
        let shadow = OwnShadow::new(&OwnShadowSettings {
            sectors: Vec::new(),
            below_deg: Some(-40.0),
        })
        .unwrap();
        // Level: nothing is lower than 15 degrees. At -45 degrees of tilt the beams to one side go down 30 to 60 degrees.
        assert_eq!(shadow.look(&mut firing(90.0, 0.0)), 0);
        let mut steep = firing(270.0, -45.0);
        let lower = |firing: &Firing| {
            let down = |laser: &usize| firing.directions[*laser].z < (-40.0_f64).to_radians().sin();
            firing.alive().filter(down).count()
        };
        let hidden = lower(&steep) as u32 + lower(&firing(90.0, -45.0)) as u32;
        let mut other = firing(90.0, -45.0);
        assert!(hidden > 8);
        assert_eq!(shadow.look(&mut steep) + shadow.look(&mut other), hidden);
        assert_eq!(lower(&steep), 0);
    }
}
