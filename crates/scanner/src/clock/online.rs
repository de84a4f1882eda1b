//! Olson's passive synchronisation, streaming.
//!
//! E. Olson, "A passive solution to the sensor synchronization problem" (IROS 2010): the packet
//! with the smallest delay so far defines the clock, and its offset may grow at the greatest drift
//! between the two clocks; a packet below that replaces it. Time and memory per packet are
//! constant. On a link with few prompt packets the error is the growth until the next of them;
//! [`super::DeviceClock`] is more accurate for a whole recording.
//!
//! Time never runs backwards: if a packet lowers the offset, the clock runs at half speed until it
//! has caught up. The clock restarts if the host's clock goes back, the device's clock is set, or
//! no packet is prompt for five seconds (the host's clock went forward). Time may jump then, and
//! [`OnlineClock::observe`] reports it.

use units::{Lidar, Span, Stamp};

use super::Arrival;
use super::device::span;
use super::segment::{ClockSegment, Moment, OffsetLine};

/// Greatest growth of the offset: the greatest drift between two crystals, each within 100 ppm.
const MAX_DRIFT: f64 = 200e-6;
/// Rate at which the offset comes down.
const CATCH_UP: f64 = 0.5;
/// Reordered packets go back by at most this.
const BACK_NS: f64 = 10e6;
/// A gap in device time that the host's clock does not show, or delays above this for
/// [`RESTART_NS`], indicate that a clock was set.
const STEP_NS: f64 = 10e6;
const RESTART_NS: f64 = 5e9;
/// Number of intervals between prompt packets from which the bound follows.
const INTERVALS: usize = 32;
/// Bound before two such intervals are known.
const UNKNOWN_NS: f64 = 1e9;

/// Follows a device's clock packet by packet.
#[derive(Clone, Debug, Default)]
pub struct OnlineClock {
    origin_ns: i64,
    whole: i64,
    state: Option<OnlineState>,
}

/// Nanoseconds: x after the origin, y of offset.
#[derive(Clone, Debug, Default)]
struct OnlineState {
    /// The packet that defines the clock.
    prompt: (f64, f64),
    /// Point from which the clock comes down to that packet's line.
    from: (f64, f64),
    last: (f64, f64),
    /// Beginning of a period in which every delay exceeds a step, and the least delay in it.
    late: Option<(f64, f64)>,
    /// Lengths of the last intervals between prompt packets, as a ring.
    intervals: [f64; INTERVALS],
    next_interval: usize,
}

impl OnlineClock {
    /// Takes a packet. Returns whether the clock restarted because one of the clocks was set.
    pub fn observe(&mut self, arrival: Arrival) -> bool {
        let (device, host) = (arrival.device.as_nanos(), arrival.host.as_nanos());
        if self.state.is_some() {
            let at = self.point(device, host);
            if let Some(state) = &mut self.state
                && !state.was_set(at)
            {
                state.follow(at);
                return false;
            }
        }
        let restarted = self.state.is_some();
        self.origin_ns = device;
        self.whole = host.wrapping_sub(device);
        self.state = Some(OnlineState::default());
        restarted
    }

    /// The host time at which the device's clock read `device`. `None` before the first packet.
    #[must_use]
    pub fn moment(&self, device: Stamp<Lidar>) -> Option<Moment> {
        let x = self.since_origin(device);
        let line = self.state.as_ref()?.line(x);
        Some(ClockSegment::straight(line, self.whole).moment(device, x))
    }

    /// Greatest error of the clock now, without the constant delay: growth and drift over the two
    /// longest of the last 32 intervals between prompt packets. Statistical: it holds at 99 of 100
    /// packets from the first second on; it is 1 s until two such intervals are known.
    #[must_use]
    pub fn bound(&self) -> Span {
        span(
            self.state
                .as_ref()
                .map_or(UNKNOWN_NS, OnlineState::bound_ns),
        )
    }

    fn since_origin(&self, device: Stamp<Lidar>) -> f64 {
        device.as_nanos().saturating_sub(self.origin_ns) as f64
    }

    fn point(&self, device: i64, host: i64) -> (f64, f64) {
        let offset = host.wrapping_sub(device).wrapping_sub(self.whole);
        (device.saturating_sub(self.origin_ns) as f64, offset as f64)
    }
}

impl OnlineState {
    /// Greatest possible offset.
    fn target(&self, x: f64) -> f64 {
        self.prompt.1 + MAX_DRIFT * (x - self.prompt.0)
    }

    /// Whether a packet shows that one of the clocks was set.
    fn was_set(&mut self, at: (f64, f64)) -> bool {
        let device = at.0 - self.last.0;
        let host = device + at.1 - self.last.1;
        if host < -BACK_NS || device < -BACK_NS {
            return true;
        }
        // Delayed packets come close together by the host's clock, never far apart by the device's.
        if device > RESTART_NS.min(host + 100.0 * STEP_NS) && at.1 < self.target(at.0) - STEP_NS {
            return true;
        }
        let late = at.1 - self.target(at.0);
        self.late = (late > STEP_NS).then(|| {
            let (since, least) = self.late.unwrap_or((at.0, late));
            (since, least.min(late))
        });
        self.late
            .is_some_and(|(since, _)| at.0 - since > RESTART_NS)
    }

    fn follow(&mut self, at: (f64, f64)) {
        let (x, y) = at;
        let late = y - self.target(x);
        if late < 0.0 {
            let now = x.max(self.last.0);
            self.from = (now, self.offset(now));
            if let Some(interval) = self.intervals.get_mut(self.next_interval) {
                *interval = (x - self.prompt.0).max(0.0);
            }
            self.next_interval = (self.next_interval + 1) % INTERVALS;
            self.prompt = at;
        }
        self.last = (x.max(self.last.0), y);
    }

    fn offset(&self, x: f64) -> f64 {
        let coming_down = self.from.1 - CATCH_UP * (x - self.from.0).max(0.0);
        coming_down.max(self.target(x))
    }

    /// The line at `x`.
    fn line(&self, x: f64) -> OffsetLine {
        let above = self.from.1 - self.target(self.from.0);
        let there = self.from.0 + (above / (CATCH_UP + MAX_DRIFT)).max(0.0);
        if x >= there {
            return OffsetLine {
                centre_ns: self.prompt.0,
                offset_ns: self.prompt.1,
                slope: MAX_DRIFT,
            };
        }
        // Before it came down the clock ran at the greatest drift.
        let slope = if x >= self.from.0 {
            -CATCH_UP
        } else {
            MAX_DRIFT
        };
        OffsetLine {
            centre_ns: self.from.0,
            offset_ns: self.from.1,
            slope,
        }
    }

    fn bound_ns(&self) -> f64 {
        let mut intervals = self.intervals;
        intervals.sort_unstable_by(f64::total_cmp);
        let grew = match intervals.as_slice() {
            [.., second, first] if *second > 0.0 => first + second,
            _ => return UNKNOWN_NS,
        };
        let now = (self.last.0 - self.prompt.0).max(0.0);
        let coming_down = (self.offset(self.last.0) - self.target(self.last.0)).max(0.0);
        2.0 * MAX_DRIFT * grew.max(now) + coming_down
    }
}
