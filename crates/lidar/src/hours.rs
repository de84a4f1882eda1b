//! Unwrapping of time stamps, which are microseconds past an unknown hour.
//!
//! The first packet takes the hour nearest to the host's clock. A later one continues the hour of
//! the last packet if it is close, and otherwise takes the hour that the host's clock predicts. A
//! decrease alone does not imply a new hour, since reordered packets decrease too.

use units::{Host, Lidar, Span, Stamp};

const HOUR_NS: i64 = 3_600_000_000_000;
/// Within this time of the last packet, 15 packets, the hour continues whatever the host's clock
/// did.
const CONTINUES: Span = Span::from_millis(20);
/// If the clocks disagree by more since the last packet, one of them was set, and the host's clock
/// is not used.
const HOST_TRUST: Span = Span::from_secs(60);
/// Limit of stamps, so that sums with a packet's length do not overflow.
const LIMIT_NS: i64 = i64::MAX - 1_000 * HOUR_NS;

/// Unwraps the timestamps of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct HourUnwrapper {
    last: Option<(Stamp<Lidar>, Stamp<Host>)>,
}

impl HourUnwrapper {
    pub(crate) const fn new() -> Self {
        Self { last: None }
    }

    /// The instant of a packet that is `us` microseconds past an hour and arrived at `host`.
    ///
    /// `us` may exceed an hour: devices wrap late (3600.06 s were recorded).
    pub(crate) fn unwrap(&mut self, us: u32, host: Stamp<Host>) -> Stamp<Lidar> {
        let device = match self.last {
            None => nearest_hour(us, host.as_nanos()),
            Some((device, then)) => {
                let continued = nearest_hour(us, device.as_nanos());
                if distance(continued, device) <= CONTINUES {
                    continued
                } else {
                    let predicted = device.saturating_add(host.saturating_since(then));
                    let by_host = nearest_hour(us, predicted.as_nanos());
                    if distance(by_host, predicted) <= HOST_TRUST {
                        by_host
                    } else {
                        continued
                    }
                }
            }
        };
        self.last = Some((device, host));
        device
    }
}

/// The instant `us` past an hour that is nearest to `target_ns`.
fn nearest_hour(us: u32, target_ns: i64) -> Stamp<Lidar> {
    let past_hour = i64::from(us) * 1_000;
    let target = target_ns.clamp(-LIMIT_NS, LIMIT_NS);
    let hour = (target - past_hour + HOUR_NS / 2).div_euclid(HOUR_NS) * HOUR_NS;
    Stamp::from_nanos(hour + past_hour)
}

