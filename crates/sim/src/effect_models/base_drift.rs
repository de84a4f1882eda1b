//! View: a base that moves and turns slowly during the scan, as a tripod on soft ground does.
//!
//! The true points are those of the room, in the base's frame at the start. Vibrations are not
//! included.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::effects::ViewEffect;
use crate::firing::SimulatedFiring;

/// `[effects.base_drift]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct BaseDrift {
    /// Velocity, metres per second.
    pub velocity_m_s: [f64; 3],
    /// Rates of rotation about x, y and z, degrees per second.
    pub turn_deg_s: [f64; 3],
}

impl BaseDrift {
    fn checked(self) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        for (name, three) in [
            ("velocity_m_s", self.velocity_m_s),
            ("turn_deg_s", self.turn_deg_s),
        ] {
            for number in three {
                check.within(name, number, -10.0..=10.0)?;
            }
        }
        Ok(self)
    }
}

effect! {
    BaseDrift, BaseDrift, firings.view: Arc, "base_drift",
    idle: "velocity and rotation are 0",
    new: |drift, _| drift.checked()
}

impl ViewEffect for BaseDrift {
    fn hide(&self, firing: &mut SimulatedFiring) -> u32 {
        if *self == Self::default() {
            return 0;
        }
        let time_s = firing.time_s;
        let turn = DVec3::from_array(self.turn_deg_s.map(f64::to_radians)) * time_s;
        let (turn, shift) = (
            DQuat::from_scaled_axis(turn),
            DVec3::from_array(self.velocity_m_s) * time_s,
        );
        for origin in &mut firing.origins_m {
            *origin = turn * *origin + shift;
        }
        for direction in &mut firing.directions {
            *direction = turn * *direction;
        }
        firing.alive.count_ones()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_move_and_turn_with_the_base() {
        let drift = BaseDrift {
            velocity_m_s: [0.0, 0.0, 0.01],
            turn_deg_s: [0.0, 0.0, 9.0],
        };
        let mut firing = SimulatedFiring::new(16);
        firing.alive = 0b11;
        firing.time_s = 10.0;
        assert_eq!(drift.checked().unwrap().hide(&mut firing), 2);
        let (origin, direction) = firing.ray(0).unwrap();
        assert!(origin.distance(DVec3::new(0.0, 0.0, 0.1)) < 1e-12);
        // 90 deg about z: from y to -x.
        assert!(direction.distance(-DVec3::X) < 1e-12, "{direction}");
        assert_eq!(BaseDrift::default().hide(&mut firing), 0);
        let fast = BaseDrift {
            velocity_m_s: [11.0, 0.0, 0.0],
            ..BaseDrift::default()
        };
        assert!(fast.checked().is_err());
    }
}
