use super::super::moving_objects::{MovingBox, MovingObjects, MovingObjectsSettings};
use super::*;
use crate::cast::{Cuboid, Cylinder, Object, Placement, Plane, Sphere};
use crate::effect_models::testing::{around, cast, firing};
use crate::effects::ObjectsEffect;
use crate::firing::{Echoes, SimulatedFiring, Surroundings};
use crate::scene::Scene;
use glam::{DMat3, DVec3, dvec3};

fn divergence() -> Divergence {
    Divergence::new(&DivergenceSettings::default()).unwrap()
}

/// A near screen that ends at a plane through the axis, in front of a far wall.
fn screen(near_m: f64, far_m: f64, edge_x_m: f64) -> Surroundings {
    let corner = dvec3(-100.0, near_m, -100.0);
    let screen = Cuboid::new(corner, dvec3(edge_x_m, near_m + 0.05, 100.0));
    let scene = wall(far_m * DVec3::Y, DVec3::Y).with(Object::new(screen), 50);
    around(scene.unwrap())
}

fn wall(through_m: DVec3, normal: DVec3) -> Scene {
    let normal = normal.normalize();
    let x = normal.any_orthonormal_vector();
    let rotation = DMat3::from_cols(x, normal.cross(x), normal);
    let plane = Object::new(Plane).placed(Placement::new(rotation, through_m).unwrap());
    Scene::new().with(plane, 50).unwrap()
}

fn received(
    divergence: &Divergence,
    surroundings: &Surroundings,
) -> (SimulatedFiring, Echoes, u32) {
    let firing = firing(0.0, 0.0);
    let mut echoes = cast(&firing, surroundings);
    let acted = divergence.receive(&firing, surroundings, &mut echoes);
    (firing, echoes, acted)
}

#[test]
fn planes_are_unchanged_and_cast_no_sub_rays() {
    let wall = around(wall(20.0 * DVec3::Y, dvec3(0.3, -1.0, 0.1)));
    let firing = firing(20.0, -30.0);
    let before = cast(&firing, &wall);
    let mut echoes = before.clone();
    assert_eq!(divergence().receive(&firing, &wall, &mut echoes), 0);
    assert_eq!(echoes.strongest, before.strongest);
    let nothing = around(Scene::new());
    assert_eq!(received(&divergence(), &nothing).2, 0);
    let sphere = Object::new(Sphere { radius_m: 10.0 });
    let sphere = around(Scene::new().with(sphere, 50).unwrap());
    assert_eq!(received(&divergence(), &sphere).2, 0);
}

/// Beams whose axis is within 1.5 mrad of the screen's edge see both sides.
#[test]
fn an_edge_far_in_front_of_a_wall_gives_two_returns() {
    // Laser 0's own azimuth is 0; the others fire up to 0.124 degrees later, 2.2 mrad to the right.
    let surroundings = screen(5.0, 12.0, 0.0);
    let (firing, echoes, acted) = received(&divergence(), &surroundings);
    let across = |laser: usize| {
        let direction = firing.directions[laser];
        (direction.x / direction.y.hypot(direction.z)).abs() < 1.5e-3
    };
    let expected: Vec<usize> = (0..16).filter(|&laser| across(laser)).collect();
    assert!(expected.len() > 5 && expected.len() < 16);
    assert_eq!(acted as usize, expected.len());
    for laser in expected {
        let (strongest, other) = (echoes.strongest[laser], echoes.other[laser]);
        let cosine = firing.directions[laser].y;
        let near = |echo: f64| (echo * cosine - 5.0).abs() < 0.02;
        let far = |echo: f64| (echo * cosine - 12.0).abs() < 0.02;
        let ranges = (strongest.range_m, other.range_m);
        assert!(
            near(ranges.0) && far(ranges.1)
                || far(ranges.0) && near(ranges.1)
                || other.range_m.is_infinite(),
            "{ranges:?}"
        );
        assert!((strongest.share + other.share - 1.0).abs() < 1e-12 || !other.is_present());
        // A calibrated sensor reports a part of the light as a darker surface.
        assert!((strongest.reflectivity - 50.0 * strongest.share).abs() < 1e-9);
    }
}

#[test]
fn an_edge_close_to_a_wall_gives_a_mixed_pixel() {
    let surroundings = screen(10.0, 10.5, 0.0);
    let (firing, echoes, acted) = received(&divergence(), &surroundings);
    assert!(acted > 5);
    let mut between = 0;
    for (echo, direction) in echoes.strongest.iter().zip(&firing.directions).take(16) {
        let y = echo.range_m * direction.y;
        assert!((9.99..10.51).contains(&y), "{y}");
        between += u32::from((10.05..10.45).contains(&y));
        // True points lie on a surface.
        let truth = echo.true_range_m * direction.y;
        assert!((truth - 10.0).abs() < 0.01 || (truth - 10.5).abs() < 0.01);
    }
    assert!(between >= 3, "{between}");
    assert!(echoes.other.iter().all(|echo| !echo.is_present()));
}

