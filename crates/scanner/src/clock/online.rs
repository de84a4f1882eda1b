//! A device's clock while packets come in: Olson's passive algorithm, streaming.
//!
//! E. Olson, "A passive solution to the sensor synchronization problem" (IROS 2010): of all packets
//! so far the one that was late the least tells the clock, its offset allowed to grow by the most
//! that the two clocks can drift apart since; a packet that comes before that replaces it. Cost:
//! constant, in time and memory. On a link of few prompt packets the clock is late by what it may
//! grow until the next of them comes; a whole recording is better served by [`super::DeviceClock`].
//!
//! Time never runs backwards for firings asked for packet by packet: where a prompter packet lowers
//! the offset, the clock runs at half its speed until it is there. It begins anew where the host's
//! clock went back, the device's was set, or nothing has come in time for five seconds (the host's
//! clock went forward); then time may jump, and [`OnlineClock::observe`] says so.

use core::fmt;
use core::marker::PhantomData;

use units::{Lidar, Span, Stamp};

use super::Arrival;
use super::device::span;
use super::segment::{ClockSegment, Moment, OffsetLine};

/// How fast the offset may grow: the clocks drift apart no faster.
const RATE: f64 = 100e-6;
/// How fast the offset may come down.
const CATCH_UP: f64 = 0.5;
/// Stamps that go back by more were not reordered.
const BACK_NS: f64 = 10e6;
/// A gap in device time that the host's clock does not show, or packets all later than this for
/// [`PATIENCE_NS`], are of a clock that was set.
const SET_NS: f64 = 10e6;
const PATIENCE_NS: f64 = 5e9;
/// Intervals between prompt packets that the bound remembers.
const AGES: usize = 32;
/// The bound before they are known.
const UNKNOWN_NS: f64 = 1e9;

/// Follows a device's clock packet by packet.
pub struct OnlineClock<C = Lidar> {
    origin_ns: i64,
    whole: i64,
    state: Option<OnlineState>,
    domain: PhantomData<fn() -> C>,
}

/// All in nanoseconds: x after the origin, y of offset.
#[derive(Clone, Debug)]
struct OnlineState {
    /// The packet that tells the clock.
    held: (f64, f64),
    /// Where the clock was when that was last found: it comes down from there.
    from: (f64, f64),
    last: (f64, f64),
    /// Since when every packet was late by more than a step, and the least lateness since.
    late: Option<(f64, f64)>,
    /// How long packets stayed the held one, in turn.
    ages: [f64; AGES],
    turn: usize,
    median: f64,
}

impl<C> OnlineClock<C> {
    /// A clock that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            origin_ns: 0,
            whole: 0,
            state: None,
            domain: PhantomData,
        }
    }

    /// Takes a packet. Whether the clock began anew with it, because one of the clocks was set; the
    /// first does not count.
    pub fn observe(&mut self, arrival: Arrival<C>) -> bool {
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
        let anew = self.state.is_some();
        self.origin_ns = device;
        self.whole = host.wrapping_sub(device);
        self.state = Some(OnlineState::new());
        anew
    }

    /// The host time at which the device's clock read `device`. `None` before the first packet.
    #[must_use]
    pub fn moment(&self, device: Stamp<C>) -> Option<Moment> {
        let x = self.since_origin(device);
        let line = self.state.as_ref()?.line(x);
        Some(ClockSegment::straight(line, self.whole).moment(device, x))
    }

    /// About the median of how late packets come above the clock.
    #[must_use]
    pub fn residual(&self) -> Span {
        self.state
            .as_ref()
            .map_or(Span::ZERO, |state| span(state.median))
    }

    /// How far off the clock may be now, beyond the constant delay: what it grew, and clocks may
    /// have drifted, in the two longest of the last 32 intervals between prompt packets.
    /// Statistical: it holds at 99 of 100 packets from the first second on; until two such
    /// intervals are known it is a second.
    #[must_use]
    pub fn bound(&self) -> Span {
        span(
            self.state
                .as_ref()
                .map_or(UNKNOWN_NS, OnlineState::bound_ns),
        )
    }

    fn since_origin(&self, device: Stamp<C>) -> f64 {
        device.as_nanos().saturating_sub(self.origin_ns) as f64
    }

    fn point(&self, device: i64, host: i64) -> (f64, f64) {
        let offset = host.wrapping_sub(device).wrapping_sub(self.whole);
        (device.saturating_sub(self.origin_ns) as f64, offset as f64)
    }
}

