//! The largest hole: the largest circle on the sphere without points.
//!
//! The distance to the nearest point changes by at most the distance moved. So in a cell it is at
//! most its value at the centre plus the radius of the cell. Cells are cut, the most promising
//! first, until none promises more than the best hole and the tolerance. If only a few points
//! matter to a cell, it is solved exactly: a locally largest hole touches three points (two or one
//! if it exceeds a hemisphere), and all such choices are tried. The result is a hole, and its
//! radius is within the tolerance of the largest. [`super::holes`] finds smaller ones.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::cells::{CubeCell, MOST_CUTS};
use super::nearby::{Nearby, SAME};
use super::{DensityError, check};

/// A circle without points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Unit vector to the centre.
    pub centre: DVec3,
    /// Radius in radians: the angle to the nearest point.
    pub radius_rad: f64,
}

/// The largest hole.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LargestHole {
    /// The hole.
    pub hole: Hole,
    /// Upper bound of the radius of any hole, radians.
    pub bound_rad: f64,
}

/// The smallest tolerance, radians: a five-thousandth of the finest encoder step.
pub const TOLERANCE_RAD: f64 = 1e-6;

/// The largest hole between directions, to within `tolerance_rad` (at least [`TOLERANCE_RAD`]).
/// `None` without directions.
///
/// # Errors
/// [`DensityError::Direction`] for an invalid direction.
pub fn largest_hole(
    directions: &[DVec3],
    tolerance_rad: f64,
) -> Result<Option<LargestHole>, DensityError> {
    largest_hole_within(directions, tolerance_rad, &EVERYWHERE)
}

/// The largest hole with its centre in a region, or within a quarter of the tolerance of it.
/// `depth_rad` gives the depth of a direction inside the region in radians, negative outside.
/// Between two directions it changes by at most the angle between them. `None` without directions
/// or without a region.
///
/// # Errors
/// [`DensityError::Direction`] for an invalid direction.
pub fn largest_hole_within(
    directions: &[DVec3],
    tolerance_rad: f64,
    depth_rad: RegionDepth<'_>,
) -> Result<Option<LargestHole>, DensityError> {
    check(directions)?;
    let nearby = Nearby::new(directions);
    Ok(HoleSearch::new(&nearby, tolerance_rad.max(TOLERANCE_RAD), depth_rad).largest())
}

/// Depth of a direction inside a region, radians.
pub type RegionDepth<'a> = &'a dyn Fn(DVec3) -> f64;

/// The whole sphere.
pub(super) const EVERYWHERE: fn(DVec3) -> f64 = |_| f64::INFINITY;

/// A cell is cut if more points than this matter to it.
const FEW: usize = 10;
/// More points than this are not examined one by one.
const MANY: usize = 1_000;

/// A search for holes.
pub(super) struct HoleSearch<'a> {
    nearby: &'a Nearby,
    /// Cells smaller than a quarter of it are not cut.
    pub tolerance_rad: f64,
    depth_rad: RegionDepth<'a>,
    open: BinaryHeap<OpenCell>,
    pub best: Option<Hole>,
}

/// A cell to be searched.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenCell {
    /// Upper bound of the radius of holes centred in the cell, radians.
    pub bound_rad: f64,
    cell: CubeCell,
    pub middle: DVec3,
    /// Radius of its ball, measured as a chord.
    ball: f64,
    /// Angle from the centre to the nearest point, radians.
    pub free_rad: f64,
    /// Whether it lies inside the region with a margin.
    inside: bool,
}

impl OpenCell {
    /// Largest angle of its directions from its centre, radians.
    pub fn reach_rad(&self) -> f64 {
        angle(self.ball)
    }
}

/// Result of searching a cell.
pub(super) enum CellOutcome {
    /// The cell was cut.
    Cut,
    /// Centres of all locally largest holes in the cell, and of some others; [`HoleSearch::at`]
    /// gives their radius.
    Holes(Vec<DVec3>),
    /// Too small to be cut: the hole around its centre represents all others.
    Tiny,
}

impl<'a> HoleSearch<'a> {
    pub fn new(nearby: &'a Nearby, tolerance_rad: f64, depth_rad: RegionDepth<'a>) -> Self {
        let mut search = Self {
            nearby,
            tolerance_rad,
            depth_rad,
            open: BinaryHeap::new(),
            best: None,
        };
        for cell in CubeCell::faces() {
            search.open(cell);
        }
        search
    }

