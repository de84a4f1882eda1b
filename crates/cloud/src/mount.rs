//! Pose of the lidar on the tilt axis: Eq. 4-6 of "Analysis of 3D Scan Measurement Distribution
//! with Application to a Multi-Beam Lidar on a Rotating Platform" (2018).
//!
//! Frames are x right, y forward, z up. The platform turns about Y. The paper's lidar is upright at
//! height d above that axis; a [`Mount`] may also shift and rotate it: p = Ry(g) (T + M p_v).
//! Everything is f64: in f32 these equations are wrong by tens of micrometres at 100 m, as a test
//! below measures.

use units::{Degrees, Metres, Real};

/// Pose of the lidar on the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    position_m: [f64; 3],
    rotation_deg: [f64; 3],
    /// Rows of the rotation matrix.
    rotation: [[f64; 3]; 3],
    /// Neither rotated nor shifted sideways: Eq. 4-6 as printed, without further products.
    is_upright: bool,
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

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Mount {
    /// An upright mount with the lidar's origin `d` above the tilt axis (negative below it).
    #[must_use]
    pub const fn new(d: Metres) -> Self {
        Self {
            position_m: [0.0, 0.0, d.0],
            rotation_deg: [0.0; 3],
            rotation: IDENTITY,
            is_upright: true,
        }
    }

    /// A mount with the lidar's origin at `position_m` on the level platform, rotated about the
    /// platform's x, then y, then z.
    #[must_use]
    pub fn at(position_m: [f64; 3], rotation_deg: [f64; 3]) -> Self {
        let upright = Self::new(Metres(position_m[2]));
        if position_m[..2] == [0.0; 2] && rotation_deg == [0.0; 3] {
            return upright;
        }
        let [(sx, cx), (sy, cy), (sz, cz)] = rotation_deg.map(|deg| deg.to_radians().sin_cos());
        Self {
            position_m,
            rotation_deg,
            rotation: [
                [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
                [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
                [-sy, cy * sx, cy * cx],
            ],
            is_upright: false,
        }
    }

    /// Position of the lidar's origin on the level platform, metres from the tilt axis.
    #[must_use]
    pub const fn position_m(&self) -> [f64; 3] {
        self.position_m
    }

    /// Rotation about the platform's x, then y, then z, degrees.
    #[must_use]
    pub const fn rotation_deg(&self) -> [f64; 3] {
        self.rotation_deg
    }

    /// The rotation as a unit quaternion x, y, z, w.
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let half = |deg: f64| (0.5 * deg).to_radians().sin_cos();
        let [(sx, cx), (sy, cy), (sz, cz)] = self.rotation_deg.map(half);
        [
            sx * cy * cz - cx * sy * sz,
            cx * sy * cz + sx * cy * sz,
            cx * cy * sz - sx * sy * cz,
            cx * cy * cz + sx * sy * sz,
        ]
    }

    /// A point of the lidar's frame (Eq. 1-3, metres) in the frame of the platform's base, whose
    /// origin is on the tilt axis (Eq. 4-6, metres).
    ///
    /// With x_v, y_v, z_v of Eq. 1-3 the paper's equations read x = x_v cos g + (z_v + d) sin g, y
    /// = y_v, z = (z_v + d) cos g - x_v sin g.
    #[inline(always)]
    #[must_use]
    pub fn place<V: Real>(&self, position_m: [V; 3], tilt: Tilt<V>) -> [V; 3] {
        let [x, y, height] = self.on_platform(position_m);
        [
            x * tilt.cos + height * tilt.sin,
            y,
            height * tilt.cos - x * tilt.sin,
        ]
    }

    /// A point of the lidar's frame (metres) in the frame of the platform, which tilts with it.
    #[inline(always)]
    #[must_use]
    pub fn on_platform<V: Real>(&self, position_m: [V; 3]) -> [V; 3] {
        let [x, y, z] = position_m;
        if self.is_upright {
            return [x, y, z + self.position_m[2]];
        }
        let along = |axis: usize| {
            let row = &self.rotation[axis];
            x * row[0] + y * row[1] + z * row[2] + self.position_m[axis]
        };
        [along(0), along(1), along(2)]
    }

    /// A placed point (metres) in the lidar's frame: the inverse of [`Mount::place`].
    #[must_use]
    pub fn in_lidar_frame(&self, placed_m: [f64; 3], tilt: Tilt) -> [f64; 3] {
        let [x, y, z] = placed_m;
        let [px, py, pz] = self.position_m;
        let across = x * tilt.cos - z * tilt.sin - px;
        let from = [across, y - py, z * tilt.cos + x * tilt.sin - pz];
        if self.is_upright {
            return from;
        }
        let rows = &self.rotation;
        let along = |axis: usize| {
            from[0] * rows[0][axis] + from[1] * rows[1][axis] + from[2] * rows[2][axis]
        };
        [along(0), along(1), along(2)]
    }

    /// Squared distances of a placed point (Eq. 4-6, metres) from the tilt axis and from the
    /// lidar's spin axis: the lever arms of tilt and azimuth errors.
    #[inline(always)]
    #[must_use]
    pub fn arms_m2<V: Real>(&self, placed_m: [V; 3], tilt: Tilt<V>) -> [V; 2] {
        let [x, y, z] = placed_m;
        let from_tilt_axis = x * x + z * z;
        // Back into the frame of the platform, where an upright spin axis is z.
        let across = x * tilt.cos - z * tilt.sin;
        if self.is_upright {
            return [from_tilt_axis, across * across + y * y];
        }
        let up = z * tilt.cos + x * tilt.sin;
        let [px, py, pz] = self.position_m;
        let (from_x, from_y, from_z) = (across + -px, y + -py, up + -pz);
        let along = |axis: usize| {
            let rows = &self.rotation;
            from_x * rows[0][axis] + from_y * rows[1][axis] + from_z * rows[2][axis]
        };
        let (x, y) = (along(0), along(1));
        [from_tilt_axis, x * x + y * y]
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DMat4, DQuat, DVec3};
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
        let d = PAPER.position_m()[2];
        [
            range_m * (cos_w * sin_a * cos_g + sin_w * sin_g) + d * sin_g,
            range_m * cos_w * cos_a,
            range_m * (sin_w * cos_g - cos_w * sin_a * sin_g) + d * cos_g,
        ]
    }

    /// Eq. 4-6 by composing matrices: lift by d, then rotate about Y.
    fn by_matrices(position_m: [f64; 3], gamma: Degrees) -> [f64; 3] {
        let matrix = DMat4::from_rotation_y(gamma.to_radians().0)
            * DMat4::from_translation(DVec3::new(0.0, 0.0, PAPER.position_m()[2]));
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

    /// Old configurations have a height alone: their clouds must not change by a bit.
    #[test]
    fn a_mount_with_a_height_alone_is_upright() {
        assert_eq!(Mount::at([0.0, 0.0, 0.06], [0.0; 3]), PAPER);
        assert_ne!(Mount::at([0.0, 1e-9, 0.06], [0.0; 3]), PAPER);
        assert_ne!(Mount::at([0.0, 0.0, 0.06], [0.0, 0.0, 1e-9]), PAPER);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn general_mounts_compose_rotations_about_x_then_y_then_z(
            point in prop::array::uniform3(-130.0..130.0),
            position in prop::array::uniform3(-1.0..1.0),
            rotation in prop::array::uniform3(-180.0..180.0),
            gamma in -90.0..90.0,
        ) {
            let mount = Mount::at(position, rotation);
            let [x, y, z] = rotation.map(f64::to_radians);
            let turned = DMat3::from_rotation_z(z)
                * DMat3::from_rotation_y(y)
                * DMat3::from_rotation_x(x);
            let on_platform = turned * DVec3::from_array(point) + DVec3::from_array(position);
            let tilt = DMat3::from_rotation_y(f64::to_radians(gamma));
            let placed = mount.place(point, Tilt::new(Degrees(gamma)));
            prop_assert!(distance(placed, (tilt * on_platform).to_array()) < 1e-12);
            let by_quaternion = DQuat::from_array(mount.quaternion()) * DVec3::from_array(point);
            prop_assert!(distance(by_quaternion.to_array(), (turned * DVec3::from_array(point)).to_array()) < 1e-12);
            let [from_tilt, from_spin] = mount.arms_m2(placed, Tilt::new(Degrees(gamma)));
            let tilt_arm = on_platform.x * on_platform.x + on_platform.z * on_platform.z;
            prop_assert!((from_tilt - tilt_arm).abs() < 1e-9);
            prop_assert!((from_spin - (point[0] * point[0] + point[1] * point[1])).abs() < 1e-9);
            let back = mount.in_lidar_frame(placed, Tilt::new(Degrees(gamma)));
            prop_assert!(distance(back, point) < 1e-12);
        }

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