impl OnlineState {
    fn new() -> Self {
        Self {
            held: (0.0, 0.0),
            from: (0.0, 0.0),
            last: (0.0, 0.0),
            late: None,
            ages: [0.0; AGES],
            turn: 0,
            median: 0.0,
        }
    }

    /// Where the offset may have grown to.
    fn target(&self, x: f64) -> f64 {
        self.held.1 + RATE * (x - self.held.0)
    }

    /// Whether a packet shows that one of the clocks was set.
    fn was_set(&mut self, at: (f64, f64)) -> bool {
        let device = at.0 - self.last.0;
        let host = device + at.1 - self.last.1;
        if host < -BACK_NS || device < -BACK_NS {
            return true;
        }
        // Packets that were held up come close together by the host's clock, never far apart by the
        // device's.
        if device > PATIENCE_NS.min(host + 100.0 * SET_NS) && at.1 < self.target(at.0) - SET_NS {
            return true;
        }
        let late = at.1 - self.target(at.0);
        self.late = (late > SET_NS).then(|| {
            let (since, least) = self.late.unwrap_or((at.0, late));
            (since, least.min(late))
        });
        self.late
            .is_some_and(|(since, _)| at.0 - since > PATIENCE_NS)
    }

    fn follow(&mut self, at: (f64, f64)) {
        let (x, y) = at;
        let late = y - self.target(x);
        let step = 0.02 * self.median + 100.0;
        self.median = (self.median + if late > self.median { step } else { -step }).max(0.0);
        if late < 0.0 {
            let now = x.max(self.last.0);
            self.from = (now, self.offset(now));
            if let Some(age) = self.ages.get_mut(self.turn) {
                *age = (x - self.held.0).max(0.0);
            }
            self.turn = (self.turn + 1) % AGES;
            self.held = at;
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
        let there = self.from.0 + (above / (CATCH_UP + RATE)).max(0.0);
        if x >= there {
            return OffsetLine {
                centre_ns: self.held.0,
                offset_ns: self.held.1,
                slope: RATE,
            };
        }
        // Before it came down the clock ran evenly.
        let slope = if x >= self.from.0 { -CATCH_UP } else { RATE };
        OffsetLine {
            centre_ns: self.from.0,
            offset_ns: self.from.1,
            slope,
        }
    }

    fn bound_ns(&self) -> f64 {
        let mut ages = self.ages;
        ages.sort_unstable_by(f64::total_cmp);
        let grew = match ages.as_slice() {
            [.., second, first] if *second > 0.0 => first + second,
            _ => return UNKNOWN_NS,
        };
        let now = (self.last.0 - self.held.0).max(0.0);
        let coming_down = (self.offset(self.last.0) - self.target(self.last.0)).max(0.0);
        2.0 * RATE * grew.max(now) + coming_down
    }
}

impl<C> Default for OnlineClock<C> {
    fn default() -> Self {
        Self::new()
    }
}

// Derives would ask for `C: Clone` and so on; the clock's name is only a name.
impl<C> Clone for OnlineClock<C> {
    fn clone(&self) -> Self {
        Self {
            origin_ns: self.origin_ns,
            whole: self.whole,
            state: self.state.clone(),
            domain: PhantomData,
        }
    }
}

impl<C> fmt::Debug for OnlineClock<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OnlineClock")
            .field("origin_ns", &self.origin_ns)
            .field("state", &self.state)
            .finish_non_exhaustive()
    }
}