    fn largest(mut self) -> Option<LargestHole> {
        let mut bound_rad = 0.0;
        while let Some(next) = self.next() {
            let best_rad = self.best.map_or(0.0, |hole| hole.radius_rad);
            if next.bound_rad <= best_rad + self.tolerance_rad {
                bound_rad = next.bound_rad;
                break;
            }
            match self.look_to_the_edge(&next) {
                CellOutcome::Cut => {}
                CellOutcome::Holes(centres) => centres.into_iter().for_each(|c| {
                    self.at(c);
                }),
                CellOutcome::Tiny => {
                    bound_rad = next.bound_rad.max(bound_rad);
                    self.at(next.middle);
                }
            }
        }
        let hole = self.best?;
        Some(LargestHole {
            hole,
            bound_rad: bound_rad.max(hole.radius_rad),
        })
    }

    /// The cell with the largest bound.
    pub fn next(&mut self) -> Option<OpenCell> {
        self.open.pop()
    }

    fn open(&mut self, cell: CubeCell) {
        let (middle, ball) = cell.ball();
        let depth_rad = (self.depth_rad)(middle);
        if depth_rad < -angle(ball) {
            return;
        }
        if let Some(hole) = self.about(middle) {
            if depth_rad >= 0.0 {
                self.keep(hole);
            }
            self.open.push(OpenCell {
                bound_rad: hole.radius_rad + angle(ball),
                cell,
                middle,
                ball,
                free_rad: hole.radius_rad,
                inside: depth_rad > angle(ball) + 1e-6,
            });
        }
    }

    /// The hole around a direction; `None` without points.
    fn about(&self, centre: DVec3) -> Option<Hole> {
        let nearest = self.nearby.nearest(centre);
        nearest.is_finite().then(|| Hole {
            centre,
            radius_rad: angle(nearest),
        })
    }

    fn keep(&mut self, hole: Hole) {
        if self
            .best
            .is_none_or(|best| hole.radius_rad > best.radius_rad)
        {
            self.best = Some(hole);
        }
    }

    /// The hole around a direction; keeps it if it is the largest so far.
    pub fn at(&mut self, centre: DVec3) -> Option<Hole> {
        let hole = self.about(centre)?;
        self.keep(hole);
        Some(hole)
    }

    /// Searches a cell for holes of at least `least_rad`.
    pub fn look_into(&mut self, next: &OpenCell, least_rad: f64) -> CellOutcome {
        let reach = next.free_rad + 2.0 * angle(next.ball);
        let points = self.nearby.within(next.middle, chord(reach) + SAME, MANY);
        if let Some(points) = points {
            if let Some(few) = distinct(&points) {
                let large = next.bound_rad > FRAC_PI_2 - 1e-6;
                return CellOutcome::Holes(centres(&few, next, least_rad, large));
            }
            if grow(&points, next) {
                return CellOutcome::Holes(Vec::new());
            }
        } else if self.all_grow(next, chord(reach) + SAME) {
            return CellOutcome::Holes(Vec::new());
        }
        self.cut(next)
    }

    /// [`grow`] for more points than can be examined, in the direction away from the nearest. This
    /// occurs around the pole of a circle full of points, where cells would have to be cut very
    /// finely.
    fn all_grow(&self, within: &OpenCell, distance: f64) -> bool {
        let nearest = self.nearby.nearest_point(within.middle);
        let way = nearest.map(|p| -p.reject_from_normalized(within.middle));
        way.and_then(DVec3::try_normalize).is_some_and(|way| {
            let behind = -within.ball - 1e-12;
            self.nearby.all_behind(within.middle, distance, way, behind)
        })
    }

    /// The same, but holes at the edge of the region count although they could grow out of it.
    pub fn look_to_the_edge(&mut self, next: &OpenCell) -> CellOutcome {
        if next.inside {
            self.look_into(next, next.free_rad)
        } else {
            self.cut(next)
        }
    }

    fn cut(&mut self, next: &OpenCell) -> CellOutcome {
        if angle(next.ball) < 0.25 * self.tolerance_rad || next.cell.level >= MOST_CUTS {
            return CellOutcome::Tiny;
        }
        for cell in next.cell.cut() {
            self.open(cell);
        }
        CellOutcome::Cut
    }
}

