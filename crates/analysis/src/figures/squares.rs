//! Pictures of points: squares in the colour of their number of points.
//!
//! Counting takes linear time, and memory for the squares only.

use super::colour::colour;
use super::frame::{MARGIN, scale_name};
use crate::draw::plot::{TextAnchor, small};

/// Squares along a side of a picture.
pub(super) const CELLS: usize = 200;
/// Number of classes of 1, 2 and 3, 4 to 7 points and so on; the last is open.
const CLASSES: u32 = 7;

/// Points in the squares of a picture, in rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Squares(Vec<u32>);

impl Default for Squares {
    fn default() -> Self {
        Self(vec![0; CELLS * CELLS])
    }
}

impl Squares {
    /// Counts a point right of and above the lower left corner, in sides of the picture, and tells
    /// whether it is inside.
    pub fn count(&mut self, right: f64, up: f64) -> bool {
        let square = square(right, up).and_then(|square| self.0.get_mut(square));
        let is_inside = square.is_some();
        if let Some(count) = square {
            *count = count.saturating_add(1);
        }
        is_inside
    }

    /// Number of squares with a point.
    pub fn drawn(&self) -> usize {
        self.0.iter().filter(|count| **count > 0).count()
    }

    /// The squares at a place, with sides of so many pixels together.
    pub fn picture(&self, left: f64, top: f64, side: f64) -> String {
        let scale = side / CELLS as f64;
        let mut svg = format!(
            "<g transform=\"translate({left:.1} {top:.1}) scale({scale:.4}) translate(0 0.5)\" fill=\"none\" stroke-width=\"1.04\">\n"
        );
        for (class, path) in (0..CLASSES).zip(self.runs()) {
            if !path.is_empty() {
                svg += &format!("<path stroke=\"{}\" d=\"{path}\"/>\n", shade(class));
            }
        }
        svg + "</g>\n"
    }

    /// A path per class from the runs of its squares.
    fn runs(&self) -> Vec<String> {
        let mut paths = vec![String::new(); CLASSES as usize];
        for (y, row) in self.0.chunks(CELLS).enumerate() {
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
}

fn square(right: f64, up: f64) -> Option<usize> {
    // A point on the last edge belongs to the last square.
    let of = |share: f64| {
        let is_inside = (0.0..=1.0).contains(&share);
        is_inside.then(|| ((share * CELLS as f64) as usize).min(CELLS - 1))
    };
    Some((CELLS - 1 - of(up)?) * CELLS + of(right)?)
}

fn class(count: u32) -> Option<u32> {
    Some(count.checked_ilog2()?.min(CLASSES - 1))
}

/// The colour of a class; the lightest is still visible as a single point on white.
fn shade(class: u32) -> String {
    colour(0.3 + 0.7 * f64::from(class) / f64::from(CLASSES - 1))
}

/// The scale of colours.
pub(super) fn scale(top: f64, name: &str) -> String {
    let y = top + 10.0;
    let mut svg = scale_name(y, name);
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
    fn places_belong_to_one_square() {
        assert_eq!(
            (square(0.0, 0.0), square(1.0, 1.0), square(1.0005, 0.15)),
            (Some(199 * CELLS), Some(199), None)
        );
        assert_eq!(square(f64::NAN, 0.05), None);
        let mut squares = Squares::default();
        assert!(squares.count(0.5, 0.5) && squares.count(0.501, 0.501) && !squares.count(2.0, 0.5));
        assert_eq!((squares.0[99 * CELLS + 100], squares.drawn()), (2, 1));
    }

    #[test]
    fn runs_cover_every_square() {
        let mut squares = Squares::default();
        squares.0[3..6].copy_from_slice(&[1, 1, 2]);
        squares.0[CELLS] = 500;
        let paths = squares.runs();
        assert_eq!(
            (paths[0].as_str(), paths[1].as_str(), paths[6].as_str()),
            ("M3 0h2", "M5 0h1", "M0 1h1")
        );
    }
}
