//! Calibration files of both kinds give the corrections of their conventions, and invalid ones are
//! refused with the line. All numbers are invented.
#![expect(clippy::unwrap_used, reason = "a test")]

use std::fmt::Write as _;

use lidar::calibration::{Ignored, from_ros_yaml, from_toml};
use lidar::{Corrections, LaserCorrection};
use protocol::vlp16::LidarModel;
use protocol::vlp16::models::{HDL_32E, PUCK_HI_RES, VLP_16, VLP_32C};

/// One laser of a ROS file: angles in radians, lengths in metres.
#[derive(Clone, Copy, Debug)]
struct RosLaser {
    rot: f64,
    vert: f64,
    dist: f64,
    vert_offset: f64,
    horiz_offset: f64,
}

impl RosLaser {
    /// A laser with individual deviations from its model.
    fn invented(model: &LidarModel, i: usize) -> Self {
        let wobble = |scale: f64, k: usize| scale * ((i * 7 + k * 3) as f64).sin();
        let laser = model.lasers[i];
        Self {
            rot: -laser.azimuth_offset_deg.to_radians() + wobble(0.004, 1),
            vert: laser.elevation_deg.to_radians() + wobble(0.003, 2),
            dist: wobble(0.03, 3),
            vert_offset: laser.vertical_offset_m + wobble(0.02, 4),
            horiz_offset: wobble(0.025, 5),
        }
    }

    fn yaml(&self, i: usize) -> String {
        let Self {
            rot,
            vert,
            dist,
            vert_offset,
            horiz_offset,
        } = self;
        format!(
            "- {{dist_correction: {dist:e}, dist_correction_x: 0.0, dist_correction_y: 0.0,\n  \
             focal_distance: 0.0, focal_slope: 0.0, horiz_offset_correction: {horiz_offset},\n  \
             laser_id: {i}, rot_correction: {rot}, vert_correction: {vert},\n  \
             vert_offset_correction: {vert_offset}}}\n"
        )
    }

    /// The driver's arithmetic, term by term, in its own axes: x forward, y left.
    fn driver(&self, raw_m: f64, azimuth: f64) -> [f64; 3] {
        let distance = raw_m + self.dist;
        let cos_rot = azimuth.cos() * self.rot.cos() + azimuth.sin() * self.rot.sin();
        let sin_rot = azimuth.sin() * self.rot.cos() - azimuth.cos() * self.rot.sin();
        let xy = distance * self.vert.cos() - self.vert_offset * self.vert.sin();
        let x = xy * sin_rot - self.horiz_offset * cos_rot;
        let y = xy * cos_rot + self.horiz_offset * sin_rot;
        let z = distance * self.vert.sin() + self.vert_offset * self.vert.cos();
        [y, -x, z]
    }
}

fn ros_file(model: &LidarModel, order: impl Iterator<Item = usize>) -> String {
    let mut text = "lasers:\n".to_owned();
    for i in order {
        text += &RosLaser::invented(model, i).yaml(i);
    }
    let count = model.lasers.len();
    write!(
        text,
        "num_lasers: {count}\ndistance_resolution: {}\n",
        model.distance_unit_m
    )
    .unwrap();
    text
}

const MODELS: [&LidarModel; 4] = [&VLP_16, &PUCK_HI_RES, &HDL_32E, &VLP_32C];

#[test]
fn ros_files_place_points_like_the_ros_driver() {
    for model in MODELS {
        let n = model.lasers.len();
        let read = from_ros_yaml(&ros_file(model, 0..n), model).unwrap();
        assert_eq!(
            (read.corrections.lasers.len(), &read.ignored[..]),
            (n, &[][..])
        );
        for (i, correction) in read.corrections.lasers.iter().enumerate() {
            let laser = RosLaser::invented(model, i);
            for azimuth_deg in [0.0, 17.0, 133.3, 359.99] {
                for raw_m in [0.5, 10.0, 100.0] {
                    let [forward, left, up] = laser.driver(raw_m, f64::to_radians(azimuth_deg));
                    let [x, y, z] = correction.place(raw_m, azimuth_deg);
                    for (got, expected) in [(x, -left), (y, forward), (z, up)] {
                        assert!((got - expected).abs() < 1e-11, "{} laser {i}", model.name);
                    }
                }
            }
        }
    }
}

