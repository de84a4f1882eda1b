//! Hard cases, one test each.

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use glam::DVec3;
use num_rational::BigRational;

use super::cosines::cosine;
use super::patterns::{rmbl, scattered, tilted, vlp16};
use crate::k::plain::plain;
use crate::k::{Edges, KCurve, KError, PairCounts, exact};

pub(super) const ONE: NonZeroUsize = NonZeroUsize::MIN;

pub(super) fn counted(points: &[DVec3], bins: usize) -> PairCounts {
    exact(points, &Edges::equal(bins).unwrap(), ONE).unwrap()
}

/// The definition in fractions: the first bin whose upper edge's cosine does not exceed the dot
/// product, else the last bin.
fn bin_by_fractions(a: DVec3, b: DVec3, edges: &[BigRational]) -> usize {
    let exact = |x: f64| BigRational::from_float(x).unwrap();
    let dot = exact(a.x) * exact(b.x) + exact(a.y) * exact(b.y) + exact(a.z) * exact(b.z);
    let bin = edges.iter().position(|edge| dot >= *edge);
    bin.unwrap_or(edges.len())
}

/// Cosines to 10^-100; rational ones are exact.
fn edges_in_fractions(bins: u32) -> Vec<BigRational> {
    let of = |j: u32| match (2 * j == bins, 3 * j == bins, 3 * j == 2 * bins) {
        (true, _, _) => BigRational::from_float(0.0).unwrap(),
        (_, true, _) => BigRational::from_float(0.5).unwrap(),
        (_, _, true) => BigRational::from_float(-0.5).unwrap(),
        _ => cosine(j, bins),
    };
    (1..bins).map(of).collect()
}

#[test]
fn no_point_and_one_point_have_no_pairs() {
    for points in [vec![], vec![DVec3::X]] {
        let counts = counted(&points, 151);
        assert_eq!(counts.counts, vec![0; 151]);
        let curve = KCurve::new(&counts.clone().into(), 10.0);
        assert!(!curve.has_pairs() && curve.d.is_empty() && curve.k_m2.is_empty());
        assert_eq!(curve.theta_rad.len(), 151);
    }
}

#[test]
fn two_points_make_one_pair() {
    for degrees in [0.0_f64, 1e-7, 1.0, 89.9, 90.1, 179.0, 180.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let counts = counted(&[DVec3::X, DVec3::new(cos, sin, 0.0)], 151);
        let mut expected = vec![0; 151];
        expected[((degrees / 180.0 * 151.0) as usize).min(150)] = 1;
        assert_eq!(counts.counts, expected, "{degrees} degrees");
    }
}

#[test]
fn coincident_pairs_are_in_the_first_bin_and_antipodal_ones_in_the_last() {
    let some = scattered(40, 3);
    let mut points = some.clone();
    points.extend(&some);
    points.extend(some.iter().map(|p| -p));
    let counts = counted(&points, 151);
    assert_eq!(counts, plain(&points, &counts.edges).unwrap());
    let same = counted(&vec![some[0]; 100], 151);
    assert_eq!((same.counts[0], same.pairs()), (4950, 4950));
    let both: Vec<DVec3> = [some[0], -some[0]].repeat(50);
    let both = counted(&both, 151);
    assert_eq!((both.counts[0], both.counts[150]), (2 * 1225, 2500));
}

