//! Whole packets against single rays, bit for bit; moving objects against a caster of all objects.

use super::{Body, Echo, Echoes, SimulatedFiring, SurfaceHit, Surroundings};
use crate::sensor::{DetectionRange, LidarMount, LidarSensor, RayTable};
use std::sync::Arc;

use glam::{DMat3, DVec3};

use crate::cast::{Caster, Cuboid, Mesh, Object, Placement, Plane, Sphere, Surface};
use crate::motion::AxisState;
use crate::scene::Scene;
use crate::scenery::{Scenery, no_files, shipped};

fn scene(name: &str) -> Arc<Scene> {
    let scenery = Scenery::parse(shipped(name).unwrap()).unwrap();
    Arc::new(Scene::of(scenery.place(3, &mut no_files).unwrap()).unwrap())
}

/// Consecutive firings, every third without some of its lasers.
fn firings(sensor: &LidarSensor, count: usize, first: u32) -> Vec<SimulatedFiring> {
    let rays = RayTable::new(sensor, 3_600.0);
    let aimed = (0..count).zip(first..).map(|(at, number)| {
        let mut firing = SimulatedFiring::new(rays.count);
        firing.azimuth_deg = (0.199 * f64::from(number)).rem_euclid(360.0);
        firing.tilt = AxisState {
            angle_deg: -0.011 * f64::from(number),
            rate_deg_s: -200.0,
        };
        firing.alive = match at % 3 {
            0 => sensor.used as u32 & 0x5a5a_1234,
            _ => sensor.used as u32,
        };
        firing.aim(&rays, &LidarMount::above(0.06));
        firing
    });
    aimed.collect()
}

/// All bits of an echo.
fn bits(echo: &Echo) -> [u64; 7] {
    let [x, y, z] = echo.normal.to_array();
    let numbers = [
        echo.range_m,
        echo.true_range_m,
        echo.reflectivity,
        echo.share,
        x,
        y,
        z,
    ];
    numbers.map(f64::to_bits)
}

#[test]
fn ray_packets_agree_with_single_rays() {
    let near = DetectionRange {
        min_m: 6.0,
        max_m: 30.0,
    };
    for name in ["hall", "parking", "quarry"] {
        let scene = scene(name);
        let (mut there, mut not) = (0, 0);
        for (sensor, reach, normals, count) in [
            (
                LidarSensor::vlp16(),
                LidarSensor::vlp16().range(),
                false,
                24,
            ),
            (LidarSensor::vlp16(), near, true, 24),
            (
                LidarSensor::hdl32e(),
                LidarSensor::hdl32e().range(),
                true,
                12,
            ),
            (LidarSensor::single_beam(), near, false, 3),
        ] {
            let around = Surroundings::new(scene.clone(), reach, true).with_normals(normals);
            let mut echoes = vec![Echoes::new(sensor.beams.len(), true); count];
            for packet in 0..75 {
                let firings = firings(&sensor, count, 24 * packet);
                around.meet_all(&firings, &mut echoes);
                for (firing, echoes) in firings.iter().zip(&echoes) {
                    for laser in 0..firing.lasers {
                        let (origin, direction) =
                            (firing.origins_m[laser], firing.directions[laser]);
                        let met = around
                            .meet(origin, direction)
                            .filter(|_| firing.is_alive(laser));
                        let one = Echo::from_met(met);
                        assert_eq!(
                            bits(&echoes.strongest[laser]),
                            bits(&one),
                            "{name} {packet} {laser}"
                        );
                        assert!(!echoes.other[laser].is_present());
                        assert!(met.is_none_or(|met| (met.normal == DVec3::ZERO) != normals));
                        there += u32::from(met.is_some());
                        not += u32::from(met.is_none() && firing.is_alive(laser));
                    }
                }
            }
        }
        assert!(there > 10_000 && not > 1_000, "{name}: {there} {not}");
    }
}

