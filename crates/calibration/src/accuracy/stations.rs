//! Distances between corners that two scans see: derived points, without targets.
//!
//! Corners are where three large surfaces meet. Two upright scanners differ by a turn about the
//! vertical and a shift, found from pairs of corners that are equally far apart in both scans.

use crate::flatness::{WallElement, surfaces};
use crate::linear::{Vec3, add, axes, cross, dot};
use crate::patches::Patches;

/// Two scans with common corners.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StationPair {
    /// Numbers of the scans, from 0.
    pub logs: [usize; 2],
    /// Common corners.
    pub corners: usize,
    /// Distances between them.
    pub distances: usize,
    /// Shortest and longest, metres.
    pub lengths_m: [f64; 2],
    /// Mean difference, the second scan less the first, metres.
    pub mean_m: f64,
    /// Root mean square.
    pub rms_m: f64,
    /// Largest.
    pub worst_m: f64,
}

/// Fewest elements of a surface.
const MIN_ELEMENTS: usize = 20;
/// Most surfaces of a scan.
const MAX_SURFACES: usize = 12;
/// Volume of three normals from which on surfaces meet in a point.
const MIN_VOLUME: f64 = 0.5;
/// A corner lies so near to elements of its surfaces, metres.
const NEAR_M: f64 = 1.5;
/// Corners nearer than this to another are one, metres.
const APART_M: f64 = 0.5;
/// Distances of pairs that may be the same agree so well, metres.
const SAME_M: f64 = 0.1;
/// Common corners agree so well after turn and shift: scanners stand upright to 2 deg, metres.
const COMMON_M: f64 = 0.4;
/// Fewest common corners.
const MIN_CORNERS: usize = 4;

struct FlatSurface {
    centre: Vec3,
    normal: Vec3,
    elements: Vec<Vec3>,
}

pub(super) fn pairs(patches: &Patches, logs: usize) -> Vec<StationPair> {
    if logs < 2 {
        return Vec::new();
    }
    let corners: Vec<Vec<Vec3>> = (0..logs).map(|log| corners(patches, log)).collect();
    let mut pairs = Vec::new();
    for first in 0..logs {
        for second in first + 1..logs {
            pairs.extend(compare([first, second], &corners[first], &corners[second]));
        }
    }
    pairs
}

fn corners(patches: &Patches, log: usize) -> Vec<Vec3> {
    let elements = patches.list.iter().filter(|patch| patch.log == log);
    let elements: Vec<WallElement> = elements
        .map(|patch| WallElement {
            log,
            centre: patch.frame.centre,
            slope: [0.0; 3],
            normal: patch.frame.normal,
            shots: patch.shots.len(),
            number: 0,
        })
        .collect();
    let mut planes: Vec<FlatSurface> = surfaces(&elements, MIN_ELEMENTS)
        .into_iter()
        .map(|surface| plane(&surface))
        .collect();
    planes.sort_by_key(|plane| std::cmp::Reverse(plane.elements.len()));
    planes.truncate(MAX_SURFACES);
    let mut found: Vec<Vec3> = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in &planes[j + 1..] {
                let corner = meeting(a, b, c);
                let corner =
                    corner.filter(|corner| [a, b, c].iter().all(|plane| plane.is_near(*corner)));
                let is_new = |corner: &Vec3| {
                    found
                        .iter()
                        .all(|other| distance(*corner, *other) > APART_M)
                };
                found.extend(corner.filter(is_new));
            }
        }
    }
    found
}

/// The plane through the elements' centres.
fn plane(surface: &[&WallElement]) -> FlatSurface {
    let elements: Vec<Vec3> = surface.iter().map(|element| element.centre).collect();
    let sum = elements.iter().fold([0.0; 3], |sum, at| add(sum, 1.0, *at));
    let centre = sum.map(|sum| sum / elements.len() as f64);
    let mut moments = [[0.0; 3]; 3];
    for at in &elements {
        let d = add(*at, -1.0, centre);
        for (row, di) in moments.iter_mut().zip(d) {
            *row = add(*row, di, d);
        }
    }
    let (_, [normal, ..]) = axes(moments);
    FlatSurface {
        centre,
        normal,
        elements,
    }
}

impl FlatSurface {
    fn is_near(&self, at: Vec3) -> bool {
        self.elements
            .iter()
            .any(|element| distance(*element, at) < NEAR_M)
    }
}

