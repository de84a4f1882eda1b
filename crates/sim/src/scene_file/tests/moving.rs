//! Moving objects of a scene file through the whole simulation, against their true positions at
//! each firing.

use crate::effect_models::Explanation;
use crate::packet_maker::TruePoint;
use crate::simulate::{SimulationEvent, SimulationSink};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

use glam::{DMat3, DVec3};

use super::*;

/// Bytes and points of a run.
#[derive(Default, PartialEq)]
struct Taken {
    bytes: Vec<u8>,
    points: Vec<TruePoint>,
}

impl SimulationSink for Taken {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        if let SimulationEvent::Datagram { payload, .. } = event {
            self.bytes.extend_from_slice(payload);
        }
        ControlFlow::Continue(())
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.points.extend_from_slice(points);
        ControlFlow::Continue(())
    }
}

/// An upright plate along x, 2 m wide and high.
const PLATE: &str = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n";

/// Everything but the objects.
const BEFORE: &str = "[sensor]\nideal = true\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -20\nspeed_deg_s = 40\n[materials]\nwall = { reflectivity = 60 }\n\
                      a = { reflectivity = 1 }\nb = { reflectivity = 2 }\nc = { reflectivity = 3 }\nd = { reflectivity = 4 }\ne = { reflectivity = 5 }\n\
                      f = { reflectivity = 6 }\nplate = { reflectivity = 30 }\n[[objects]]\nmaterial = \"wall\"\nsphere = { radius_m = 20 }\n";
const BOX: &str = "[[objects]]\nname = \"trolley\"\nposition_m = [1, 4, 0]\nvelocity_m_s = [0, 2, 0]\n\
                   box = { size_m = [1.5, 1, 2], faces = [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\"] }\n";
const MESH: &str = "[[objects]]\nmaterial = \"plate\"\nposition_m = [-4, -3, 0]\nrotation_deg = [0, 0, 20]\nturn_deg_s = [0, 0, 120]\n\
                    velocity_m_s = [1, 0, 0.1]\nmesh = { file = \"plate.obj\" }\n";

fn read(text: &str) -> SceneFile {
    let mut files = |name: &str| match name {
        "plate.obj" => Ok(PLATE.as_bytes().to_vec()),
        other => Err(format!("no {other}")),
    };
    SceneFile::parse_with(text, None, None, &mut files).unwrap()
}

fn run(text: &str, threads: usize) -> (Taken, SceneFile) {
    let (mut scene, mut taken) = (read(text), Taken::default());
    let threads = NonZeroUsize::new(threads).unwrap();
    let effects = &mut scene.effects.effects;
    scene.simulation.run(effects, threads, &mut taken).unwrap();
    (taken, scene)
}

/// Time of the first laser of a point's firing, seconds since the start, for which objects are
/// placed.
fn fired_s(point: &TruePoint) -> f64 {
    (point.device_ns / 55_296 * 55_296) as f64 * 1e-9
}

