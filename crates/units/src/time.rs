//! Instants of three clocks, and the spans between two instants of one clock.

use core::cmp::Ordering;
use core::fmt;
use core::hash::{Hash, Hasher};
use core::marker::PhantomData;
use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

/// The lidar's clock: microseconds of the hour on the wire, unwrapped to nanoseconds here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lidar {}

/// The tilt drive's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {}

/// The host's clock (`CLOCK_REALTIME`): nanoseconds since 1970-01-01 UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {}

/// An instant of clock `C` in nanoseconds since that clock's epoch.
///
/// Stamps of different clocks do not compare or subtract; only a clock model converts between them.
pub struct Stamp<C> {
    ns: i64,
    clock: PhantomData<fn() -> C>,
}

/// A signed duration in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    ns: i64,
}

impl<C> Stamp<C> {
    /// The instant `ns` nanoseconds after the clock's epoch.
    #[must_use]
    pub const fn from_nanos(ns: i64) -> Self {
        Self {
            ns,
            clock: PhantomData,
        }
    }

    /// Nanoseconds since the clock's epoch.
    #[must_use]
    pub const fn as_nanos(self) -> i64 {
        self.ns
    }

    /// Seconds since the clock's epoch; for display and files (0.24 us per ulp in 2026).
    #[must_use]
    pub fn as_secs_f64(self) -> f64 {
        self.ns as f64 * 1e-9
    }

    /// This instant moved by `span`, saturating.
    #[must_use]
    pub const fn saturating_add(self, span: Span) -> Self {
        Self::from_nanos(self.ns.saturating_add(span.ns))
    }

    /// The time from `earlier` to this instant, saturating.
    #[must_use]
    pub const fn saturating_since(self, earlier: Self) -> Span {
        Span::from_nanos(self.ns.saturating_sub(earlier.ns))
    }
}

impl Span {
    /// The empty span.
    pub const ZERO: Self = Self { ns: 0 };

    /// A span of nanoseconds.
    #[must_use]
    pub const fn from_nanos(ns: i64) -> Self {
        Self { ns }
    }

    /// A span of microseconds.
    #[must_use]
    pub const fn from_micros(us: i64) -> Self {
        Self::from_nanos(us * 1_000)
    }

    /// A span of milliseconds.
    #[must_use]
    pub const fn from_millis(ms: i64) -> Self {
        Self::from_nanos(ms * 1_000_000)
    }

    /// A span of whole seconds.
    #[must_use]
    pub const fn from_secs(s: i64) -> Self {
        Self::from_nanos(s * 1_000_000_000)
    }

    /// A span of `s` seconds, rounded to the nearest nanosecond, saturating.
    #[must_use]
    pub fn from_secs_f64(s: f64) -> Self {
        let ns = s * 1e9;
        let half = if ns >= 0.0 { 0.5 } else { -0.5 };
        Self::from_nanos((ns + half) as i64)
    }

    /// Nanoseconds.
    #[must_use]
    pub const fn as_nanos(self) -> i64 {
        self.ns
    }

    /// Seconds.
    #[must_use]
    pub fn as_secs_f64(self) -> f64 {
        self.ns as f64 * 1e-9
    }

    /// Microseconds.
    #[must_use]
    pub fn as_micros_f64(self) -> f64 {
        self.ns as f64 * 1e-3
    }

    /// The sum of the two spans, saturating.
    #[must_use]
    pub const fn saturating_add(self, other: Self) -> Self {
        Self::from_nanos(self.ns.saturating_add(other.ns))
    }

    /// The difference of the two spans, saturating.
    #[must_use]
    pub const fn saturating_sub(self, other: Self) -> Self {
        Self::from_nanos(self.ns.saturating_sub(other.ns))
    }

    /// Half of the span, towards zero.
    #[must_use]
    pub const fn half(self) -> Self {
        Self::from_nanos(self.ns / 2)
    }
}

// Derives would require `C: Clone`; `C` is only a marker.
impl<C> Clone for Stamp<C> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<C> Copy for Stamp<C> {}
impl<C> PartialEq for Stamp<C> {
    fn eq(&self, other: &Self) -> bool {
        self.ns == other.ns
    }
}
impl<C> Eq for Stamp<C> {}
impl<C> PartialOrd for Stamp<C> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl<C> Ord for Stamp<C> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.ns.cmp(&other.ns)
    }
}
impl<C> Hash for Stamp<C> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.ns.hash(state);
    }
}
impl<C> fmt::Debug for Stamp<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ns", self.ns)
    }
}

impl<C> Add<Span> for Stamp<C> {
    type Output = Self;
    fn add(self, span: Span) -> Self {
        Self::from_nanos(self.ns + span.ns)
    }
}
impl<C> AddAssign<Span> for Stamp<C> {
    fn add_assign(&mut self, span: Span) {
        self.ns += span.ns;
    }
}
impl<C> Sub<Span> for Stamp<C> {
    type Output = Self;
    fn sub(self, span: Span) -> Self {
        Self::from_nanos(self.ns - span.ns)
    }
}
impl<C> SubAssign<Span> for Stamp<C> {
    fn sub_assign(&mut self, span: Span) {
        self.ns -= span.ns;
    }
}
impl<C> Sub for Stamp<C> {
    type Output = Span;
    fn sub(self, earlier: Self) -> Span {
        Span::from_nanos(self.ns - earlier.ns)
    }
}
impl Add for Span {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::from_nanos(self.ns + other.ns)
    }
}
impl Sub for Span {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::from_nanos(self.ns - other.ns)
    }
}
impl Neg for Span {
    type Output = Self;
    fn neg(self) -> Self {
        Self::from_nanos(-self.ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_stay_exact_in_the_year_2100() {
        // 2100-01-01 UTC; an f64 of seconds would have 0.48 us per ulp here.
        let t = Stamp::<Host>::from_nanos(4_102_444_800_000_000_001);
        assert_eq!((t + Span::from_nanos(1)) - t, Span::from_nanos(1));
    }

    #[test]
    fn seconds_round_to_the_nearest_nanosecond_on_both_sides_of_zero() {
        assert_eq!(
            Span::from_secs_f64(1.000_000_000_6).as_nanos(),
            1_000_000_001
        );
        assert_eq!(Span::from_secs_f64(-0.3).as_nanos(), -300_000_000);
        assert_eq!(Span::from_secs_f64(f64::INFINITY).as_nanos(), i64::MAX);
    }

    #[test]
    fn saturation_does_not_wrap() {
        let end = Stamp::<Lidar>::from_nanos(i64::MAX);
        assert_eq!(end.saturating_add(Span::from_secs(1)), end);
        let most = Span::from_nanos(i64::MAX);
        assert_eq!(most.saturating_add(Span::from_secs(1)), most);
        let least = Span::from_nanos(i64::MIN);
        assert_eq!(least.saturating_sub(Span::from_secs(1)), least);
        let start = Stamp::<Lidar>::from_nanos(i64::MIN);
        assert_eq!(end.saturating_since(start).as_nanos(), i64::MAX);
    }
}
