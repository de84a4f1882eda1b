//! The bounds of faster methods hold against counting every pair.

use std::f64::consts::PI;

use glam::DVec3;

use super::hard_cases::{ONE, counted};
use super::patterns::{rmbl, scattered, vlp16};
use crate::k::{
    Edges, Estimate, FrameRotation, KCurve, KError, KMethod, Sampling, choose, drawn, estimate,
    exact, sampled,
};

/// The number of shares whose error exceeds the bound, and the largest error.
fn compared_with(of: &Estimate, exact: &Estimate) -> (usize, f64) {
    assert_eq!(of.shares.len(), exact.shares.len());
    let off = of
        .shares
        .iter()
        .zip(&exact.shares)
        .map(|(a, b)| (a - b).abs());
    let outside = off
        .clone()
        .enumerate()
        .filter(|(bin, off)| *off > of.bounds[*bin]);
    (outside.count(), off.fold(0.0, f64::max))
}

fn sampling(tolerance: f64, risk: f64) -> Sampling {
    Sampling {
        tolerance,
        risk,
        seed: 7,
    }
}

fn patterns() -> [Vec<DVec3>; 4] {
    let mut clustered = vec![DVec3::Z; 700];
    clustered.extend(
        scattered(300, 8)
            .iter()
            .map(|p| (DVec3::Y * 30.0 + p).normalize()),
    );
    clustered.extend(vec![DVec3::NEG_Z; 500]);
    [
        vlp16(300),
        rmbl(4).into_iter().step_by(11).collect(),
        scattered(3000, 4),
        clustered,
    ]
}

#[test]
fn sampled_estimates_are_within_their_confidence_intervals() {
    // 4 patterns, 2 kinds of bins, 12 seeds at a risk of 1 in 20: 4.8 of 96 intervals may fail.
    // Bernstein's bound is conservative: none does.
    for points in patterns() {
        for bins in [12, 151] {
            let truth: Estimate = counted(&points, bins).into();
            let mut mean = vec![0.0; bins];
            let mut bound = 0.0_f64;
            for seed in 0..12 {
                let sampling = Sampling {
                    tolerance: 0.01,
                    risk: 0.05,
                    seed,
                };
                let of = sampled(&points, &truth.edges, &sampling).unwrap();
                assert!(of.largest_bound() <= 0.01, "{}", of.largest_bound());
                let (outside, off) = compared_with(&of, &truth);
                assert_eq!(outside, 0, "seed {seed}, {bins} bins: {off}");
                for (mean, share) in mean.iter_mut().zip(&of.shares) {
                    *mean += share / 12.0;
                }
                bound = bound.max(of.largest_bound());
            }
            // Unbiased: the mean of twelve draws is closer than the bound of one.
            for (mean, share) in mean.iter().zip(&truth.shares) {
                assert!((mean - share).abs() < bound / 2.0, "{mean} {share} {bound}");
            }
        }
    }
}

/// The bound of drawn pairs holds for all bins at once but for a risk of 1 in 20.
#[test]
fn drawn_pairs_are_within_their_bound() {
    for points in patterns() {
        let truth: Estimate = counted(&points, 151).into();
        let direction = |index: u64| points.get(index as usize).copied();
        let (n, setting) = (points.len() as u64, sampling(3e-3, 0.05));
        let of = drawn(n, &direction, &truth.edges, &setting).unwrap();
        assert_eq!((of.method, of.points), ("drawn", points.len()));
        assert!(of.largest_bound() <= 3e-3);
        let (outside, off) = compared_with(&of, &truth);
        assert!(outside == 0 && off > 1e-5, "{off}");
        // Threads do not change the draws.
        assert_eq!(drawn(n, &direction, &truth.edges, &setting).unwrap(), of);
        let missing = drawn(n + 50_000, &direction, &truth.edges, &setting);
        assert!(
            matches!(missing, Err(KError::NotUnit { .. })),
            "{missing:?}"
        );
    }
}

/// Eight frames of an RMBL, bin edges, and the exact estimate.
fn counted_rmbl() -> (Vec<DVec3>, Edges, Estimate) {
    let points = rmbl(8);
    let rotation = FrameRotation {
        axis: DVec3::Y,
        step_rad: PI / 8.0,
        frames: 8,
    };
    let edges = Edges::equal(151).unwrap();
    let truth = estimate(&points, Some(&rotation), &edges, &sampling(0.0, 1e-3), ONE).unwrap();
    (points, edges, truth)
}

