//! How the lidar sits on the tilt axis: Eq. 4-6 of "Analysis of 3D Scan Measurement Distribution
//! with Application to a Multi-Beam Lidar on a Rotating Platform" (2018).
//!
//! Frames are x right, y forward, z up. The platform turns about Y, and the lidar's origin is at
//! height d above that axis. Everything is f64: in f32 these equations are wrong by tens of
//! micrometres at 100 m, as a test below measures.
//!
//! Left out until a calibration gives it: the rigid transforms before the rotation (boresight,
//! offsets along x and y) and after it (pose of the axis). They would compose here, behind
//! [`Mount::place`], and nowhere else.

use units::{Degrees, Metres, Real};

/// Position of the lidar's origin on the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Height of the lidar's origin above the tilt axis (d of Eq. 4-6); negative below it.
    pub d: Metres,
}

/// A tilt angle with its sine and cosine, shared by the points of a firing; or several of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt<V = f64> {
    sin: V,
    cos: V,
}

/// Greatest angle for [`Tilt::ahead`], radians either way.
pub const MOST_AHEAD_RAD: f64 = 2e-3;

impl Tilt {
    /// No tilt.
    pub const LEVEL: Self = Self { sin: 0.0, cos: 1.0 };

    /// The tilt by `angle` (gamma): positive from z (up) towards x (right).
    #[must_use]
    pub fn new(angle: Degrees) -> Self {
        let (sin, cos) = angle.to_radians().0.sin_cos();
        Self { sin, cos }
    }

    /// The tilts `ahead_rad` beyond this one, at most [`MOST_AHEAD_RAD`] either way.
    ///
    /// The Taylor series of third order displaces a point by at most 2e-3 ^ 4 / 24 = 7e-13 of its
    /// distance.
    #[inline(always)]
    #[must_use]
    pub fn ahead<V: Real>(self, ahead_rad: V) -> Tilt<V> {
        const SIXTH: f64 = 1.0 / 6.0;
        let (Self { sin, cos }, e) = (self, ahead_rad);
        Tilt {
            sin: ((e * (-SIXTH * cos) + (-0.5 * sin)) * e + cos) * e + sin,
            cos: ((e * (SIXTH * sin) + (-0.5 * cos)) * e + (-sin)) * e + cos,
        }
    }
}

impl Mount {
    /// A mount with the lidar's origin `d` above the tilt axis.
    #[must_use]
    pub const fn new(d: Metres) -> Self {
        Self { d }
    }

    /// A point of the lidar's frame (Eq. 1-3, metres) in the frame of the platform's base, whose
    /// origin is on the tilt axis (Eq. 4-6, metres).
    ///
    /// With x_v, y_v, z_v of Eq. 1-3 the paper's equations read x = x_v cos g + (z_v + d) sin g, y
    /// = y_v, z = (z_v + d) cos g - x_v sin g.
    #[inline(always)]
    #[must_use]
    pub fn place<V: Real>(&self, position_m: [V; 3], tilt: Tilt<V>) -> [V; 3] {
        let [x, y, z] = position_m;
        let height = z + self.d.0;
        [
            x * tilt.cos + height * tilt.sin,
            y,
            height * tilt.cos - x * tilt.sin,
        ]
    }

    /// Squared distances of a placed point (Eq. 4-6, metres) from the tilt axis and from the
    /// lidar's spin axis: the lever arms of tilt and azimuth errors.
    #[inline(always)]
    #[must_use]
    pub fn arms_m2<V: Real>(&self, placed_m: [V; 3], tilt: Tilt<V>) -> [V; 2] {
        let [x, y, z] = placed_m;
        // Back into the lidar's frame, where the spin axis is z.
        let across = x * tilt.cos - z * tilt.sin;
        [x * x + z * z, across * across + y * y]
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};
    use proptest::prelude::*;

    use super::*;

    const PAPER: Mount = Mount::new(Metres(0.06));

    /// Eq. 1-3.
    fn sensor(range_m: f64, elevation: Degrees, azimuth: Degrees) -> [f64; 3] {
        let (sin_w, cos_w) = elevation.to_radians().0.sin_cos();
        let (sin_a, cos_a) = azimuth.to_radians().0.sin_cos();
        [
            range_m * cos_w * sin_a,
            range_m * cos_w * cos_a,
            range_m * sin_w,
        ]
    }

    /// Eq. 4-6 as printed, in range, elevation, azimuth, gamma and d.
    fn printed(range_m: f64, elevation: Degrees, azimuth: Degrees, gamma: Degrees) -> [f64; 3] {
        let (sin_w, cos_w) = elevation.to_radians().0.sin_cos();
        let (sin_a, cos_a) = azimuth.to_radians().0.sin_cos();
        let (sin_g, cos_g) = gamma.to_radians().0.sin_cos();
        let d = PAPER.d.0;
        [
            range_m * (cos_w * sin_a * cos_g + sin_w * sin_g) + d * sin_g,
            range_m * cos_w * cos_a,
            range_m * (sin_w * cos_g - cos_w * sin_a * sin_g) + d * cos_g,
        ]
    }

    /// Eq. 4-6 by composing matrices: lift by d, then rotate about Y.
    fn by_matrices(position_m: [f64; 3], gamma: Degrees) -> [f64; 3] {
        let matrix = DMat4::from_rotation_y(gamma.to_radians().0)
            * DMat4::from_translation(DVec3::new(0.0, 0.0, PAPER.d.0));
        matrix
            .transform_point3(DVec3::from_array(position_m))
            .to_array()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        DVec3::from_array(a).distance(DVec3::from_array(b))
    }

