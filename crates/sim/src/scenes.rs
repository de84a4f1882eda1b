//! The scene of the rig; [`crate::scenery::SHIPPED`] has the others.

use crate::scene::Scene;
use crate::scenery::{Scenery, no_files, shipped};

/// A building hall of 30 x 20 x 6 m with six pillars, crates, a cabinet and a retroreflecting sign.
///
/// The scanner is near the middle, its tilt axis at the origin and the floor 1.2 m below.
/// Every surface is from 1 m to 20 m away, so every firing returns.
#[must_use]
pub fn hall() -> Scene {
    // A test checks that the scene exists.
    let placed =
        shipped("hall").and_then(|text| Scenery::parse(text).ok()?.place(0, &mut no_files).ok());
    placed
        .and_then(|placed| Scene::of(placed).ok())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::DVec3;

    use super::*;
    use crate::sensor::{LidarMount, LidarSensor};

    #[test]
    fn every_firing_in_the_hall_returns_within_20_m_at_every_tilt() {
        let (scene, sensor, mount) = (hall(), LidarSensor::vlp16(), LidarMount::above(0.06));
        let mut seen = BTreeSet::new();
        for tilt in (-90..=0).map(|half| f64::from(half) / 2.0) {
            for azimuth in (0..1_800).map(|i| f64::from(i) / 5.0) {
                for laser in 0..16 {
                    let (origin, direction) = sensor.ray(laser, azimuth, tilt, &mount).unwrap();
                    let hit = scene.cast(origin, direction, 1.0, 100.0).unwrap();
                    assert!((1.2..20.0).contains(&hit.range_m), "{hit:?}");
                    seen.insert(hit.reflectivity);
                }
            }
        }
        // Floor, both kinds of wall, ceiling, pillars, cardboard, wood, steel and the sign are all
        // hit.
        assert_eq!(
            seen.into_iter().collect::<Vec<_>>(),
            [12, 22, 28, 33, 35, 40, 45, 62, 210]
        );
    }

    #[test]
    fn the_floor_is_one_tripod_height_below_the_axis() {
        let down = hall().cast(DVec3::ZERO, -DVec3::Z, 0.0, 100.0).unwrap();
        assert_eq!((down.range_m, down.reflectivity), (1.2, 28));
    }
}
