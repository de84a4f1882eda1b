//! Lidars whose packets are not simulated: clouds without a log.

use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use cloud::formats::Format;
use cloud::read::positions;
use engine::failure::Kind;
use engine::simulate::{
    Sampler, SimulationFiles, SimulationReport, SimulationRequest, choose_effects, make, read,
};

const THREADS: NonZeroUsize = NonZeroUsize::new(2).unwrap();

fn scene(model: &str, more: &str) -> String {
    format!(
        "scene = \"hall\"\n{more}[sensor]\nmodel = \"{model}\"\nnoise = {{ sd_m = 0.02 }}\n[mount]\nd_m = 0.06\n\
         [motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -30\nspeed_deg_s = 200\n"
    )
}

/// The measured cloud and the true one.
fn clouds(text: &str) -> (SimulationReport, Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let folder = tempfile::tempdir().unwrap();
    let [measured, truth] = ["measured.ply", "truth.ply"].map(|name| folder.path().join(name));
    let scene = read("test", text, None, None).unwrap();
    let files = SimulationFiles {
        scene: Path::new("test"),
        output: &measured,
        option: "-o",
        truth: Some(&truth),
        force: false,
    };
    let (output, truth_target) = files.open(&scene).unwrap();
    let request = SimulationRequest {
        name: "test".to_owned(),
        output,
        truth: truth_target,
        threads: THREADS,
        explain: false,
        interrupt: &AtomicBool::new(false),
        progressed: &mut |_| {},
    };
    let (report, failure) = make(scene, request).unwrap();
    assert!(failure.is_none(), "{failure:?}");
    let points = |path: &Path| {
        let read = positions(Format::Ply, std::fs::read(path).unwrap()).unwrap();
        read.positions.to_vec()
    };
    let (measured, truth) = (points(&measured), points(&truth));
    (report, measured, truth)
}

#[test]
fn a_lidar_without_packets_gives_its_cloud() {
    for (model, least) in [("hdl64e", 200_000), ("utm30lx", 3_000), ("lms151", 2_000)] {
        let (report, measured, truth) = clouds(&scene(model, ""));
        assert_eq!((report.log, report.packets.data), (None, 0));
        assert!(report.cloud.is_some() && report.truth.is_some());
        assert!(measured.len() > least, "{model}: {}", measured.len());
        assert_eq!(measured.len() as u64, report.returns);
        assert_eq!(measured.len(), truth.len());
        let errors = measured.iter().zip(&truth);
        let squares =
            errors.map(|(a, b)| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum() });
        let rms_m = (squares.sum::<f64>() / measured.len() as f64).sqrt();
        // The noise of the scene, and mixed pixels.
        assert!((0.019..0.2).contains(&rms_m), "{model}: {rms_m}");
    }
}

/// The measured cloud has errors of the lasers and of a base that moves.
#[test]
fn a_measured_cloud_is_placed_by_the_nominal_sensor() {
    for (more, sd_m, least_mm) in [
        ("[base]\nvelocity_m_s = [0.5, 0, 0]\n", 0.0, 30.0),
        (
            "[effects]\nlaser_errors = { azimuth_sd_deg = 0.5 }\n",
            0.0,
            30.0,
        ),
        ("", 0.0, 0.0),
    ] {
        let text = scene("hdl64e", "").replace("sd_m = 0.02", &format!("sd_m = {sd_m}"));
        let without = "divergence = false\nreflectance = false\n";
        let more = match more.strip_prefix("[effects]\n") {
            Some(laser_errors) => format!("[effects]\n{without}{laser_errors}"),
            None => format!("{more}[effects]\n{without}"),
        };
        let (_, measured, truth) = clouds(&format!("{text}{more}"));
        let errors = measured.iter().zip(&truth).map(|(a, b)| {
            let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            square.sqrt() * 1e3
        });
        let worst_mm = errors.fold(0.0, f64::max);
        // Steps of 2 mm remain.
        assert!(
            worst_mm >= least_mm && (least_mm > 0.0 || worst_mm < 1.1),
            "{more}: {worst_mm}"
        );
    }
}

/// Lasers from 32 on are those of the second firing at an instant.
#[test]
fn a_laser_of_the_second_firing_is_simulated_alone() {
    let text = scene("hdl64e", "");
    let (all, ..) = clouds(&text);
    let (one, measured, _) = clouds(&text.replace("[mount]", "only_laser = 40\n[mount]"));
    assert!(all.shots > 100_000);
    assert_eq!(64 * one.shots, all.shots);
    assert_eq!(measured.len() as u64, one.returns);
    assert!(one.returned > one.shots / 2);
}

/// Without a return the end of a run is found too.
#[test]
fn a_scene_without_objects_is_simulated_to_its_end() {
    let text = scene("utm30lx", "").replace("scene = \"hall\"\n", "");
    let (report, measured, truth) = clouds(&text);
    assert!(measured.is_empty() && truth.is_empty() && report.shots > 1_000);
}

/// Fog is measured and not true.
#[test]
fn returns_from_fog_are_in_the_measured_cloud_alone() {
    let text = format!("{}[weather]\nvisibility_m = 20\n", scene("hdl64e", ""));
    let (_, measured, truth) = clouds(&text);
    assert!(measured.len() > truth.len() + 100);
    assert!(measured.iter().flatten().all(|x| x.is_finite()));
}

#[test]
fn effects_of_a_lidar_without_packets_are_measured_and_chosen() {
    for model in ["hdl64e", "utm30lx"] {
        let mut scene = read("test", &scene(model, ""), None, None).unwrap();
        let sampler = Sampler::new(&scene, THREADS);
        let sizes = sampler.sizes(&sampler.candidates()).unwrap();
        let size = |name: &str| sizes.iter().find(|size| size.effect == name);
        let noise = size("range_noise").unwrap();
        // The median of a normal distribution of 20 mm, without its sign.
        assert!((12.0..15.0).contains(&noise.median_mm), "{noise:?}");
        assert!(size("divergence").is_some() && size("link_jitter").is_none());
        // Four standard deviations of the noise.
        let tolerance = Some("80mm,1%".parse().unwrap());
        let chosen = choose_effects(
            &mut scene,
            "test",
            |_| false,
            tolerance,
            THREADS,
            None,
            None,
        );
        let chosen = chosen.unwrap().unwrap();
        assert!(!chosen.on.contains(&"range_noise"), "{:?}", chosen.on);
    }
}

#[test]
fn a_log_of_a_lidar_without_packets_is_refused() {
    let scene = read("test", &scene("lms151", ""), None, None).unwrap();
    let files = SimulationFiles {
        scene: Path::new("test"),
        output: Path::new("scene.pcapng"),
        option: "-o",
        truth: None,
        force: false,
    };
    let failure = files.open(&scene).err().unwrap();
    assert_eq!(failure.kind, Kind::Usage);
    assert!(failure.message.contains("no log"), "{failure:?}");
}