#[test]
fn a_box_at_2_m_s_is_at_its_position_of_each_firing() {
    let (taken, scene) = run(&format!("{BEFORE}{BOX}"), 2);
    let mut faces = [0; 7];
    for point in &taken.points {
        if point.reflectivity == 60 {
            assert!((point.position_m.length() - 20.0).abs() < 1e-9);
            continue;
        }
        let middle = DVec3::new(1.0, 4.0 + 2.0 * fired_s(point), 0.0);
        let own = point.position_m - middle;
        let (sides, half) = (own.to_array(), [0.75, 0.5, 1.0]);
        let face = usize::from(point.reflectivity) - 1;
        let out = if face % 2 == 0 { -1.0 } else { 1.0 };
        assert!(
            (sides[face / 2] - out * half[face / 2]).abs() < 1e-9,
            "{own} {face}"
        );
        assert!(
            (0..3).all(|axis| sides[axis].abs() < half[axis] + 1e-9),
            "{own}"
        );
        faces[face] += 1;
    }
    // The box is in front and to the right, and the scanner sees its left side as well.
    assert!(
        faces[2] > 500 && faces[0] > 100 && faces[1] == 0 && faces[3] == 0,
        "{faces:?}"
    );
    // Sheared: within one revolution, 0.1 s, the front moves by 0.2 m. Checked for each revolution.
    let front = |from_s: f64| {
        let turn = taken.points.iter().filter(|point| {
            point.reflectivity == 3 && (from_s..from_s + 0.1).contains(&fired_s(point))
        });
        turn.map(|point| point.position_m.y).fold(0.0, f64::max)
    };
    let gone = front(0.3) - front(0.1);
    assert!((gone - 0.4).abs() < 0.02, "{gone}");
    let line = BEFORE.lines().count() + 1;
    let name = "moving_objects";
    assert_eq!(
        scene.effects.lines,
        [EffectLine {
            name,
            line: Some(line)
        }]
    );
    let explained = Explanation::new(
        &scene.effects.effects.usage(),
        &[EffectLine {
            name,
            line: Some(line),
        }],
        0,
    );
    let [on] = &explained.on[..] else { panic!() };
    assert_eq!(
        (on.effect, on.line, on.not_needed),
        (name, Some(line), None)
    );
    assert!(!explained.absent.contains(&name));
}

#[test]
fn a_rotating_moving_mesh_is_at_its_pose_of_each_firing() {
    let (taken, _) = run(&format!("{BEFORE}{MESH}"), 1);
    let (mut met, mut turned) = (0, [f64::INFINITY, f64::NEG_INFINITY]);
    for point in taken.points.iter().filter(|point| point.reflectivity == 30) {
        let t = fired_s(point);
        let degrees = 20.0 + 120.0 * t;
        let from = DVec3::new(-4.0 + t, -3.0, 0.1 * t);
        let own = DMat3::from_rotation_z(-degrees.to_radians()) * (point.position_m - from);
        assert!(own.y.abs() < 1e-9, "{own} at {t}");
        assert!(
            own.x.abs() < 1.0 + 1e-9 && own.z.abs() < 1.0 + 1e-9,
            "{own}"
        );
        met += 1;
        turned = [turned[0].min(degrees), turned[1].max(degrees)];
    }
    assert!(
        met > 500 && turned[1] - turned[0] > 40.0,
        "{met} {turned:?}"
    );
}

#[test]
fn moving_objects_and_boxes_do_not_depend_on_threads() {
    let table = "[effects.range_noise]\nsd_m = 0.01\n[effects.moving_objects]\n\
                 boxes = [{ at_m = [0, -5, 0], size_m = [1, 1, 2], reflectivity = 44 }]\n[effects.divergence]\n";
    let text = format!("{BEFORE}{BOX}{MESH}{table}");
    let (first, scene) = run(&text, 1);
    for of in [1, 3, 30, 44, 60] {
        let there = first.points.iter().any(|point| point.reflectivity == of);
        assert!(there, "{of}");
    }
    for threads in [2, 3, 8] {
        assert!(run(&text, threads).0 == first, "{threads}");
    }
    let names: Vec<_> = scene.effects.lines.iter().map(|line| line.name).collect();
    assert_eq!(names, ["moving_objects", "divergence", "range_noise"]);
    // Its own table enables it, even without other moving objects.
    let line = text
        .lines()
        .position(|line| line == "[effects.moving_objects]")
        .unwrap()
        + 1;
    assert_eq!(scene.effects.lines[0].line, Some(line));
    let after = format!("{BEFORE}{MESH}[effects.range_noise]\nsd_m = 0.01\n");
    let names: Vec<_> = read(&after)
        .effects
        .lines
        .iter()
        .map(|line| line.name)
        .collect();
    assert_eq!(names, ["moving_objects", "range_noise"]);
}