#[test]
fn laser_id_is_the_index_in_the_firing_order() {
    let in_order = from_ros_yaml(&ros_file(&VLP_16, 0..16), &VLP_16).unwrap();
    let reversed = from_ros_yaml(&ros_file(&VLP_16, (0..16).rev()), &VLP_16).unwrap();
    assert_eq!(in_order, reversed);
    for (correction, laser) in in_order.corrections.lasers.iter().zip(VLP_16.lasers) {
        assert!((correction.elevation_deg - laser.elevation_deg).abs() < 0.2);
    }
    // A file numbered by elevation has wrong angles.
    let mut by_ring = "num_lasers: 16\nlasers:\n".to_owned();
    for ring in 0..16 {
        let i = VLP_16
            .lasers
            .iter()
            .position(|laser| usize::from(laser.ring) == ring)
            .unwrap();
        by_ring += &RosLaser::invented(&VLP_16, i).yaml(ring);
    }
    let message = from_ros_yaml(&by_ring, &VLP_16).unwrap_err().to_string();
    assert!(
        message.starts_with("calibration YAML line 9: vert_correction: expected an elevation within 2 deg of the 1 deg of laser 1 of a VLP-16, got -1"),
        "{message}"
    );
}

#[test]
fn corrections_default_to_the_model() {
    for model in MODELS {
        let mut text = format!("model = {:?}\n", model.name);
        for (i, laser) in model.lasers.iter().enumerate() {
            write!(
                text,
                "[[laser]]\nid = {i}\nelevation_deg = {}\n",
                laser.elevation_deg
            )
            .unwrap();
        }
        assert_eq!(from_toml(&text, model).unwrap(), Corrections::from(model));
    }
}

/// A TOML table for a laser of a VLP-16 with every key.
fn table(i: usize) -> String {
    let elevation = VLP_16.lasers[i].elevation_deg as i64;
    format!(
        "[[laser]]\nid = {i}\nelevation_deg = {elevation}\nazimuth_offset_deg = 0.0{i}\nrange_offset_m = -0.01\n\
         radial_offset_m = 2e-3\ntangential_offset_m = 0.003\nvertical_offset_m = 0.01\n"
    )
}

fn toml_file() -> String {
    let tables: String = (0..16).map(table).collect();
    format!("# made up\nmodel = \"VLP-16\"\n{tables}")
}

#[test]
fn toml_files_give_their_corrections() {
    let corrections = from_toml(&toml_file(), &VLP_16).unwrap();
    let expected = LaserCorrection {
        elevation_deg: 1.0,
        azimuth_offset_deg: 0.01,
        range_offset_m: -0.01,
        radial_offset_m: 0.002,
        tangential_offset_m: 0.003,
        vertical_offset_m: 0.01,
    };
    assert_eq!(corrections.lasers[1], expected);
    // Ahead: radial along y, tangential to the left (-x), vertical.
    let straight = LaserCorrection {
        elevation_deg: 0.0,
        azimuth_offset_deg: 0.0,
        ..expected
    };
    let [x, y, z] = straight.place(10.01, 0.0);
    assert!((x + 0.003).abs() < 1e-12 && (y - 10.002).abs() < 1e-12 && (z - 0.01).abs() < 1e-12);
    // To the right: radial along x, tangential to the left, which is forward.
    let [x, y, _] = straight.place(10.01, 90.0);
    assert!((x - 10.002).abs() < 1e-12 && (y - 0.003).abs() < 1e-12);
}