/// A fan of rays against single rays, with and without moving objects, for full and partial
/// packets.
#[test]
fn a_fan_agrees_with_its_rays() {
    for (name, normals) in [("hall", false), ("parking", true)] {
        let reach = LidarSensor::vlp16().range();
        let mut around = Surroundings::new(scene(name), reach, false).with_normals(normals);
        let mut body = Body::new(made_of(Object::new(mesh()), 77));
        let at_m = DVec3::new(3.0, 1.0, 0.0);
        body.place(Some(Placement::new(DMat3::IDENTITY, at_m).unwrap()));
        around.bodies_mut().push(body);
        let (mut moving, mut there) = (0, 0);
        for (number, firing) in firings(&LidarSensor::vlp16(), 900, 0).iter().enumerate() {
            for laser in firing.alive() {
                let (from, to) = firing.ray(laser).unwrap();
                let part = |ray: usize| {
                    let off = [
                        1.5e-3 * ray as f64,
                        -1e-3 * (ray % 3) as f64,
                        2e-3 * (ray % 5) as f64,
                    ];
                    (to + DVec3::from_array(off)).normalize()
                };
                let parts: Vec<DVec3> = (0..number % 19).map(part).collect();
                let (mut mets, mut still) = (vec![None; parts.len()], vec![None; parts.len()]);
                around.cast_fan(from, &parts, &mut mets);
                around.cast_fan_static(from, &parts, &mut still);
                for ((part, met), still) in parts.iter().zip(&mets).zip(&still) {
                    let echo = |met: &Option<SurfaceHit>| bits(&Echo::from_met(*met));
                    assert_eq!(echo(met), echo(&around.meet(from, *part)));
                    assert_eq!(echo(still), echo(&around.meet_static(from, *part)));
                    there += u32::from(met.is_some());
                    moving += u32::from(echo(met) != echo(still));
                }
            }
        }
        assert!(moving > 100 && there > 10_000, "{name}: {moving} {there}");
    }
}

#[test]
fn invalid_rays_hit_nothing() {
    let around = Surroundings::new(scene("hall"), LidarSensor::vlp16().range(), true);
    let mut all = firings(&LidarSensor::vlp16(), 24, 1);
    for (at, firing) in all.iter_mut().enumerate() {
        firing.alive = 0xffff;
        firing.origins_m[at % 16].x = [f64::NAN, f64::INFINITY, 2e15][at % 3];
        firing.directions[(at + 1) % 16].y = [f64::NAN, f64::NEG_INFINITY, 1.5][at % 3];
    }
    let mut echoes = vec![Echoes::new(16, false); 24];
    around.meet_all(&all, &mut echoes);
    for (at, echoes) in echoes.iter().enumerate() {
        for laser in 0..16 {
            let bad = [at % 16, (at + 1) % 16].contains(&laser);
            assert_eq!(echoes.strongest[laser].is_present(), !bad, "{at} {laser}");
        }
    }
}

fn made_of(object: Object, reflectivity: u8) -> Arc<Scene> {
    Arc::new(Scene::new().with(object, reflectivity).unwrap())
}

/// A pyramid.
fn mesh() -> Surface {
    let corners = [
        [-1.0, -1.0, -0.5],
        [1.0, -1.0, -0.5],
        [1.0, 1.0, -0.5],
        [-1.0, 1.0, -0.5],
        [0.0, 0.0, 1.5],
    ];
    let corners = corners.map(DVec3::from_array);
    let faces = [
        [0, 1, 4],
        [1, 2, 4],
        [2, 3, 4],
        [3, 0, 4],
        [0, 2, 1],
        [0, 3, 2],
    ];
    Mesh::new(&corners, &faces).unwrap().into()
}

