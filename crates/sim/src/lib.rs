//! Scenes, ray casting, the tilted lidar and ground truth: both devices of the scanner in one
//! virtual world.
//!
//! [`Rig`] runs both devices with the drive's firmware, driven by bytes and time; [`Truth`] tells
//! where every beam met the scene. [`simulate`] runs whole scenes for every lidar model as fast as
//! possible, without the drive's firmware. Both make packets by the same computation. Effects
//! ([`effects`]) are absent unless configured, and cost nothing then.
//!
//! The geometry is stated independently, as a composition of rigid motions, and nothing of the
//! scanner's code is used, so that agreement is evidence. There is no I/O, no clock and no global
//! randomness: time and seeds are arguments, and one seed gives one result.
//!
//! ```
//! use sim::{DATA_PORT, Rig, RigConfig};
//! use units::{Span, Stamp};
//!
//! let start = Stamp::from_nanos(1_790_000_000_000_000_000);
//! let mut rig = Rig::new(RigConfig::new(start));
//! rig.advance(start + Span::from_millis(10));
//! let datagram = rig.poll_datagram().ok_or("no datagram in 10 ms")?;
//! assert_eq!((datagram.port, datagram.payload.len()), (DATA_PORT, 1206));
//! let first_laser = rig.truth().point(1_234_567_890_000, 0);
//! assert!(first_laser.is_some());
//! # Ok::<(), &str>(())
//! ```

pub mod cast;
#[cfg(feature = "effects")]
pub mod effect_models;
pub mod effects;
pub mod firing;
mod gear_ripple;
mod lidar_clock;
pub mod motion;
pub mod packet_clock;
mod packet_maker;
pub mod patterns;
pub mod random;
mod rig;
mod scene;
#[cfg(feature = "effects")]
pub mod scene_file;
pub mod scenery;
pub mod sensor;
pub mod simulate;

pub use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT};
pub use gear_ripple::GearRipple;
pub use packet_maker::{HeadRotation, TruePoint};
pub use rig::{Attachment, Datagram, DriveOutput, DriveServer, Rig, RigConfig, RigLidar, Truth};
pub use scene::{Scene, SceneHit};