#[test]
fn toml_errors_name_the_line() {
    let good = toml_file();
    let message = |from: &str, to: &str| {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        from_toml(&text, &VLP_16).unwrap_err().to_string()
    };
    let assert_error = |from: &str, to: &str, expected: &str| {
        let message = message(from, to);
        assert!(
            message.starts_with(&format!("calibration TOML line {expected}")),
            "{from} -> {to}: {message}"
        );
    };
    assert_error(
        "elevation_deg = -15",
        "elevation = -15",
        "5: unknown field `elevation`",
    );
    assert_error(
        "elevation_deg = -15\n",
        "",
        "3: missing field `elevation_deg`",
    );
    assert_error("id = 3\n", "", "27: missing field `id`");
    assert_error(
        "elevation_deg = 1\n",
        "elevation_deg = nan\n",
        "13: elevation_deg: expected a finite number, got NaN",
    );
    assert_error(
        "elevation_deg = 1\n",
        "elevation_deg = \"1\"\n",
        "13: invalid type: string",
    );
    assert_error(
        "elevation_deg = 1\n",
        "elevation_deg = 11\n",
        "13: elevation_deg: expected an elevation within 2 deg of the 1 deg of laser 1",
    );
    assert_error(
        "tangential_offset_m = 0.003",
        "tangential_offset_m = 3.0",
        "9: tangential_offset_m: expected at most 1 m",
    );
    assert_error(
        "range_offset_m = -0.01",
        "range_offset_m = -inf",
        "7: range_offset_m: expected a finite number, got -inf",
    );
    assert_error(
        "azimuth_offset_deg = 0.00",
        "azimuth_offset_deg = 90",
        "6: azimuth_offset_deg: expected an azimuth offset within 2 deg",
    );
    assert_error(
        "id = 3",
        "id = 4",
        "36: laser number: expected each number once, got 4",
    );
    assert_error(
        "id = 3",
        "id = 16",
        "28: laser number: expected 0 to 15, in firing order, got 16",
    );
    assert_error(
        "id = 3",
        "id = -1",
        "28: laser number: expected 0 to 15, in firing order, got -1",
    );
    assert_error(
        &table(15),
        "",
        "2: expected the 16 lasers of a VLP-16, got 15",
    );
    assert_error(
        "\"VLP-16\"",
        "\"HDL-32E\"",
        "2: model: expected \"VLP-16\", which the sensor is, got \"HDL-32E\"",
    );
    assert_error("[[laser]]", "[laser]", "11: duplicate key");
    assert_error("# made up", "made up", "1:");
    assert!(
        from_toml("", &VLP_16)
            .unwrap_err()
            .to_string()
            .contains("missing field `model`")
    );
}

#[test]
fn ros_errors_name_the_line() {
    let good = ros_file(&VLP_16, 0..16);
    let laser_1 = RosLaser::invented(&VLP_16, 1);
    let assert_error = |from: &str, to: &str, expected: &str| {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let message = from_ros_yaml(&text, &VLP_16).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("calibration YAML line {expected}")),
            "{from} -> {to}: {message}"
        );
    };
    assert_error(
        "laser_id: 1,",
        "laser_id: 0,",
        "8: laser number: expected each number once, got 0",
    );
    assert_error(
        "laser_id: 1,",
        "laser_id: 99,",
        "8: laser number: expected 0 to 15, in firing order, got 99",
    );
    assert_error(
        "laser_id: 1,",
        "laser_id: one,",
        "8: laser_id: expected a whole number, got \"one\"",
    );
    assert_error(
        "laser_id: 1,",
        "",
        "6: expected key laser_id, which is missing",
    );
    assert_error("rot_correction", "rotation", "4: key rotation is not known");
    assert_error(
        "laser_id: 1, rot_correction",
        "laser_id: 1, laser_id",
        "8: key laser_id is repeated",
    );
    let vert = |vert: f64| format!("vert_correction: {vert},");
    assert_error(
        &vert(laser_1.vert),
        "vert_correction: .nan,",
        "8: vert_correction: expected a finite number, got \".nan\"",
    );
    assert_error(
        &vert(laser_1.vert),
        "vert_correction: inf,",
        "8: vert_correction: expected a finite number, got \"inf\"",
    );
    assert_error(
        &vert(laser_1.vert),
        "vert_correction: -15,",
        "8: vert_correction: expected radians, at most half a revolution, got \"-15\"",
    );
    assert_error(
        &vert(laser_1.vert),
        "vert_correction: [1],",
        "8: vert_correction: expected a finite number, got a list of 1",
    );
    assert_error(
        "horiz_offset_correction: ",
        "horiz_offset_correction: 4",
        "3: horiz_offset_correction: expected at most 1 m",
    );
    assert_error(
        "num_lasers: 16",
        "num_lasers: 32",
        "66: num_lasers: expected at most 16, the length of the list, got \"32\"",
    );
    assert_error(
        "distance_resolution: 0.002",
        "distance_resolution: 0.004",
        "67: distance_resolution: expected the 0.002 m of a VLP-16, got \"0.004\"",
    );
    assert_error(
        "num_lasers: 16\n",
        "",
        "1: expected key num_lasers, which is missing",
    );
    assert_error(
        "lasers:\n",
        "lasers: &all\n",
        "1: anchors and tags are not supported",
    );
    assert_error(
        "lasers:\n",
        "lasers: 3\nother:\n",
        "2: key other is not known",
    );
    assert_error("}", "", "");
    let message = from_ros_yaml(&good, &HDL_32E).unwrap_err().to_string();
    assert_eq!(
        message,
        "calibration YAML line 2: expected the 32 lasers of a HDL-32E, got 16"
    );
    let message = from_ros_yaml(&ros_file(&PUCK_HI_RES, 0..16), &VLP_16)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("within 2 deg of the -15 deg of laser 0 of a VLP-16"),
        "{message}"
    );
    for (text, expected) in [
        ("", "1: expected a document, got an empty file"),
        ("[]", "1: the file: expected a mapping, got a list of 0"),
        ("lasers: {}\nnum_lasers: 0", "1: lasers: expected a list"),
        (
            "lasers: [1]\nnum_lasers: 1",
            "1: a laser: expected a mapping, got \"1\"",
        ),
        ("lasers: []\n---\nnum_lasers: 0", "2: expected one document"),
        ("lasers: *x", "1:"),
        ("? [a]\n: b", "1: expected a key, got a list of 1"),
        (&"[".repeat(40), "1: nested too deeply"),
    ] {
        let message = from_ros_yaml(text, &VLP_16).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("calibration YAML line {expected}")),
            "{message}"
        );
    }
}

