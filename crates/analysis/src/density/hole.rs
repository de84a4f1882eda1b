//! The largest hole: the biggest circle on the sphere with no point in it.
//!
//! How far the nearest point is changes by no more than one moves, so in a cell it is at most what it is in the middle and the cell's radius more. Cells
//! are cut, the most promising first, until none promises more than what was found and the tolerance. Where only a few points can matter to a
//! cell, it is done with exactly: a hole that cannot grow touches three points, or two or one where it is more than a hemisphere, and each of those choices is tried.
//! What comes out is a hole for sure, and its radius is within the tolerance of the largest. Left out: smaller holes ([`super::holes`]).

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::cells::{CubeCell, MOST_CUTS};
use super::nearby::{Nearby, SAME};
use super::{DensityError, check};

/// A circle with no point in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Its middle, length 1.
    pub centre: DVec3,
    /// Its radius, radians: so far is the nearest point.
    pub radius_rad: f64,
}

/// The largest hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestHole {
    /// A hole.
    pub hole: Hole,
    /// No hole is larger, radians.
    pub bound_rad: f64,
}

/// The tolerance that is always met, radians: a five-thousandth of what the finest encoder step tells apart.
pub const TOLERANCE_RAD: f64 = 1e-6;

/// The largest hole that some directions leave, to within `tolerance_rad` ([`TOLERANCE_RAD`] and up; less is taken for that). `None` without a direction: then
/// there is nothing but hole.
///
/// # Errors
/// [`DensityError::Direction`] for what is none.
pub fn largest_hole(
    directions: &[DVec3],
    tolerance_rad: f64,
) -> Result<Option<LargestHole>, DensityError> {
    largest_hole_within(directions, tolerance_rad, &EVERYWHERE)
}

/// The largest hole with its middle in a region, or within a quarter of the tolerance of it. `depth_rad` tells how deep in the region a direction is, radians,
/// negative outside; from one direction to another it changes by no more than the angle between them. `None` where there is no direction, or no region.
///
/// # Errors
/// [`DensityError::Direction`] for what is none.
pub fn largest_hole_within(
    directions: &[DVec3],
    tolerance_rad: f64,
    depth_rad: RegionDepth<'_>,
) -> Result<Option<LargestHole>, DensityError> {
    check(directions)?;
    let nearby = Nearby::new(directions);
    Ok(HoleSearch::new(&nearby, tolerance_rad.max(TOLERANCE_RAD), depth_rad).largest())
}

/// How deep in a region a direction is, radians.
pub type RegionDepth<'a> = &'a dyn Fn(DVec3) -> f64;

/// The whole sphere.
pub(super) const EVERYWHERE: fn(DVec3) -> f64 = |_| f64::INFINITY;

/// More points than this that can matter to a cell, and the cell is cut.
const FEW: usize = 10;
/// More than this, and they are not looked at one by one.
const MANY: usize = 1_000;

/// A search for holes.
pub(super) struct HoleSearch<'a> {
    nearby: &'a Nearby,
    /// Cells of a quarter of it are small enough.
    pub tolerance_rad: f64,
    depth_rad: RegionDepth<'a>,
    open: BinaryHeap<OpenCell>,
    pub best: Option<Hole>,
}

/// A cell that is to be looked into.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenCell {
    /// No hole about any of its points is larger, radians.
    pub bound_rad: f64,
    cell: CubeCell,
    pub middle: DVec3,
    /// Its ball, through the sphere.
    ball: f64,
    /// How far the nearest point is from the middle, radians.
    pub free_rad: f64,
    /// Whether it is in the region, and a little more.
    inside: bool,
}

impl OpenCell {
    /// How far its points are from its middle at most, radians.
    pub fn reach_rad(&self) -> f64 {
        angle(self.ball)
    }
}

/// What became of a cell.
pub(super) enum CellOutcome {
    /// It was cut.
    Cut,
    /// All holes that cannot grow about its points; some of others, too ([`HoleSearch::at`] tells how large they are).
    Holes(Vec<DVec3>),
    /// Too small to be cut: the hole about its middle stands for all about its points.
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

    /// The cell that promises most.
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

    /// The hole about a direction; `None` without points.
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

    /// The hole about a direction, remembered if it is the largest so far.
    pub fn at(&mut self, centre: DVec3) -> Option<Hole> {
        let hole = self.about(centre)?;
        self.keep(hole);
        Some(hole)
    }

    /// Does with a cell what is to be done: of its holes, those of at least `least_rad`.
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

    /// [`grow`] where there are too many points to look at: away from the nearest. So it is about a pole of a circle full of points, where cells would have
    /// to be cut very fine before few of its points matter.
    fn all_grow(&self, within: &OpenCell, distance: f64) -> bool {
        let nearest = self.nearby.nearest_point(within.middle);
        let way = nearest.map(|p| -p.reject_from_normalized(within.middle));
        way.and_then(DVec3::try_normalize).is_some_and(|way| {
            let behind = -within.ball - 1e-12;
            self.nearby.all_behind(within.middle, distance, way, behind)
        })
    }

    /// The same where holes at the edge of the region count as they are, though they could grow out of it.
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

/// Whether all holes about points of a cell grow if they are moved one way, and so none of them is as large as it can be: all points that matter lie behind
/// the plane across that way, by more than the cell's ball. Moved along u from x in the cell, the distance to p grows where u p < (u x)(x p); u is
/// at right angles to the middle, so that the right side is no more than the ball's radius.
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

/// The points without those that are as good as equal to another; `None` where more than a few are left.
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

/// Whether a hole of some points touches them all around, and so cannot grow.
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
    // The far side of one point has nowhere to grow to, either.
    widest <= PI + 1e-6 || nearest > 2.0 - 1e-9
}

/// The middles of holes about points of a cell that touch three of these points; where they may be larger than a hemisphere, two or one.
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
    // No hole is larger than to the nearest of these points: sorted out cheaply before the search asks all.
    centres.retain(|centre| {
        let nearest = points.iter().map(|p| p.distance_squared(*centre));
        angle(nearest.fold(4.0, f64::min).sqrt()) > least_rad - 1e-7 && is_held(*centre, points)
    });
    centres
}

/// The angle between two directions so far apart, radians: to the last digits near 0, to 3e-8 near a half turn.
pub(super) fn angle(chord: f64) -> f64 {
    2.0 * (0.5 * chord).min(1.0).asin()
}

/// How far apart two directions at an angle are.
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
