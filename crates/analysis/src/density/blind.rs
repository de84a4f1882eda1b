//! Blind spots: locally largest holes down to a size, their rows around an axis, and bands without
//! points.
//!
//! The angle of a point from the tilt axis depends on the elevation of its laser and on its
//! azimuth, not on the tilt. If the rays of a sensor leave out a band of such angles, no tilt speed
//! fills it: blind spots form rows around the axis. [`bands`] finds the bands from the points
//! alone; [`holes`] and [`rows`] find the spots. [`super::hole`] has the search.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use serde::Serialize;
use utoipa::ToSchema;

use super::hole::{CellOutcome, Hole, HoleSearch, RegionDepth};
use super::nearby::Nearby;
use super::{DensityError, check};

/// Holes at one angle from an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct HoleRow {
    /// Mean angle of the holes from the axis, degrees.
    pub from_axis_deg: f64,
    /// Number of holes.
    pub holes: usize,
    /// Radius of the largest hole, degrees.
    pub radius_deg: f64,
}

/// A range of angles from an axis without points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EmptyBand {
    /// Start: the angle of the last point before, or 0; degrees.
    pub from_deg: f64,
    /// End: the angle of the next point, or 180.
    pub to_deg: f64,
}

impl EmptyBand {
    /// Width in degrees.
    #[must_use]
    pub fn width_deg(&self) -> f64 {
        self.to_deg - self.from_deg
    }
}

/// Relative accuracy of the radius of holes.
const EXACT: f64 = 0.01;
/// Distance outside its cell at which a hole may be found, radians, with room for rounding.
const BESIDE_RAD: f64 = 2e-6;

/// Holes of at least `least_rad`, the largest first, at most `most`. Each is locally as large as
/// possible, none has its centre in a larger listed one, and all are in the region of `depth_rad`
/// ([`super::largest_hole_within`]). Differences below one hundredth are ignored. The radius is
/// exact to rounding, or to one hundredth if more than ten points touch the hole.
///
/// # Errors
/// [`DensityError`] for an invalid direction or a least radius that is not above 0.
pub fn holes(
    directions: &[DVec3],
    least_rad: f64,
    most: usize,
    depth_rad: RegionDepth<'_>,
) -> Result<Vec<Hole>, DensityError> {
    check(directions)?;
    if !(least_rad > 0.0 && least_rad.is_finite()) {
        return Err(DensityError::Least { got: least_rad });
    }
    let nearby = Nearby::new(directions);
    let mut list = HoleList::new(least_rad, most);
    looked_for(&nearby, &mut list, depth_rad);
    Ok(list.listed)
}

/// Fills the list; returns the number of cells that were searched. Cells inside a listed hole are
/// skipped.
fn looked_for(nearby: &Nearby, list: &mut HoleList, depth_rad: RegionDepth<'_>) -> usize {
    let mut search = HoleSearch::new(nearby, EXACT * list.least_rad, depth_rad);
    let mut looked = 0;
    while let Some(next) = search.next() {
        // No later hole is larger than the bound.
        list.settle(next.bound_rad * (1.0 - EXACT));
        if next.bound_rad < list.least_rad || list.is_full() {
            break;
        }
        if list.covers(next.middle, next.reach_rad() + BESIDE_RAD) {
            continue;
        }
        looked += 1;
        search.tolerance_rad = EXACT * next.bound_rad;
        let keep = |hole: &Hole| depth_rad(hole.centre) >= 0.0;
        match search.look_into(&next, list.least_rad) {
            CellOutcome::Cut => {}
            CellOutcome::Holes(centres) => {
                let holes = centres.into_iter().filter_map(|c| search.at(c));
                holes.filter(keep).for_each(|hole| list.add(hole));
            }
            CellOutcome::Tiny => {
                let hole = Hole {
                    centre: next.middle,
                    radius_rad: next.free_rad,
                };
                Some(hole)
                    .filter(keep)
                    .into_iter()
                    .for_each(|hole| list.add(hole));
            }
        }
    }
    list.settle(0.0);
    looked
}

/// Holes whose centres lie in no larger one, the largest first.
struct HoleList {
    least_rad: f64,
    most: usize,
    listed: Vec<Hole>,
    /// Found holes that a larger one may still displace.
    waiting: BTreeMap<[i64; 4], Hole>,
    /// Listed holes by the cell of a lattice; each reaches at most into the neighbouring cells.
    lattice: HashMap<[i64; 3], Vec<Hole>>,
    /// The few holes that are much larger.
    wide: Vec<Hole>,
}

impl HoleList {
    fn new(least_rad: f64, most: usize) -> Self {
        Self {
            least_rad,
            most,
            listed: Vec::new(),
            waiting: BTreeMap::new(),
            lattice: HashMap::new(),
            wide: Vec::new(),
        }
    }

