//! The sphere from three sides in orthographic projection, as in the paper's Figures 2 to 7.

use glam::DVec3;

use super::frame::{MARGIN, WIDTH};
use crate::draw::plot::{TextAnchor, small};

/// Radius of a drawn sphere, pixels.
pub(super) const RADIUS: f64 = 104.0;
/// Height of the row of a scan.
pub(super) const ROW: f64 = 2.0 * RADIUS + 62.0;

/// A viewing direction.
pub(super) struct Side {
    pub caption: &'static str,
    /// Direction towards the viewer.
    pub to: DVec3,
    /// Axes to the right and up, and their names.
    pub right: (DVec3, &'static str),
    pub up: (DVec3, &'static str),
}

pub(super) const SIDES: [Side; 3] = [
    Side {
        caption: "from +x",
        to: DVec3::X,
        right: (DVec3::Y, "y"),
        up: (DVec3::Z, "z"),
    },
    Side {
        caption: "from -y, along the tilt axis",
        to: DVec3::NEG_Y,
        right: (DVec3::X, "x"),
        up: (DVec3::Z, "z"),
    },
    Side {
        caption: "from +z, above",
        to: DVec3::Z,
        right: (DVec3::X, "x"),
        up: (DVec3::Y, "y"),
    },
];

/// The centre of a drawn sphere, by the number of its side, in the row that begins at `top`.
pub(super) fn centre(number: usize, top: f64) -> (f64, f64) {
    let column = (WIDTH - 2.0 * MARGIN) / 3.0;
    let x = MARGIN + column * (number as f64 + 0.5);
    (x, top + 30.0 + RADIUS)
}

/// The names of a side and its axes.
pub(super) fn captions(side: &Side, (x, y): (f64, f64)) -> String {
    let right = (x + RADIUS + 5.0, y + 4.0);
    let up = (x - 3.0, y - RADIUS - 3.0);
    small(x, y + RADIUS + 18.0, TextAnchor::Middle, side.caption)
        + &small(right.0, right.1, TextAnchor::Start, side.right.1)
        + &small(up.0, up.1, TextAnchor::Start, side.up.1)
}
