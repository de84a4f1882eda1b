//! `tf2_msgs/TFMessage`: poses of frames.

use std::f64::consts::FRAC_1_SQRT_2;

use units::Degrees;

use super::cdr::Cdr;
use super::{Time, frames, header};
use crate::EastNorthUp;
use crate::mount::Mount;

/// A rotation as a unit quaternion x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// x, y, z, w.
    pub quaternion: [f64; 4],
}

impl Rotation {
    /// No rotation.
    pub const NONE: Self = Self {
        quaternion: [0.0, 0.0, 0.0, 1.0],
    };

    /// The tilt by `angle`: about y, positive from z towards x, as in Eq. 4-6
    /// ([`crate::mount::Mount::place`]).
    #[must_use]
    pub fn tilt(angle: Degrees) -> Self {
        let (sin, cos) = (angle.to_radians().0 / 2.0).sin_cos();
        Self {
            quaternion: [0.0, sin, 0.0, cos],
        }
    }

    /// From x right, y forward to ROS's x forward, y left: 90 deg about z.
    #[must_use]
    pub const fn to_ros() -> Self {
        Self {
            quaternion: [0.0, 0.0, -FRAC_1_SQRT_2, FRAC_1_SQRT_2],
        }
    }

    /// From ROS's x forward, y left to x right, y forward.
    #[must_use]
    pub const fn from_ros() -> Self {
        Self {
            quaternion: [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2],
        }
    }
}

/// Pose of a frame in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<'a> {
    /// Reference frame.
    pub parent: &'a str,
    /// Described frame.
    pub child: &'a str,
    /// Its origin, metres.
    pub translation_m: [f64; 3],
    /// Rotation.
    pub rotation: Rotation,
}

/// Names of a scanner's frames: those of [`frames`], with a prefix to tell several scanners apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    root: String,
    base: String,
    platform: String,
    lidar: String,
    lidar_ros: String,
}

impl Default for Frames {
    fn default() -> Self {
        Self::with_prefix("")
    }
}

impl Frames {
    /// The names with `prefix`, such as `left/`.
    #[must_use]
    pub fn with_prefix(prefix: &str) -> Self {
        let name = |name| format!("{prefix}{name}");
        Self {
            root: name(frames::ROOT),
            base: name(frames::BASE),
            platform: name(frames::PLATFORM),
            lidar: name(frames::LIDAR),
            lidar_ros: name(frames::LIDAR_ROS),
        }
    }

    /// Frame of the clouds, [`frames::ROOT`].
    #[must_use]
    pub fn of_clouds(&self) -> &str {
        &self.root
    }

    /// Static transforms: ROS's axes, and for a tilting platform the lidar's mount.
    #[must_use]
    pub fn fixed(&self, mount: Option<Mount>) -> Vec<Transform<'_>> {
        let axes = Transform {
            parent: &self.root,
            child: match mount {
                Some(_) => &self.base,
                None => &self.lidar,
            },
            translation_m: [0.0; 3],
            rotation: Rotation::to_ros(),
        };
        let lidar = mount.map(|mount| Transform {
            parent: &self.platform,
            child: &self.lidar,
            translation_m: mount.position_m(),
            rotation: Rotation {
                quaternion: mount.quaternion(),
            },
        });
        [axes].into_iter().chain(lidar).collect()
    }

    /// Static transform of the scanner on the earth, [`frames::MAP`].
    #[must_use]
    pub fn in_map(&self, axes: EastNorthUp) -> Transform<'_> {
        // Yaw is counterclockwise from x (east), the heading clockwise from y (north).
        let yaw = Degrees(90.0 - axes.heading().0);
        let (sin, cos) = (yaw.to_radians().0 / 2.0).sin_cos();
        Transform {
            parent: frames::MAP,
            child: &self.root,
            translation_m: [0.0; 3],
            rotation: Rotation {
                quaternion: [0.0, 0.0, sin, cos],
            },
        }
    }

    /// Static transform of the frame of raw packets.
    #[must_use]
    pub fn of_packets(&self) -> Transform<'_> {
        Transform {
            parent: &self.lidar,
            child: &self.lidar_ros,
            translation_m: [0.0; 3],
            rotation: Rotation::from_ros(),
        }
    }

    /// Pose of the tilted platform.
    #[must_use]
    pub fn tilted(&self, tilt: Degrees) -> Transform<'_> {
        Transform {
            parent: &self.base,
            child: &self.platform,
            translation_m: [0.0; 3],
            rotation: Rotation::tilt(tilt),
        }
    }
}