    fn is_full(&self) -> bool {
        self.listed.len() >= self.most
    }

    fn add(&mut self, hole: Hole) {
        if hole.radius_rad >= self.least_rad && !self.covers(hole.centre, 0.0) {
            self.waiting.insert(by_size(&hole), hole);
        }
    }

    /// Lists the waiting holes of at least this radius.
    fn settle(&mut self, radius_rad: f64) {
        while !self.is_full()
            && let Some(largest) = self.waiting.last_entry()
            && largest.get().radius_rad >= radius_rad
        {
            let hole = largest.remove();
            if self.covers(hole.centre, 0.0) {
                continue;
            }
            if hole.radius_rad > self.lattice_rad() {
                self.wide.push(hole);
            } else {
                let cell = self.lattice.entry(self.cell(hole.centre));
                cell.or_default().push(hole);
            }
            self.listed.push(hole);
        }
    }

    /// Whether all directions within `reach_rad` of `middle` lie in a listed hole.
    fn covers(&self, middle: DVec3, reach_rad: f64) -> bool {
        let covers = |hole: &Hole| {
            // The chord of a negative angle is negative, and nothing is nearer.
            let chord = 2.0 * (0.5 * (hole.radius_rad - reach_rad)).sin();
            chord > 0.0 && hole.centre.distance_squared(middle) < chord * chord
        };
        let [x, y, z] = self.cell(middle);
        let mut around = (0..27).map(|k: i64| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        self.wide.iter().any(covers)
            || reach_rad < self.lattice_rad()
                && around.any(|cell| {
                    self.lattice
                        .get(&cell)
                        .is_some_and(|of| of.iter().any(covers))
                })
    }

    fn lattice_rad(&self) -> f64 {
        2.0 * self.least_rad
    }

    fn cell(&self, of: DVec3) -> [i64; 3] {
        let place = (of / self.lattice_rad()).floor();
        place.to_array().map(|c| c as i64)
    }
}

/// A key that orders holes by radius, then by coordinates.
fn by_size(hole: &Hole) -> [i64; 4] {
    let [x, y, z] = hole.centre.to_array();
    // As `f64::total_cmp` orders numbers.
    [hole.radius_rad, x, y, z].map(|number| {
        let bits = number.to_bits().cast_signed();
        bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
    })
}

/// Holes by their angle from an axis; a gap of more than `apart_rad` starts another row.
#[must_use]
pub fn rows(holes: &[Hole], axis: DVec3, apart_rad: f64) -> Vec<HoleRow> {
    let mut angles: Vec<(f64, f64)> = holes
        .iter()
        .map(|hole| (from_axis(hole.centre, axis), hole.radius_rad))
        .collect();
    angles.sort_by(|a, b| a.0.total_cmp(&b.0));
    angles
        .chunk_by(|a, b| b.0 - a.0 <= apart_rad)
        .map(|row| {
            let sum: f64 = row.iter().map(|(angle, _)| angle).sum();
            let radius = row.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
            HoleRow {
                from_axis_deg: (sum / row.len() as f64).to_degrees(),
                holes: row.len(),
                radius_deg: radius.to_degrees(),
            }
        })
        .collect()
}

/// The bands around an axis without directions, at least `least_rad` wide.
///
/// # Errors
/// [`DensityError::Direction`] for an invalid direction.
pub fn bands(
    directions: &[DVec3],
    axis: DVec3,
    least_rad: f64,
) -> Result<Vec<EmptyBand>, DensityError> {
    check(directions)?;
    let mut angles: Vec<f64> = directions.iter().map(|d| from_axis(*d, axis)).collect();
    angles.extend([0.0, std::f64::consts::PI]);
    angles.sort_unstable_by(f64::total_cmp);
    Ok(angles
        .iter()
        .zip(angles.iter().skip(1))
        .filter(|(from, to)| *to - *from >= least_rad)
        .map(|(from, to)| EmptyBand {
            from_deg: from.to_degrees(),
            to_deg: to.to_degrees(),
        })
        .collect())
}

/// The angle between a direction and an axis in radians, accurate for all angles.
fn from_axis(direction: DVec3, axis: DVec3) -> f64 {
    direction.cross(axis).length().atan2(direction.dot(axis))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::hole::EVERYWHERE;
    use super::*;

    /// Rings around y at these angles from it in degrees, `n` points each.
    fn rings(angles_deg: &[f64], n: u32) -> Vec<DVec3> {
        let ring = |angle_deg: &f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            (0..n).map(move |k| {
                let (s, c) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
                DVec3::new(sin * s, cos, sin * c)
            })
        };
        angles_deg.iter().flat_map(ring).collect()
    }

