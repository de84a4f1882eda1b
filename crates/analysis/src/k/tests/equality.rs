//! Equal counts for every SIMD level and number of threads, for whole scans and for rotated frames.

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use glam::{DQuat, DVec3};
use proptest::prelude::*;

use super::hard_cases::ONE;
use super::patterns::{rmbl, scattered, vlp16};
use crate::k::plain::plain;
use crate::k::{
    Edges, FrameRotation, KError, MOST_FRAMES, Registers, exact, exact_by, turned, turned_by,
};

/// The SIMD levels of this processor.
pub(super) const REGISTERS: [Registers; 4] = [
    Registers::Best,
    Registers::Avx2,
    Registers::Sse4,
    Registers::Least,
];

fn rotation(frames: usize, step_rad: f64) -> FrameRotation {
    FrameRotation {
        axis: DVec3::Y,
        step_rad,
        frames,
    }
}

#[test]
fn counts_do_not_depend_on_simd_level_or_threads() {
    let frame = vlp16(901);
    let few = scattered(1001, 5);
    for points in [&frame[..2003], &few] {
        for bins in [2, 151, 180, 1000] {
            let edges = Edges::equal(bins).unwrap();
            let one_by_one = plain(points, &edges).unwrap();
            for registers in REGISTERS {
                let counts = exact_by(registers, points, &edges, ONE);
                assert_eq!(counts.unwrap(), one_by_one, "{registers:?}, {bins} bins");
            }
            for threads in [2, 5] {
                let threads = NonZeroUsize::new(threads).unwrap();
                let counts = exact(points, &edges, threads).unwrap();
                assert_eq!(counts, one_by_one, "{threads} threads");
            }
        }
    }
}

#[test]
fn counting_by_rotated_frames_agrees_with_counting_points() {
    let points: Vec<DVec3> = rmbl(9)
        .chunks(14_416)
        .flat_map(|frame| frame[..203].to_vec())
        .collect();
    let rotation = rotation(9, PI / 9.0);
    // 180 and 36 bins have edges at the rotation of every frame: rounding decides the side of pairs
    // on them.
    for bins in [1, 36, 151, 180] {
        let edges = Edges::equal(bins).unwrap();
        let one_by_one = plain(&points, &edges).unwrap();
        assert_eq!(
            exact(&points, &edges, ONE).unwrap(),
            one_by_one,
            "{bins} bins"
        );
        for registers in REGISTERS {
            let counts = turned_by(registers, &points, &rotation, &edges, ONE);
            assert_eq!(counts.unwrap(), one_by_one, "{registers:?}, {bins} bins");
        }
        let three = NonZeroUsize::new(3).unwrap();
        assert_eq!(
            turned(&points, &rotation, &edges, three).unwrap(),
            one_by_one
        );
    }
}

#[test]
fn frames_that_do_not_match_the_rotation_are_refused() {
    let edges = Edges::equal(151).unwrap();
    let mut points: Vec<DVec3> = rmbl(3);
    let count = |points: &[DVec3], of: FrameRotation| turned(points, &of, &edges, ONE);
    let wrong = count(&points, rotation(3, 1.0));
    assert!(
        matches!(wrong, Err(KError::NotTurned { frame: 1, .. })),
        "{wrong:?}"
    );
    let wrong = count(&points, rotation(5, PI / 3.0));
    assert!(
        matches!(wrong, Err(KError::Frames { frames: 5, .. })),
        "{wrong:?}"
    );
    assert!(count(&points, rotation(0, PI / 3.0)).is_err());
    assert!(count(&points, rotation(MOST_FRAMES + 1, PI / 3.0)).is_err());
    points[30_000] = (points[30_000] + DVec3::X * 1e-8).normalize();
    let wrong = count(&points, rotation(3, PI / 3.0));
    assert!(
        matches!(
            wrong,
            Err(KError::NotTurned {
                frame: 2,
                index: 1168,
                ..
            })
        ),
        "{wrong:?}"
    );
    assert_eq!(count(&[], rotation(1, 0.0)).unwrap().pairs(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Clusters of any size, also at antipodes and with coincident points, in any number of bins.
    #[test]
    fn clusters_agree_with_pair_by_pair_counting(
        sizes in prop::collection::vec((1..60_usize, 1e-9..2.0_f64, 0..1000_u64), 1..6),
        bins in 1..400_usize,
    ) {
        let mut points = Vec::new();
        for (size, width, seed) in sizes {
            let middle = scattered(1, seed)[0];
            let turn = DQuat::from_rotation_arc(DVec3::Z, middle);
            for p in scattered(size, seed + 1) {
                points.push((turn * (DVec3::Z + p * width)).normalize());
            }
            points.push(middle);
            points.push(-middle);
        }
        let edges = Edges::equal(bins).unwrap();
        let one_by_one = plain(&points, &edges).unwrap();
        prop_assert_eq!(&exact(&points, &edges, ONE).unwrap(), &one_by_one);
        let still = rotation(1, 0.0);
        prop_assert_eq!(&turned(&points, &still, &edges, ONE).unwrap(), &one_by_one);
    }
}
