//! Scenes, ray casting, the tilted lidar and what truly happened: both devices of the scanner in one virtual world.
//!
//! [`Rig`] makes the bytes that the devices would send, [`Truth`] keeps where every beam really met the scene. The
//! geometry is stated here in its own way, by composing rigid motions, and nothing of the scanner's own code is used,
//! so that the two agreeing is evidence. There is no I/O, no clock and no global randomness: time and seeds are
//! arguments, and one seed gives one result.
//!
//! [`simulate`] is the other way to make bytes: whole scenes, every model of lidar, as fast as the machine goes, without the firmware of the
//! drive. [`effects`] are absent unless asked for, and cost nothing then.

mod attached;
pub mod cast;
mod clock;
pub mod effects;
mod head;
pub mod link;
pub mod motion;
pub mod packet_clock;
pub mod patterns;
pub mod random;
mod rig;
mod scene;
#[cfg(feature = "effects")]
pub mod scene_file;
pub mod scenery;
pub mod scenes;
pub mod sensor;
mod shaft;
pub mod simulate;
mod spinning;
mod truth;
mod world;

pub use attached::Attached;
pub use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT};
pub use head::{Head, LASERS, Laser, MAX_RANGE_M, MIN_RANGE_M};
pub use rig::{Datagram, LidarConfig, Rig, RigConfig, Sent};
pub use scene::{Hit, Scene};
pub use truth::Truth;