    #[test]
    fn bands_lie_between_rings() {
        let points = rings(&[10.0, 12.0, 90.0, 91.0], 360);
        let found = bands(&points, DVec3::Y, 1.5_f64.to_radians()).unwrap();
        let expected = [(0.0, 10.0), (10.0, 12.0), (12.0, 90.0), (91.0, 180.0)];
        assert_eq!(found.len(), expected.len());
        for (band, (from, to)) in found.iter().zip(expected) {
            assert!((band.from_deg - from).abs() < 1e-9 && (band.to_deg - to).abs() < 1e-9);
        }
        let all = bands(&[], DVec3::Y, 1.0).unwrap();
        assert_eq!(
            all,
            [EmptyBand {
                from_deg: 0.0,
                to_deg: 180.0
            }]
        );
    }

    #[test]
    fn holes_between_rings_form_rows() {
        // Without 50 and 51 degrees, a gap of 3 degrees remains on both sides, with holes of 1.5
        // degrees along it.
        let angles: Vec<f64> = (0..=180)
            .filter(|a| !matches!(a, 50 | 51 | 129 | 130))
            .map(f64::from)
            .collect();
        let points = rings(&angles, 720);
        let found = holes(&points, 1.2_f64.to_radians(), usize::MAX, &EVERYWHERE).unwrap();
        let rows = rows(&found, DVec3::Y, 0.5_f64.to_radians());
        assert_eq!(rows.len(), 2, "{rows:?}");
        for (row, at) in rows.iter().zip([50.5, 129.5]) {
            assert!((row.from_axis_deg - at).abs() < 0.2, "{row:?}");
            assert!((row.radius_deg - 1.5).abs() < 0.1, "{row:?}");
            // Centres outside the other holes are between 1 and 2 radii apart along the row.
            let around = 360.0 * 50.5_f64.to_radians().sin() / 1.5;
            assert!(
                (0.5 * around..=around).contains(&(row.holes as f64)),
                "{row:?}"
            );
        }
    }

    #[test]
    fn every_hole_is_found_at_its_full_size() {
        let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let mut points: Vec<DVec3> = (0..4_000)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 4_000.0;
                let (s, c) = (turn * f64::from(i)).sin_cos();
                DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
            })
            .collect();
        let spacing = (4.0 * std::f64::consts::PI / 4_000.0).sqrt();
        // Without these, five holes of about the spacing remain.
        let out: Vec<DVec3> = [3_000, 2_000, 1_500, 800, 555]
            .map(|i| points.swap_remove(i))
            .to_vec();
        let found = holes(&points, 0.9 * spacing, usize::MAX, &EVERYWHERE).unwrap();
        assert_eq!(found.len(), out.len());
        for hole in &found {
            assert!(
                out.iter()
                    .any(|out| out.distance(hole.centre) < 0.5 * spacing)
            );
            let nearest = points.iter().map(|p| from_axis(*p, hole.centre));
            let nearest = nearest.fold(f64::MAX, f64::min);
            assert!((nearest - hole.radius_rad).abs() < 1e-9);
        }
        assert_eq!(
            holes(&points, 0.9 * spacing, 2, &EVERYWHERE).unwrap(),
            found[..2]
        );
    }

    #[test]
    fn work_is_bounded_per_hole_when_holes_are_equal() {
        // Two rings with a belt between, of pairs of points so close that more than ten touch a
        // hole. There are as many equal holes as pairs. The cost follows the listed holes, not the
        // number of points.
        let looks = |n: u32| {
            let mut points = rings(&[80.0, 80.000_1, 84.0, 84.000_1], n);
            points.extend(rings(
                &[10.0, 30.0, 50.0, 65.0, 100.0, 120.0, 140.0, 160.0],
                360,
            ));
            let nearby = Nearby::new(&points);
            let mut list = HoleList::new(1.95_f64.to_radians(), usize::MAX);
            let belt = |at: DVec3| {
                3.0_f64.to_radians() - (from_axis(at, DVec3::Y) - 82.0_f64.to_radians()).abs()
            };
            let looked = looked_for(&nearby, &mut list, &belt);
            assert!(
                (90..=185).contains(&list.listed.len()),
                "{}",
                list.listed.len()
            );
            looked
        };
        let (few, many) = (looks(1_800), looks(18_000));
        assert!(many < 3 * few, "{few} {many}");
    }

    #[test]
    fn invalid_hole_sizes_are_refused() {
        for got in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = holes(&[DVec3::X], got, 10, &EVERYWHERE).unwrap_err();
            assert!(matches!(error, DensityError::Least { .. }), "{got}");
        }
    }
}
