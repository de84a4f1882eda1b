//! The 2018 paper's analysis of scan patterns, made again: patterns of `sim`, measured by `analysis`.

use analysis::density::{
    Counts, Icosahedron, Locator, Statistics, TOLERANCE_RAD, bands, holes, largest_hole, rows,
};
use glam::DVec3;
use sim::patterns::{AXIS, Pattern, Wish};

fn pattern(text: &str) -> Pattern {
    Wish::parse(text).unwrap().build().unwrap()
}

fn statistics(directions: &[DVec3]) -> Statistics {
    let locator = Locator::new(&Icosahedron::new(4).unwrap());
    Counts::new(&locator, directions).unwrap().statistics()
}

/// The table of densities: name, mean, sd, fewest, most, mean and sd a square degree, as printed.
type Row = (&'static str, f64, f64, Option<(u64, u64)>, f64, f64);

const PRINTED: [Row; 3] = [
    ("rmbl:120", 84.47, 56.24, Some((25, 365)), 10.48, 6.98),
    ("rmbl:50", 202.73, 133.92, Some((95, 881)), 25.16, 16.62),
    ("velomotion16:50", 50.68, 63.22, None, 6.29, 7.85),
];

#[test]
fn densities_are_the_papers() {
    for (text, mean, sd, ends, mean_per_deg2, sd_per_deg2) in PRINTED {
        let ours = statistics(&pattern(text).directions());
        assert_eq!(ours.bins, 5_120);
        let printed = |ours: f64| (ours * 100.0).round() / 100.0;
        assert_eq!(printed(ours.mean), mean, "{text}");
        assert!((ours.sd - sd).abs() < 0.1, "{text}: {}", ours.sd);
        assert!(
            (ours.mean_per_deg2 - mean_per_deg2).abs() < 0.01,
            "{text}: {}",
            ours.mean_per_deg2
        );
        assert!(
            (ours.sd_per_deg2 - sd_per_deg2).abs() < 0.02,
            "{text}: {}",
            ours.sd_per_deg2
        );
        if let Some((least, most)) = ends {
            assert_eq!(ours.min, least, "{text}");
            let off = ours.max as f64 / most as f64 - 1.0;
            assert!(off.abs() < 0.015, "{text}: {}", ours.max);
        }
    }
}

/// The figures that were found to come closest, which differ from the printed ones in the last place.
#[test]
fn densities_are_what_they_were_found_to_be() {
    for (text, sd, least, most) in [
        ("rmbl:120", 56.23, 25, 366),
        ("rmbl:50", 133.96, 95, 878),
        ("velomotion16:50", 63.23, 0, 235),
    ] {
        let ours = statistics(&pattern(text).directions());
        assert!((ours.sd - sd).abs() < 0.011, "{text}: {}", ours.sd);
        assert_eq!(ours.min, least, "{text}");
        assert!(ours.max.abs_diff(most) <= 3, "{text}: {}", ours.max);
    }
}

/// Points a square degree in the zone between two angles from the tilt axis, both of its ends.
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
    for (text, times) in [("rmbl:120", 4.0), ("rmbl:50", 4.0)] {
        let directions = pattern(text).directions();
        let around = zone(&directions, 60.0, 90.0);
        let mean = directions.len() as f64 / 41_252.961_249;
        let poles = zone(&directions, 0.0, 15.0);
        assert!(
            poles > times * mean && around < 0.8 * mean,
            "{text}: {poles} {around} {mean}"
        );
        // From the pole to the belt it only falls, but for the edge of the head's own fan at 15 deg.
        let zones: Vec<f64> = [15.0, 30.0, 45.0, 60.0, 75.0]
            .map(|a| zone(&directions, a, a + 15.0))
            .to_vec();
        assert!(
            poles > zones[0] && zones.windows(2).all(|w| w[0] > w[1]),
            "{text}: {poles} {zones:?}"
        );
        // The densest bins of all are at the poles.
        let icosahedron = Icosahedron::new(4).unwrap();
        let counts = Counts::new(&Locator::new(&icosahedron), &directions).unwrap();
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
fn blind_rows_stay_at_any_speed() {
    // How far a point is from the tilt axis does not depend on the tilt: the bands that a level scan leaves out stay.
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
    // Narrower steps of azimuth are what narrows them.
    let fine = bands(&pattern("rmbl:120,step=0.1").directions(), AXIS, least).unwrap();
    assert!(fine.len() < level.len() / 2, "{}", fine.len());
}

#[test]
fn the_poles_themselves_are_holes_at_any_speed() {
    // No laser is level: the nearest are 1 deg off, and so is all they can see from the axis.
    for text in ["rmbl:120", "rmbl:50", "rmbl:20"] {
        let pattern = pattern(text);
        let directions = pattern.directions();
        let hole = largest_hole(&directions, TOLERANCE_RAD).unwrap().unwrap();
        let everywhere = |direction: DVec3| pattern.depth_rad(direction);
        let found = holes(&directions, 0.9 * hole.hole.radius_rad, 10_000, &everywhere).unwrap();
        let rows = rows(&found, AXIS, 0.2_f64.to_radians());
        assert!(!rows.is_empty());
        let at_poles = found
            .iter()
            .filter(|hole| hole.centre.dot(AXIS).abs() > 0.999_99);
        let radii: Vec<f64> = at_poles.map(|hole| hole.radius_rad.to_degrees()).collect();
        assert_eq!(radii.len(), 2, "{text}: {rows:?}");
        assert!(
            radii.iter().all(|radius| (radius - 1.0).abs() < 1e-3),
            "{text}: {radii:?}"
        );
    }
}