/// Transforms at `stamp`.
pub fn tf_message(cdr: &mut Cdr, stamp: Time, transforms: &[Transform<'_>]) {
    cdr.clear();
    cdr.length(transforms.len());
    for transform in transforms {
        header(cdr, stamp, transform.parent);
        cdr.string(transform.child);
        for value in transform.translation_m {
            cdr.f64(value);
        }
        for value in transform.rotation.quaternion {
            cdr.f64(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::point_cloud2::to_ros;
    use crate::mount::Tilt;
    use crate::tests::cdr_reader::Reader;
    use glam::{DQuat, DVec3};
    use units::Metres;

    fn turned(rotation: Rotation, v: [f64; 3]) -> [f64; 3] {
        let quaternion = DQuat::from_array(rotation.quaternion);
        assert!(quaternion.is_normalized());
        quaternion.mul_vec3(DVec3::from_array(v)).to_array()
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn the_tilt_transform_agrees_with_eq_4_to_6() {
        for degrees in [-90.0, -45.0, 0.0, 12.3, 180.0] {
            let placed =
                Mount::new(Metres(0.0)).place([1.0, 2.0, 3.0], Tilt::new(Degrees(degrees)));
            let expected = turned(Rotation::tilt(Degrees(degrees)), [1.0, 2.0, 3.0]);
            assert!(
                close(placed, expected),
                "{degrees}: {placed:?} {expected:?}"
            );
        }
    }

    #[test]
    fn forward_is_x_and_left_is_y_in_ros() {
        // Points are turned as the frames are.
        let point = [1.0, 2.0, 3.0];
        assert!(close(turned(Rotation::to_ros(), point), to_ros(point)));
        assert!(close(
            turned(Rotation::to_ros(), [0.0, 1.0, 0.0]),
            [1.0, 0.0, 0.0]
        ));
        assert!(close(
            turned(Rotation::to_ros(), [-1.0, 0.0, 0.0]),
            [0.0, 1.0, 0.0]
        ));
        // What velodyne_pointcloud places forward is forward of the lidar.
        let packets = Frames::default();
        let packets = packets.of_packets();
        assert_eq!((packets.parent, packets.child), ("lidar", "lidar_ros"));
        assert!(close(
            turned(packets.rotation, [1.0, 0.0, 0.0]),
            [0.0, 1.0, 0.0]
        ));
        assert!(close(
            turned(packets.rotation, [0.0, 1.0, 0.0]),
            [-1.0, 0.0, 0.0]
        ));
    }

    /// A cloud in `map` and one in `base_link` are the same.
    #[test]
    fn the_scanner_on_the_earth_agrees_with_the_axes_of_points() {
        for heading in [-90.0, 0.0, 30.0, 123.4, 270.0] {
            let axes = EastNorthUp::new(Degrees(heading));
            let frames = Frames::default();
            let map = frames.in_map(axes);
            assert_eq!((map.parent, map.child), ("map", "base_link"));
            let point = [1.0, 2.0, 3.0];
            assert!(close(
                turned(map.rotation, to_ros(point)),
                axes.place(point)
            ));
        }
    }

    #[test]
    fn the_prefix_precedes_every_frame_name() {
        let frames = Frames::with_prefix("left/");
        let mut names = vec![frames.of_clouds()];
        let fixed = frames.fixed(Some(Mount::new(Metres(0.06))));
        assert_eq!(fixed[1].translation_m, [0.0, 0.0, 0.06]);
        names.extend(fixed.iter().flat_map(|t| [t.parent, t.child]));
        let tilted = frames.tilted(Degrees(-45.0));
        names.extend([tilted.parent, tilted.child]);
        let all = [
            "base_link",
            "base_link",
            "tilt_base",
            "tilt_platform",
            "lidar",
            "tilt_base",
            "tilt_platform",
        ];
        assert_eq!(names, all.map(|name| format!("left/{name}")));
        assert_eq!(Frames::default().fixed(None)[0].child, "lidar");
    }

    #[test]
    fn transforms_round_trip() {
        let mut cdr = Cdr::new();
        let stamp = Time { sec: 1, nanosec: 2 };
        let mount = Transform {
            parent: "a",
            child: "bcd",
            translation_m: [0.0, 0.5, 0.06],
            rotation: Rotation::NONE,
        };
        tf_message(&mut cdr, stamp, &[mount, mount]);
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!(reader.u32(), 2);
        for _ in 0..2 {
            assert_eq!(reader.header(), (1, 2, "a".to_owned()));
            assert_eq!(reader.string(), "bcd");
            let values: Vec<f64> = (0..7).map(|_| reader.f64()).collect();
            assert_eq!(values, [0.0, 0.5, 0.06, 0.0, 0.0, 0.0, 1.0]);
        }
        assert!(reader.is_done());
    }
}
