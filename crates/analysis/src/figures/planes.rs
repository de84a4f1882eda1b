//! Intersections of the rays of a scan with planes around the scanner: the ground 1.5 m below and
//! walls at 10 m, parallel to YZ and XZ.
//!
//! The planes are divided into squares, in which points are counted: linear time, and memory for
//! the squares only. The height of the sensor above the axis is ignored.

use glam::DVec3;

use super::AnalyzedScans;
use super::colour::colour;
use super::frame::{MARGIN, TITLE, WIDTH, document, heading, scale_name};
use crate::draw::plot::{TextAnchor, small};

/// Depth of the ground below the scanner, metres.
const GROUND_M: f64 = 1.5;
/// Distance of the walls, metres.
const WALL_M: f64 = 10.0;
/// Side of a picture, metres.
const SIDE_M: f64 = 20.0;
/// Side of the squares, metres.
pub const CELL_M: f64 = 0.1;
/// Squares along a side of a picture.
const CELLS: usize = 200;
/// Number of classes of 1, 2 and 3, 4 to 7 points and so on; the last is open.
const CLASSES: u32 = 7;
const GAP: f64 = 18.0;
const PANEL: f64 = (WIDTH - 2.0 * MARGIN - 2.0 * GAP) / 3.0;
const ROW: f64 = PANEL + 64.0;

/// Points in the squares of the three planes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planes {
    /// Ground, wall at x = 10 m, wall at y = 10 m; rows from the top.
    cells: [Vec<u32>; 3],
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
        let mut planes = Self {
            cells: [(); 3].map(|()| vec![0; CELLS * CELLS]),
            shown: 0,
            met: 0,
            all: directions.len() as u64,
        };
        for direction in directions {
            let Some((plane, right_m, up_m)) = meet(*direction) else {
                continue;
            };
            planes.met += 1;
            if let Some(cell) = cell(right_m, up_m)
                && let Some(count) = planes.cells.get_mut(plane).and_then(|p| p.get_mut(cell))
            {
                *count = count.saturating_add(1);
                planes.shown += 1;
            }
        }
        planes
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
        let all = self.cells.iter().flatten();
        all.filter(|count| **count > 0).count()
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

fn cell(right_m: f64, up_m: f64) -> Option<usize> {
    // A point on the edge of a wall belongs to its last square.
    let of = |metres: f64| {
        (0.0..=SIDE_M)
            .contains(&metres)
            .then(|| ((metres / CELL_M) as usize).min(CELLS - 1))
    };
    Some((CELLS - 1 - of(up_m)?) * CELLS + of(right_m)?)
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
        for (number, (cells, names)) in scan.planes.cells.iter().zip(NAMES).enumerate() {
            let left = MARGIN + (PANEL + GAP) * number as f64;
            body += &panel(cells, names, left, top + 26.0);
        }
        top += ROW;
    }
    body += &scale(top);
    document(
        "Points on planes about the scanner",
        &about,
        top + 44.0,
        &body,
    )
}

fn panel(cells: &[u32], (name, right, up): (&str, &str, &str), left: f64, top: f64) -> String {
    let scale = PANEL / CELLS as f64;
    let mut svg = format!(
        "<rect class=\"tv-paper\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{PANEL:.1}\" height=\"{PANEL:.1}\"/>\n\
         <g transform=\"translate({left:.1} {top:.1}) scale({scale:.4}) translate(0 0.5)\" fill=\"none\" stroke-width=\"1.04\">\n"
    );
    for (class, path) in (0..CLASSES).zip(runs(cells)) {
        if !path.is_empty() {
            svg += &format!("<path stroke=\"{}\" d=\"{path}\"/>\n", shade(class));
        }
    }
    svg += "</g>\n";
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

/// A path per class from the runs of its squares.
fn runs(cells: &[u32]) -> Vec<String> {
    let mut paths = vec![String::new(); CLASSES as usize];
    for (y, row) in cells.chunks(CELLS).enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| class(*a) == class(*b)) {
            let path = run.first().and_then(|count| class(*count));
            if let Some(path) = path.and_then(|class| paths.get_mut(class as usize)) {
                *path += &format!("M{x} {y}h{}", run.len());
            }
            x += run.len();
        }
    }
    paths
}

fn class(count: u32) -> Option<u32> {
    Some(count.checked_ilog2()?.min(CLASSES - 1))
}

/// The colour of a class; the lightest is still visible as a single point on white.
fn shade(class: u32) -> String {
    colour(0.3 + 0.7 * f64::from(class) / f64::from(CLASSES - 1))
}

fn scale(top: f64) -> String {
    let y = top + 10.0;
    let mut svg = scale_name(y, "points in a square of 0.1 m");
    let mut x = MARGIN + 190.0;
    for class in 0..CLASSES {
        let (from, to) = (1_u32 << class, (2_u32 << class) - 1);
        let name = match class {
            0 => "1".to_owned(),
            class if class + 1 == CLASSES => format!("{from}+"),
            _ => format!("{from} to {to}"),
        };
        let colour = shade(class);
        svg += &format!(
            "<rect fill=\"{colour}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"14\" height=\"12\"/>\n"
        );
        svg += &small(x + 18.0, y + 10.0, TextAnchor::Start, &name);
        x += 71.0;
    }
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
        let sum: u32 = planes.cells.iter().flatten().sum();
        assert_eq!(u64::from(sum), planes.shown());
        assert_eq!(planes.cells[0][99 * CELLS + 100], 2);
        assert_eq!(
            (cell(0.0, 0.0), cell(20.0, 20.0), cell(20.01, 3.0)),
            (Some(199 * CELLS), Some(199), None)
        );
        assert_eq!(cell(f64::NAN, 1.0), None);
    }

    #[test]
    fn runs_cover_every_cell() {
        let mut cells = vec![0; CELLS * CELLS];
        cells[3..6].copy_from_slice(&[1, 1, 2]);
        cells[CELLS] = 500;
        let paths = runs(&cells);
        assert_eq!(
            (paths[0].as_str(), paths[1].as_str(), paths[6].as_str()),
            ("M3 0h2", "M5 0h1", "M0 1h1")
        );
    }
}
