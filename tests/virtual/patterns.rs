//! The scan-pattern analysis of the 2018 paper, repeated: patterns of `sim`, measured by
//! `analysis`.

use analysis::density::{
    BinCounts, Icosahedron, Locator, Statistics, TOLERANCE_RAD, bands, holes, largest_hole, rows,
};
use glam::DVec3;
use sim::patterns::{AXIS, Pattern, PatternRequest};

fn pattern(text: &str) -> Pattern {
    PatternRequest::parse(text).unwrap().build().unwrap()
}

fn statistics(directions: &[DVec3]) -> Statistics {
    let locator = Locator::new(&Icosahedron::new(4).unwrap());
    BinCounts::new(&locator, directions).unwrap().statistics()
}

/// A printed row of the table of densities.
struct Printed {
    pattern: &'static str,
    mean: f64,
    sd: f64,
    ends: Option<(u64, u64)>,
    /// Mean and standard deviation per square degree.
    per_deg2: [f64; 2],
}

const PRINTED: [Printed; 3] = [
    Printed {
        pattern: "rmbl:120",
        mean: 84.47,
        sd: 56.24,
        ends: Some((25, 365)),
        per_deg2: [10.48, 6.98],
    },
    Printed {
        pattern: "rmbl:50",
        mean: 202.73,
        sd: 133.92,
        ends: Some((95, 881)),
        per_deg2: [25.16, 16.62],
    },
    Printed {
        pattern: "velomotion16:50",
        mean: 50.68,
        sd: 63.22,
        ends: None,
        per_deg2: [6.29, 7.85],
    },
];

#[test]
fn densities_match_the_paper() {
    for row in PRINTED {
        let text = row.pattern;
        let ours = statistics(&pattern(text).directions());
        assert_eq!(ours.bins, 5_120);
        let printed = |ours: f64| (ours * 100.0).round() / 100.0;
        assert_eq!(printed(ours.mean), row.mean, "{text}");
        assert!((ours.sd - row.sd).abs() < 0.1, "{text}: {}", ours.sd);
        let [mean, sd] = row.per_deg2;
        assert!((ours.mean_per_deg2 - mean).abs() < 0.01, "{text}: {ours:?}");
        assert!((ours.sd_per_deg2 - sd).abs() < 0.02, "{text}: {ours:?}");
        if let Some((least, most)) = row.ends {
            assert_eq!(ours.min, least, "{text}");
            let off = ours.max as f64 / most as f64 - 1.0;
            assert!(off.abs() < 0.015, "{text}: {}", ours.max);
        }
    }
}

/// Settings whose figures come closest to the paper's; they differ in the last place.
#[test]
fn densities_match_the_recorded_values() {
    for (text, mean, sd, least, most) in [
        ("rmbl:120", "84.469", 56.23, 25, 366),
        ("rmbl:50", "202.725", 133.95, 95, 878),
        ("velomotion16:50", "50.681", 63.23, 0, 235),
    ] {
        let ours = statistics(&pattern(text).directions());
        // As `analyze` prints it: at two decimals the last bit would decide between 202.72 and the
        // paper's 202.73.
        assert_eq!(format!("{:.3}", ours.mean), mean, "{text}");
        assert!((ours.sd - sd).abs() < 0.011, "{text}: {}", ours.sd);
        assert_eq!(ours.min, least, "{text}");
        assert!(ours.max.abs_diff(most) <= 3, "{text}: {}", ours.max);
    }
}

