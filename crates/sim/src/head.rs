//! The lidar's head on the tilting platform: which way each laser looks, and from where.
//!
//! Stated as a composition of rigid motions, not as the printed equations that the scanner's own code follows: the laser's aim
//! is raised about x by its elevation and turned about the vertical by the azimuth, the head is lifted along its own z, and
//! the platform turns about y. Left out: misalignments of the mount, and the tripod's own shadow.

use firmware_sim::vlp16;
use glam::{DAffine3, DMat3, DVec3};
use units::{Degrees, Metres};

/// Nearest surface that returns, metres; a nearer one blocks the beam (data sheet of the VLP-16: 1 m to 100 m).
pub const MIN_RANGE_M: f64 = 1.0;
/// Farthest surface that returns, metres.
pub const MAX_RANGE_M: f64 = 100.0;

/// One laser of the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Angle of the beam above the head's own horizontal.
    pub elevation: Degrees,
    /// Where the beam starts, measured along the head's own vertical.
    pub origin: Metres,
}

/// The lasers of the VLP-16 in the order in which they fire (manual 63-9243, "Sensor operation", table of vertical angles
/// and vertical corrections).
pub const LASERS: [Laser; vlp16::LASERS] = [
    laser(-15.0, 11.2),
    laser(1.0, -0.7),
    laser(-13.0, 9.7),
    laser(3.0, -2.2),
    laser(-11.0, 8.1),
    laser(5.0, -3.7),
    laser(-9.0, 6.6),
    laser(7.0, -5.1),
    laser(-7.0, 5.1),
    laser(9.0, -6.6),
    laser(-5.0, 3.7),
    laser(11.0, -8.1),
    laser(-3.0, 2.2),
    laser(13.0, -9.7),
    laser(-1.0, 0.7),
    laser(15.0, -11.2),
];

const fn laser(elevation_deg: f64, origin_mm: f64) -> Laser {
    Laser {
        elevation: Degrees(elevation_deg),
        origin: Metres(origin_mm / 1e3),
    }
}

/// The head, mounted.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Each laser's origin and direction in the head's frame at azimuth 0.
    beams: [(DVec3, DVec3); vlp16::LASERS],
    /// From the head's frame to the platform's.
    mount: DAffine3,
}

impl Head {
    /// The VLP-16's head with its origin at height `d` above the tilt axis of a level platform.
    #[must_use]
    pub fn new(d: Metres) -> Self {
        let beams = LASERS.map(|laser| {
            let raise = DMat3::from_rotation_x(laser.elevation.to_radians().0);
            (laser.origin.0 * DVec3::Z, raise * DVec3::Y)
        });
        Self {
            beams,
            mount: DAffine3::from_translation(d.0 * DVec3::Z),
        }
    }

    /// Where a laser's beam starts (metres) and which way it goes (length 1) in the frame of the platform's base: origin on
    /// the tilt axis, x right, y forward, z up. `None` where there is no such laser.
    ///
    /// The azimuth runs clockwise seen from above (y to x), a positive tilt turns z towards x.
    #[inline]
    #[must_use]
    pub fn beam(&self, laser: usize, azimuth: Degrees, tilt: Degrees) -> Option<(DVec3, DVec3)> {
        let &(origin, aim) = self.beams.get(laser)?;
        let spin = DMat3::from_rotation_z(-azimuth.to_radians().0);
        let platform = DMat3::from_rotation_y(tilt.to_radians().0);
        Some((
            platform * self.mount.transform_point3(spin * origin),
            platform * self.mount.transform_vector3(spin * aim),
        ))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Eq. 4-6 of "Analysis of 3D Scan Measurement Distribution with Application to a Multi-Beam Lidar on a Rotating Platform"
    /// (2018) as printed, with z lifted in the head's frame by the laser's vertical origin.
    fn printed(range_m: f64, laser: Laser, azimuth: Degrees, tilt: Degrees, d: f64) -> DVec3 {
        let (sw, cw) = laser.elevation.to_radians().0.sin_cos();
        let (sa, ca) = azimuth.to_radians().0.sin_cos();
        let (sg, cg) = tilt.to_radians().0.sin_cos();
        let d = d + laser.origin.0;
        DVec3::new(
            range_m * (cw * sa * cg + sw * sg) + d * sg,
            range_m * cw * ca,
            range_m * (sw * cg - cw * sa * sg) + d * cg,
        )
    }

    #[test]
    fn the_table_is_the_manuals() {
        // Odd lasers are 16 deg above the even one before them; origins mirror about the middle of the stack.
        for (i, laser) in LASERS.iter().enumerate() {
            let expected = if i % 2 == 0 {
                i as f64 - 15.0
            } else {
                i as f64
            };
            assert_eq!(laser.elevation.0, expected);
            let mirrored = LASERS[15 - i];
            assert_eq!(laser.elevation.0, -mirrored.elevation.0);
            assert_eq!(laser.origin.0, -mirrored.origin.0);
        }
        // The beams cross close to one point, 41.91 mm from the axis: origin = -41.91 mm x tan(elevation), printed to 0.1 mm.
        for laser in LASERS {
            let crossing = -0.041_91 * laser.elevation.to_radians().0.tan();
            assert!((laser.origin.0 - crossing).abs() < 0.6e-4, "{laser:?}");
        }
    }

    #[test]
    fn level_and_forward_is_along_y() {
        let head = Head::new(Metres(0.06));
        let (origin, direction) = head.beam(15, Degrees(0.0), Degrees(0.0)).unwrap();
        assert!(origin.distance(DVec3::new(0.0, 0.0, 0.06 - 0.0112)) < 1e-15);
        let (sin, cos) = 15_f64.to_radians().sin_cos();
        assert!(direction.distance(DVec3::new(0.0, cos, sin)) < 1e-15);
        let (_, right) = head.beam(15, Degrees(90.0), Degrees(0.0)).unwrap();
        assert!(right.distance(DVec3::new(cos, 0.0, sin)) < 1e-15);
        assert!(head.beam(16, Degrees(0.0), Degrees(0.0)).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn the_papers_equations_come_out(
            range_m in 0.0..100.0, laser in 0..16_usize, azimuth in 0.0..360.0, tilt in -180.0..180.0, d in -1.0..1.0,
        ) {
            let (azimuth, tilt) = (Degrees(azimuth), Degrees(tilt));
            let (origin, direction) = Head::new(Metres(d)).beam(laser, azimuth, tilt).unwrap();
            prop_assert!((direction.length() - 1.0).abs() < 1e-15);
            let point = origin + range_m * direction;
            let expected = printed(range_m, LASERS[laser], azimuth, tilt, d);
            prop_assert!(point.distance(expected) < 1e-13, "{point} {expected}");
        }
    }
}
