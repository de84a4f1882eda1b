//! Counts and curves of scan patterns known from other programs.

use std::f64::consts::PI;

use glam::DVec3;

use super::hard_cases::{ONE, counted};
use super::patterns::{rmbl, vlp16};
use crate::k::plain::plain;
use crate::k::{Edges, FrameRotation, KCurve, PairCounts, turned};

fn by_rotation(frames: u32) -> PairCounts {
    let rotation = FrameRotation {
        axis: DVec3::Y,
        step_rad: PI / f64::from(frames),
        frames: frames as usize,
    };
    let edges = Edges::equal(151).unwrap();
    turned(&rmbl(frames), &rotation, &edges, ONE).unwrap()
}

fn first_two_and_last(counts: &PairCounts) -> [u64; 3] {
    assert_eq!(counts.counts.iter().sum::<u64>(), counts.pairs());
    assert_eq!(counts.on_edges, 0);
    [counts.counts[0], counts.counts[1], counts.counts[150]]
}

#[test]
fn a_vlp16_frame_matches_the_known_counts() {
    let edges = Edges::equal(151).unwrap();
    let truth = [37_900, 138_021, 45_100];
    assert_eq!(first_two_and_last(&counted(&vlp16(901), 151)), truth);
    assert_eq!(
        first_two_and_last(&plain(&vlp16(901), &edges).unwrap()),
        truth
    );
    let truth = [37_800, 137_700, 45_000];
    assert_eq!(first_two_and_last(&counted(&vlp16(900), 151)), truth);
}

#[test]
fn pairs_of_900_azimuths_are_symmetric_about_90_degrees_but_for_antipodes() {
    let counts = counted(&vlp16(900), 151);
    let within = counts.cumulative();
    for bins in 1..=75 {
        // Bins from the far end hold as many pairs as from the near end, and 14,400 / 2 antipodes.
        let far = counts.pairs() - within[150 - bins];
        assert_eq!(far, within[bins - 1] + 7200, "{bins} bins");
    }
}

#[test]
fn rmbls_match_the_known_counts_and_curves() {
    let truths = [
        (30, [14_413_980, 44_099_850, 14_628_780], Some(0.024_38)),
        (72, [82_933_920, 250_263_432, 83_444_544], None),
    ];
    for (frames, truth, d_max) in truths {
        let counts = by_rotation(frames);
        assert_eq!(first_two_and_last(&counts), truth, "{frames} frames");
        let curve = KCurve::new(&counts.clone().into(), 10.0);
        if let Some(d_max) = d_max {
            assert!((curve.d_max - d_max).abs() < 1e-5, "{}", curve.d_max);
        }
        // An RMBL is antipodally symmetric but for its doubled azimuth: D(t) = -D(pi - t).
        for (near, far) in curve.d.iter().zip(curve.d.iter().rev().skip(1)) {
            assert!((near + far).abs() < 1e-4, "{near} {far}");
        }
    }
}

#[test]
fn vlp16_clustering_and_dispersion_match_known_values() {
    let curve = KCurve::new(&counted(&vlp16(901), 151).into(), 10.0);
    assert!((curve.d_max - 0.094_86).abs() < 5e-6, "{}", curve.d_max);
    assert!((curve.d_min + 0.094_93).abs() < 5e-6, "{}", curve.d_min);
    // K of the whole sphere is its area, whatever the points.
    assert!((curve.k_m2[150] - 400.0 * PI).abs() < 1e-9);
    assert!(curve.d[150].abs() < 1e-15);
    // The sum of the derivative over the bins is the end of the curve.
    let sum: f64 = curve.derivative_m2_rad.iter().sum::<f64>() * PI / 151.0;
    assert!(sum.abs() < 1e-9);
    assert_eq!(curve.d_error_bound, 0.0);
}