/// Intersection of three planes.
fn meeting(a: &FlatSurface, b: &FlatSurface, c: &FlatSurface) -> Option<Vec3> {
    let [bc, ca, ab] = [(b, c), (c, a), (a, b)].map(|(u, v)| cross(u.normal, v.normal));
    let volume = dot(a.normal, bc);
    let along = |plane: &FlatSurface| dot(plane.normal, plane.centre) / volume;
    let meeting = [(a, bc), (b, ca), (c, ab)]
        .into_iter()
        .fold([0.0; 3], |sum, (plane, way)| add(sum, along(plane), way));
    (volume.abs() > MIN_VOLUME).then_some(meeting)
}

fn distance(a: Vec3, b: Vec3) -> f64 {
    let d = add(a, -1.0, b);
    dot(d, d).sqrt()
}

/// The corners of two scans that are the same, most of them or, of equally many, those that agree
/// best.
fn compare(logs: [usize; 2], a: &[Vec3], b: &[Vec3]) -> Option<StationPair> {
    let mut best: Option<(usize, f64, StationPair)> = None;
    let ways = |points: &[Vec3]| -> Vec<(usize, usize)> {
        let count = points.len();
        (0..count)
            .flat_map(|i| (0..count).map(move |j| (i, j)))
            .filter(|(i, j)| i != j)
            .collect()
    };
    let (of_a, of_b) = (ways(a), ways(b));
    for &(i, j) in of_a.iter().filter(|(i, j)| i < j) {
        let from = add(a[j], -1.0, a[i]);
        for &(k, l) in &of_b {
            let to = add(b[l], -1.0, b[k]);
            let level = |v: Vec3| v[0].hypot(v[1]);
            let agrees =
                (level(from) - level(to)).abs() < SAME_M && (from[2] - to[2]).abs() < COMMON_M;
            if !agrees || level(from) < APART_M {
                continue;
            }
            let turn = to[1].atan2(to[0]) - from[1].atan2(from[0]);
            let (sin, cos) = turn.sin_cos();
            let moved = |p: Vec3| {
                let d = add(p, -1.0, a[i]);
                add(
                    b[k],
                    1.0,
                    [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos, d[2]],
                )
            };
            let nearest = |from: Vec3, to: &mut dyn Iterator<Item = Vec3>| {
                let off = to.enumerate().map(|(index, q)| (index, distance(from, q)));
                let nearest = off.min_by(|a, b| a.1.total_cmp(&b.1));
                nearest
                    .filter(|(_, off_m)| *off_m < COMMON_M)
                    .map(|(index, _)| index)
            };
            // Each is the nearest of the other, so that no corner is taken twice.
            let common: Vec<(Vec3, Vec3)> = (a.iter().enumerate())
                .filter_map(|(index, &p)| {
                    let of_b = nearest(moved(p), &mut b.iter().copied())?;
                    let q = *b.get(of_b)?;
                    let back = nearest(q, &mut a.iter().map(|p| moved(*p)));
                    (back == Some(index)).then_some((p, q))
                })
                .collect();
            if let Some(pair) = differences(logs, &common) {
                let rank = (pair.corners, -pair.rms_m);
                if best
                    .as_ref()
                    .is_none_or(|(corners, less, _)| rank > (*corners, *less))
                {
                    best = Some((rank.0, rank.1, pair));
                }
            }
        }
    }
    best.map(|(_, _, pair)| pair)
}

fn differences(logs: [usize; 2], common: &[(Vec3, Vec3)]) -> Option<StationPair> {
    let (mut count, mut sum, mut squares, mut worst) = (0, 0.0, 0.0, 0.0_f64);
    let mut lengths_m = [f64::INFINITY, 0.0];
    for (index, (p, q)) in common.iter().enumerate() {
        for (other_p, other_q) in &common[index + 1..] {
            let length = distance(*p, *other_p);
            let difference = distance(*q, *other_q) - length;
            count += 1;
            sum += difference;
            squares += difference * difference;
            worst = worst.max(difference.abs());
            lengths_m = [lengths_m[0].min(length), lengths_m[1].max(length)];
        }
    }
    (common.len() >= MIN_CORNERS).then(|| StationPair {
        logs,
        corners: common.len(),
        distances: count,
        lengths_m,
        mean_m: sum / f64::from(count as u32),
        rms_m: (squares / f64::from(count as u32)).sqrt(),
        worst_m: worst,
    })
}
