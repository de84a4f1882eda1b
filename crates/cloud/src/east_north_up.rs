//! Local frame of georeferenced clouds: x east, y north, z up.
//!
//! The frame is the plane that touches the earth at its origin, so that all its axes are straight.
//! At 100 m and a latitude of 60 deg the meridian differs from that of the origin by 100 m tan(60
//! deg) / 6371 km = 0.0016 deg, which is 2.7 mm over another 100 m, and the earth is 100^2 / (2 *
//! 6371 km) = 0.8 mm below the plane. A position to metres and a heading to tenths of a degree hide
//! both, so neither is corrected.

use std::borrow::Cow;

use units::Degrees;

use crate::Points;

/// Axes east, north and up, relative to a level scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EastNorthUp {
    heading: Degrees,
    sin: f64,
    cos: f64,
}

impl EastNorthUp {
    /// The axes for a scanner whose y axis (forward) is `heading` clockwise from true north.
    #[must_use]
    pub fn new(heading: Degrees) -> Self {
        let (sin, cos) = heading.to_radians().0.sin_cos();
        Self { heading, sin, cos }
    }

    /// Heading of the scanner's y axis (forward), clockwise from true north.
    #[must_use]
    pub const fn heading(&self) -> Degrees {
        self.heading
    }

    /// A point x right, y forward, z up as x east, y north, z up, metres.
    #[must_use]
    pub fn place(self, [right, forward, up]: [f64; 3]) -> [f64; 3] {
        [
            right * self.cos + forward * self.sin,
            forward * self.cos - right * self.sin,
            up,
        ]
    }

    /// The unit quaternion (x, y, z, w) that turns the scanner's axes into these.
    pub(crate) fn rotation(self) -> [f64; 4] {
        // Clockwise, seen from above.
        let (sin, cos) = (-self.heading.to_radians().0 / 2.0).sin_cos();
        // Both signs are one rotation; E57 takes only w >= 0.
        let sign = if cos < 0.0 { -1.0 } else { 1.0 };
        [0.0, 0.0, sign * sin, sign * cos]
    }

    /// The batch with its points in `axes`; without axes the batch itself.
    pub(crate) fn apply(axes: Option<Self>, batch: &Points) -> Cow<'_, Points> {
        axes.map_or(Cow::Borrowed(batch), |axes| {
            let mut placed = batch.clone();
            placed.map_positions(|position_m| axes.place(position_m));
            Cow::Owned(placed)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    #[test]
    fn a_heading_is_clockwise_from_north() {
        // Forward and right of the scanner.
        for (heading, forward, right) in [
            (0.0, [0.0, 1.0, 5.0], [1.0, 0.0, 5.0]),
            (90.0, [1.0, 0.0, 5.0], [0.0, -1.0, 5.0]),
            (180.0, [0.0, -1.0, 5.0], [-1.0, 0.0, 5.0]),
            (-90.0, [-1.0, 0.0, 5.0], [0.0, 1.0, 5.0]),
            (
                30.0,
                [0.5, 0.75_f64.sqrt(), 5.0],
                [0.75_f64.sqrt(), -0.5, 5.0],
            ),
        ] {
            let axes = EastNorthUp::new(Degrees(heading));
            for (point, expected) in [([0.0, 1.0, 5.0], forward), ([1.0, 0.0, 5.0], right)] {
                let placed = axes.place(point);
                assert!(distance(placed, expected) < 1e-15, "{heading}: {placed:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn distances_are_preserved_and_heading_0_changes_nothing(
            heading in -360.0..360.0_f64,
            a in prop::array::uniform3(-200.0..200.0_f64),
            b in prop::array::uniform3(-200.0..200.0_f64),
        ) {
            let axes = EastNorthUp::new(Degrees(heading));
            let placed = distance(axes.place(a), axes.place(b));
            prop_assert!((placed - distance(a, b)).abs() < 1e-12);
            prop_assert_eq!(axes.place(a)[2], a[2]);
            prop_assert_eq!(EastNorthUp::new(Degrees(0.0)).place(a), a);
        }
    }
}
