use super::*;
use crate::effects::SurfaceEffect;
use crate::sensor::{LidarMount, PacketModel, ReturnMode};

mod moving;

const LEAST: &str = "scene = \"hall\"\n[motion]\nkind = \"fixed\"\nduration_s = 1.0\n";

fn error(text: &str) -> (usize, String) {
    let error = SceneFile::parse(text, None, None).unwrap_err();
    (error.line, error.what)
}

#[test]
fn the_minimal_scene_is_a_static_vlp16_without_effects() {
    let scene = SceneFile::parse(LEAST, None, None).unwrap();
    let simulation = &scene.simulation;
    assert_eq!(simulation.sensor.model, PacketModel::Vlp16);
    assert_eq!(simulation.returns, ReturnMode::Strongest);
    assert_eq!(simulation.rotation.rpm, 600);
    assert!(simulation.polls.is_none());
    assert!(scene.effects.is_none());
    assert!(scene.effects.effects.firings.surface.is_empty());
}

#[test]
fn invalid_motions_are_reported_with_their_line() {
    let text = |rest: &str| {
        format!(
            "scene = \"hall\"\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -45\n{rest}\n"
        )
    };
    for (rest, at, what) in [
        (
            "speed_deg_s = 0",
            6,
            "speed_deg_s: expected a speed above 0",
        ),
        (
            "speed_deg_s = 5\ncount = 0",
            7,
            "count: expected one sweep or more, got 0",
        ),
        ("speed_deg_s = 5\ncount = 10001", 7, "at most 10000 sweeps"),
        (
            "speed_deg_s = 5\naccel_deg_s2 = 9\nrest_s = -1",
            8,
            "rest_s: expected a rest of 0 s or more",
        ),
        (
            "both_ways = true\naccel_deg_s2 = nan\nspeed_deg_s = 5",
            7,
            "accel_deg_s2: expected",
        ),
    ] {
        let (line, message) = error(&text(rest));
        assert_eq!(line, at, "{message}");
        assert!(message.contains(what), "{message}");
    }
    let (line, message) = error("[motion]\nkind = \"fixed\"\nangle_deg = 0\nduration_s = 0\n");
    assert_eq!(line, 4, "{message}");
}

#[test]
fn shipped_scenes_are_valid() {
    for (name, text) in SHIPPED {
        let scene = SceneFile::parse(text, None, None);
        assert!(scene.is_ok(), "{name}: {scene:?}");
    }
}

#[test]
fn all_keys_take_effect() {
    let text = format!(
        "seed = 7\nlidar_clock_us = 5\nstart_unix_s = 10.5\n{LEAST}[sensor]\nmodel = \"hdl32e\"\nreturns = \"dual\"\nrpm = 1200\n\
         start_deg = 90.0\nonly_laser = 15\n[mount]\nd_m = 0.25\n\n[effects.range_noise]\nsd_m = 0.02\n"
    );
    let scene = SceneFile::parse(&text, Some(9), None).unwrap();
    assert_eq!(scene.seed, 9);
    let simulation = &scene.simulation;
    assert_eq!(simulation.sensor.used, 1 << 15);
    assert_eq!(simulation.returns, ReturnMode::Dual);
    assert_eq!(simulation.rotation.rpm, 1_200);
    assert_eq!(simulation.mount, LidarMount::above(0.25));
    assert_eq!(simulation.start.as_nanos(), 10_500_000_000);
    let line = text
        .lines()
        .position(|l| l.starts_with("[effects"))
        .unwrap()
        + 1;
    let name = "range_noise";
    assert_eq!(
        scene.effects.lines,
        [EffectLine {
            name,
            line: Some(line)
        }]
    );
    let [listed] = &scene.effects.effects.firings.surface[..] else {
        panic!()
    };
    assert_eq!(listed.effect.name(), name);
    let _: &dyn SurfaceEffect = &*listed.effect;
}

/// Realistic scenes have the effects of a real scanner, ideal ones none; an omitted effect is
/// absent.
#[test]
fn effects_of_shipped_scenes_can_be_omitted() {
    for (name, text) in SHIPPED {
        let mut scene = SceneFile::parse(text, None, None).unwrap();
        let real = !["hollow-sphere", "planes", "rig"].contains(&name);
        assert_eq!(scene.effects.is_none(), !real, "{name}");
        let before = scene.effects.effects.usage().len();
        assert_eq!(before, scene.effects.lines.len());
        scene
            .effects
            .leave_out(|effect| ["range_noise", "link_jitter"].contains(&effect));
        let left: Vec<_> = scene
            .effects
            .effects
            .usage()
            .iter()
            .map(|u| u.name)
            .collect();
        assert_eq!(left.len(), if real { before - 2 } else { 0 });
        assert!(
            left.iter()
                .all(|left| scene.effects.lines.iter().any(|line| line.name == *left))
        );
        scene.effects.leave_out(|_| true);
        assert!(scene.effects.is_none() && scene.effects.effects.usage().is_empty());
    }
}