#[test]
fn moving_objects_are_hit_by_packets_and_single_rays() {
    let sensor = LidarSensor::vlp16();
    let hall = scene("hall");
    let objects = [
        (Object::new(Cuboid::new(DVec3::NEG_ONE, DVec3::ONE)), 91),
        (Object::new(mesh()), 92),
        (Object::new(Sphere { radius_m: 0.4 }), 93),
        (Object::new(Plane), 94),
    ];
    let place = |object: usize, t: f64| {
        let turn = DMat3::from_rotation_z(0.3 + t);
        Some(match object {
            0 => Placement::new(turn, DVec3::new(4.0 - 3.0 * t, -3.0, 0.0)).unwrap(),
            1 => Placement::new(turn, DVec3::new(-3.0, 3.0 * t - 2.0, 0.2)).unwrap(),
            // Around the scanner, nearer than its minimum range: a shadow.
            2 => {
                Placement::at(DMat3::from_rotation_z(3.0 * t) * DVec3::new(0.0, 0.9, 0.0)).unwrap()
            }
            // A floor that rises from below the hall's.
            _ => Placement::at(DVec3::Z * (0.5 * t - 1.5)).unwrap(),
        })
    };
    let mut around = Surroundings::new(hall.clone(), sensor.range(), false).with_normals(true);
    let bodies = objects
        .clone()
        .map(|(object, of)| Body::new(made_of(object, of)));
    around.bodies_mut().extend(bodies);
    assert!(
        !around.may_move_near(DVec3::ZERO, DVec3::X, 0.1),
        "not placed yet"
    );
    let mut echoes = vec![Echoes::new(16, true); 24];
    let mut seen = [0_u32; 256];
    for packet in 0..60 {
        let firings = firings(&sensor, 24, 97 * packet);
        around.meet_all(&firings, &mut echoes);
        for (at, (firing, echoes)) in (0_u32..).zip(firings.iter().zip(&mut echoes)) {
            let t = f64::from(24 * packet + at) / 1_000.0;
            for (object, body) in around.bodies_mut().iter_mut().enumerate() {
                assert!(body.place(place(object, t)));
            }
            around.meet_bodies(firing, echoes);
            let moved = objects.iter().enumerate();
            let moved =
                moved.map(|(number, (object, _))| object.clone().placed(place(number, t).unwrap()));
            let still = hall.caster().objects().iter().cloned();
            let all = Caster::new(still.clone().chain(moved)).unwrap();
            for laser in 0..16 {
                let (origin, direction) = (firing.origins_m[laser], firing.directions[laser]);
                let met = around
                    .meet(origin, direction)
                    .filter(|_| firing.is_alive(laser));
                assert_eq!(bits(&echoes.strongest[laser]), bits(&Echo::from_met(met)));
                let ray = crate::cast::Ray::new(origin, direction).unwrap();
                let hit = all.nearest(&ray, crate::cast::Reach::default()).unwrap();
                let normal = all.normal(&hit, ray.at(hit.range_m));
                let Some(met) = met else {
                    assert!(hit.range_m < 1.0 || !firing.is_alive(laser));
                    seen[0] += u32::from(firing.is_alive(laser));
                    continue;
                };
                assert!((met.range_m - hit.range_m).abs() < 1e-11);
                assert!(met.normal.distance(normal) < 1e-6, "{met:?} {hit:?}");
                seen[met.reflectivity as usize] += 1;
                if let Some(moving) = hit.object.index().checked_sub(still.len()) {
                    assert_eq!(met.reflectivity, f64::from(objects[moving].1));
                    assert!(around.may_move_near(origin, direction, 0.0));
                }
            }
        }
    }
    // The ball's shadow, the hall's walls, and all four.
    for of in [0, 62, 91, 92, 94] {
        assert!(seen[of] > 50, "{of}: {}", seen[of]);
    }
    assert_eq!(seen[93], 0);
    around.bodies_mut().truncate(1);
    around.bodies_mut()[0].place(None);
    let (origin, way) = (DVec3::ZERO, DVec3::new(3.0, -3.0, 0.0).normalize());
    assert_eq!(around.meet(origin, way), around.meet_static(origin, way));
}

/// Absorbing and too near surfaces hide moving ones behind them, and moving ones can absorb.
#[test]
fn absorbing_surfaces_block() {
    let dark = |radius_m| {
        let mut placed = made_of(Object::new(Sphere { radius_m }), 70)
            .placed()
            .clone();
        placed.materials[0].absorbing = true;
        Arc::new(Scene::of(placed).unwrap())
    };
    let ball = |radius_m| made_of(Object::new(Sphere { radius_m }), 30);
    let reach = LidarSensor::vlp16().range();
    for (stands, moves, range_m) in [
        (dark(5.0), ball(8.0), None),
        (dark(8.0), ball(5.0), Some(5.0)),
        (ball(5.0), dark(8.0), Some(5.0)),
        (ball(8.0), dark(5.0), None),
        (ball(0.5), ball(5.0), None),
        (ball(5.0), ball(0.5), None),
        // At equal distance the moving surface is hit.
        (dark(5.0), ball(5.0), Some(5.0)),
        (ball(5.0), dark(5.0), None),
    ] {
        let mut around = Surroundings::new(stands, reach, false);
        let mut body = Body::new(moves);
        body.place(Some(Placement::default()));
        around.bodies_mut().push(body);
        let along = DVec3::new(0.6, 0.0, 0.8);
        let met = around.meet(DVec3::ZERO, along).map(|met| met.range_m);
        assert_eq!(met, range_m);
        let mut firing = SimulatedFiring::new(1);
        (firing.alive, firing.directions[0]) = (1, along);
        let mut echoes = [Echoes::new(1, false)];
        around.meet_all(core::slice::from_ref(&firing), &mut echoes);
        around.meet_bodies(&firing, &mut echoes[0]);
        let echo = &echoes[0].strongest[0];
        assert_eq!(echo.is_present().then_some(echo.range_m), range_m);
    }
}