/// The map and the four corners against sub-rays at every shot.
#[test]
fn footprints_without_sub_rays_are_those_that_sub_rays_leave_unchanged() {
    let surroundings = around(Scene::hall());
    let divergence = divergence();
    let (mut missed, mut shots, mut acted) = (0, 0, 0);
    let mut worst_m = 0.0_f64;
    for step in 0..720 {
        let firing = firing(0.5 * f64::from(step), -0.06 * f64::from(step));
        let before = cast(&firing, &surroundings);
        let mut echoes = before.clone();
        acted += divergence.receive(&firing, &surroundings, &mut echoes);
        let scan = scan_axis(&firing).unwrap();
        for laser in 0..16 {
            if echoes.strongest[laser] != before.strongest[laser] {
                continue;
            }
            let (origin, direction) = (firing.origins_m[laser], firing.directions[laser]);
            let patch = Footprint::new(origin, direction, scan, divergence.half);
            let [slow, _] = divergence.pulse(&patch, &surroundings);
            let off_m = (slow.range_m - echoes.strongest[laser].range_m).abs();
            // Differences below the sensor's step, and the mean of a grazed floor, do not count.
            missed += u32::from(off_m > 0.01);
            worst_m = worst_m.max(if off_m > 0.01 { 0.0 } else { off_m });
            shots += 1;
        }
    }
    // Edges of objects between the corners of a footprint.
    assert!(missed * 2_000 < shots, "{missed} of {shots}");
    assert!(acted * 4 < shots && acted > 100, "{acted} of {shots}");
}

/// Near moving objects the result is the same as without a map, wherever the box is.
#[test]
fn the_map_of_static_objects_is_valid_near_moving_objects() {
    let walker = MovingObjects::of(&MovingObjectsSettings {
        boxes: vec![MovingBox {
            at_m: [3.0, 4.0, 0.3],
            size_m: [0.6, 0.4, 1.8],
            velocity_m_s: [-3.0, 0.0, 0.0],
            turn_deg_s: 90.0,
            reflectivity: 50,
        }],
    });
    let (walker, divergence) = (walker.unwrap(), divergence());
    let mut surroundings = around(Scene::hall());
    let (mut alone, mut near, mut acted) = (0, 0, 0);
    for step in 0..400 {
        let firing = firing(0.2 * f64::from(step) - 40.0, -0.01 * f64::from(step));
        walker.place(0.005 * f64::from(step), &mut surroundings);
        let mut echoes = cast(&firing, &surroundings);
        surroundings.meet_bodies(&firing, &mut echoes);
        let mut slow = echoes.clone();
        acted += divergence.receive(&firing, &surroundings, &mut echoes);
        let scan = scan_axis(&firing).unwrap();
        for laser in firing.alive() {
            let (origin, direction) = (firing.origins_m[laser], firing.directions[laser]);
            let patch = Footprint::new(origin, direction, scan, divergence.half);
            let met = slow.strongest[laser];
            let plain = divergence.is_plain(&patch, met.range_m, &surroundings);
            alone += u32::from(plain);
            near += u32::from(surroundings.may_move_near(origin, direction, 0.002));
            if !patch.is_flat(&met, divergence.settings.flat_m, &surroundings) {
                assert!(!plain, "{step} {laser}");
                let [strongest, other] = divergence.pulse(&patch, &surroundings);
                (slow.strongest[laser], slow.other[laser]) = (strongest, other);
            }
        }
        assert_eq!(echoes.strongest, slow.strongest, "{step}");
    }
    assert!(
        alone > 3_000 && near > 200 && acted > 40,
        "{alone} {near} {acted}"
    );
}

#[test]
fn most_shots_of_a_hall_need_no_sub_rays() {
    let surroundings = around(Scene::hall());
    let map = UniformCells::new(&surroundings, 0.002);
    let (mut plain, mut shots) = (0, 0);
    for step in 0..360 {
        let firing = firing(f64::from(step), -0.12 * f64::from(step));
        let echoes = cast(&firing, &surroundings);
        for laser in firing.alive() {
            let (origin, direction) = (firing.origins_m[laser], firing.directions[laser]);
            plain += u32::from(map.is_around(origin, direction, echoes.strongest[laser].range_m));
            shots += 1;
        }
    }
    assert!(plain * 2 > shots, "{plain} of {shots}");
    assert!(!map.is_around(dvec3(0.0, 0.0, 0.2), DVec3::Y, 5.0));
}

#[test]
fn settings_out_of_bounds_are_rejected() {
    let wrong = |change: fn(&mut DivergenceSettings)| {
        let mut settings = DivergenceSettings::default();
        change(&mut settings);
        Divergence::new(&settings).unwrap_err().setting
    };
    assert_eq!(wrong(|s| s.rows = 0), "rows");
    assert_eq!(wrong(|s| s.columns = 16), "columns");
    assert_eq!(wrong(|s| s.horizontal_mrad = f64::NAN), "horizontal_mrad");
    assert_eq!(wrong(|s| s.flat_m = 0.0), "flat_m");
    assert_eq!(wrong(|s| s.least_share = 2.0), "least_share");
}

/// A pole of 2 cm at 15 m, thinner than the map's samples are apart, in front of a wall.
#[test]
fn a_thin_pole_is_no_plain_surroundings() {
    let pole = |x_m: f64| {
        let pole = Cylinder {
            radius_m: 0.01,
            bottom_m: -3.0,
            top_m: 3.0,
            capped: true,
        };
        let placement = Placement::at(dvec3(x_m, 15.0, 0.0)).unwrap();
        let scene = wall(30.0 * DVec3::Y, DVec3::Y);
        around(scene.with(Object::new(pole).placed(placement), 50).unwrap())
    };
    // Half way between two samples, where laser 1 fires.
    let at_m = 15.0 * f64::tan(0.3_f64.to_radians());
    for place in -3..=4 {
        let pole = pole(at_m + 0.002 * f64::from(place));
        let firing = firing(0.3, 0.0);
        let mut echoes = cast(&firing, &pole);
        let acted = divergence().receive(&firing, &pole, &mut echoes);
        assert!(acted > 0, "{place}");
        let seen = [&echoes.strongest, &echoes.other]
            .into_iter()
            .any(|all| all[1].range_m < 16.0);
        assert!(seen, "{place}: {echoes:?}");
    }
}
