//! Scans as ROS 2 messages: clouds, raw packets, the tilt joint, transforms, diagnostics, and the
//! calls and messages of services, actions and parameters. A recording
//! ([`formats::mcap`](crate::formats::mcap)) and a network carry the same bytes.
//!
//! Clouds of a tilting platform are in [`frames::BASE`], the frame of every other format (x right,
//! y forward, z up, on the tilt axis). [`frames::ROOT`] has the same origin and ROS's axes (REP
//! 103: x forward, y left).

pub mod actions;
pub mod cdr;
mod clouds;
mod definitions;
mod diagnostics;
mod joint_state;
pub mod parameters;
mod point_cloud2;
mod transforms;
mod trigger;
mod velodyne_scan;

use units::{Host, Stamp};

use self::cdr::Cdr;

pub(crate) use clouds::MessageSplitter;
pub use clouds::{Cloud, Clouds, MOST_POINTS, MOST_SPAN};
pub use diagnostics::diagnostic_array;
pub use joint_state::joint_state;
pub(crate) use point_cloud2::from_ros;
pub use point_cloud2::{CloudMessage, CloudMessageError, fields_of};
pub use transforms::{Frames, Rotation, Transform, tf_message};
pub use trigger::{TRIGGER, trigger_response};
pub use velodyne_scan::{PACKET_BYTES, VelodyneScan};

/// The names of coordinate frames.
pub mod frames {
    /// The earth around the scanner: x east, y north, z up (REP 103, REP 105). Frame of
    /// georeferenced clouds. Its origin is that of the scanner, as nothing measures the height
    /// above the ellipsoid.
    pub const MAP: &str = "map";
    /// The scanner with ROS's axes: x forward, y left, z up. Frame of clouds.
    pub const ROOT: &str = "base_link";
    /// The tilt axis, which does not tilt: x right, y forward, z up. Frame of clouds in files.
    pub const BASE: &str = "tilt_base";
    /// The tilting platform.
    pub const PLATFORM: &str = "tilt_platform";
    /// The lidar: x right, y forward, z up.
    pub const LIDAR: &str = "lidar";
    /// The lidar with ROS's axes: x forward, y left, z up. Frame of raw packets.
    pub const LIDAR_ROS: &str = "lidar_ros";
}

/// The joint between [`frames::BASE`] and [`frames::PLATFORM`].
pub const TILT_JOINT: &str = "tilt";

/// A message topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// Clouds, one per sweep.
    Points,
    /// Clouds while they are measured, some thousand points each.
    LivePoints,
    /// Raw packets of the lidar, one message per revolution.
    LidarPackets,
    /// The tilt joint, sample by sample.
    JointStates,
    /// The platform against its base.
    Transforms,
    /// Mount and axes of the scanner; latched.
    StaticTransforms,
    /// Quality of the scan.
    Diagnostics,
}

/// A message type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MessageType {
    /// Full name, such as `sensor_msgs/msg/PointCloud2`.
    pub name: &'static str,
    /// Definition with all its parts, in the form `ros2msg`.
    pub definition: &'static str,
    /// Type hash (REP 2016), which subscribers of `rmw_zenoh` match: `RIHS01_` and a SHA-256.
    pub hash: &'static str,
}

impl Topic {
    /// Every topic.
    pub const ALL: [Self; 7] = [
        Self::Points,
        Self::LivePoints,
        Self::LidarPackets,
        Self::JointStates,
        Self::Transforms,
        Self::StaticTransforms,
        Self::Diagnostics,
    ];

