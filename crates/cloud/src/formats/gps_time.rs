//! Host (Unix, UTC) time as GPS time, seconds since 1980-01-06 without leap seconds: for E57, and
//! as LAS wants it, adjusted standard GPS time, minus 10^9.
//!
//! Near 2026 an f64 of the adjusted one steps by 0.06 us, four times finer than Unix seconds. The
//! leap seconds are IERS Bulletin C's; none has been announced after that of 2017. A host whose
//! clock smears a leap second is off by up to a second around it.

use units::{Host, Stamp};

use super::seconds::seconds;

const NS_PER_S: i64 = 1_000_000_000;
/// 1980-01-06 00:00:00 UTC.
const GPS_EPOCH_UNIX_S: i64 = 315_964_800;
const ADJUSTMENT_S: i64 = 1_000_000_000;

/// Unix times of leap seconds since the GPS epoch.
const LEAPS_UNIX_S: [i64; 18] = [
    362_793_600,   // 1981-07-01
    394_329_600,   // 1982-07-01
    425_865_600,   // 1983-07-01
    489_024_000,   // 1985-07-01
    567_993_600,   // 1988-01-01
    631_152_000,   // 1990-01-01
    662_688_000,   // 1991-01-01
    709_948_800,   // 1992-07-01
    741_484_800,   // 1993-07-01
    773_020_800,   // 1994-07-01
    820_454_400,   // 1996-01-01
    867_715_200,   // 1997-07-01
    915_148_800,   // 1999-01-01
    1_136_073_600, // 2006-01-01
    1_230_768_000, // 2009-01-01
    1_341_100_800, // 2012-07-01
    1_435_708_800, // 2015-07-01
    1_483_228_800, // 2017-01-01
];

/// GPS time less Unix time, seconds.
fn shift_s(unix_ns: i64) -> i64 {
    let unix_s = unix_ns.div_euclid(NS_PER_S);
    LEAPS_UNIX_S.partition_point(|&start| start <= unix_s) as i64 - GPS_EPOCH_UNIX_S
}

/// Adjusted standard GPS time in seconds.
pub(super) fn adjusted_s(time: Stamp<Host>) -> f64 {
    let unix_ns = time.as_nanos();
    seconds(unix_ns.saturating_add((shift_s(unix_ns) - ADJUSTMENT_S) * NS_PER_S))
}

/// GPS time in seconds: coarser than the adjusted one, but whole seconds are exact.
pub(super) fn gps_s(time: Stamp<Host>) -> f64 {
    let unix_ns = time.as_nanos();
    seconds(unix_ns.saturating_add(shift_s(unix_ns) * NS_PER_S))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_s(unix_s: i64) -> f64 {
        adjusted_s(Stamp::from_nanos(unix_s * NS_PER_S))
    }

    #[test]
    fn the_gps_epoch_is_zero_before_the_adjustment() {
        assert_eq!(at_s(GPS_EPOCH_UNIX_S), -1e9);
    }

    #[test]
    fn gps_time_matches_a_known_instant_of_2018() {
        // 2018-09-18 00:00:00 UTC is GPS week 2019, second 172,818.
        let gps_s = 2019.0 * 604_800.0 + 172_818.0;
        assert_eq!(at_s(1_537_228_800), gps_s - 1e9);
        assert_eq!(
            super::gps_s(Stamp::from_nanos(1_537_228_800 * NS_PER_S)),
            gps_s
        );
    }

    #[test]
    fn the_leap_second_of_2017_adds_a_second() {
        assert_eq!(at_s(1_483_228_800) - at_s(1_483_228_799), 2.0);
        assert!(LEAPS_UNIX_S.is_sorted());
    }

    #[test]
    fn nanoseconds_survive_to_a_tenth_of_a_microsecond() {
        let ns = 1_795_000_000_123_456_789;
        let back = adjusted_s(Stamp::from_nanos(ns)) + 1e9 - 18.0;
        let expected = (ns - GPS_EPOCH_UNIX_S * NS_PER_S) as f64 * 1e-9;
        assert!((back - expected).abs() < 3e-7);
        let step = adjusted_s(Stamp::from_nanos(ns + 100)) - adjusted_s(Stamp::from_nanos(ns));
        assert!((step - 1e-7).abs() < 6e-8, "{step}");
    }

    #[test]
    fn the_ends_of_time_do_not_wrap() {
        assert!(adjusted_s(Stamp::from_nanos(i64::MIN)) < -9e9);
        assert!(adjusted_s(Stamp::from_nanos(i64::MAX)) > 7e9);
    }
}
