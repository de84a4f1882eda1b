//! Intersections of the rays of a scan with planes around the scanner: the ground 1.5 m below and
//! walls at 10 m, parallel to YZ and XZ.
//!
//! The height of the sensor above the axis is ignored.

use glam::DVec3;

use super::AnalyzedScans;
use super::frame::{MARGIN, TITLE, WIDTH, document, heading};
use super::squares::{CELLS, Squares, scale};
use crate::draw::plot::{TextAnchor, small};

/// Depth of the ground below the scanner, metres.
const GROUND_M: f64 = 1.5;
/// Distance of the walls, metres.
const WALL_M: f64 = 10.0;
/// Side of a picture, metres.
const SIDE_M: f64 = 20.0;
/// Side of the squares, metres.
pub const CELL_M: f64 = SIDE_M / CELLS as f64;
const GAP: f64 = 18.0;
const PANEL: f64 = (WIDTH - 2.0 * MARGIN - 2.0 * GAP) / 3.0;
const ROW: f64 = PANEL + 64.0;

/// Points in the squares of the three planes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Planes {
    /// Ground, wall at x = 10 m, wall at y = 10 m.
    squares: [Squares; 3],
    /// Points inside the pictures.
    shown: u64,
    /// Points that meet a plane, inside the pictures or outside.
    met: u64,
    /// All points.
    all: u64,
}

impl Planes {
    /// Counts directions from the origin.
    #[must_use]
    pub fn new(directions: &[DVec3]) -> Self {
        let mut planes = Self::default();
        planes.add(directions);
        planes
    }

    /// Counts more directions.
    pub fn add(&mut self, directions: &[DVec3]) {
        self.all += directions.len() as u64;
        for direction in directions {
            let Some((plane, right_m, up_m)) = meet(*direction) else {
                continue;
            };
            self.met += 1;
            let squares = self.squares.get_mut(plane);
            let is_inside = squares.is_some_and(|s| s.count(right_m / SIDE_M, up_m / SIDE_M));
            self.shown += u64::from(is_inside);
        }
    }

    /// Points inside the pictures.
    #[must_use]
    pub const fn shown(&self) -> u64 {
        self.shown
    }

    /// Points that meet one of the planes.
    #[must_use]
    pub const fn met(&self) -> u64 {
        self.met
    }

    /// Number of squares with a point.
    #[must_use]
    pub fn drawn(&self) -> usize {
        self.squares.iter().map(Squares::drawn).sum()
    }

    fn line(&self) -> String {
        format!(
            "{} of {} points meet the planes, {} within the pictures: {} squares",
            self.met,
            self.all,
            self.shown,
            self.drawn()
        )
    }
}

/// The plane that a ray meets first, and the place in metres right of and above the lower left
/// corner of its picture.
fn meet(direction: DVec3) -> Option<(usize, f64, f64)> {
    let to = |distance: f64, along: f64| (along > 0.0).then(|| distance / along);
    let hits = [
        to(GROUND_M, -direction.z),
        to(WALL_M, direction.x),
        to(WALL_M, direction.y),
    ];
    let hits = hits.into_iter().enumerate();
    let hits = hits.filter_map(|(plane, range)| Some((plane, range?)));
    let (plane, range) = hits.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let DVec3 { x, y, z } = direction * range;
    let half = SIDE_M / 2.0;
    Some(match plane {
        0 => (plane, x + half, y + half),
        1 => (plane, y + half, z + GROUND_M),
        _ => (plane, x + half, z + GROUND_M),
    })
}

const NAMES: [(&str, &str, &str); 3] = [
    ("ground, 1.5 m below", "x", "y"),
    ("at x = 10 m", "y", "z"),
    ("at y = 10 m", "x", "z"),
];

/// The figure: a row per scan, a column per plane.
#[must_use]
pub fn planes(scans: &AnalyzedScans) -> String {
    let mut body = String::new();
    let mut about = "Where rays meet the ground 1.5 m below and the walls at x = 10 m and y = 10 m, in squares of 0.1 m, darker is more.".to_owned();
    let mut top = TITLE;
    for scan in &scans.scans {
        let line = scan.planes.line();
        body += &heading(&scan.name, &line, top + 14.0);
        about += &format!(" {}: {line}.", scan.name);
        for (number, (squares, names)) in scan.planes.squares.iter().zip(NAMES).enumerate() {
            let left = MARGIN + (PANEL + GAP) * number as f64;
            body += &panel(squares, names, left, top + 26.0);
        }
        top += ROW;
    }
    body += &scale(top, "points in a square of 0.1 m");
    document(
        "Points on planes about the scanner",
        &about,
        top + 44.0,
        &body,
    )
}

fn panel(squares: &Squares, (name, right, up): (&str, &str, &str), left: f64, top: f64) -> String {
    let mut svg = format!(
        "<rect class=\"tv-paper\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{PANEL:.1}\" height=\"{PANEL:.1}\"/>\n"
    );
    svg += &squares.picture(left, top, PANEL);
    let bottom = top + PANEL;
    let half = SIDE_M / 2.0;
    let caption = match up {
        "z" => format!(
            "{name}: {right} \u{b1}{half} m, {up} {} to {} m",
            -GROUND_M,
            SIDE_M - GROUND_M
        ),
        _ => format!("{name}: {right}, {up} \u{b1}{half} m"),
    };
    svg += &small(
        left + PANEL / 2.0,
        bottom + 15.0,
        TextAnchor::Middle,
        &caption,
    );
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_hit_the_nearest_plane() {
        let near = |to: DVec3, plane: usize, right_m: f64, up_m: f64| {
            let (got, right, up) = meet(to.normalize()).unwrap();
            assert_eq!(got, plane, "{to}");
            assert!(
                (right - right_m).abs() < 1e-12 && (up - up_m).abs() < 1e-12,
                "{to}: {right} {up}"
            );
        };
        near(DVec3::NEG_Z, 0, 10.0, 10.0);
        near(DVec3::X, 1, 10.0, 1.5);
        near(DVec3::new(3.0, 10.0, 2.0), 2, 13.0, 3.5);
        // Down to the ground before the wall: 5 m off in x.
        near(DVec3::new(5.0, -4.0, -1.5), 0, 15.0, 6.0);
        for none in [
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::new(-1.0, -1.0, 0.1),
        ] {
            assert_eq!(meet(none.normalize()), None, "{none}");
        }
    }

    #[test]
    fn every_point_is_counted_once() {
        let far = DVec3::new(-100.0, 0.0, -1.5).normalize();
        let directions = [
            DVec3::NEG_Z,
            DVec3::NEG_Z,
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            far,
        ];
        let planes = Planes::new(&directions);
        assert_eq!((planes.met(), planes.shown(), planes.drawn()), (5, 4, 3));
    }
}