#[test]
fn points_on_one_circle_are_counted_exactly() {
    // 755 points on the equator: steps of 0.2 bins. Five steps are one edge, where the last bit
    // decides the side of a pair.
    let on = |i: u32| {
        let (sin, cos) = (f64::from(i) * PI / 377.5).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    let circle: Vec<DVec3> = (0..755).map(on).collect();
    let counts = counted(&circle, 151);
    assert_eq!(counts, plain(&circle, &counts.edges).unwrap());
    // Of 377 steps every fifth is an inner edge: 75 of them, the last of which is step 375.
    assert_eq!(counts.on_edges, 75 * 755);
    let counts = counted(&circle, 7);
    assert_eq!(counts, plain(&circle, &counts.edges).unwrap());
    assert_eq!(counts.counts.iter().sum::<u64>(), 755 * 754 / 2);
}

#[test]
fn points_at_the_poles_are_counted_exactly() {
    let mut points = vec![DVec3::Z; 70];
    points.extend(vec![DVec3::NEG_Z; 30]);
    points.extend([DVec3::X, DVec3::NEG_Y]);
    for i in 0..200 {
        let (sin, cos) = (f64::from(i) * 1e-9).sin_cos();
        points.push(DVec3::new(sin, 0.0, cos));
    }
    let counts = counted(&points, 151);
    assert_eq!(counts, plain(&points, &counts.edges).unwrap());
    assert_eq!(counts.counts[0], (270 * 269 + 30 * 29) / 2);
}

#[test]
fn pairs_on_an_edge_belong_to_the_bin_of_smaller_angles() {
    // Dot products 0, 1/2, -1/2 and -1 without rounding or scaling: 60, 90, 120 and 180 degrees.
    let half = 0.5;
    let points = [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::new(half, half, std::f64::consts::FRAC_1_SQRT_2),
    ];
    for bins in [2, 3, 6, 12, 150, 180] {
        let counts = counted(&points, bins);
        let mut expected = vec![0; bins];
        let mut expect = |degrees: usize| expected[(degrees * bins).div_ceil(180) - 1] += 1;
        for degrees in [180, 90, 90, 60, 60, 120] {
            expect(degrees);
        }
        assert_eq!(counts.counts, expected, "{bins} bins");
    }
    // One bit of the dot product to either side, far below the last bit of a rounded sum.
    let edges = Edges::equal(2).unwrap();
    for (z, bin) in [(1e-100, 0), (0.0, 0), (-1e-100, 1)] {
        let a = DVec3::new(1.0, 0.0, 1e-5);
        assert_eq!(edges.bin(a, DVec3::new(0.0, 1.0, z)), Ok(bin), "{z}");
    }
}

#[test]
fn pairs_on_edges_are_counted_separately() {
    let frame = vlp16(900);
    let frame = &frame[..];
    for (bins, on_edges) in [(150, 63_175), (180, 216_600), (151, 0)] {
        let counts = counted(&vlp16(901), bins);
        assert_eq!(counts.on_edges, on_edges, "{bins} bins");
    }
    assert_eq!(counted(frame, 151).on_edges, 0);
}

#[test]
fn f32_f64_and_exact_fractions_agree_on_a_grid() {
    // A VLP-16 with 24 degrees per step and a second, tilted one: many pairs on edges of 180 and
    // 150 bins, and of 15 and 30 bins.
    let frame = vlp16(901);
    let mut grid: Vec<DVec3> = frame.chunks(16).step_by(60).flatten().copied().collect();
    let second: Vec<DVec3> = tilted(&grid, 30.0).collect();
    grid.extend(second);
    for bins in [1, 3, 15, 30, 150, 151, 180] {
        let edges = edges_in_fractions(bins);
        let mut expected = vec![0; bins as usize];
        for (i, a) in grid.iter().enumerate().step_by(5) {
            for b in grid.iter().take(i).step_by(5) {
                expected[bin_by_fractions(*a, *b, &edges)] += 1;
            }
        }
        let some: Vec<DVec3> = grid.iter().copied().step_by(5).collect();
        assert_eq!(
            counted(&some, bins as usize).counts,
            expected,
            "{bins} bins"
        );
        let counts = counted(&grid, bins as usize);
        assert_eq!(counts, plain(&grid, &counts.edges).unwrap(), "{bins} bins");
    }
}

#[test]
fn angles_near_zero_and_pi_keep_their_precision() {
    // Bins of 5.5e-3 degrees: the first edge's cosine is 4.6e-9 below 1, less than the resolution
    // of f32.
    let edges = Edges::equal(32_768).unwrap();
    let fraction_of_bin = |share: f64| {
        let (sin, cos) = (share * PI / 32_768.0).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    for (share, bin) in [
        (0.0, 0),
        (0.999_999, 0),
        (1.000_001, 1),
        (1.999_999, 1),
        (2.000_001, 2),
    ] {
        let p = fraction_of_bin(share);
        assert_eq!(edges.bin(DVec3::X, p), Ok(bin), "{share}");
        assert_eq!(edges.bin(DVec3::NEG_X, p), Ok(32_767 - bin), "pi - {share}");
        for (from, bin) in [(DVec3::X, bin), (DVec3::NEG_X, 32_767 - bin)] {
            let counts = exact(&[from, p], &edges, ONE).unwrap();
            assert_eq!(counts.counts[bin], 1, "{share} from {from}");
        }
    }
}

#[test]
fn invalid_directions_are_refused() {
    let edges = Edges::equal(151).unwrap();
    for wrong in [DVec3::ZERO, DVec3::NAN, DVec3::X * 1.01, DVec3::INFINITY] {
        let refused = exact(&[DVec3::X, wrong], &edges, ONE);
        assert!(
            matches!(refused, Err(KError::NotUnit { index: 1, .. })),
            "{refused:?}"
        );
    }
    assert_eq!(Edges::equal(0), Err(KError::Bins { got: 0 }));
    assert!(Edges::equal(32_769).is_err());
    assert_eq!(Edges::equal(1).unwrap().bins(), 1);
}

#[test]
fn a_subset_of_an_rmbl_agrees_with_pair_by_pair_counting() {
    let points: Vec<DVec3> = rmbl(5).into_iter().step_by(29).collect();
    for bins in [1, 2, 7, 151, 2000] {
        let counts = counted(&points, bins);
        assert_eq!(
            counts,
            plain(&points, &counts.edges).unwrap(),
            "{bins} bins"
        );
    }
}

#[test]
fn counters_exceed_32_bits() {
    // 92,682 points have 4,294,930,221 pairs and 92,683 have 4,295,022,903: 2^32 is between them.
    // All points in one place, and in two places 90 degrees apart.
    for (points, pairs) in [(92_682, 4_294_930_221), (92_683, 4_295_022_903)] {
        let same = counted(&vec![DVec3::Y; points], 151);
        assert_eq!((same.counts[0], same.pairs()), (pairs, pairs));
        let mut two = vec![DVec3::Y; points / 2];
        two.resize(points, DVec3::Z);
        let between = (points / 2 * points.div_ceil(2)) as u64;
        let two = counted(&two, 151);
        assert_eq!((two.counts[0], two.counts[75]), (pairs - between, between));
    }
    // The largest number of points: the number of pairs fits.
    let most = crate::k::counts::pairs(u32::MAX as usize);
    assert_eq!(most, (u32::MAX as u64 - 1) / 2 * u32::MAX as u64);
}
