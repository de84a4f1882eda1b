//! Blind spots: all holes that cannot grow, down to a size, the rows that they stand in about an axis, and the bands that no point ever comes into.
//!
//! How far a point is from the tilt axis depends on its laser's elevation and its azimuth alone, not on the tilt. So where a head's rays leave a band
//! of such angles out, no speed fills it: blind spots stand in rows about the axis. [`bands`] tells it from the points alone, [`holes`] and [`rows`] from
//! the holes. Left out: how the largest is found ([`super::hole`]).

use std::collections::HashMap;

use glam::DVec3;
use serde::Serialize;

use super::hole::{Depth, Done, Hole, Search};
use super::nearby::Nearby;
use super::{DensityError, check};

/// Holes about one angle from an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Angle from the axis, the mean of theirs, degrees.
    pub from_axis_deg: f64,
    /// How many there are.
    pub holes: usize,
    /// The radius of the largest, degrees.
    pub radius_deg: f64,
}

/// Angles from an axis that no point has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Where it begins: the angle of the last point before, or 0; degrees.
    pub from_deg: f64,
    /// Where it ends: the angle of the next point, or 180.
    pub to_deg: f64,
}

impl Band {
    /// How wide it is, degrees.
    #[must_use]
    pub fn width_deg(&self) -> f64 {
        self.to_deg - self.from_deg
    }
}

/// Holes of at least `least_rad`, the largest first, at most `most`: each as large as there is room for in its place, none with its middle in a larger
/// one that is listed, and only in the region that `depth_rad` tells of ([`super::largest_hole_within`]). Radii are right to a
/// thousandth of `least_rad` where more than ten points touch a hole, else to rounding.
///
/// # Errors
/// [`DensityError`] for what is no direction, or a least radius that is not above 0.
pub fn holes(
    directions: &[DVec3],
    least_rad: f64,
    most: usize,
    depth_rad: Depth<'_>,
) -> Result<Vec<Hole>, DensityError> {
    check(directions)?;
    if !(least_rad > 0.0 && least_rad.is_finite()) {
        return Err(DensityError::Least { got: least_rad });
    }
    let nearby = Nearby::new(directions);
    let mut search = Search::new(&nearby, 1e-3 * least_rad, depth_rad);
    let mut found = Vec::new();
    while let Some(next) = search.next() {
        if next.bound_rad < least_rad {
            break;
        }
        match search.look_into(&next, least_rad) {
            Done::Cut => {}
            Done::Holes(centres) => found.extend(centres.into_iter().filter_map(|c| search.at(c))),
            Done::Tiny => found.push(Hole {
                centre: next.middle,
                radius_rad: next.free_rad,
            }),
        }
    }
    found.retain(|hole| hole.radius_rad >= least_rad && depth_rad(hole.centre) >= 0.0);
    Ok(apart(found, least_rad, most))
}

/// Of holes those whose middles lie in no larger one, the largest first.
fn apart(mut holes: Vec<Hole>, least_rad: f64, most: usize) -> Vec<Hole> {
    let place = |hole: &Hole| hole.centre.to_array();
    holes.sort_by(|a, b| {
        let by_radius = b.radius_rad.total_cmp(&a.radius_rad);
        let (a, b) = (place(a), place(b));
        by_radius.then_with(|| b.partial_cmp(&a).unwrap_or(std::cmp::Ordering::Equal))
    });
    // Listed holes by the cells of a lattice in which they reach the cells about theirs; the few that are much larger stand aside.
    let cell = 2.0 * least_rad;
    let of = |centre: DVec3| (centre / cell).floor().to_array().map(|c| c as i64);
    let mut lattice: HashMap<[i64; 3], Vec<Hole>> = HashMap::new();
    let mut wide: Vec<Hole> = Vec::new();
    let mut listed = Vec::new();
    for hole in holes {
        if listed.len() == most {
            break;
        }
        let covers = |other: &Hole| {
            let chord = 2.0 * (0.5 * other.radius_rad).sin();
            other.centre.distance_squared(hole.centre) < chord * chord
        };
        let [x, y, z] = of(hole.centre);
        let around = (0..27).map(|k: i64| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let near = || {
            around
                .clone()
                .filter_map(|cell| lattice.get(&cell))
                .flatten()
        };
        if wide.iter().chain(near()).any(covers) {
            continue;
        }
        if hole.radius_rad > cell {
            wide.push(hole);
        } else {
            lattice.entry([x, y, z]).or_default().push(hole);
        }
        listed.push(hole);
    }
    listed
}

/// Holes by their angle from an axis: where two that follow each other are more than `apart_rad` apart, another row begins.
#[must_use]
pub fn rows(holes: &[Hole], axis: DVec3, apart_rad: f64) -> Vec<Row> {
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
            Row {
                from_axis_deg: (sum / row.len() as f64).to_degrees(),
                holes: row.len(),
                radius_deg: radius.to_degrees(),
            }
        })
        .collect()
}

/// The bands about an axis, at least `least_rad` wide, that no direction comes into.
///
/// # Errors
/// [`DensityError::Direction`] for what is none.
pub fn bands(directions: &[DVec3], axis: DVec3, least_rad: f64) -> Result<Vec<Band>, DensityError> {
    check(directions)?;
    let mut angles: Vec<f64> = directions.iter().map(|d| from_axis(*d, axis)).collect();
    angles.extend([0.0, std::f64::consts::PI]);
    angles.sort_unstable_by(f64::total_cmp);
    Ok(angles
        .iter()
        .zip(angles.iter().skip(1))
        .filter(|(from, to)| *to - *from >= least_rad)
        .map(|(from, to)| Band {
            from_deg: from.to_degrees(),
            to_deg: to.to_degrees(),
        })
        .collect())
}

/// The angle between a direction and an axis, radians: to the last digits everywhere.
fn from_axis(direction: DVec3, axis: DVec3) -> f64 {
    direction.cross(axis).length().atan2(direction.dot(axis))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::hole::EVERYWHERE;
    use super::*;

    /// Rings about y at these angles from it, degrees, `n` points each.
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
            [Band {
                from_deg: 0.0,
                to_deg: 180.0
            }]
        );
    }

    #[test]
    fn holes_between_rings_stand_in_rows() {
        // Every degree but for 50 and 51: a gap of 3 degrees is left there and on the other side, and holes of 1.5 along it.
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
            // As many as fit beside each other with middles outside each other: between 1 and 2 radii apart along the row.
            let around = 360.0 * 50.5_f64.to_radians().sin() / 1.5;
            assert!(
                (0.5 * around..=around).contains(&(row.holes as f64)),
                "{row:?}"
            );
        }
    }

    #[test]
    fn holes_are_as_large_as_there_is_room_and_none_is_left_out() {
        let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let mut points: Vec<DVec3> = (0..4_000)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 4_000.0;
                let (s, c) = (turn * f64::from(i)).sin_cos();
                DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
            })
            .collect();
        let spacing = (4.0 * std::f64::consts::PI / 4_000.0).sqrt();
        // Without these there are five holes of about the spacing.
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
    fn a_size_that_is_none_is_refused() {
        for got in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = holes(&[DVec3::X], got, 10, &EVERYWHERE).unwrap_err();
            assert!(matches!(error, DensityError::Least { .. }), "{got}");
        }
    }
}
