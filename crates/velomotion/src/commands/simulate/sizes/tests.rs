use super::*;

/// A large hall of window glass, with a train that passes.
const GLASS: &str = r#"
[motion]
kind = "sweeps"
from_deg = 0
to_deg = -30
speed_deg_s = 60
accel_deg_s2 = 500

[materials]
glass = { reflectivity = 6, specular = 0.8 }
paint = { reflectivity = 60 }

[[objects]]
name = "hall"
material = "glass"
box = { from_m = [-40, -30, -1], to_m = [40, 30, 9] }

[[objects]]
name = "train"
material = "paint"
position_m = [0, 8, 0]
velocity_m_s = [12, 0, 0]
box = { size_m = [20, 2, 3] }
"#;

const THREADS: NonZeroUsize = NonZeroUsize::MIN;

fn scene(text: &str) -> SceneFile {
    SceneFile::parse(text, Some(3), None).unwrap()
}

fn size<'s>(sizes: &'s [EffectSize], effect: &str) -> &'s EffectSize {
    sizes.iter().find(|size| size.effect == effect).unwrap()
}

fn tolerance(text: &str) -> EffectTolerance {
    text.parse().unwrap()
}

#[test]
fn effects_that_a_scene_calls_for_and_lacks_are_warned_of() {
    let mut scene = scene(GLASS);
    scene.effects.leave_out(|name| name == "moving_objects");
    let sizes = Sampler::new(&scene, THREADS).sizes(true).unwrap();
    assert!(sizes.iter().all(|size| !size.is_on));
    let warnings = warnings(&sizes);
    let has = |words: &str| warnings.iter().any(|warning| warning.contains(words));
    assert!(
        has("reflectance is off, though material \"glass\" mirrors 80 % of the light (line 10)"),
        "{warnings:?}"
    );
    assert!(
        has("moving_objects is off, though 1 object(s) move or rotate (line 18)"),
        "{warnings:?}"
    );
    assert!(size(&sizes, "reflectance").lost_percent > 10.0);
    assert!(size(&sizes, "moving_objects").moved_percent > 0.1);
}

#[test]
fn an_ideal_sensor_calls_for_no_errors_of_its_own() {
    let scene = scene(&format!("{GLASS}\n[sensor]\nideal = true\n"));
    let demands: Vec<_> = scene.demands.iter().map(|demand| demand.effect).collect();
    assert_eq!(demands, ["moving_objects"]);
}

/// The sizes by leaving out are those of whole simulations: noise of a known deviation moves points
/// as it must, and what never returns is counted once.
#[test]
fn sizes_are_those_of_the_effects() {
    let noise = "[effects.range_noise]\nsd_m = 0.02\n";
    let shadow = "[[effects.own_shadow.sectors]]\nazimuth_from_deg = 90\nazimuth_to_deg = 126\n";
    let mut scene = scene(&format!("{GLASS}\n{noise}\n{shadow}"));
    scene.effects.leave_out(|name| name == "moving_objects");
    let sizes = Sampler::new(&scene, THREADS).sizes(false).unwrap();
    let noise = size(&sizes, "range_noise");
    // Of a normal distribution: the median of its magnitude, and its 99th percentile. Ranges are
    // whole steps of 2 mm.
    assert!((noise.median_mm - 0.674_5 * 20.0).abs() < 1.0, "{noise:?}");
    assert!((noise.p99_mm - 2.575_8 * 20.0).abs() < 3.0, "{noise:?}");
    let shadow = size(&sizes, "own_shadow");
    assert!((shadow.lost_percent - 10.0).abs() < 0.5, "{shadow:?}");
    assert_eq!((shadow.gained_percent, shadow.worst_mm), (0.0, 0.0));
}

#[test]
fn a_tolerance_chooses_effects_whose_cloud_is_close_to_one_with_all() {
    let scene = scene(GLASS);
    let sampler = Sampler::new(&scene, THREADS);
    let mut before = usize::MAX;
    for text in ["1mm,0.5%", "5mm,0.5%", "60mm,2%"] {
        let choice = sampler.choose(tolerance(text), &|_| false).unwrap();
        assert!(choice.left_percent <= choice.tolerance.percent, "{text}");
        // The same difference by hand.
        let all = sampler.cloud(&sampler.candidates()).unwrap();
        let chosen = sampler.cloud(&choice.on).unwrap();
        let left = (all.difference(&chosen)).beyond_percent(choice.tolerance.displaced_mm);
        assert_eq!(left, choice.left_percent, "{text}");
        assert!(choice.on.contains(&"reflectance"), "{choice:?}");
        assert!(choice.on.len() <= before, "{choice:?}");
        before = choice.on.len();
    }
    assert!(before < sampler.candidates().len());
    let choice = sampler.choose(tolerance("1mm,0.5%"), &|name| name == "reflectance");
    assert!(!choice.unwrap().on.contains(&"reflectance"));
}

#[test]
fn shares_that_the_sample_cannot_show_are_refused() {
    let scene = scene(GLASS);
    let refused = Sampler::new(&scene, THREADS).choose(tolerance("1mm,0.0001%"), &|_| false);
    let failure = refused.unwrap_err();
    assert_eq!(failure.kind, Kind::Usage);
    assert!(failure.to_string().contains("sampled points"), "{failure}");
}

#[test]
fn a_fixed_axis_has_sizes_too() {
    let motion = GLASS.find("[materials]").unwrap();
    let text = format!(
        "[motion]\nkind = \"fixed\"\nduration_s = 0.3\n{}",
        &GLASS[motion..]
    );
    let sizes = Sampler::new(&scene(&text), THREADS).sizes(false).unwrap();
    assert!(size(&sizes, "moving_objects").is_on);
    assert!(
        sizes
            .iter()
            .all(|size| size.effect != "encoder_quantisation")
    );
}

#[test]
fn tables_fit_80_columns() {
    let scene = scene(GLASS);
    let sizes = Sampler::new(&scene, THREADS).sizes(false).unwrap();
    let table = table(&sizes);
    assert!(
        table.lines().all(|line| line.chars().count() <= 80),
        "{table}"
    );
}
