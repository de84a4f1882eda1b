//! A device's clock against the host's: a lower envelope under the arrival times.
//!
//! A packet never arrives before it is complete, and some packet always arrives almost at once, so
//! the lower edge of (arrival - device time) is the clock; everything above it is the network and
//! the operating system. [`DeviceClock`] is fitted to a whole recording (`envelope`). The smallest
//! delay itself (a cable, an interrupt: tens of microseconds) is invisible to timing and stays in
//! the result. Clocks that are set in mid-recording are told apart in [`crate::steps`].

mod device;
mod endpoint;
mod envelope;
mod online;
mod segment;

pub use device::DeviceClock;
pub(crate) use device::Stretch;
pub use online::OnlineClock;
pub use segment::Moment;
pub(crate) use segment::{ClockSegment, ROUND_TO_INTEGER, round};

use units::{Host, Lidar, Stamp};

/// One packet as a clock sees it.
#[derive(Debug)]
pub struct Arrival<C = Lidar> {
    /// Device time of the packet: of a lidar's, of its first firing.
    pub device: Stamp<C>,
    /// When the packet could first have left: host receive time less the time the packet took to
    /// fill.
    pub host: Stamp<Host>,
}

// Derives would ask for `C: Clone` and so on; the clock is only a name.
impl<C> Clone for Arrival<C> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<C> Copy for Arrival<C> {}
impl<C> PartialEq for Arrival<C> {
    fn eq(&self, other: &Self) -> bool {
        (self.device, self.host) == (other.device, other.host)
    }
}
impl<C> Eq for Arrival<C> {}

/// Maps lidar time to host time.
pub type LidarClock = DeviceClock<Lidar>;

#[cfg(test)]
mod tests;
