use super::*;
use sim::effect_models::EffectTolerance;

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

fn on(scene: &SceneFile) -> Vec<&'static str> {
    scene.effects.lines.iter().map(|line| line.name).collect()
}

/// Sizes of all effects that are on or called for.
fn sizes_of(scene: &SceneFile) -> Vec<EffectSize> {
    let sampler = Sampler::new(scene, THREADS);
    sampler.sizes(&sampler.candidates()).unwrap()
}

#[test]
fn effects_that_a_scene_calls_for_and_lacks_are_warned_of() {
    let off = "[effects]\nmoving_objects = false\nreflectance = false\n";
    let scene = scene(&format!("{GLASS}\n{off}"));
    let sampler = Sampler::new(&scene, THREADS);
    assert_eq!(sampler.off(), ["moving_objects", "reflectance"]);
    let warnings = unmet(&sampler, None, &|_| false).unwrap();
    let has = |words: &str| warnings.iter().any(|warning| warning.contains(words));
    assert!(
        has("reflectance is off, though material \"glass\" mirrors 80 % of the light (line 10)"),
        "{warnings:?}"
    );
    assert!(has("moving_objects is off, though object"), "{warnings:?}");
    let sizes = sampler.sizes(&sampler.off()).unwrap();
    assert!(sizes.iter().all(|size| !size.is_on));
    assert!(size(&sizes, "reflectance").lost_percent > 10.0);
    assert!(size(&sizes, "moving_objects").moved_percent > 0.1);
    let chosen = unmet(&sampler, Some(&sizes), &|name| name == "reflectance").unwrap();
    assert_eq!(chosen.len(), 1, "{chosen:?}");
}

/// Many effects that are off are one warning, with the fact of each and the size of all.
#[test]
fn effects_that_are_all_off_are_warned_of_together() {
    let scene = scene(&format!("{GLASS}\n[effects]\nall = false\n"));
    let sampler = Sampler::new(&scene, THREADS);
    let [warning] = &unmet(&sampler, None, &|_| false).unwrap()[..] else {
        panic!()
    };
    for name in sampler.off() {
        let demand = scene.demand(name).unwrap();
        let fact = format!("{name} ({})", demand.reason_and_line());
        assert!(warning.contains(&fact), "{fact}: {warning}");
    }
    assert!(warning.contains("Together they would add"), "{warning}");
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
    let scene = scene(&format!(
        "{GLASS}\n[effects]\nall = false\n{noise}\n{shadow}"
    ));
    let sizes = sizes_of(&scene);
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
    let with_all = scene(GLASS);
    let sampler = Sampler::new(&with_all, THREADS);
    let all = on(&with_all);
    let mut before = usize::MAX;
    for text in ["1mm,0.5%", "5mm,0.5%", "60mm,2%"] {
        let choice = sampler.choose(tolerance(text), &all, false).unwrap();
        assert!(choice.left_percent <= choice.tolerance.percent, "{text}");
        // The same difference by hand.
        let reference = sampler.cloud(&all).unwrap();
        let chosen = sampler.cloud(&choice.on).unwrap();
        let left = (reference.difference(&chosen)).beyond_percent(choice.tolerance.displaced_mm);
        assert_eq!(left, choice.left_percent, "{text}");
        assert!(choice.on.contains(&"reflectance"), "{choice:?}");
        assert_eq!(choice.on.len() + choice.off.len(), all.len());
        assert!(choice.on.len() <= before, "{choice:?}");
        before = choice.on.len();
        let words = choice.text(1e-3);
        assert!(words.contains("takes longer than it saves"), "{words}");
    }
    assert!(before < all.len());
    // `true` is on in any case.
    let forced = scene(&format!("{GLASS}\n[effects]\nlink_jitter = true\n"));
    let sampler = Sampler::new(&forced, THREADS);
    let choice = sampler.choose(tolerance("60mm,2%"), &all, false).unwrap();
    assert!(choice.on.contains(&"link_jitter") && choice.on.len() <= before + 1);
}

#[test]
fn shares_that_the_sample_cannot_show_are_refused() {
    let scene = scene(GLASS);
    let sampler = Sampler::new(&scene, THREADS);
    let refused = sampler.choose(tolerance("1mm,0.0001%"), &on(&scene), false);
    let failure = refused.unwrap_err();
    assert_eq!(failure.kind, Kind::Usage);
    let text = failure.to_string();
    assert!(
        text.contains("sampled points") && text.contains("up to below 100 %"),
        "{text}"
    );
}

#[test]
fn a_fixed_axis_has_sizes_too() {
    let motion = GLASS.find("[materials]").unwrap();
    let text = format!(
        "[motion]\nkind = \"fixed\"\nduration_s = 0.3\n{}",
        &GLASS[motion..]
    );
    let sizes = sizes_of(&scene(&text));
    assert!(size(&sizes, "moving_objects").is_on);
    assert!(
        sizes
            .iter()
            .all(|size| size.effect != "encoder_quantisation")
    );
}

/// A truck that comes after 22 s of 30: the sample covers the whole scene.
#[test]
fn what_happens_late_counts() {
    let late = scene(
        r#"
[motion]
kind = "fixed"
duration_s = 30

[sensor]
only_laser = 7

[[objects]]
name = "hall"
box = { from_m = [-40, -40, -1], to_m = [40, 40, 9] }

[[objects]]
name = "truck"
position_m = [-130, 4, 0]
velocity_m_s = [5, 0, 0]
box = { size_m = [20, 3, 4] }
"#,
    );
    let sampler = Sampler::new(&late, THREADS);
    let sizes = sampler.sizes(&["moving_objects"]).unwrap();
    let moving = size(&sizes, "moving_objects");
    assert!(moving.moved_percent > 1.0, "{moving:?}");
    assert_eq!(sampler.beginning_s(), None);
}

#[test]
fn an_interrupted_comparison_ends() {
    let scene = scene(GLASS);
    let flag = AtomicBool::new(true);
    let sampler = Sampler::new(&scene, THREADS).interrupted_by(Some(&flag));
    let failure = sampler.sizes(&["reflectance"]).unwrap_err();
    assert_eq!(failure.kind, Kind::Interrupted);
    flag.store(false, Ordering::Relaxed);
    assert!(sampler.sizes(&["reflectance"]).is_ok());
}
