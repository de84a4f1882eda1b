mod mesh_files;

use glam::DVec3;

use super::*;
use crate::cast::{Caster, Ray, Reach};

fn placed(text: &str) -> PlacedScenery {
    Scenery::parse(text)
        .unwrap()
        .place(1, &mut no_files)
        .unwrap()
}

fn wrong(text: &str) -> String {
    let error = match Scenery::parse(text) {
        Err(error) => error,
        Ok(scenery) => scenery.place(1, &mut no_files).unwrap_err(),
    };
    error.to_string()
}

/// Distance, reflectivity and normal of a ray's hit.
fn hit(
    placed: &PlacedScenery,
    caster: &Caster,
    from: DVec3,
    to: DVec3,
) -> Option<(f64, u8, DVec3)> {
    let ray = Ray::new(from, to.normalize()).unwrap();
    let hit = caster.nearest(&ray, Reach::default())?;
    let material = placed.material(hit.object.index(), hit.primitive).unwrap();
    let normal = caster.normal(&hit, ray.at(hit.range_m));
    Some((hit.range_m, material.reflectivity, normal))
}

fn range(text: &str, from: [f64; 3], to: [f64; 3]) -> Option<f64> {
    let placed = placed(text);
    let caster = placed.caster().unwrap();
    hit(&placed, &caster, from.into(), to.into()).map(|(range_m, _, _)| range_m)
}

#[test]
fn every_shipped_scene_can_be_ray_cast() {
    for (name, text) in SHIPPED {
        let placed = placed(text);
        let caster = placed.caster().unwrap();
        assert_eq!(placed.objects.len(), placed.assignments.len());
        let down = hit(&placed, &caster, DVec3::ZERO, -DVec3::Z).unwrap();
        assert!((1.0..=10.0).contains(&down.0), "{}: {down:?}", name);
        for object in 0..placed.objects.len() {
            assert!(placed.material(object, 0).is_some(), "{}", name);
        }
    }
    assert!(shipped("hall").is_some() && shipped("nowhere").is_none());
}

/// The rig's hall; distances computed by hand.
#[test]
fn the_rig_scene_has_the_geometry_of_the_hall() {
    let [hall, rig] = ["hall", "rig"].map(|name| placed(shipped(name).unwrap()));
    assert_eq!(format!("{:?}", hall.objects), format!("{:?}", rig.objects));
    assert_eq!(
        (&hall.assignments, &hall.materials),
        (&rig.assignments, &rig.materials)
    );
    let caster = hall.caster().unwrap();
    for (from, to, range_m, reflectivity) in [
        ([0.0, 0.0, 0.0], [0.0, 0.0, -1.0], 1.2, 28),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 4.8, 45),
        ([0.0, 0.0, 3.0], [1.0, 0.0, 0.0], 14.6, 62),
        ([0.0, 0.0, 3.0], [-1.0, 0.0, 0.0], 15.4, 22),
        ([3.0, 0.0, 3.0], [0.0, 1.0, 0.0], 9.7, 62),
        ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 4.7, 35),
        ([0.0, 1.4, 1.0], [1.0, 0.0, 0.0], 14.55, 210),
        ([4.0, 2.5, 3.0], [0.0, 0.0, -1.0], 3.2, 40),
        ([-4.5, 3.0, 3.0], [0.0, 0.0, -1.0], 2.6, 33),
        ([0.0, -2.0, 0.0], [-1.0, 0.0, 0.0], 14.8, 12),
        ([7.0, -9.0, 0.0], [0.0, 0.0, -1.0], 0.3, 33),
    ] {
        let (range, of, _) = hit(&hall, &caster, from.into(), to.into()).unwrap();
        assert!(
            (range - range_m).abs() < 1e-12 && of == reflectivity,
            "{from:?} {to:?}: {range} {of}"
        );
    }
}

#[test]
fn the_papers_sphere_and_planes_are_exact() {
    let sphere = shipped("hollow-sphere").unwrap();
    for to in [[1.0, 0.0, 0.0], [-0.3, 0.7, 0.2], [0.0, 0.0, -1.0]] {
        assert!((range(sphere, [0.0; 3], to).unwrap() - 10.0).abs() < 1e-14);
    }
    let planes = shipped("planes").unwrap();
    for (to, expected) in [
        ([0.0, 0.0, -1.0], Some(1.5)),
        ([1.0, 0.0, 0.0], Some(10.0)),
        ([0.0, 1.0, 0.0], Some(10.0)),
        ([1.0, 1.0, 0.0], Some(10.0 * 2_f64.sqrt())),
        ([-1.0, -1.0, 0.0], None),
    ] {
        let got = range(planes, [0.0; 3], to);
        let near = got
            .zip(expected)
            .map(|(got, expected)| (got - expected).abs() < 1e-13);
        assert_eq!(near, expected.map(|_| true), "{to:?}: {got:?}");
    }
}

