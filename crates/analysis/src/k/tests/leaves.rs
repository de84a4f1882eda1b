//! The fast paths of leaves (outlines, loops by number of edges, sign masks) against
//! counting every pair.

use std::f64::consts::PI;

use fearless_simd::{Level, dispatch};
use glam::{DQuat, DVec3};

use super::equality::REGISTERS;
use super::hard_cases::ONE;
use super::patterns::{rmbl, scattered};
use crate::k::outline::{self, Outline, Outlines};
use crate::k::plain::plain;
use crate::k::{Edges, FrameRotation, exact_by, turned_by};

/// This many points of a width about a centre; with a width of 4 or more, over the whole sphere.
fn cluster(count: usize, width: f64, seed: u64) -> Vec<DVec3> {
    let turn = DQuat::from_rotation_arc(DVec3::Z, scattered(1, seed)[0]);
    let about = |p: DVec3| (turn * (DVec3::Z + p * width)).normalize();
    scattered(count, seed + 1).into_iter().map(about).collect()
}

#[test]
fn outlines_contain_every_pair() {
    let mut leaves: Vec<Vec<DVec3>> = Vec::new();
    for (seed, width) in [0.0, 1e-7, 1e-3, 0.01, 0.02, 0.1, 0.5, 1.0, 2.0, 9.0]
        .into_iter()
        .enumerate()
    {
        leaves.push(cluster(16, width, seed as u64));
        leaves.push(leaves[0].iter().map(|p| -p).collect());
        // On a circle, at a pole, and a single point.
        let on_circle = |i: u32| {
            DVec3::new(
                (f64::from(i) * width).cos(),
                (f64::from(i) * width).sin(),
                0.0,
            )
        };
        leaves.push((0..16).map(on_circle).collect());
        leaves.push(vec![DVec3::Z; 16]);
        leaves.push(cluster(1, width, seed as u64));
    }
    let outlines: Vec<Outline> = leaves.iter().map(|leaf| outline::around(leaf)).collect();
    let columns = Outlines::new(&outlines);
    for bins in [1, 2, 151, 3000] {
        let edges = Edges::equal(bins).unwrap();
        for (from, leaf) in leaves.iter().enumerate() {
            for start in (0..leaves.len()).step_by(16) {
                let one = columns.one(from).unwrap();
                let span =
                    dispatch!(Level::new(), simd => columns.span(simd, &one, start, bins)).unwrap();
                let others = leaves.iter().skip(start).zip(&span.first).zip(&span.last);
                for ((other, first), last) in others {
                    for a in leaf {
                        for b in other {
                            let bin = edges.bin(*a, *b).unwrap() as i32;
                            assert!(
                                (*first..=*last).contains(&bin),
                                "{a} {b}: {bin}, {first} to {last}"
                            );
                        }
                    }
                }
                let point = leaf[0].as_vec3().to_array();
                let span = dispatch!(Level::new(), simd => columns.span_of_point(simd, point, start, bins));
                let span = span.unwrap();
                for ((other, first), last) in
                    leaves.iter().skip(start).zip(&span.first).zip(&span.last)
                {
                    for b in other {
                        let bin = edges.bin(leaf[0], *b).unwrap() as i32;
                        assert!((*first..=*last).contains(&bin), "{} {b}: {bin}", leaf[0]);
                    }
                }
            }
        }
    }
}

