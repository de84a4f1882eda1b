//! Velodyne packets to firings to returns: models, azimuth, time, hour unwrap, loss, dual return.
//!
//! [`Decoder`] takes the payloads of one sensor in order of arrival and emits [`Firing`]s in order
//! of device time, or, where speed matters, [`FiringBlock`]s: the firings of a block at a time. It
//! never guesses across a gap. [`Timekeeper`] says when packets were fired without decoding them,
//! by the code that the decoder itself uses, so that a first pass over a log agrees with the second
//! to the nanosecond. Beside them: [`FrameCutter`] and [`OrganisedFrame`] (turns of the head),
//! [`UtcClock`] (UTC from position packets), and [`calibration`] (a sensor's own angles from a
//! file). Left out on purpose: host time (a clock model's), the tilt of the platform, and which
//! port or address bytes came from.

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
mod plan;
mod stats;
mod timekeeper;
mod utc;

pub use corrections::{Corrections, LaserCorrection};
pub use decoder::Decoder;
pub use fast::{FiringBlock, Heading, ReturnLayer};
pub use firing::{Duplicates, Echo, Firing, LaserReturn, SensorPoint, azimuth_variance_rad2};
pub use frames::{FrameCutter, LidarFrameError, RevolutionFrame};
pub use options::Options;
pub use organised::{FiringColumn, OrganisedFrame};
pub use stats::{Conflict, Stats};
pub use timekeeper::{PacketTiming, Timekeeper};
pub use utc::{NoUtc, Utc, UtcChange, UtcClock, UtcState};