/// Distance between two instants.
fn distance(a: Stamp<Lidar>, b: Stamp<Lidar>) -> Span {
    if a < b {
        b.saturating_since(a)
    } else {
        a.saturating_since(b)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HOUR_US: i64 = 3_600_000_000;

    fn host(ns: i64) -> Stamp<Host> {
        Stamp::from_nanos(ns)
    }

    /// Time stamp that the device sends at an instant of its clock.
    fn wire(device_us: i64) -> u32 {
        device_us.rem_euclid(HOUR_US) as u32
    }

    #[test]
    fn the_first_packet_takes_the_nearest_hour() {
        let ten = host(10 * HOUR_NS);
        let us = |u| HourUnwrapper::new().unwrap(u, ten).as_nanos();
        assert_eq!(us(1), 10 * HOUR_NS + 1_000);
        assert_eq!(us(3_599_999_999), 10 * HOUR_NS - 1_000);
        assert_eq!(us(1_799_999_999), 10 * HOUR_NS + 1_799_999_999_000);
        assert_eq!(us(1_800_000_001), 10 * HOUR_NS - 1_799_999_999_000);
    }

    #[test]
    fn a_late_wrap_causes_no_step() {
        // A recorded counter reached 3600.06 s and then returned to 0.061 s.
        let mut hours = HourUnwrapper::new();
        let mut last = None;
        for k in 0..200i64 {
            let past = 3_599_900_000 + 1_327 * k;
            let us = if past <= 3_600_060_000 {
                past
            } else {
                past - HOUR_US
            };
            let at = hours.unwrap(us as u32, host(7 * HOUR_NS + past * 1_000));
            if let Some(last) = last {
                assert_eq!(at - last, Span::from_micros(1_327), "packet {k}");
            }
            last = Some(at);
        }
    }

    #[test]
    fn reordered_packets_across_the_hour_do_not_jump() {
        let mut hours = HourUnwrapper::new();
        let t = 5 * HOUR_NS;
        let order = [3_599_998_000u32, 653, 3_599_999_325, 1_980];
        let at: Vec<i64> = order
            .map(|us| hours.unwrap(us, host(t)).as_nanos() - t)
            .to_vec();
        assert_eq!(at, [-2_000_000, 653_000, -675_000, 1_980_000]);
    }

    #[test]
    fn steps_of_the_host_clock_have_no_effect() {
        for step_s in [-7_200, -3_600, -1_000, 50, 1_000, 1_800, 3_600, 36_000] {
            for gap_us in [1_327, 155_000] {
                // A step of whole hours with a gap is indistinguishable from an outage.
                if gap_us > 20_000 && step_s % 3_600 == 0 {
                    continue;
                }
                let mut hours = HourUnwrapper::new();
                let first = hours.unwrap(500_000_000, host(500_000_000_000));
                let stepped = 500_000_000_000 + (step_s * 1_000_000 + gap_us) * 1_000;
                let second = hours.unwrap(500_000_000 + gap_us as u32, host(stepped));
                assert_eq!(second - first, Span::from_micros(gap_us), "{step_s} s");
            }
        }
    }

    #[test]
    fn a_device_clock_that_is_set_keeps_the_hour() {
        // NMEA sets minutes and seconds of a free-running clock.
        let mut hours = HourUnwrapper::new();
        let first = hours.unwrap(100_000_000, host(100_000_000_000));
        let second = hours.unwrap(900_000_000, host(100_001_327_000));
        assert_eq!(second - first, Span::from_secs(800));
        let third = hours.unwrap(900_001_327, host(100_002_654_000));
        assert_eq!(third - second, Span::from_micros(1_327));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn any_sequence_of_times_is_recovered(
            start_h in -1_000i64..1_000_000,
            before_us in -3_000_000i64..3_000_000,
            steps_us in prop::collection::vec(prop_oneof![
                8 => 1i64..20_000, // packets, some of them lost
                1 => -5_000i64..0, // out of order
                1 => 20_000i64..20_000_000_000, // outages of up to five hours and a half
            ], 1..60),
            delays_us in prop::collection::vec(0i64..20_000, 60),
            drift_ppm in -100i64..100,
        ) {
            let mut hours = HourUnwrapper::new();
            let begin = start_h * HOUR_US + before_us;
            let mut at = begin;
            prop_assert_eq!(hours.unwrap(wire(at), host(at * 1_000)).as_nanos(), at * 1_000);
            for (&step, delay) in steps_us.iter().zip(&delays_us) {
                // An outage of whole hours within 20 ms is indistinguishable from none.
                let whole_hours = step >= 20_000 && (step + 25_000) % HOUR_US <= 50_000;
                at += if whole_hours { step + 60_000 } else { step };
                let arrival = at + (at - begin) * drift_ppm / 1_000_000 + delay;
                let got = hours.unwrap(wire(at), host(arrival * 1_000)).as_nanos();
                prop_assert_eq!(got, at * 1_000);
            }
        }

        #[test]
        fn no_input_overflows(
            packets in prop::collection::vec((any::<u32>(), any::<i64>()), 1..50),
        ) {
            let mut hours = HourUnwrapper::new();
            for (us, at) in packets {
                let got = hours.unwrap(us, host(at)).as_nanos();
                prop_assert_eq!(got.rem_euclid(HOUR_NS), (i64::from(us) * 1_000) % HOUR_NS);
                prop_assert!(got.checked_add(HOUR_NS).is_some() && got.checked_sub(HOUR_NS).is_some());
            }
        }
    }
}