#[test]
fn outlines_are_tight() {
    // Sixteen points of width 0.02 rad, 1 rad apart: at most 0.04 between them, and one bin more
    // for rounding and the diagonal of a square.
    let square = |middle: DVec3| -> Vec<DVec3> {
        let (e, f) = middle.any_orthonormal_pair();
        let at = |i: usize, j: usize| {
            middle + (e * (i as f64 - 1.5) + f * (j as f64 - 1.5)) * (0.02 / 3.0)
        };
        (0..16).map(|i| at(i % 4, i / 4).normalize()).collect()
    };
    let middle = DVec3::new(1.0_f64.cos(), 1.0_f64.sin(), 0.0);
    let both = [DVec3::X, middle].map(|middle| outline::around(&square(middle)));
    let columns = Outlines::new(&both);
    let span = dispatch!(Level::new(), simd => columns.span(simd, &both[0], 1, 3000)).unwrap();
    let width = f64::from(span.last[0] - span.first[0] + 1) * PI / 3000.0;
    assert!(width < 0.04 * 2.0_f64.sqrt() + 0.002, "{width}");
}

#[test]
fn leaves_of_any_size_agree_with_pair_by_pair_counting() {
    let mut points = Vec::new();
    for (seed, width) in [0.0, 1e-9, 1e-5, 3e-3, 0.02, 0.1, 0.4, 9.0]
        .into_iter()
        .enumerate()
    {
        let of = cluster(16 * 20 + seed, width, 7 * seed as u64);
        points.extend(of.iter().step_by(3).map(|p| -p));
        points.extend(of);
    }
    for bins in [3, 151, 1000] {
        let edges = Edges::equal(bins).unwrap();
        let one_by_one = plain(&points, &edges).unwrap();
        let still = FrameRotation {
            axis: DVec3::Y,
            step_rad: 0.0,
            frames: 1,
        };
        for registers in REGISTERS {
            let counts = exact_by(registers, &points, &edges, ONE).unwrap();
            assert_eq!(counts, one_by_one, "{registers:?}, {bins} bins");
            let counts = turned_by(registers, &points, &still, &edges, ONE).unwrap();
            assert_eq!(counts, one_by_one, "{registers:?}, {bins} bins, turned");
        }
    }
}

#[test]
fn pairs_near_edges_are_counted_on_the_right_side() {
    // Leaves of sixteen points within 1e-8, others at an edge from there and up to 1e-6 nearer or
    // farther: f32 cannot decide most pairs but can decide some. Leaves have enough edges between
    // them to use every loop.
    for (bins, edge) in [
        (151, 1),
        (151, 75),
        (151, 76),
        (2, 1),
        (6, 2),
        (7, 6),
        (40_000 / 2, 10_000),
    ] {
        let edges = Edges::equal(bins).unwrap();
        let angle = f64::from(edge) * PI / bins as f64;
        let at = |angle: f64, aside: f64| {
            let (sin, cos) = angle.sin_cos();
            DVec3::new(cos, sin, aside).normalize()
        };
        let mut points = Vec::new();
        for i in 0..64_i32 {
            points.push(at(
                1e-8 * f64::from(i * 7 % 16 - 8),
                1e-4 * f64::from(i % 5),
            ));
            points.push(at(
                angle + 3e-8 * f64::from(i - 32),
                1e-4 * f64::from(i % 3),
            ));
        }
        // On the edge within the resolution of f64, and a few of its last bits off.
        for i in 0..32_i32 {
            points.push(at(angle + 1e-16 * f64::from(i - 16), 0.0));
        }
        let one_by_one = plain(&points, &edges).unwrap();
        for registers in REGISTERS {
            let counts = exact_by(registers, &points, &edges, ONE).unwrap();
            assert_eq!(counts, one_by_one, "{registers:?}, edge {edge} of {bins}");
        }
    }
}

#[test]
fn every_simd_level_counts_a_subset_of_an_rmbl_alike() {
    let points: Vec<DVec3> = rmbl(7).into_iter().step_by(13).collect();
    for bins in [40, 151, 600] {
        let edges = Edges::equal(bins).unwrap();
        let one_by_one = plain(&points, &edges).unwrap();
        for registers in REGISTERS {
            let counts = exact_by(registers, &points, &edges, ONE).unwrap();
            assert_eq!(counts, one_by_one, "{registers:?}, {bins} bins");
        }
    }
}
