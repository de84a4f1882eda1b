//! The 2018 paper's statements on the evenness of patterns as numbers, with the simulator's
//! patterns; `docs/src/paper.md` compares them with the paper's text.

use std::sync::LazyLock;

use super::hard_cases::ONE;
use crate::k::{Edges, KCurve, Sampling, estimate};

/// Tolerance of a `D` of many points; below 65,000 points every pair is counted.
const TOLERANCE: f64 = 2e-5;

fn curve(name: &str, tolerance: f64) -> KCurve {
    let pattern = sim::patterns::PatternRequest::parse(name)
        .unwrap()
        .build()
        .unwrap();
    let edges = Edges::equal(151).unwrap();
    let sampling = Sampling {
        tolerance,
        ..Sampling::default()
    };
    // Without their rotation, so that samples are taken.
    let of = estimate(&pattern.directions(), None, &edges, &sampling, ONE).unwrap();
    let curve = KCurve::new(&of, 1.0);
    assert!(curve.d_error_bound <= tolerance, "{name}");
    curve
}

static VLP16: LazyLock<KCurve> = LazyLock::new(|| curve("vlp16", TOLERANCE));
static HDL32: LazyLock<KCurve> = LazyLock::new(|| curve("hdl32e", TOLERANCE));
static VELOMOTION16: LazyLock<KCurve> = LazyLock::new(|| curve("velomotion16:50", TOLERANCE));
static RMBL_120: LazyLock<KCurve> = LazyLock::new(|| curve("rmbl:120", 0.5 * TOLERANCE));
static RMBL_50: LazyLock<KCurve> = LazyLock::new(|| curve("rmbl:50", 0.5 * TOLERANCE));
/// Frames begin and end at the azimuth of the tilt axis, with a stepped tilt, as for the paper's
/// figures: every frame fires twice at the pole.
static RSBL_50: LazyLock<KCurve> =
    LazyLock::new(|| curve("rsbl:50,start=0,tilt=stepped", TOLERANCE));

fn most(curve: &KCurve) -> f64 {
    curve.d_max.max(-curve.d_min)
}

#[test]
fn extremes_match_the_recorded_values() {
    // The last digit may be truncated instead of rounded.
    for (name, largest, smallest, digit) in [
        ("vlp16", 0.094_86, -0.094_93, 1e-5),
        ("hdl32e", 0.0906, -0.0536, 1e-4),
        (
            "velomotion16:50,start=0,tilt=stepped",
            0.083_03,
            -0.083_03,
            1e-5,
        ),
        ("velomotion16:50", 0.082_94, -0.082_92, 1e-5),
        ("rmbl:120", 0.024_06, -0.024_05, 1e-5),
        ("rmbl:120,start=0,tilt=stepped", 0.024_38, -0.024_38, 1e-5),
        ("rsbl:50,start=0,tilt=stepped", 0.027_62, -0.027_64, 1e-5),
        ("rsbl:50", 0.027_29, -0.027_31, 1e-5),
    ] {
        let found = curve(name, TOLERANCE);
        let within = digit + found.d_error_bound;
        for (found, expected) in [(found.d_max, largest), (found.d_min, smallest)] {
            assert!((found - expected).abs() < within, "{name}: {found}");
        }
    }
}

#[test]
fn an_rmbl_of_120_and_one_of_50_coincide() {
    let (a, b) = (&*RMBL_120, &*RMBL_50);
    let bounds = a.d_error_bound + b.d_error_bound;
    assert!(
        (a.d_max - b.d_max).abs() < 2e-5 + bounds,
        "{} {}",
        a.d_max,
        b.d_max
    );
    assert!(
        (a.d_min - b.d_min).abs() < 2e-5 + bounds,
        "{} {}",
        a.d_min,
        b.d_min
    );
    // Everywhere within a hundredth of the largest value.
    for ((theta, a), b) in a.theta_rad.iter().zip(&a.d).zip(&b.d) {
        assert!((a - b).abs() < 2.5e-4, "{theta}: {a} {b}");
    }
}

#[test]
fn an_rmbl_is_slightly_better_than_an_rsbl() {
    let nearer = RMBL_50.d.iter().zip(&RSBL_50.d);
    let nearer = nearer
        .filter(|(rmbl, rsbl)| rmbl.abs() < rsbl.abs())
        .count();
    // All bins but the last, where both are 0.
    assert_eq!(nearer, 150);
    let better = most(&RSBL_50) / most(&RMBL_50);
    assert!((better - 1.149).abs() < 0.003, "{better}");
}

#[test]
fn a_vlp16_and_an_hdl32_cluster_alike_and_the_vlp16_disperses_more() {
    let (vlp, hdl) = (&*VLP16, &*HDL32);
    let alike = hdl.d_max / vlp.d_max;
    assert!((0.95..1.0).contains(&alike), "{alike}");
    let more = vlp.d_min / hdl.d_min;
    assert!((more - 1.77).abs() < 0.01, "{more}");
    // The HDL-32 looks 10.67 deg up and 30.67 deg down: clustering and dispersion are not
    // symmetric.
    let asymmetry = -hdl.d_max / hdl.d_min;
    assert!((asymmetry - 1.69).abs() < 0.01, "{asymmetry}");
}

#[test]
fn velomotion_is_between_a_vlp16_and_an_rmbl() {
    let [vlp, ours, rmbl] = [&*VLP16, &*VELOMOTION16, &*RMBL_120].map(most);
    assert!(vlp > 1.1 * ours && ours > 3.0 * rmbl, "{vlp} {ours} {rmbl}");
}

/// In antipodally symmetric patterns equally many pairs are farther apart than 180 deg minus an
/// angle as are within that angle: maximum and minimum differ only in sign.
#[test]
fn d_is_symmetric_unless_the_reference_is_half_a_bin_off() {
    for (name, curve, off_by_half) in [("rmbl", &*RMBL_120, 1.38), ("rsbl", &*RSBL_50, 1.32)] {
        let ratio = -curve.d_max / curve.d_min;
        assert!((ratio - 1.0).abs() < 2e-3, "{name}: {ratio}");
        let last = curve.d.len() - 1;
        for (bin, d) in curve.d.iter().enumerate().take(last) {
            let mirrored = curve.d[last - 1 - bin];
            assert!((d + mirrored).abs() < 3e-4, "{name}: {bin} {d} {mirrored}");
        }
        // Shares up to the upper edges of bins, and a reference at their middles.
        let half_rad = 0.5 * curve.theta_rad[0];
        let shifted = curve.d.iter().zip(&curve.theta_rad).map(|(d, theta)| {
            let csr = |theta: f64| (theta / 2.0).sin().powi(2);
            d + csr(*theta) - csr(theta - half_rad)
        });
        let (most, least) = shifted.fold((0.0_f64, 0.0_f64), |(most, least), d| {
            (most.max(d), least.min(d))
        });
        let ratio = -most / least;
        assert!((ratio - off_by_half).abs() < 0.015, "{name}: {ratio}");
    }
}