#[test]
fn unknown_keys_are_reported_with_the_known_keys_and_the_line() {
    let text = "[[objects]]\nname = \"ball\"\nsphere = { radios_m = 1 }\n";
    assert_eq!(
        wrong(text),
        "line 3, column 12: unknown field `radios_m`, expected `radius_m`"
    );
    let text = "[materials.a]\nreflectivity = 1\n[materials.b]\nshiny = 2\n";
    let message = wrong(text);
    assert!(
        message.starts_with("line 4, column 1: unknown field `shiny`"),
        "{message}"
    );
    assert!(message.contains("`specular`"), "{message}");
    let message = wrong("[[objects]]\nsphere = { radius_m = 1 }\n\n[[objects]]\ncone = {}\n");
    assert!(
        message.starts_with("line 5, column 1: unknown field `cone`"),
        "{message}"
    );
    let message = wrong("[[objects]]\nsphere = { radius_m = }\n");
    assert!(message.starts_with("line 2, column"), "{message}");
}

#[test]
fn invalid_values_are_reported_with_their_line() {
    let object = |rest: &str| {
        format!("\n[materials]\ngrey = {{ reflectivity = 50 }}\n[[objects]]\n{rest}\n")
    };
    for (rest, expected) in [
        (
            "sphere = { radius_m = 0 }",
            "sphere.radius_m: expected a number above 0, got 0.0",
        ),
        ("sphere = { radius_m = nan }", "got NaN"),
        ("name = \"nothing\"", "exactly one of sphere, plane, box"),
        (
            "plane = {}\nsphere = { radius_m = 1 }",
            r#"got ["sphere", "plane"]"#,
        ),
        (
            "plane = {}\nmaterial = \"gray\"",
            r#"material: expected one of grey, got "gray""#,
        ),
        (
            "plane = {}\nposition_m = [0, inf, 0]",
            "position_m: expected finite numbers",
        ),
        (
            "plane = {}\nposition_m = [0, 1e16, 0]",
            "placement: expected coordinates within 1e15 m",
        ),
        ("plane = {}\nvelocity_m_s = [nan, 0, 0]", "velocity_m_s"),
        ("box = { size_m = [1, 0, 1] }", "edges longer than 0"),
        ("box = { size_m = [1, -1, 1] }", "edges longer than 0"),
        (
            "box = { from_m = [0, 0, 0] }",
            "either size_m, or from_m and to_m",
        ),
        (
            "cylinder = { radius_m = 1, height_m = -1 }",
            "cylinder.height_m",
        ),
        (
            "height_field = { columns = 2 }",
            "columns, spacing_m and heights_m, or quarry",
        ),
        (
            "height_field = { columns = 2, spacing_m = [1, 1], heights_m = [0, 0, 0] }",
            "2 x 2",
        ),
        (
            "height_field = { columns = 2, spacing_m = [1, 1], heights_m = [0, 0, 0, nan] }",
            "vertex 3",
        ),
        (
            "height_field = { columns = 2, spacing_m = [0, 1], heights_m = [0, 0, 0, 0] }",
            "spacings",
        ),
        (
            "height_field = { quarry = { size_m = 1e9 } }",
            "2 to 5000 spacings",
        ),
        (
            "plane = {}\ncopies = { counts = [0, 1, 1] }",
            "copies: expected 1 to 100000, got 0",
        ),
        (
            "plane = {}\ncopies = { counts = [99999, 99999, 99999] }",
            "copies",
        ),
        (
            "trees = { count = 1, from_m = [0, 0], to_m = [1, 1], height_m = [3, 2], foliage = \"grey\" }",
            "trees.height_m",
        ),
    ] {
        let message = wrong(&object(rest));
        // The position of the table, or of the value if one value is invalid.
        let places = ["line 4, column 1: ", "line 5, column ", "line 6, column "];
        let names = |place: &&str| message.starts_with(*place);
        assert!(places.iter().any(names), "{message}");
        assert!(message.contains(expected), "{message}");
    }
    let message = wrong("[materials]\nsky = { specular = 0.5 }\n");
    assert!(
        message.contains("line 2") && message.contains("absorbing"),
        "{message}"
    );
    assert!(wrong("[materials]\nsky = { reflectivity = 256 }\n").contains("line 2"));
    assert!(wrong("[materials]\nsky = { reflectivity = 5, specular = 2 }\n").contains("0 to 1"));
}