#[test]
fn lasers_beyond_num_lasers_are_ignored() {
    let zero = RosLaser {
        rot: 0.0,
        vert: 0.0,
        dist: 0.0,
        vert_offset: 0.0,
        horiz_offset: 0.0,
    };
    let lasers = |extra: usize| {
        let first = (0..32).map(|i| RosLaser::invented(&HDL_32E, i).yaml(i));
        let text: String = first.chain([zero.yaml(extra)]).collect();
        format!("lasers:\n{text}num_lasers: 32\n")
    };
    let read = from_ros_yaml(&lasers(32), &HDL_32E).unwrap();
    assert_eq!(
        read,
        from_ros_yaml(&ros_file(&HDL_32E, 0..32), &HDL_32E).unwrap()
    );
    let message = from_ros_yaml(&lasers(31), &HDL_32E)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "calibration YAML line 132: laser_id: expected 32 or more beyond the first num_lasers, got 31"
    );
}

#[test]
fn azimuth_offsets_with_the_wrong_sign_are_refused() {
    // The manufacturer's tables of the VLP-32C have the opposite sign.
    let mut text = "num_lasers: 32\nlasers:\n".to_owned();
    for i in 0..32 {
        let laser = RosLaser::invented(&VLP_32C, i);
        text += &RosLaser {
            rot: -laser.rot,
            ..laser
        }
        .yaml(i);
    }
    let message = from_ros_yaml(&text, &VLP_32C).unwrap_err().to_string();
    assert!(
        message.starts_with("calibration YAML line 5: rot_correction: expected an azimuth offset within 2 deg of the 1.4 deg of laser 0 of a VLP-32C, got -1."),
        "{message}"
    );
}

#[test]
fn effective_two_point_corrections_are_refused() {
    let good = ros_file(&VLP_16, 0..16);
    let dist = RosLaser::invented(&VLP_16, 0).dist;
    let with = |available: &str, x: f64, y: f64| {
        let keys = format!(
            "two_pt_correction_available: {available}, dist_correction_x: {x}, dist_correction_y: {y},"
        );
        let text = good.replacen("dist_correction_x: 0.0, dist_correction_y: 0.0,", &keys, 1);
        from_ros_yaml(&text, &VLP_16)
    };
    let plain = from_ros_yaml(&good, &VLP_16).unwrap();
    assert_eq!(with("false", 1.3, 1.4).unwrap(), plain);
    assert_eq!(with("True", dist, dist).unwrap(), plain);
    let message = with("true", dist, dist + 0.01).unwrap_err().to_string();
    assert!(
        message.starts_with("calibration YAML line 2: dist_correction_y is not supported: a range correction that differs"),
        "{message}"
    );
    assert!(
        with("perhaps", dist, dist)
            .unwrap_err()
            .to_string()
            .contains("expected true or false")
    );
}

#[test]
fn corrections_of_reflectivity_are_listed() {
    let good = ros_file(&VLP_16, 0..16);
    let text = good
        .replacen(
            "focal_slope: 0.0",
            "focal_slope: 1.2, max_intensity: 255, min_intensity: 40",
            1,
        )
        .replacen("focal_distance: 0.0, focal_slope: 0.0,", "", 1);
    let read = from_ros_yaml(&text, &VLP_16).unwrap();
    let key = |key| Ignored { line: 3, key };
    assert_eq!(read.ignored, [key("focal_slope"), key("min_intensity")]);
    assert_eq!(
        read.corrections,
        from_ros_yaml(&good, &VLP_16).unwrap().corrections
    );
}