#[test]
fn errors_name_the_line_and_the_fault() {
    let with = |more: &str| format!("{LEAST}{more}\n");
    assert_eq!(error("scene = \"hall\"\n[motion\n").0, 2);
    let (line, what) = error(&with("[sensor]\nmodle = \"vlp16\""));
    assert!(line == 6 && what.contains("modle"), "{line} {what}");
    let (line, what) = error(&with("[effects]\nrange_nois = { sd_m = 1 }"));
    assert!(line == 6 && what.contains("range_nois"), "{line} {what}");
    let (line, what) = error(&with("[effects.range_noise]\nsd_m = -0.1"));
    assert!(line == 6 && what.contains("-0.1"), "{line} {what}");
    let (line, what) = error(&with("[effects]\n\nrange_noise = { sd_m = -0.1 }"));
    assert!(line == 7 && what.contains("-0.1"), "{line} {what}");
    let (line, what) = error(&with("[sensor]\nrpm = 0"));
    assert!(
        line == 6 && what.contains("300 to 1200 rpm"),
        "{line} {what}"
    );
    let (line, what) = error(&with("[sensor]\nonly_laser = 16"));
    assert!(line == 6 && what.contains("got 16"), "{line} {what}");
    let (line, what) = error(&LEAST.replace("hall", "castle"));
    assert!(line == 1 && what.contains("castle"), "{line} {what}");
    let (line, what) = error(&with("from_deg = 1.0"));
    assert!(line == 5 && what.contains("stands"), "{line} {what}");
    let (line, what) = error("scene = \"hall\"\n\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0.0\n");
    assert!(line == 3 && what.contains("to_deg"), "{line} {what}");
    let sweeps = "scene = \"hall\"\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = 1\nspeed_deg_s = 0\n";
    let (line, what) = error(sweeps);
    assert!(line == 6 && what.contains("speed above 0"), "{line} {what}");
}

#[test]
fn arbitrary_text_is_read_or_rejected() {
    let whole = SHIPPED[0].1;
    for end in 0..whole.len() {
        let _ = SceneFile::parse(&whole[..end], None, None);
    }
}

#[test]
fn objects_come_from_the_file_or_a_shipped_scene() {
    let own = LEAST.replace("scene = \"hall\"", "about = \"a ball\"")
        + "[materials]\ndull = { reflectivity = 7 }\n[[objects]]\nmaterial = \"dull\"\nsphere = { radius_m = 4 }\n";
    let look = |text: &str| {
        let scene = SceneFile::parse(text, None, None).unwrap();
        let hit = scene
            .simulation
            .scene
            .cast(glam::DVec3::ZERO, -glam::DVec3::Z, 1.0, 100.0);
        hit.unwrap()
    };
    let hit = look(&own);
    assert_eq!((hit.range_m, hit.reflectivity), (4.0, 7));
    let hit = look(LEAST);
    assert_eq!((hit.range_m, hit.reflectivity), (1.2, 28));
    let (line, what) = error(&format!("{LEAST}[[objects]]\nplane = {{}}\n"));
    assert!(line == 1 && what.contains("got both"), "{line} {what}");
    let (line, what) = error(&own.replace("radius_m", "radius"));
    assert!(
        line == 9 && what.contains("`radius`, expected `radius_m`"),
        "{line} {what}"
    );
    let (line, what) =
        error(&own.replace("sphere = { radius_m = 4 }", "mesh = { file = \"a.ply\" }"));
    assert!(line == 7 && what.contains("a.ply"), "{line} {what}");
}

#[test]
fn sensor_range_and_mount_settings_take_effect() {
    let text = format!(
        "{LEAST}[sensor]\nmodel = \"vlp32c\"\nideal = true\nrange_m = [0.5, 20]\n[mount]\nd_m = 0.1\nposition_m = [0.2, 0, 0.3]\n\
         rotation_deg = [0, 0, 90]\n"
    );
    let simulation = SceneFile::parse(&text, None, None).unwrap().simulation;
    let beams = &simulation.sensor.beams;
    assert!(
        beams
            .iter()
            .all(|beam| beam.origin_m == 0.0 && beam.delay_ns == 0)
    );
    assert_eq!(
        (
            simulation.sensor.range().min_m,
            simulation.sensor.range().max_m
        ),
        (0.5, 20.0)
    );
    assert_eq!(simulation.mount.position_m, glam::DVec3::new(0.2, 0.0, 0.4));
    assert_eq!(simulation.mount.rotation * glam::DVec3::X, glam::DVec3::Y);
    let (line, what) = error(&text.replace("0.5, 20", "5, 2"));
    assert!(
        line == 8 && what.contains("0 <= from < to"),
        "{line} {what}"
    );
    let (line, what) = error(&text.replace("0, 0, 90", "0, nan, 90"));
    assert!(
        line == 12 && what.contains("three numbers"),
        "{line} {what}"
    );
}

/// The example of the documentation is a valid scene.
#[test]
fn the_documented_example_is_valid() {
    let page = include_str!("../../../../docs/src/scenes.md");
    let example = page.split("```toml\n").nth(1).unwrap();
    let example = example.split("```").next().unwrap();
    let scene = SceneFile::parse(example, None, None).unwrap();
    assert_eq!(scene.simulation.scene.caster().objects().len(), 1);
    assert_eq!(scene.effects.lines.len(), 1);
}
