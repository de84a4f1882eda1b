use super::*;
use crate::effects::SurfaceEffect;
use crate::sensor::{LidarMount, PacketModel, ReturnMode};

mod moving;

const LEAST: &str = "scene = \"hall\"\n[motion]\nkind = \"fixed\"\nduration_s = 1.0\n";

/// Names of the effects that are on.
fn on(scene: &SceneFile) -> Vec<&'static str> {
    let usage = scene.effects.effects.usage();
    usage.iter().map(|used| used.name).collect()
}

fn error(text: &str) -> (usize, String) {
    let error = SceneFile::parse(text, None, None).unwrap_err();
    (error.line, error.what)
}

#[test]
fn the_minimal_scene_is_a_static_vlp16_with_the_effects_that_it_calls_for() {
    let scene = SceneFile::parse(LEAST, None, None).unwrap();
    let simulation = &scene.simulation;
    assert_eq!(simulation.sensor.packets, Some(PacketModel::Vlp16));
    assert_eq!(simulation.returns, ReturnMode::Strongest);
    assert_eq!(simulation.rotation.rpm, 600);
    assert!(simulation.polls.is_none() && scene.tolerance.is_none());
    let expected = [
        "divergence",
        "reflectance",
        "range_noise",
        "lidar_clock",
        "link_jitter",
    ];
    assert_eq!(on(&scene), expected);
    let none = format!("{LEAST}[effects]\nall = false\n");
    let scene = SceneFile::parse(&none, None, None).unwrap();
    assert!(scene.effects.is_none() && scene.effects.lines.is_empty());
    assert!(scene.effects.effects.firings.surface.is_empty());
    assert_eq!(scene.demands.len(), expected.len());
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
         start_deg = 90.0\nonly_laser = 15\n[mount]\nd_m = 0.25\n\n[effects]\nall = false\n[effects.range_noise]\nsd_m = 0.02\n"
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
        .position(|l| l.starts_with("[effects."))
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

/// Shipped scenes list no effects: their facts call for those of a real scanner, and their
/// tolerance decides. Ideal ones have none.
#[test]
fn effects_of_shipped_scenes_follow_from_their_facts() {
    let real = [
        "own_shadow",
        "divergence",
        "reflectance",
        "range_noise",
        "lidar_clock",
        "encoder_quantisation",
        "link_jitter",
    ];
    for (name, text) in SHIPPED {
        let mut scene = SceneFile::parse(text, None, None).unwrap();
        let is_real = !["hollow-sphere", "planes", "rig"].contains(&name);
        assert_eq!(scene.tolerance.is_some(), is_real, "{name}");
        let mut expected = real.to_vec();
        match name {
            "fog" => expected.insert(2, "weather"),
            "traffic" => expected.insert(0, "moving_objects"),
            _ => {}
        }
        expected.retain(|_| is_real);
        assert_eq!(on(&scene), expected, "{name}");
        let lines = scene.effects.lines.iter().map(|line| line.name);
        assert_eq!(lines.collect::<Vec<_>>(), expected, "{name}");
        for demand in &scene.demands {
            let is_sized = demand.percent.is_some() || demand.displaced_mm.is_some();
            assert!(is_sized, "{name}: {demand:?}");
        }
        scene
            .effects
            .leave_out(|effect| ["range_noise", "link_jitter"].contains(&effect));
        expected.retain(|effect| !["range_noise", "link_jitter"].contains(effect));
        assert_eq!(on(&scene), expected);
        scene.effects.leave_out(|_| true);
        assert!(scene.effects.is_none());
    }
}

/// A street of a stranger, who lists no effect.
const STRANGE: &str = r#"
[motion]
kind = "sweeps"
from_deg = 0
to_deg = -45
speed_deg_s = 56.25

[weather]
visibility_m = 80

[drive]
servo = { frequency_hz = 20 }
backlash = { play_deg = 0.02 }

[link]
loss = { lidar_share = 0.01 }
batching = { period_ms = 10 }

[materials]
mirror = { reflectivity = 4, specular = 0.95 }
tar = { reflectivity = 3 }
plate = { reflectivity = 230 }
paint = { reflectivity = 60 }
opening = { absorbing = true }

[[objects]]
material = "tar"
plane = {}
position_m = [0, 0, -1.5]

[[objects]]
name = "shop window"
material = "mirror"
box = { from_m = [6, -20, -1.5], to_m = [7, 20, 4] }

[[objects]]
name = "sign"
material = "plate"
box = { from_m = [-2, 9, 0], to_m = [2, 9.1, 2] }

[[objects]]
name = "gate"
material = "opening"
box = { from_m = [-6, -9, -1], to_m = [-5, 9, 3] }

[[objects]]
name = "tram"
material = "paint"
position_m = [3, -8, 0]
velocity_m_s = [0, 10, 0]
box = { size_m = [2, 12, 3] }
"#;

#[test]
fn the_facts_of_a_scene_call_for_its_effects() {
    let scene = SceneFile::parse(STRANGE, None, None).unwrap();
    let expected = [
        "moving_objects",
        "divergence",
        "weather",
        "reflectance",
        "range_noise",
        "lidar_clock",
        "servo_lag",
        "backlash",
        "encoder_quantisation",
        "loss",
        "link_jitter",
        "batching",
    ];
    assert_eq!(on(&scene), expected);
    let line_of = |start: &str| {
        let line = STRANGE.lines().position(|line| line.starts_with(start));
        Some(line.unwrap() + 1)
    };
    let demand = |effect: &str, about: &str| {
        let mut all = scene.demands.iter();
        let found = all.find(|demand| demand.effect == effect && demand.reason.contains(about));
        found.unwrap_or_else(|| panic!("{effect} {about}: {:#?}", scene.demands))
    };
    let tram = line_of("name = \"tram\"").map(|line| line - 1);
    for (effect, about, object, line) in [
        (
            "reflectance",
            "\"mirror\" mirrors 95 %",
            Some("mirror"),
            line_of("mirror"),
        ),
        (
            "reflectance",
            "\"tar\" returns 3 %",
            Some("tar"),
            line_of("tar"),
        ),
        (
            "reflectance",
            "\"plate\" is retroreflecting",
            Some("plate"),
            line_of("plate"),
        ),
        (
            "moving_objects",
            "object \"tram\" moves",
            Some("tram"),
            tram,
        ),
        ("weather", "visibility of 80 m", None, line_of("[weather]")),
        ("servo_lag", "20 Hz", None, line_of("servo")),
        ("batching", "10 ms", None, line_of("batching")),
        (
            "divergence",
            "most of material \"paint\"",
            Some("paint"),
            line_of("paint"),
        ),
    ] {
        let found = demand(effect, about);
        assert_eq!(
            (found.object.as_deref(), found.line),
            (object, line),
            "{found:?}"
        );
        assert!(found.estimate().is_some(), "{found:?}");
    }
    // What absorbs returns nothing without any effect.
    let absorbing = scene
        .demands
        .iter()
        .find(|demand| demand.reason.contains("opening"));
    assert!(absorbing.is_none(), "{absorbing:?}");
    // The tram passes 8 m in the 0.8 s of the sweep, and 2 m in the rests.
    let moved_mm = demand("moving_objects", "").displaced_mm.unwrap();
    assert!((moved_mm - 10_000.0).abs() < 50.0, "{moved_mm}");
    // Half of the shots meet tar, most of them at more than 9 m where 3 % are too faint.
    let lost = demand("reflectance", "tar").percent.unwrap();
    assert!((5.0..60.0).contains(&lost), "{lost}");
    // First order: the shaft is 1 / (2 pi 20 Hz) behind, 0.45 deg at full speed.
    let lag_mm = demand("servo_lag", "").displaced_mm.unwrap();
    assert!((300.0..800.0).contains(&lag_mm), "{lag_mm}");
}

/// `weather = true` beside the fact of a fog once had no fog, without a word.
#[test]
fn an_effect_that_is_switched_on_has_the_settings_of_its_fact() {
    let with = |text: &str| {
        let motion = "[motion]\nkind = \"fixed\"\nduration_s = 1\n";
        SceneFile::parse(&format!("scene = \"hall\"\n{motion}{text}"), None, None)
    };
    let fog = with("[weather]\nvisibility_m = 20\n[effects]\nweather = true\n").unwrap();
    assert!(fog.is_forced("weather"));
    let demand = fog.demand("weather").unwrap();
    assert!(demand.reason.contains("20 m"), "{demand:?}");
    for nothing in [
        "[effects]\nweather = true\n",
        "[weather]\n",
        "[effects]\nweather = {}\n",
        "[effects]\nbase_drift = true\n",
        "[effects]\nown_shadow = true\n",
    ] {
        let error = with(nothing).unwrap_err();
        let expected = ["got neither", "got true alone"];
        assert!(
            expected.iter().any(|what| error.what.contains(what)),
            "{nothing} {error}"
        );
        assert!(error.line > 3, "{nothing} {error}");
    }
    // What is off, or 0, is no slip.
    for valid in [
        "[weather]\n[effects]\nweather = false\n",
        "[base]\nvelocity_m_s = [0, 0, 0]\n",
        "[mount]\nshadow = { sectors = [] }\n",
    ] {
        with(valid).unwrap();
    }
}

/// A boom of 40 m that turns by 20 deg, and a fan of 1.2 m that turns many times.
#[test]
fn a_turning_object_is_displaced_by_its_own_arm() {
    let displaced_m = |objects: &str| {
        let motion = "[motion]\nkind = \"fixed\"\nduration_s = 1\n";
        let scene = SceneFile::parse(&format!("{motion}{objects}"), None, None).unwrap();
        let demand = scene.demand("moving_objects").unwrap();
        demand.displaced_mm.unwrap() * 1e-3
    };
    let boom = "[[objects]]\nposition_m = [0, 10, 0]\nturn_deg_s = [0, 0, 20]\n\
                box = { from_m = [0, -0.1, -0.1], to_m = [40, 0.1, 0.1] }\n";
    assert!((displaced_m(boom) - 40.0 * 20.0_f64.to_radians()).abs() < 0.2);
    let fan = "[[objects]]\nposition_m = [0, 10, 0]\nturn_deg_s = [0, 1200, 0]\n\
               box = { size_m = [1.2, 0.05, 0.1] }\n";
    assert!((displaced_m(fan) - 1.2).abs() < 0.2);
}

#[test]
fn demanded_effects_are_switched_off_and_set_in_the_file() {
    let with = |effects: &str| {
        SceneFile::parse(&format!("{STRANGE}\n[effects]\n{effects}\n"), None, None).unwrap()
    };
    let off = with("reflectance = false\ndivergence = false");
    assert!(!on(&off).contains(&"reflectance") && !on(&off).contains(&"divergence"));
    assert!(off.demand("reflectance").is_some() && !off.is_requested("reflectance"));
    // A table is stronger than a fact and than `all`; `true` has the usual settings.
    let some = with("all = false\nrange_noise = true\nbacklash = { play_deg = 0.5 }");
    assert_eq!(on(&some), ["range_noise", "backlash"]);
    assert!(some.is_forced("range_noise") && !some.is_forced("backlash"));
    assert_eq!(
        some.effects.effects.firings.surface[0]
            .effect
            .range_variance_m2(),
        1e-4
    );
    let play = some.demand("backlash").unwrap();
    assert!(play.reason.contains("0.5 deg"), "{play:?}");
    let all = with("limited_field_of_view = { from_deg = 10, to_deg = 350 }");
    assert!(on(&all).contains(&"limited_field_of_view"));
    let (line, what) = error(&format!("{LEAST}[effects]\nlimited_field_of_view = true\n"));
    assert!(line == 6 && what.contains("no usual"), "{line} {what}");
    let (line, what) = error(&format!("{LEAST}[effects]\nreflectance = 3\n"));
    assert!(
        line == 6 && what.contains("true, false or a table"),
        "{line} {what}"
    );
    let (line, what) = error(&STRANGE.replace("visibility_m = 80", "visibility_m = 0"));
    assert!(line == 9 && what.contains("visibility_m"), "{line} {what}");
    let (line, what) = error(&STRANGE.replace("play_deg = 0.02", "play_deg = -1"));
    assert!(line == 13 && what.contains("play_deg"), "{line} {what}");
}

#[test]
fn a_scene_states_its_tolerance() {
    let scene = SceneFile::parse(&format!("tolerance = \"5mm,0.1%\"\n{LEAST}"), None, None);
    let tolerance = scene.unwrap().tolerance.unwrap();
    assert_eq!((tolerance.displaced_mm, tolerance.percent), (5.0, 0.1));
    let (line, what) = error(&format!("seed = 1\ntolerance = \"5\"\n{LEAST}"));
    assert!(line == 2 && what.contains("5mm,0.1%"), "{line} {what}");
}

/// Where `[effects]` has no settings of its own.
#[test]
fn an_invalid_fact_is_named_where_it_is_stated() {
    let text = format!("{LEAST}[weather]\nvisibility_m = 0.1\n[effects]\nweather = true\n");
    let (line, what) = error(&text);
    assert!(
        line == 6 && what.starts_with("weather.visibility_m:"),
        "{line} {what}"
    );
}

/// Copies are one object; the farthest comes first.
#[test]
fn each_moving_object_is_a_demand() {
    let mover = |name: &str, y_m: f64, speed: f64, copies: &str| {
        format!(
            "[[objects]]\nname = \"{name}\"\nposition_m = [5, {y_m}, 0]\nvelocity_m_s = [0, {speed}, 0]\n\
             box = {{ size_m = [1, 2, 2] }}\n{copies}"
        )
    };
    let text = LEAST.replace("scene = \"hall\"\n", "")
        + &mover("cart", 0.0, 1.0, "")
        + &mover(
            "van",
            9.0,
            10.0,
            "copies = { at_m = [[0, 0, 0], [4, 0, 0]] }\n",
        );
    let scene = SceneFile::parse(&text, None, None).unwrap();
    let demands = scene.demands.iter();
    let found: Vec<_> = (demands.filter(|demand| demand.effect == "moving_objects"))
        .map(|demand| (demand.reason.as_str(), demand.displaced_mm.unwrap().round()))
        .collect();
    let expected = [
        ("2 objects \"van\" move or rotate", 10_000.0),
        ("object \"cart\" moves or rotates", 1_000.0),
    ];
    assert_eq!(found, expected);
}

/// Noise by the data sheet of the lidar.
#[test]
fn the_usual_noise_is_that_of_the_lidar() {
    for (model, mm) in [
        ("vlp16", "10 mm"),
        ("hdl32e", "6.7 mm"),
        ("lms151", "12 mm"),
    ] {
        let text = format!("{LEAST}[sensor]\nmodel = \"{model}\"\n");
        let scene = SceneFile::parse(&text, None, None).unwrap();
        let noise = scene.demand("range_noise").unwrap();
        assert!(noise.reason.ends_with(mm), "{noise:?}");
    }
    let ideal = format!("{LEAST}[sensor]\nideal = true\n");
    let ideal = SceneFile::parse(&ideal, None, None).unwrap();
    assert!(!on(&ideal).contains(&"range_noise"));
}

/// Fog returns shots that nothing else would: in the open most of what it changes.
#[test]
fn fog_before_the_sky_counts() {
    let text = LEAST.replace("hall", "parking") + "[weather]\nvisibility_m = 40\n";
    let scene = SceneFile::parse(&text, None, None).unwrap();
    let percent = scene.demand("weather").unwrap().percent.unwrap();
    assert!((30.0..90.0).contains(&percent), "{percent}");
}

#[test]
fn lidars_without_packets_stand_in_scenes() {
    for (model, rpm, lasers) in [
        ("hdl64e", 600, 64),
        ("utm30lx", 2_400, 1),
        ("lms151", 1_500, 1),
    ] {
        let text = format!("{LEAST}[sensor]\nmodel = \"{model}\"\n");
        let scene = SceneFile::parse(&text, None, None).unwrap();
        let simulation = &scene.simulation;
        assert_eq!(
            (simulation.rotation.rpm, simulation.sensor.beams.len()),
            (rpm, lasers)
        );
        assert_eq!(simulation.sensor.packets, None);
        let of_packets = ["lidar_clock", "link_jitter", "encoder_quantisation"];
        assert!(of_packets.iter().all(|name| scene.demand(name).is_none()));
        assert!(scene.demand("range_noise").is_some());
        let (line, what) = error(&format!("{text}rpm = 1080\n"));
        assert!(line == 7 && what.contains("rpm"), "{line} {what}");
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
    assert!(line == 5 && what.contains("fixed axis"), "{line} {what}");
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
    assert_eq!(on(&scene)[0], "moving_objects");
}