#[test]
fn invalid_values_are_reported_with_their_own_line() {
    let text = "[materials]\ngrey = { reflectivity = 50 }\n[materials.sky]\nabsorbing = true\nspecular = 2\n";
    assert_eq!(
        wrong(text),
        "line 5, column 12: specular: expected 0 to 1, got 2.0"
    );
    let first = "[[objects]]\nsphere = { radius_m = 1 }\n\n";
    for (second, place) in [
        (
            "name = \"ball\"\nsphere = { radius_m = 0 }\n",
            "line 6, column 23",
        ),
        (
            "[objects.cylinder]\nradius_m = 1\nheight_m = -1\n",
            "line 7, column 12",
        ),
        (
            "plane = {}\n\nvelocity_m_s = [0, nan, 0]\n",
            "line 7, column 16",
        ),
        // For several keys: the table that has them.
        (
            "name = \"wall\"\nbox = { size_m = [1, 1, 1], from_m = [0, 0, 0] }\n",
            "line 6, column 7",
        ),
        // For no key.
        ("name = \"nothing\"\n", "line 4, column 1"),
    ] {
        let message = wrong(&format!("{first}[[objects]]\n{second}"));
        assert!(message.starts_with(&format!("{place}:")), "{message}");
    }
    let message = wrong("[[objects]]\nplane = {}\nmaterial = \"grey\"\n");
    assert!(
        message.contains("line 3, column 12: material: expected a name of [materials], where none is, got \"grey\""),
        "{message}"
    );
}

#[test]
fn each_kind_of_geometry_is_placed_at_its_position() {
    let at = |shape: &str| {
        format!("[[objects]]\nposition_m = [5, 0, 0]\nrotation_deg = [0, 0, 90]\n{shape}\n")
    };
    let x = [1.0, 0.0, 0.0];
    for (shape, from, to, expected) in [
        ("sphere = { radius_m = 2 }", [0.0; 3], x, Some(3.0)),
        // From inside.
        ("sphere = { radius_m = 2 }", [5.0, 0.0, 0.0], x, Some(2.0)),
        ("box = { size_m = [2, 4, 2] }", [0.0; 3], x, Some(3.0)),
        (
            "box = { from_m = [0, 1, -1], to_m = [1, 2, 1] }",
            [3.5, -5.0, 0.0],
            [0.0, 1.0, 0.0],
            Some(5.0),
        ),
        (
            "cylinder = { radius_m = 1, height_m = 3 }",
            [0.0, 0.0, 1.0],
            x,
            Some(4.0),
        ),
        (
            "cylinder = { radius_m = 1, height_m = 3 }",
            [5.0, 0.0, 9.0],
            [0.0, 0.0, -1.0],
            Some(6.0),
        ),
        (
            "cylinder = { radius_m = 1, height_m = 3, capped = false }",
            [5.0, 0.0, 9.0],
            [0.0, 0.0, -1.0],
            None,
        ),
        ("plane = {}", [0.0, 0.0, 2.0], [0.0, 0.0, -1.0], Some(2.0)),
        // The grid's x points along the world's y, its y against the world's x.
        (
            "height_field = { columns = 2, spacing_m = [4, 2], heights_m = [1, 1, 1, 1] }",
            [3.5, 3.5, 9.0],
            [0.0, 0.0, -1.0],
            Some(8.0),
        ),
        (
            "height_field = { columns = 2, spacing_m = [4, 2], heights_m = [1, 1, 1, 1] }",
            [5.5, 3.5, 9.0],
            [0.0, 0.0, -1.0],
            None,
        ),
    ] {
        let got = range(&at(shape), from, to);
        let near = got
            .zip(expected)
            .map(|(got, expected)| (got - expected).abs() < 1e-12);
        assert_eq!(near, expected.map(|_| true), "{shape}: {got:?}");
    }
}

#[test]
fn rotations_apply_x_then_y_then_z_and_are_exact_at_90_deg() {
    let turned = |degrees| place::rotation(degrees) * DVec3::new(1.0, 2.0, 3.0);
    assert_eq!(turned([90.0, 0.0, 0.0]), DVec3::new(1.0, -3.0, 2.0));
    assert_eq!(turned([90.0, 90.0, 0.0]), DVec3::new(2.0, -3.0, -1.0));
    assert_eq!(turned([90.0, 90.0, -270.0]), DVec3::new(3.0, 2.0, -1.0));
    let glams = glam::DMat3::from_rotation_z(0.3)
        * glam::DMat3::from_rotation_y(-0.8)
        * glam::DMat3::from_rotation_x(2.9);
    let ours = place::rotation([2.9_f64, -0.8, 0.3].map(f64::to_degrees));
    assert!(glams.abs_diff_eq(ours, 1e-15));
}

