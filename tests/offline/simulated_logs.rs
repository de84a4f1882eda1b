//! Logs of `simulate`: what may be compared with them, and what replaces which file.

use super::*;

const SCENE: &str = "[sensor]\nideal = true\nrpm = 600\n[mount]\nd_m = 0.06\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0\nto_deg = -45\nspeed_deg_s = 50\n[[objects]]\nsphere = { radius_m = 10 }\n";

fn simulated() -> Place {
    let place = Place::new();
    std::fs::write(place.path("swept.toml"), SCENE).unwrap();
    let made = place.run("simulate swept.toml -o swept.pcapng");
    assert!(made.status.success(), "{made:?}");
    place
}

/// Compared with another scene, points would be metres off.
#[test]
fn only_the_scene_of_a_log_is_its_truth() {
    let place = simulated();
    place.fails(
        "accuracy swept.pcapng --scene hall",
        2,
        &["swept.pcapng has the scene swept.toml, not hall"],
    );
    place.fails(
        "accuracy swept.pcapng --scene swept.toml --seed 3",
        2,
        &["the seed 0, not 3", "without --seed"],
    );
    std::fs::write(place.path("swept.toml"), SCENE.replace("= 10", "= 11")).unwrap();
    place.fails(
        "accuracy swept.pcapng --scene swept.toml",
        2,
        &["swept.toml has changed since swept.pcapng was simulated"],
    );
    let lidar = place.run("replay swept.pcapng -o lidar.pcap");
    assert!(lidar.status.success());
    place.fails(
        "accuracy lidar.pcap --scene swept.toml",
        2,
        &["lidar.pcap does not say that a scene was simulated"],
    );
}

#[test]
fn a_calibration_needs_different_scans_and_replaces_only_a_calibration() {
    let place = simulated();
    place.fails(
        "calibrate swept.pcapng swept.pcapng",
        2,
        &["swept.pcapng and swept.pcapng are the same scan"],
    );
    place.fails(
        "calibrate swept.pcapng --fix lasers",
        2,
        &[
            "\"lasers\" is neither a parameter nor the first words of one",
            "play_deg",
        ],
    );
    place.fails(
        "calibrate swept.pcapng -o swept.toml --force",
        2,
        &["swept.toml exists and is no calibration"],
    );
    // Before the minutes of the fit.
    place.fails(
        "calibrate swept.pcapng -o missing/mount.toml",
        2,
        &["the folder missing does not exist"],
    );
}

#[test]
fn a_motion_that_cannot_be_simulated_replaces_no_log() {
    let place = simulated();
    let endless = SCENE.replace("speed_deg_s = 50", "speed_deg_s = 1e-9");
    std::fs::write(place.path("endless.toml"), endless).unwrap();
    place.fails(
        "simulate endless.toml -o swept.pcapng --force",
        3,
        &["at most 86400 s"],
    );
}

/// A droplet of fog is no surface, so its echo can be compared with nothing.
#[test]
fn echoes_of_fog_are_named_as_points_without_a_truth() {
    let place = Place::new();
    let made = place.run("simulate fog -o fog.pcapng");
    assert!(made.status.success(), "{made:?}");
    let compared = place.run("accuracy fog.pcapng --scene fog");
    assert!(compared.status.success(), "{compared:?}");
    let text = String::from_utf8_lossy(&compared.stdout).into_owned();
    assert!(text.contains("points have no truth"), "{text}");
}

/// Where nothing is in range, a cloud is no result.
#[test]
fn a_cloud_without_points_is_incomplete() {
    let place = Place::new();
    let scene = SCENE.replace("= 10", "= 500");
    std::fs::write(place.path("far.toml"), scene).unwrap();
    let made = place.run("simulate far.toml -o far.pcapng -q");
    assert!(made.status.success(), "{made:?}");
    let said = String::from_utf8_lossy(&made.stderr).into_owned();
    assert!(said.contains("warning: no shot returned"), "{said}");
    let replayed = place.run("replay far.pcapng");
    let said = String::from_utf8_lossy(&replayed.stderr).into_owned();
    assert_eq!(replayed.status.code(), Some(6), "{said}");
    let expected = "far.pcapng: the cloud has no point: the lidar had no return";
    assert!(said.contains(expected), "{said}");
}