/// The documentation's figures equal the computed ones, rounded as in the report.
#[test]
fn the_documentation_prints_the_output_of_the_report() {
    let book = include_str!("../../docs/src/paper.md");
    let table = book
        .split("## ")
        .find(|part| part.starts_with("Points per bin"));
    let rows: Vec<Vec<&str>> = table
        .unwrap()
        .lines()
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let ours: Vec<&Vec<&str>> = rows
        .iter()
        .filter(|row| row.get(1) == Some(&"ours"))
        .collect();
    assert_eq!(ours.len(), PRINTED.len());
    for (printed, row) in PRINTED.iter().zip(ours) {
        let directions = pattern(printed.pattern).directions();
        let s = statistics(&directions);
        let expected = [
            format!("{:.3}", s.mean),
            format!("{:.2}", s.sd),
            s.min.to_string(),
            s.max.to_string(),
            format!("{:.2}", s.mean_per_deg2),
            format!("{:.2}", s.sd_per_deg2),
        ];
        let points = row.get(2).unwrap().replace(',', "");
        assert_eq!(points, directions.len().to_string(), "{}", printed.pattern);
        assert_eq!(row.get(3..).unwrap(), expected, "{}", printed.pattern);
    }
}

/// Points per square degree in the zone between two angles from the tilt axis, both of its ends.
fn zone(directions: &[DVec3], from_deg: f64, to_deg: f64) -> f64 {
    let (high, low) = (from_deg.to_radians().cos(), to_deg.to_radians().cos());
    let within = directions
        .iter()
        .filter(|d| (low..high).contains(&d.dot(AXIS).abs()));
    let area_deg2 =
        4.0 * std::f64::consts::PI * (high - low) * (180.0 / std::f64::consts::PI).powi(2);
    within.count() as f64 / area_deg2
}

#[test]
fn poles_on_the_tilt_axis_are_densest() {
    for (text, times) in [("rmbl:120", 3.5), ("rmbl:50", 3.5)] {
        let directions = pattern(text).directions();
        let around = zone(&directions, 60.0, 90.0);
        let mean = directions.len() as f64 / 41_252.961_249;
        let poles = zone(&directions, 0.0, 15.0);
        assert!(
            poles > times * mean && around < 0.8 * mean,
            "{text}: {poles} {around} {mean}"
        );
        // Density falls from pole to belt except at the edge of the fan at 15 deg.
        let zones: Vec<f64> = [15.0, 30.0, 45.0, 60.0, 75.0]
            .map(|a| zone(&directions, a, a + 15.0))
            .to_vec();
        assert!(
            poles > zones[0] && zones.windows(2).all(|w| w[0] > w[1]),
            "{text}: {poles} {zones:?}"
        );
        // The densest bins are at the poles.
        let icosahedron = Icosahedron::new(4).unwrap();
        let counts = BinCounts::new(&Locator::new(&icosahedron), &directions).unwrap();
        let densest = icosahedron
            .bins()
            .iter()
            .zip(counts.by_bin())
            .max_by_key(|(_, count)| **count);
        let (bin, _) = densest.unwrap();
        assert!(
            bin.centre.dot(AXIS).abs() > 20.0_f64.to_radians().cos(),
            "{text}"
        );
    }
}

#[test]
fn blind_rows_remain_at_any_speed() {
    // A point's angle from the tilt axis does not depend on the tilt: gaps of a level scan remain.
    let least = 0.1_f64.to_radians();
    let level = bands(&pattern("vlp16").directions(), AXIS, least).unwrap();
    assert!(level.len() > 20, "{}", level.len());
    for text in [
        "rmbl:120",
        "rmbl:50",
        "rmbl:500",
        "rmbl:120,tilt=stepped",
        "velomotion16:13",
    ] {
        let turned = bands(&pattern(text).directions(), AXIS, least).unwrap();
        assert_eq!(turned.len(), level.len(), "{text}");
        for (a, b) in turned.iter().zip(&level) {
            assert!((a.from_deg - b.from_deg).abs() < 1e-6 && (a.to_deg - b.to_deg).abs() < 1e-6);
        }
    }
    // Narrower steps of azimuth narrow them.
    let fine = bands(&pattern("rmbl:120,step=0.1").directions(), AXIS, least).unwrap();
    assert!(fine.len() < level.len() / 2, "{}", fine.len());
}