#[test]
fn faces_copies_and_openings_take_effect() {
    let text = r#"
[materials]
dark = { reflectivity = 10 }
light = { reflectivity = 90 }
hole = { absorbing = true }
[[objects]]
box = { size_m = [20, 20, 20], faces = ["dark", "light", "dark", "hole", "light", "dark"] }
[[objects]]
material = "light"
position_m = [0, -5, 0]
copies = { at_m = [[1, 0, 0], [3, 0, 0]], counts = [1, 1, 2], step_m = [0, 0, 4] }
sphere = { radius_m = 0.5 }
"#;
    let placed = placed(text);
    let caster = placed.caster().unwrap();
    assert_eq!(placed.objects.len(), 5);
    let of = |to: [f64; 3]| hit(&placed, &caster, DVec3::ZERO, to.into()).unwrap().1;
    assert_eq!(
        [
            of([-1.0, 0.0, 0.0]),
            of([1.0, 0.0, 0.0]),
            of([0.0, 0.0, -1.0])
        ],
        [10, 90, 90]
    );
    assert_eq!(of([3.0, -5.0, 4.0]), 90);
    assert_eq!(of([2.0, -5.0, 4.0]), 10);
    let ahead = caster.nearest(&Ray::new(DVec3::ZERO, DVec3::Y).unwrap(), Reach::default());
    let ahead = ahead.unwrap();
    assert!(
        placed
            .material(ahead.object.index(), ahead.primitive)
            .unwrap()
            .absorbing
    );
}

#[test]
fn moving_objects_follow_their_velocity() {
    let text = "[[objects]]\nplane = {}\n[[objects]]\nposition_m = [5, 0, 0]\nvelocity_m_s = [0, 2, 0]\nturn_deg_s = [0, 0, 45]\n\
                box = { size_m = [4, 1, 1] }\n";
    let scenery = Scenery::parse(text).unwrap();
    let placed = scenery.place(0, &mut no_files).unwrap();
    let [moving] = &placed.moving[..] else {
        panic!()
    };
    assert_eq!((moving.objects.clone(), moving.at.line), (1..2, 3));
    let caster = placed.caster().unwrap();
    let x = |caster: &Caster, y| {
        hit(&placed, caster, DVec3::new(0.0, y, 0.2), DVec3::X)
            .unwrap()
            .0
    };
    assert_eq!(x(&caster, 0.0), 3.0);
    // After two seconds it has moved 4 m along y and rotated by 90 degrees.
    let mut later = placed.objects.clone();
    later[1].placement = moving.travel.at(2.0).unwrap();
    let caster = Caster::new(later).unwrap();
    assert!((x(&caster, 4.0) - 4.5).abs() < 1e-12);
    assert!((x(&caster, 5.9) - 4.5).abs() < 1e-12);
    assert!(moving.travel.at(1e18).is_err());
}