#[test]
fn a_sampled_rmbl_is_within_a_ten_thousandth() {
    let (points, edges, truth) = counted_rmbl();
    assert_eq!((truth.method, truth.largest_bound()), ("turned", 0.0));
    let of = sampled(&points, &edges, &Sampling::default()).unwrap();
    assert!(of.largest_bound() <= 1e-4);
    assert_eq!(compared_with(&of, &truth).0, 0);
    let (of, truth) = (KCurve::new(&of, 1.0), KCurve::new(&truth, 1.0));
    assert!((of.d_max - truth.d_max).abs() <= of.d_error_bound);
    assert!((of.d_min - truth.d_min).abs() <= of.d_error_bound);
}

/// A level VLP-16 of 0.4 degrees: pairs lie on the edges of 150 and of 180 bins, none on those of
/// 151.
#[test]
fn samples_detect_pairs_on_bin_edges() {
    let points = vlp16(901);
    for (bins, on_edges) in [(150, 63_175.0), (180, 216_600.0), (151, 0.0)] {
        let edges = Edges::equal(bins).unwrap();
        let of = sampled(&points, &edges, &sampling(1e-3, 1e-3)).unwrap();
        let found = of.on_edges as f64;
        assert!(
            (found - on_edges).abs() <= 0.1 * on_edges,
            "{bins} bins: {found}"
        );
        let counted = Estimate::from(counted(&points, bins));
        assert_eq!(counted.on_edges, on_edges as u64, "{bins} bins");
    }
}

#[test]
fn the_cheapest_sufficient_method_is_chosen() {
    let rotation = FrameRotation {
        axis: DVec3::Y,
        step_rad: PI / 72.0,
        frames: 72,
    };
    let of =
        |points, rotation, tolerance, risk| choose(points, rotation, &sampling(tolerance, risk));
    assert_eq!(of(14_416, None, 1e-2, 0.1), KMethod::Exact);
    assert_eq!(of(1_037_952, None, 0.0, 0.1), KMethod::Exact);
    assert_eq!(of(1_037_952, Some(&rotation), 0.0, 0.1), KMethod::Turned);
    assert_eq!(of(1_037_952, None, 1e-4, 1e-3), KMethod::Sampled);
    assert_eq!(of(1_037_952, Some(&rotation), 1e-4, 1e-3), KMethod::Sampled);
    // Coarse bounds of many points need few pairs of them.
    assert_eq!(of(20_000_000, None, 1e-2, 1e-3), KMethod::Drawn);
    // With a risk of zero every pair is counted.
    assert_eq!(of(1_037_952, None, 0.1, 0.0), KMethod::Exact);
    assert_eq!(of(1_037_952, None, 1e-4, 0.0), KMethod::Exact);
    assert_eq!(of(1_037_952, None, f64::NAN, 0.1), KMethod::Exact);
    let points = scattered(70_000, 6);
    let edges = Edges::equal(151).unwrap();
    let truth: Estimate = exact(&points, &edges, ONE).unwrap().into();
    for (tolerance, risk, method) in [(0.1, 0.0, "exact"), (1e-3, 1e-3, "sampled")] {
        let of = estimate(&points, None, &edges, &sampling(tolerance, risk), ONE).unwrap();
        assert!(of.largest_bound() <= tolerance, "{}", of.largest_bound());
        assert_eq!(of.method, method);
        assert_eq!(compared_with(&of, &truth).0, 0);
    }
}

/// The draws of a row have more bits than a crowded cell has points: else their unevenness exceeds
/// the tolerance, and every pair is counted for minutes.
#[test]
#[ignore = "needs 2 GB of memory"]
fn twenty_million_points_are_sampled() {
    let mut points = scattered(20_000_000, 9);
    // Most of them around a pole.
    for point in points.iter_mut().step_by(2) {
        *point = (0.3 * *point + DVec3::Y).normalize();
    }
    let edges = Edges::equal(151).unwrap();
    let found = estimate(&points, None, &edges, &Sampling::default(), ONE).unwrap();
    assert_eq!(found.method, "sampled");
    assert!(found.largest_bound() <= 1e-4, "{}", found.largest_bound());
}

#[test]
fn estimates_of_zero_one_and_two_points() {
    let edges = Edges::equal(151).unwrap();
    for points in [&[][..], &[DVec3::X], &[DVec3::X, DVec3::Y]] {
        let of = sampled(points, &edges, &Sampling::default()).unwrap();
        assert_eq!(of.shares.len(), 151);
    }
    let of = sampled(&[DVec3::X, DVec3::Y], &edges, &Sampling::default()).unwrap();
    assert_eq!((of.shares[74], of.shares[75]), (0.0, 1.0));
    let sampling = Sampling {
        risk: 0.0,
        ..Sampling::default()
    };
    let refused = sampled(&[DVec3::X, DVec3::Y], &edges, &sampling);
    assert_eq!(
        refused,
        Err(KError::Setting {
            name: "risk",
            got: 0.0
        })
    );
}
