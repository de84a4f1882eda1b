//! Clock of a device against the host's clock: a lower envelope under the packet arrivals.
//!
//! A packet never arrives before it is complete, and some packets arrive with almost no delay. The
//! lower edge of (arrival - device time) is therefore the clock; everything above it is delay of
//! the network and the operating system. [`DeviceClock`] is fitted to a whole recording
//! (`envelope`), [`OnlineClock`] follows packets as they arrive. The smallest delay (cable,
//! interrupt: tens of microseconds) cannot be observed and stays in the result.
//! [`crate::clock_steps`] finds clocks that are set in mid-recording.

mod device;
mod endpoint;
mod envelope;
mod online;
mod segment;
mod stretches;

pub use device::DeviceClock;
pub use online::OnlineClock;
pub use segment::Moment;
pub(crate) use segment::{ClockSegment, ROUND_TO_INTEGER, round};
pub(crate) use stretches::{Joint, Stretch};

use units::{Host, Lidar, Stamp};

/// Arrival of one packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival<C = Lidar> {
    /// Device time of the packet; for a lidar, of its first firing.
    pub device: Stamp<C>,
    /// Earliest time at which the packet can have left: host receive time less the time to fill it.
    pub host: Stamp<Host>,
}

/// Maps lidar time to host time.
pub type LidarClock = DeviceClock<Lidar>;

#[cfg(test)]
mod tests;