/// The parts of a facade rotate about the facade's origin, not each about its own.
#[test]
fn parts_of_moving_objects_stay_together_and_copies_move_alone() {
    let text = "[materials]\nglass = { reflectivity = 6 }\n[[objects]]\nsphere = { radius_m = 1 }\n[[objects]]\nposition_m = [5, 6, 0]\n\
                rotation_deg = [0, 0, -90]\nturn_deg_s = [0, 0, 90]\ncopies = { at_m = [[0, 0, 0], [40, 0, 0]] }\n\
                facade = { width_m = 12, height_m = 9, depth_m = 5, columns = 3, storeys = 2, window_m = [2, 1.5], sill_m = 1, glass = \"glass\" }\n";
    let placed = Scenery::parse(text)
        .unwrap()
        .place(0, &mut no_files)
        .unwrap();
    let (stands, moves) = placed.divided().unwrap();
    assert_eq!((stands.objects.len(), moves.len()), (1, 2));
    let all = stands.objects.len()
        + moves
            .iter()
            .map(|(_, body)| body.objects.len())
            .sum::<usize>();
    assert_eq!(all, placed.objects.len());
    let start = placed.caster().unwrap();
    let rays = (0..400).map(|at| {
        let turn = 0.003 + f64::from(at) * 0.0157;
        let along = DVec3::new(turn.cos(), turn.sin(), 0.2 * (3.0 * turn).sin()).normalize();
        Ray::new(2.0 * DVec3::Z, along).unwrap()
    });
    let (mut met, mut glass) = (0, 0);
    for ray in rays {
        // After a rotation by 90 degrees about its origin, a body looks the same from a scanner
        // that rotated with it.
        for (moving, body) in &moves {
            let (body_caster, place) = (body.caster().unwrap(), moving.travel.at(1.0).unwrap());
            let from = moving.travel.from_m;
            let back = |v: DVec3| DVec3::new(v.y, -v.x, v.z);
            let turned = DVec3::new(-ray.direction().y, ray.direction().x, ray.direction().z);
            let origin = ray.origin_m() - from;
            let turned_origin = DVec3::new(-origin.y, origin.x, origin.z) + from;
            assert!(back(turned).distance(ray.direction()) < 1e-15);
            let own = |origin, along| {
                let ray = Ray::new(place.own_point(origin), place.own_direction(along)).unwrap();
                body_caster.nearest(&ray, Reach::default())
            };
            let then = own(turned_origin, turned);
            let now = Ray::new(origin, ray.direction()).unwrap();
            let now = body_caster.nearest(&now, Reach::default());
            assert_eq!(then.map(|hit| hit.primitive), now.map(|hit| hit.primitive));
            let off = then
                .zip(now)
                .map_or(0.0, |(a, b)| (a.range_m - b.range_m).abs());
            assert!(off < 1e-9, "{off}");
            // At the start it is where it was placed.
            if let (Some(first), Some(own)) = (start.nearest(&ray, Reach::default()), now)
                && moving.objects.contains(&first.object.index())
            {
                assert_eq!(
                    moving.objects.start + own.object.index(),
                    first.object.index()
                );
                assert!((first.range_m - own.range_m).abs() < 1e-9);
                let material = body.material(own.object.index(), own.primitive).unwrap();
                let same = placed.material(first.object.index(), first.primitive);
                assert_eq!(Some(material), same);
                met += 1;
                glass += u32::from(material.name == "glass");
            }
        }
    }
    assert!(met > 50 && glass > 5, "{met} {glass}");
}

#[test]
fn generated_geometry_depends_only_on_the_seed() {
    for name in ["parking", "quarry"] {
        let scenery = Scenery::parse(shipped(name).unwrap()).unwrap();
        let look = |seed| {
            let placed = scenery.place(seed, &mut no_files).unwrap();
            let caster = placed.caster().unwrap();
            let ways = (0..400).map(|i| {
                DVec3::new(
                    (0.1 * f64::from(i)).cos(),
                    (0.1 * f64::from(i)).sin(),
                    -0.03,
                )
            });
            ways.map(|to| hit(&placed, &caster, DVec3::ZERO, to).map(|hit| hit.0.to_bits()))
                .collect::<Vec<_>>()
        };
        assert_eq!(look(5), look(5));
        assert_ne!(look(5), look(6), "{name}");
    }
}

#[test]
fn cars_are_on_the_ground_in_their_bays() {
    let text = r#"
[materials]
grey = { reflectivity = 50 }
[[objects]]
parked_cars = { bays = 40, share = 1, paints = ["grey"], glass = "grey", tyres = "grey", plates = "grey" }
"#;
    let placed = placed(text);
    let caster = placed.caster().unwrap();
    for bay in 0..40 {
        let middle = DVec3::new(2.5 * (f64::from(bay) + 0.5), 0.0, 5.0);
        let roof = 5.0 - hit(&placed, &caster, middle, -DVec3::Z).unwrap().0;
        assert!((0.8..1.65).contains(&roof), "{roof}");
        // Between two cars there is air.
        let gap = middle + 1.25 * DVec3::X;
        assert!(hit(&placed, &caster, gap, -DVec3::Z).is_none());
        // Wheels touch the ground.
        let up = |x: i32, y: i32| {
            let from = DVec3::new(middle.x + 0.05 * f64::from(x), 0.05 * f64::from(y), -1.0);
            hit(&placed, &caster, from, DVec3::Z).map_or(f64::MAX, |hit| hit.0)
        };
        let lowest = (-20..=20).flat_map(|x| (-40..=40).map(move |y| (x, y)));
        let lowest = lowest.map(|(x, y)| up(x, y)).fold(f64::MAX, f64::min);
        assert!((1.0..1.01).contains(&(lowest + 1e-12)), "{lowest}");
    }
}
