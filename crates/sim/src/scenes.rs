//! Scenes that come with the simulator.

use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};

use crate::scene::Scene;
use crate::shapes::{Cuboid, Cylinder, TurnedCuboid};

/// Height of the tilt axis above the floor: the tripod of the rig, metres.
pub const TRIPOD_M: f64 = 1.2;

/// Calibrated reflectivities (0..=100 diffuse, in percent; above that retroreflecting).
mod reflectivity {
    pub const CONCRETE_FLOOR: u8 = 28;
    pub const CONCRETE_PILLAR: u8 = 35;
    pub const PAINTED_WALL: u8 = 62;
    pub const BRICK_WALL: u8 = 22;
    pub const METAL_CEILING: u8 = 45;
    pub const CARDBOARD: u8 = 40;
    pub const STEEL_CABINET: u8 = 12;
    pub const WOOD: u8 = 33;
    pub const SAFETY_SIGN: u8 = 210;
}

/// A building hall of 30 x 20 x 6 m with six pillars, crates, a cabinet and a retroreflecting sign.
///
/// The scanner stands near the middle, its tilt axis at the origin and the floor [`TRIPOD_M`] below. The hall is closed, and
/// every surface is farther than 1 m and nearer than 20 m, so that every firing returns.
#[must_use]
pub fn hall() -> Scene {
    use reflectivity as r;
    const FLOOR: f64 = -TRIPOD_M;
    const CEILING: f64 = FLOOR + 6.0;
    let room = Cuboid::with_faces(
        dvec3(-15.4, -10.3, FLOOR),
        dvec3(14.6, 9.7, CEILING),
        [
            r::BRICK_WALL,
            r::PAINTED_WALL,
            r::PAINTED_WALL,
            r::PAINTED_WALL,
            r::CONCRETE_FLOOR,
            r::METAL_CEILING,
        ],
    );
    let pillar = |x, y| Cylinder::new(dvec2(x, y), 0.3, FLOOR, CEILING, r::CONCRETE_PILLAR);
    let standing = |at: DVec2, size: DVec3, reflectivity| {
        let corner = dvec3(at.x, at.y, FLOOR);
        Cuboid::new(corner, corner + size, reflectivity)
    };
    let crate_turned = |at: DVec2, size: DVec3, degrees: f64, reflectivity| {
        TurnedCuboid::new(
            dvec3(at.x, at.y, FLOOR + 0.5 * size.z),
            size,
            DMat3::from_rotation_z(degrees.to_radians()),
            reflectivity,
        )
    };
    Scene::new()
        .with(room)
        .with(pillar(-9.0, -5.0))
        .with(pillar(-9.0, 5.0))
        .with(pillar(0.0, -5.0))
        .with(pillar(0.0, 5.0))
        .with(pillar(9.0, -5.0))
        .with(pillar(9.0, 5.0))
        .with(crate_turned(
            dvec2(4.0, 2.5),
            dvec3(1.2, 0.8, 1.0),
            30.0,
            r::CARDBOARD,
        ))
        .with(crate_turned(
            dvec2(-4.5, 3.0),
            dvec3(2.0, 1.0, 1.6),
            -20.0,
            r::WOOD,
        ))
        .with(standing(
            dvec2(-15.4, -3.0),
            dvec3(0.6, 4.0, 2.0),
            r::STEEL_CABINET,
        ))
        .with(standing(dvec2(6.0, -9.5), dvec3(2.4, 1.2, 0.9), r::WOOD))
        .with(Cuboid::new(
            dvec3(14.55, 1.0, 0.6),
            dvec3(14.6, 1.8, 1.4),
            r::SAFETY_SIGN,
        ))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use units::{Degrees, Metres};

    use super::*;
    use crate::head::{Head, MAX_RANGE_M, MIN_RANGE_M};

    #[test]
    fn every_firing_in_the_hall_returns_from_within_20_m_whatever_the_tilt() {
        let (scene, head) = (hall(), Head::new(Metres(0.06)));
        let mut seen = BTreeSet::new();
        for tilt in (-90..=0).map(|half| Degrees(f64::from(half) / 2.0)) {
            for azimuth in (0..1_800).map(|i| Degrees(f64::from(i) / 5.0)) {
                for laser in 0..16 {
                    let (origin, direction) = head.beam(laser, azimuth, tilt).unwrap();
                    let hit = scene
                        .cast(origin, direction, MIN_RANGE_M, MAX_RANGE_M)
                        .unwrap();
                    assert!((1.2..20.0).contains(&hit.range_m), "{hit:?}");
                    seen.insert(hit.reflectivity);
                }
            }
        }
        // Floor, both kinds of wall, ceiling, pillars, cardboard, wood, steel and the sign all show.
        assert_eq!(
            seen.into_iter().collect::<Vec<_>>(),
            [12, 22, 28, 33, 35, 40, 45, 62, 210]
        );
    }

    #[test]
    fn the_floor_is_a_tripod_below_the_axis() {
        let down = hall().cast(DVec3::ZERO, -DVec3::Z, 0.0, 100.0).unwrap();
        assert_eq!((down.range_m, down.reflectivity), (TRIPOD_M, 28));
    }
}
