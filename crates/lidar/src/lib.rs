//! Decoding of Velodyne packets into firings and returns.
//!
//! [`Decoder`] takes the payloads of one sensor in order of arrival. It emits [`Firing`]s in order
//! of device time, or [`FiringBlock`]s, the firings of a block together, which are faster. It does
//! not extrapolate across gaps. [`Timekeeper`] gives packet times without decoding, by the same
//! code.
//!
//! [`FrameCutter`] and [`OrganisedFrame`] split revolutions, [`UtcClock`] derives UTC from position
//! packets, and [`calibration`] reads a sensor's own angles from a file. Times are device times.
//!
//! ```
//! use lidar::{Decoder, Options};
//! use units::Stamp;
//!
//! // A data packet of a VLP-16 (manual 9.3.2) with one return per channel at 1 m.
//! let mut payload = [0; 1206];
//! for (n, block) in (0..).zip(payload.chunks_exact_mut(100)) {
//!     let azimuth_cdeg = 40 * n as u16;
//!     block[..2].copy_from_slice(&[0xFF, 0xEE]);
//!     block[2..4].copy_from_slice(&azimuth_cdeg.to_le_bytes());
//!     for channel in block[4..].chunks_exact_mut(3) {
//!         channel[..2].copy_from_slice(&500_u16.to_le_bytes());
//!     }
//! }
//! payload[1204..].copy_from_slice(&[0x37, 0x22]); // strongest return, VLP-16
//!
//! let mut points = 0;
//! let mut decoder = Decoder::new(Options::default());
//! let arrival = Stamp::from_nanos(0);
//! decoder.packet(arrival, &payload, &mut |firing| points += firing.points().count());
//! decoder.finish(&mut |firing| points += firing.points().count());
//! assert_eq!(points, 384);
//! ```

mod block_timing;
pub mod calibration;
mod continuity;
mod corrections;
mod decoder;
mod fast;
mod firing;
mod frames;
mod geometry;
mod hours;
mod identify;
mod options;
mod organised;
mod stats;
mod timekeeper;
mod utc;

pub use corrections::{Corrections, LaserCorrection};
pub use decoder::Decoder;
pub use fast::{FiringBlock, Heading, ReturnLayer};
pub use firing::{Duplicates, Firing, LaserReturn, ReturnKind, SensorPoint, azimuth_variance_rad2};
pub use frames::{FrameCutter, LidarFrameError, RevolutionFrame};
pub use identify::is_dual;
pub use options::Options;
pub use organised::{FiringColumn, OrganisedFrame};
pub use stats::{ModelConflict, PacketGap, Stats};
pub use timekeeper::{PacketTiming, Timekeeper};
pub use utc::{NoUtc, Utc, UtcChange, UtcClock, UtcState};