    /// Name, the conventional one if there is one.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Points => "/velomotion/points",
            Self::LivePoints => "/velomotion/live_points",
            Self::LidarPackets => "/velomotion/velodyne_packets",
            Self::JointStates => "/joint_states",
            Self::Transforms => "/tf",
            Self::StaticTransforms => "/tf_static",
            Self::Diagnostics => "/diagnostics",
        }
    }

    /// Type of the messages.
    #[must_use]
    pub const fn message_type(self) -> MessageType {
        let (name, definition, hash) = match self {
            Self::Points | Self::LivePoints => (
                "sensor_msgs/msg/PointCloud2",
                definitions::POINT_CLOUD2,
                "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
            ),
            Self::LidarPackets => (
                "velodyne_msgs/msg/VelodyneScan",
                definitions::VELODYNE_SCAN,
                "RIHS01_4e4edd7152e8bd604311d8b2e68e4c1b0771c8ce72700de79f6d1418aa242b3c",
            ),
            Self::JointStates => (
                "sensor_msgs/msg/JointState",
                definitions::JOINT_STATE,
                "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
            ),
            Self::Transforms | Self::StaticTransforms => (
                "tf2_msgs/msg/TFMessage",
                definitions::TF_MESSAGE,
                "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
            ),
            Self::Diagnostics => (
                "diagnostic_msgs/msg/DiagnosticArray",
                definitions::DIAGNOSTIC_ARRAY,
                "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
            ),
        };
        MessageType {
            name,
            definition,
            hash,
        }
    }

    /// Whether the last message is kept for late subscribers (durability "transient local").
    #[must_use]
    pub const fn is_latched(self) -> bool {
        matches!(self, Self::StaticTransforms)
    }
}

/// `builtin_interfaces/Time`: seconds in 32 bits, until 2038.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Time {
    /// Whole seconds since 1970.
    pub sec: i32,
    /// Nanoseconds beyond.
    pub nanosec: u32,
}

/// A time outside the range of ROS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "messages: time {got_ns} ns, expected between 1970 and 2038, as ROS counts seconds in 31 bits"
)]
#[non_exhaustive]
pub struct TimeOutOfRange {
    /// The time, nanoseconds since 1970.
    pub got_ns: i64,
}

impl Time {
    /// A time of the host's clock.
    ///
    /// # Errors
    /// [`TimeOutOfRange`] before 1970 and from 2038 on.
    pub fn of(stamp: Stamp<Host>) -> Result<Self, TimeOutOfRange> {
        let got_ns = stamp.as_nanos();
        let parts = (
            i32::try_from(got_ns.div_euclid(1_000_000_000)),
            u32::try_from(got_ns.rem_euclid(1_000_000_000)),
        );
        match parts {
            (Ok(sec), Ok(nanosec)) if sec >= 0 => Ok(Self { sec, nanosec }),
            _ => Err(TimeOutOfRange { got_ns }),
        }
    }
}

/// `std_msgs/Header`.
fn header(cdr: &mut Cdr, stamp: Time, frame: &str) {
    cdr.i32(stamp.sec);
    cdr.u32(stamp.nanosec);
    cdr.string(frame);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_range_from_1970_to_2038() {
        let of = |ns| Time::of(Stamp::from_nanos(ns));
        assert_eq!(
            of(1_795_226_733_000_000_001),
            Ok(Time {
                sec: 1_795_226_733,
                nanosec: 1
            })
        );
        let last = 0x7FFF_FFFF * 1_000_000_000 + 999_999_999;
        assert!(of(0).is_ok() && of(last).is_ok());
        assert_eq!(of(-1), Err(TimeOutOfRange { got_ns: -1 }));
        assert_eq!(of(last + 1), Err(TimeOutOfRange { got_ns: last + 1 }));
    }

    /// Every type that a definition names is defined in it.
    #[test]
    fn definitions_are_complete() {
        for topic in Topic::ALL {
            let MessageType {
                name, definition, ..
            } = topic.message_type();
            let mut defined = vec![name.replace("/msg/", "/")];
            defined.extend(
                definition
                    .lines()
                    .filter_map(|l| l.strip_prefix("MSG: "))
                    .map(String::from),
            );
            for line in definition.lines() {
                if line.starts_with("MSG: ") || line.starts_with("====") || line.contains('=') {
                    continue;
                }
                let kind = line.split(' ').next().unwrap();
                let kind = kind.split('[').next().unwrap();
                let plain = [
                    "bool", "byte", "uint8", "int32", "uint32", "float64", "string",
                ];
                let known = plain.contains(&kind)
                    || defined
                        .iter()
                        .any(|d| d == kind || d.ends_with(&format!("/{kind}")));
                assert!(known, "{name}: {kind}");
            }
        }
    }
}