/// Whether all holes centred in a cell grow if moved in one direction, so that none of them is
/// locally largest. This holds if all relevant points lie behind the plane across that direction by
/// more than the cell's ball. Moved along u from x in the cell, the distance to p grows where u p <
/// (u x)(x p). u is orthogonal to the centre, so the right side is at most the ball's radius.
fn grow(points: &[DVec3], within: &OpenCell) -> bool {
    let sum: DVec3 = points
        .iter()
        .map(|p| p.reject_from_normalized(within.middle))
        .sum();
    let Some(way) = (-sum).try_normalize() else {
        return false;
    };
    let nearest = points
        .iter()
        .map(|p| way.dot(*p))
        .fold(f64::NEG_INFINITY, f64::max);
    nearest < -within.ball - 1e-12
}

/// The points without near duplicates; `None` if more than a few remain.
fn distinct(points: &[DVec3]) -> Option<Vec<DVec3>> {
    let mut found: Vec<DVec3> = Vec::new();
    for point in points {
        let known = |other: &DVec3| other.distance_squared(*point) < SAME * SAME;
        if !found.iter().any(known) {
            found.push(*point);
            if found.len() > FEW {
                return None;
            }
        }
    }
    Some(found)
}

/// Whether the points that a hole touches surround it, so that it cannot grow.
fn is_held(centre: DVec3, points: &[DVec3]) -> bool {
    let off = || points.iter().map(|p| p.distance(centre));
    let nearest = off().fold(f64::INFINITY, f64::min);
    let right = centre.any_orthonormal_vector();
    let up = centre.cross(right);
    let touching = points
        .iter()
        .zip(off())
        .filter(|(_, off)| *off <= nearest + 1e-7);
    let mut ways: Vec<f64> = touching
        .map(|(p, _)| p.dot(up).atan2(p.dot(right)))
        .collect();
    ways.sort_unstable_by(f64::total_cmp);
    let (Some(first), Some(last)) = (ways.first(), ways.last()) else {
        return false;
    };
    let around = TAU - (last - first);
    let between = ways.iter().zip(ways.iter().skip(1)).map(|(a, b)| b - a);
    let widest = between.fold(around, f64::max);
    // The far side of a single point cannot grow either.
    widest <= PI + 1e-6 || nearest > 2.0 - 1e-9
}

/// Centres in a cell of holes that touch three of the points; or two or one, if the hole may exceed
/// a hemisphere.
fn centres(points: &[DVec3], within: &OpenCell, least_rad: f64, large: bool) -> Vec<DVec3> {
    let mut centres = Vec::new();
    let reach = (within.ball + 1e-6) * (within.ball + 1e-6);
    let mut add = |direction: DVec3| {
        if let Some(centre) = direction.try_normalize() {
            for centre in [centre, -centre] {
                if centre.distance_squared(within.middle) <= reach {
                    centres.push(centre);
                }
            }
        }
    };
    for (i, &a) in points.iter().enumerate() {
        if large {
            add(a);
            add(a.any_orthonormal_vector());
        }
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            if large {
                add(a + b);
            }
            for &c in points.iter().skip(j + 1) {
                add((b - a).cross(c - a));
            }
        }
    }
    // A cheap filter by these points alone, before the search among all.
    centres.retain(|centre| {
        let nearest = points.iter().map(|p| p.distance_squared(*centre));
        angle(nearest.fold(4.0, f64::min).sqrt()) > least_rad - 1e-7 && is_held(*centre, points)
    });
    centres
}

/// The angle of a chord in radians, accurate near 0, and to 3e-8 near pi.
pub(super) fn angle(chord: f64) -> f64 {
    2.0 * (0.5 * chord).min(1.0).asin()
}

/// The chord of an angle.
fn chord(angle_rad: f64) -> f64 {
    2.0 * (0.5 * angle_rad.min(std::f64::consts::PI)).sin()
}

impl Ord for OpenCell {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_bound = self.bound_rad.total_cmp(&other.bound_rad);
        by_bound.then_with(|| self.cell.cmp(&other.cell))
    }
}

impl PartialOrd for OpenCell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for OpenCell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for OpenCell {}

#[cfg(test)]
mod tests;
