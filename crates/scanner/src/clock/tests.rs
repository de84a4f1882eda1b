//! The clock of a whole recording.

use proptest::prelude::*;
use units::Stamp;

use super::envelope::lower_hull;
use super::{Arrival, LidarClock};

/// A reproducible stream of numbers in 0..1 (xorshift64*).
struct Noise(u64);
impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }
}

const EPOCH: i64 = 1_795_000_000_000_000_000;

/// Arrivals of a clock that drifts by `ppm`, with exponential delays of `mean_us` and some
/// millisecond spikes.
fn link(seconds: f64, ppm: f64, mean_us: f64) -> Vec<Arrival> {
    let mut noise = Noise(7);
    (0..(seconds / 1.327_104e-3) as i64)
        .map(|i| {
            let device = 1_000_000_000 + i * 1_327_104;
            let late = -mean_us * 1e3 * (1.0 - noise.next()).ln()
                + if noise.next() < 0.01 {
                    5e6 * noise.next()
                } else {
                    0.0
                };
            let host = EPOCH + device + ((i * 1_327_104) as f64 * ppm * 1e-6) as i64;
            Arrival {
                device: Stamp::from_nanos(device),
                host: Stamp::from_nanos(host + late as i64),
            }
        })
        .collect()
}

fn worst_us(seconds: f64, ppm: f64, mean_us: f64) -> f64 {
    let arrivals = link(seconds, ppm, mean_us);
    let clock = LidarClock::fit(&arrivals).unwrap();
    arrivals
        .iter()
        .map(|a| {
            let x = a.device.as_nanos() - 1_000_000_000;
            let truth = EPOCH + a.device.as_nanos() + (x as f64 * ppm * 1e-6) as i64;
            (clock.host(a.device).as_nanos() - truth).abs() as f64 * 1e-3
        })
        .fold(0.0, f64::max)
}

#[test]
fn a_drifting_clock_is_fitted_below_the_noise() {
    for ppm in [-50.0, 0.0, 50.0] {
        let worst = worst_us(45.0, ppm, 66.0);
        assert!(worst < 5.0, "{ppm} ppm: {worst} us");
    }
    assert!(worst_us(600.0, 50.0, 66.0) < 10.0);
}

#[test]
fn one_packet_gives_its_own_offset() {
    let only = Arrival {
        device: Stamp::from_nanos(5),
        host: Stamp::from_nanos(EPOCH),
    };
    let clock = LidarClock::fit(&[only]).unwrap();
    assert_eq!(clock.host(Stamp::from_nanos(5)).as_nanos(), EPOCH);
    assert_eq!(
        clock.host(Stamp::from_nanos(1_005)).as_nanos(),
        EPOCH + 1_000
    );
    assert!(LidarClock::fit(&[]).is_none());
}

#[test]
fn two_packets_give_no_slope_from_jitter() {
    // 1 ms of jitter over one packet would be 750,000 ppm.
    let arrivals = [(0, 0), (1_327_104, 2_327_104)].map(|(device, host)| Arrival {
        device: Stamp::from_nanos(device),
        host: Stamp::from_nanos(EPOCH + host),
    });
    let clock = LidarClock::fit(&arrivals).unwrap();
    assert!(clock.drift_ppm().abs() <= 200.0);
    for a in arrivals {
        assert!(clock.host(a.device) <= a.host);
    }
}

#[test]
fn repeated_device_times_use_the_earliest_arrival() {
    let arrivals = [30, 10, 20].map(|late| Arrival {
        device: Stamp::from_nanos(0),
        host: Stamp::from_nanos(EPOCH + late),
    });
    let clock = LidarClock::fit(&arrivals).unwrap();
    assert_eq!(clock.host(Stamp::from_nanos(0)).as_nanos(), EPOCH + 10);
}

#[test]
fn nanoseconds_survive_the_year_2100() {
    let host = 4_102_444_800_000_000_001;
    let arrivals = [0, 1_327_104].map(|t| Arrival {
        device: Stamp::from_nanos(t),
        host: Stamp::from_nanos(host + t),
    });
    let clock = LidarClock::fit(&arrivals).unwrap();
    assert_eq!(clock.host(Stamp::from_nanos(1)).as_nanos(), host + 1);
}

proptest! {
    #[test]
    fn a_block_line_is_never_above_a_point(
        late in proptest::collection::vec(0i64..20_000_000, 1..200),
    ) {
        let arrivals: Vec<Arrival> = late.iter().enumerate().map(|(i, late)| Arrival {
            device: Stamp::from_nanos(i as i64 * 1_327_104),
            host: Stamp::from_nanos(EPOCH + i as i64 * 1_327_104 + late),
        }).collect();
        let clock = LidarClock::fit(&arrivals).unwrap();
        for a in &arrivals {
            // One nanosecond for rounding.
            prop_assert!(clock.host(a.device).as_nanos() <= a.host.as_nanos() + 1);
        }
    }

    #[test]
    fn the_hull_is_below_its_points_and_convex(
        ys in proptest::collection::vec(-1e6f64..1e6, 1..60),
    ) {
        let points: Vec<(f64, f64)> = ys.iter().enumerate().map(|(i, y)| (i as f64, *y)).collect();
        let hull = lower_hull(&points);
        for w in hull.windows(3) {
            prop_assert!((w[1].1 - w[0].1) / (w[1].0 - w[0].0) < (w[2].1 - w[1].1) / (w[2].0 - w[1].0));
        }
        for p in &points {
            let k = hull.partition_point(|h| h.0 <= p.0).clamp(1, hull.len().max(2) - 1);
            if let (Some(a), Some(b)) = (hull.get(k - 1), hull.get(k)) {
                let y = a.1 + (b.1 - a.1) * (p.0 - a.0) / (b.0 - a.0);
                prop_assert!(y <= p.1 + 1e-6);
            }
        }
    }
}