#[test]
fn the_poles_are_holes_at_any_speed() {
    // No laser is level: the nearest are 1 deg off, and so are all points that they see from the
    // axis.
    for text in ["rmbl:300", "rmbl:120", "rmbl:50"] {
        let pattern = pattern(text);
        let directions = pattern.directions();
        let near_poles =
            |direction: DVec3| 5_f64.to_radians() - direction.dot(AXIS).abs().min(1.0).acos();
        let found = holes(&directions, 0.9_f64.to_radians(), 10_000, &near_poles).unwrap();
        let rows = rows(&found, AXIS, 0.2_f64.to_radians());
        for row in [&rows[0], &rows[rows.len() - 1]] {
            let from_pole = row.from_axis_deg.min(180.0 - row.from_axis_deg);
            assert_eq!(row.holes, 1, "{text}: {row:?}");
            assert!(
                from_pole < 0.02 && (row.radius_deg - 1.0).abs() < 0.02,
                "{text}: {row:?}"
            );
        }
    }
}

#[test]
fn the_largest_holes_are_outside_the_laser_fan() {
    // Level, the fan of 15 deg leaves caps of 75 deg. Swept to one side, 53 deg remain below the
    // limits of the sweep.
    for (text, radius_deg, at_least) in [
        ("vlp16", 75.0, 0.0),
        ("velomotion16:50", 53.13, 0.0),
        ("rmbl:120", 1.016, 1.0),
    ] {
        let pattern = pattern(text);
        let directions = pattern.directions();
        let hole = largest_hole(&directions, TOLERANCE_RAD)
            .unwrap()
            .unwrap()
            .hole;
        let found = hole.radius_rad.to_degrees();
        assert!((found - radius_deg).abs() < 0.006, "{text}: {found}");
        assert!(found >= at_least);
        // The cap holds no point.
        let most = directions
            .iter()
            .map(|d| d.dot(hole.centre))
            .fold(-1.0, f64::max);
        assert!((most - hole.radius_rad.cos()).abs() < 1e-9, "{text}");
    }
}

/// The bin whose triangle holds a direction, found from the face of the icosahedron down.
fn containing(icosahedron: &Icosahedron, direction: DVec3) -> usize {
    let depth = |corners: [DVec3; 3]| {
        let [a, b, c] = corners;
        [a.cross(b), b.cross(c), c.cross(a)]
            .map(|side| side.dot(direction))
            .into_iter()
            .fold(f64::MAX, f64::min)
    };
    let mut among = 0..20;
    for faces in icosahedron.levels() {
        let best =
            among.max_by(|&a, &b| depth(faces[a].corners).total_cmp(&depth(faces[b].corners)));
        let best = best.unwrap();
        among = 4 * best..4 * best + 4;
    }
    among.start / 4
}

/// Settings that the paper does not give, and their figures.
#[test]
fn other_settings_deviate_more_from_the_paper() {
    let icosahedron = Icosahedron::new(4).unwrap();
    let mut counts = vec![0_u64; 5_120];
    for direction in pattern("rmbl:120").directions() {
        counts[containing(&icosahedron, direction)] += 1;
    }
    let mean = 432_480.0 / 5_120.0;
    let sd = (counts
        .iter()
        .map(|&c| (c as f64 - mean).powi(2))
        .sum::<f64>()
        / 5_120.0)
        .sqrt();
    assert!((sd - 56.36).abs() < 0.011, "{sd}");
    let ends = (*counts.iter().min().unwrap(), *counts.iter().max().unwrap());
    assert!(
        ends.0.abs_diff(22) <= 1 && ends.1.abs_diff(363) <= 3,
        "{ends:?}"
    );
    for (text, sd) in [
        ("rmbl:120,start=0", 56.73),
        ("rmbl:50,start=0", 134.98),
        ("rmbl:120,tilt=stepped", 56.22),
        ("rmbl:50,tilt=stepped", 133.97),
    ] {
        let ours = statistics(&pattern(text).directions());
        assert!((ours.sd - sd).abs() < 0.011, "{text}: {}", ours.sd);
    }
}
