//! The points themselves on the sphere, from three sides.

use glam::DVec3;

use super::AnalyzedScans;
use super::frame::{TITLE, document, heading};
use super::sides::{RADIUS, ROW, SIDES, captions, centre};
use super::squares::{Squares, scale};

/// Points in the squares of the three sides.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpherePoints([Squares; 3]);

impl SpherePoints {
    /// Points of directions.
    #[must_use]
    pub fn new(directions: &[DVec3]) -> Self {
        let mut points = Self::default();
        points.add(directions);
        points
    }

    /// Counts more directions.
    pub fn add(&mut self, directions: &[DVec3]) {
        for direction in directions {
            for (squares, side) in self.0.iter_mut().zip(&SIDES) {
                if direction.dot(side.to) > 0.0 {
                    let share = |axis: DVec3| 0.5 + 0.5 * direction.dot(axis);
                    squares.count(share(side.right.0), share(side.up.0));
                }
            }
        }
    }
}

/// The figure: a row per scan, a column per side.
#[must_use]
pub fn points(scans: &AnalyzedScans) -> String {
    let mut body = String::new();
    let mut about = "Points on hemispheres seen from +x, from -y and from +z, in squares of a hundredth of the radius, darker is more.".to_owned();
    let mut top = TITLE;
    for scan in &scans.scans {
        let line = format!("{} points", scan.points);
        about += &format!(" {}: {line}.", scan.name);
        body += &heading(&scan.name, &line, top + 14.0);
        for (number, (side, squares)) in SIDES.iter().zip(&scan.sphere.0).enumerate() {
            let (x, y) = centre(number, top);
            body += &format!(
                "<circle class=\"tv-paper\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{RADIUS:.0}\"/>\n"
            );
            body += &squares.picture(x - RADIUS, y - RADIUS, 2.0 * RADIUS);
            body += &captions(side, (x, y));
        }
        top += ROW;
    }
    body += &scale(top, "points in a square");
    document("Points on the sphere", &about, top + 44.0, &body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_drawn_on_the_sides_that_show_them() {
        let drawn = |direction: DVec3| {
            let points = SpherePoints::new(&[direction.normalize()]);
            points.0.each_ref().map(Squares::drawn)
        };
        assert_eq!(drawn(DVec3::X), [1, 0, 0]);
        assert_eq!(drawn(DVec3::new(1.0, -2.0, 3.0)), [1, 1, 1]);
        assert_eq!(drawn(DVec3::new(-1.0, 2.0, -3.0)), [0, 0, 0]);
    }
}