    #[test]
    fn placement_agrees_with_eq_4_to_6_and_with_matrices_at_every_angle() {
        let mut worst: f64 = 0.0;
        for gamma in (-720..=720).map(|i| Degrees(f64::from(i) * 0.25)) {
            for elevation in (-15..=15).step_by(2).map(|w| Degrees(f64::from(w))) {
                for azimuth in (0..36).map(|a| Degrees(f64::from(a) * 10.0 + 0.3)) {
                    let range_m = 100.0;
                    let lidar = sensor(range_m, elevation, azimuth);
                    let placed = PAPER.place(lidar, Tilt::new(gamma));
                    worst = worst
                        .max(distance(
                            placed,
                            printed(range_m, elevation, azimuth, gamma),
                        ))
                        .max(distance(placed, by_matrices(lidar, gamma)));
                }
            }
        }
        assert!(worst < 1e-13, "{worst} m");
    }

    /// The reason for f64: the same equations in f32 throughout, degrees included.
    #[test]
    fn f32_equations_are_wrong_by_tens_of_micrometres() {
        let mut worst: f64 = 0.0;
        for gamma in (0..=90).map(|i| -0.5 * f64::from(i) - 0.0015) {
            for azimuth in (0..360).map(|a| f64::from(a) + 0.2) {
                let exact = printed(100.0, Degrees(15.0), Degrees(azimuth), Degrees(gamma));
                let (sin_w, cos_w) = 15.0_f32.to_radians().sin_cos();
                let (sin_a, cos_a) = (azimuth as f32).to_radians().sin_cos();
                let (sin_g, cos_g) = (gamma as f32).to_radians().sin_cos();
                let single = [
                    100.0 * (cos_w * sin_a * cos_g + sin_w * sin_g) + 0.06 * sin_g,
                    100.0 * cos_w * cos_a,
                    100.0 * (sin_w * cos_g - cos_w * sin_a * sin_g) + 0.06 * cos_g,
                ];
                worst = worst.max(distance(exact, single.map(f64::from)));
            }
        }
        assert!((1e-5..1e-4).contains(&worst), "{worst} m");
    }

    #[test]
    fn level_mounts_add_d_and_inverted_mounts_mirror() {
        let level = PAPER.place([1.0, 2.0, 3.0], Tilt::new(Degrees(0.0)));
        assert_eq!(level, [1.0, 2.0, 3.0 + 0.06]);
        let over = PAPER.place([1.0, 2.0, 3.0], Tilt::new(Degrees(180.0)));
        assert!(distance(over, [-1.0, 2.0, -3.06]) < 1e-15, "{over:?}");
    }

    #[test]
    fn at_minus_45_the_lidar_is_left_of_the_axis_and_looks_up_right() {
        let gamma = Tilt::new(Degrees(-45.0));
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let origin = PAPER.place([0.0; 3], gamma);
        assert!(distance(origin, [-0.06 * half, 0.0, 0.06 * half]) < 1e-16);
        let right = PAPER.place([10.0, 0.0, 0.0], gamma);
        let expected = [(10.0 - 0.06) * half, 0.0, (10.0 + 0.06) * half];
        assert!(distance(right, expected) < 1e-14);
    }

    #[test]
    fn arms_are_distances_from_both_axes() {
        for gamma in [-45.0, 0.0, 30.0, 180.0] {
            let tilt = Tilt::new(Degrees(gamma));
            let [from_tilt, from_head] = PAPER.arms_m2(PAPER.place([3.0, 4.0, 12.0], tilt), tilt);
            assert!((from_tilt - (9.0 + 12.06 * 12.06)).abs() < 1e-12);
            assert!((from_head - 25.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_full_rotation_is_the_identity() {
        let point = [70.0, -70.0, 12.0];
        let once = PAPER.place(point, Tilt::new(Degrees(-45.0)));
        let again = PAPER.place(point, Tilt::new(Degrees(-45.0 + 3600.0)));
        assert!(distance(once, again) < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn advancing_a_tilt_equals_adding_the_angles(
            point in prop::array::uniform3(-130.0..130.0),
            gamma in -360.0..360.0,
            ahead_rad in prop::array::uniform4(-MOST_AHEAD_RAD..=MOST_AHEAD_RAD),
        ) {
            let tilt = Tilt::new(Degrees(gamma));
            for ahead in ahead_rad {
                let angle = Degrees(gamma + ahead.to_degrees());
                let expected = PAPER.place(point, Tilt::new(angle));
                let off = distance(PAPER.place(point, tilt.ahead(ahead)), expected);
                prop_assert!(off < 2e-10, "{off} m");
            }
        }

        #[test]
        fn placement_preserves_distances(
            a in prop::array::uniform3(-100.0..100.0),
            b in prop::array::uniform3(-100.0..100.0),
            gamma in -360.0..360.0,
            d in -1.0..1.0,
        ) {
            let mount = Mount::new(Metres(d));
            let tilt = Tilt::new(Degrees(gamma));
            let moved = distance(mount.place(a, tilt), mount.place(b, tilt));
            prop_assert!((moved - distance(a, b)).abs() < 1e-12);
        }
    }
}
