//! Directions in which gaps are examined.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::noise::SeededNoise;

/// Tries to find a wider gap nearby before the search is finer.
const SIDES: u32 = 6;
/// Smallest step of a climb, radians: 0.03 deg.
const LEAST_STEP_RAD: f64 = 5e-4;
/// Random directions to draw from at most, of which those in view are used.
const MOST_DRAWN: usize = 1_000_000;

/// `count` directions on a spiral about the tilt axis, by the golden ratio: all have equal areas,
/// the poles as well.
pub(super) fn evenly_spread(count: u32) -> impl Iterator<Item = DVec3> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    (0..count).map(move |number| {
        let along = 1.0 - (2.0 * f64::from(number) + 1.0) / f64::from(count);
        about_axis(along, (f64::from(number) * GOLDEN).fract())
    })
}

/// Random directions, always the same.
pub(super) fn random() -> impl Iterator<Item = DVec3> {
    let mut noise = SeededNoise(16);
    std::iter::repeat_with(move || about_axis(2.0 * noise.uniform() - 1.0, noise.uniform()))
        .take(MOST_DRAWN)
}

/// A random direction in each cell of a grid of so many cells along the tilt axis and about it, all
/// of equal areas.
pub(super) fn one_per_cell(cells: u32, seed: u64) -> impl Iterator<Item = DVec3> {
    let mut noise = SeededNoise(seed);
    let mut inside = move |cell: u32| (f64::from(cell) + noise.uniform()) / f64::from(cells);
    let grid = (0..cells).flat_map(move |along| (0..cells).map(move |turned| (along, turned)));
    grid.map(move |(along, turned)| about_axis(2.0 * inside(along) - 1.0, inside(turned)))
}

/// The direction at a distance along the tilt axis and an angle about it, in revolutions.
fn about_axis(along: f64, turned: f64) -> DVec3 {
    let across = (1.0 - along * along).max(0.0).sqrt();
    let (sin, cos) = (TAU * turned).sin_cos();
    DVec3::new(across * cos, along, across * sin)
}

/// The gap at a peak that is uphill from a direction, in view.
pub(super) fn climb(
    from: DVec3,
    step_rad: f64,
    in_view: impl Fn(&DVec3) -> bool,
    gap: impl Fn(DVec3) -> f64,
) -> f64 {
    let (mut place, mut widest, mut step) = (from, gap(from), step_rad);
    while step > LEAST_STEP_RAD {
        let (right, up) = place.any_orthonormal_pair();
        let sides = (0..SIDES).map(|side| {
            let (sin, cos) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
            (place + step * (cos * right + sin * up)).normalize()
        });
        let sides = sides.filter(&in_view).map(|side| (gap(side), side));
        match sides.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((wider, side)) if wider > widest => (place, widest) = (side, wider),
            _ => step *= 0.5,
        }
    }
    widest
}
