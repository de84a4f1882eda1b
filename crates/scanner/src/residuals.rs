//! Residuals of clock and angle over a recording: what the bounds of a scan rest on.
//!
//! A packet's residual is its delay beyond the clock's lower envelope. A sample's is its deviation
//! from the curve, without the delay that all samples of a sweep share (by least squares), which
//! shifts the curve and shows in no residual.

use units::{Host, Lidar, Span, Stamp};

use crate::angles::AngleSample;
use crate::clock::{Arrival, LidarClock, Moment};
use crate::trajectory::Trajectory;

/// Intervals of a recording: one per pixel or two of a plot.
const INTERVALS: usize = 120;

/// Residuals within one of equal intervals of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ResidualInterval {
    /// Middle of the interval, since the first packet.
    pub at: Span,
    /// Median and greatest delay of its packets; `None` without packets.
    pub delay: Option<(Span, Span)>,
    /// Root mean square and greatest deviation of its samples in sweeps, degrees; `None` without
    /// such samples.
    pub angle_deg: Option<(f64, f64)>,
}

/// Residuals from the first packet to the last: `recorded` are the packets before steps of the
/// host's clock were undone.
pub(crate) fn over_time(
    arrivals: &[Arrival],
    recorded: &[Arrival],
    clock: &LidarClock,
    trajectory: &Trajectory,
    spans: &[(Stamp<Host>, Stamp<Host>)],
) -> Vec<ResidualInterval> {
    let hosts = || arrivals.iter().map(|arrival| arrival.host);
    let (Some(begin), Some(end)) = (hosts().min(), hosts().max()) else {
        return Vec::new();
    };
    let length_ns = end.saturating_since(begin).as_nanos() / INTERVALS as i64 + 1;
    let interval = |host: Stamp<Host>| {
        let number = host
            .saturating_since(begin)
            .as_nanos()
            .div_euclid(length_ns);
        usize::try_from(number)
            .ok()
            .filter(|number| *number < INTERVALS)
    };
    let mut delays: Vec<Vec<Span>> = vec![Vec::new(); INTERVALS];
    for (arrival, recorded) in arrivals.iter().zip(recorded) {
        let sent: Stamp<Lidar> = arrival.device;
        let host = clock.moment_near(sent, Some(recorded.host)).host;
        if let Some(of) = interval(arrival.host).and_then(|number| delays.get_mut(number)) {
            of.push(arrival.host.saturating_since(host));
        }
    }
    let mut angles: Vec<(f64, f64, usize)> = vec![(0.0, 0.0, 0); INTERVALS];
    // A curve through the samples has no residuals.
    let fitted = (!trajectory.fits().is_empty()).then_some(spans);
    for span in fitted.unwrap_or_default() {
        for (host, off_deg) in without_shared_delay(trajectory.samples_within(*span), trajectory) {
            if let Some((squares, most, count)) =
                interval(host).and_then(|number| angles.get_mut(number))
            {
                *squares += off_deg * off_deg;
                *most = most.max(off_deg.abs());
                *count += 1;
            }
        }
    }
    let intervals = delays.into_iter().zip(angles).enumerate();
    let intervals = intervals.map(|(number, (mut delays, (squares, most, count)))| {
        let latest = delays.iter().max().copied();
        let middle = delays.len() / 2;
        let median = latest.map(|_| *delays.select_nth_unstable(middle).1);
        ResidualInterval {
            at: Span::from_nanos(length_ns * number as i64 + length_ns / 2),
            delay: median.zip(latest),
            angle_deg: (count > 0).then(|| ((squares / count as f64).sqrt(), most)),
        }
    });
    intervals.collect()
}

/// Deviations of samples from the curve, degrees, without a delay that all share.
fn without_shared_delay(
    samples: &[AngleSample],
    trajectory: &Trajectory,
) -> Vec<(Stamp<Host>, f64)> {
    let rows = samples.iter().filter_map(|sample| {
        let at = Moment::at(sample.host);
        let off_deg = sample.angle.0 - trajectory.angle(at)?.0;
        let piece = trajectory.piece(at)?;
        Some((sample.host, off_deg, piece.rate(piece.since(at))))
    });
    let rows: Vec<(Stamp<Host>, f64, f64)> = rows.collect();
    let (product, square) = rows.iter().fold((0.0, 0.0), |(product, square), row| {
        (product + row.1 * row.2, square + row.2 * row.2)
    });
    let delay = if square > 0.0 { product / square } else { 0.0 };
    rows.into_iter()
        .map(|(host, off_deg, rate)| (host, off_deg - delay * rate))
        .collect()
}

#[cfg(test)]
mod tests {
    use units::Degrees;

    use super::*;
    use crate::clock::{Joint, Stretch};
    use crate::clock_steps::{ClockSteps, Timeline};
    use crate::trajectory::Method;

    const SECOND: i64 = 1_000_000_000;

    const fn host(ns: i64) -> Stamp<Host> {
        Stamp::from_nanos(ns)
    }

    /// A packet per millisecond for 12 s; in the second half all are 0.4 ms late but one of a
    /// hundred.
    fn packets() -> Vec<Arrival> {
        let packet = |i: i64| {
            let late = if i >= 6_000 && i % 100 != 0 {
                400_000
            } else {
                0
            };
            Arrival {
                device: Stamp::from_nanos(i * 1_000_000),
                host: host(i * 1_000_000 + late),
            }
        };
        (0..12_000).map(packet).collect()
    }

    fn clock(arrivals: &[Arrival]) -> LidarClock {
        let (first, last) = (arrivals[0], arrivals[arrivals.len() - 1]);
        let stretch = Stretch {
            all: arrivals.to_vec(),
            sure: arrivals.to_vec(),
            first: first.device,
            last: last.device,
            join: first.device,
            received: first.host,
        };
        let no_joints: [Joint; 0] = [];
        LidarClock::fit_pieces(&[stretch], &no_joints).unwrap().0
    }

    #[test]
    fn delays_are_those_of_their_time() {
        let arrivals = packets();
        let clock = clock(&arrivals);
        let found = over_time(
            &arrivals,
            &arrivals,
            &clock,
            &Trajectory::fixed(Degrees(0.0)),
            &[],
        );
        assert_eq!(found.len(), INTERVALS);
        for interval in &found {
            let (median, most) = interval.delay.unwrap();
            let at_s = interval.at.as_secs_f64();
            let late = i64::from(at_s > 6.0) * 400_000;
            let apart = |span: Span| (span.as_nanos() - late).abs();
            assert!(apart(median) < 2_000 && apart(most) < 2_000, "{interval:?}");
            assert_eq!(interval.angle_deg, None);
        }
        assert_eq!(
            over_time(&[], &[], &clock, &Trajectory::fixed(Degrees(0.0)), &[]),
            []
        );
    }

    const fn sample(i: i64, late_ms: i64) -> AngleSample {
        let at_s = i as f64 * 2.5e-3;
        AngleSample {
            host: host(i * 2_500_000 + late_ms * 1_000_000),
            bound: Span::from_micros(500),
            angle: Degrees(10.0 * at_s),
        }
    }

    /// Samples that are all late by 2 ms are off by 0.02 deg, one that is late by 6 ms has a
    /// residual.
    #[test]
    fn a_delay_that_all_samples_share_is_no_residual() {
        let curve = Trajectory::through(
            (0..4_800).map(|i| sample(i, 0)).collect(),
            Degrees(0.0015),
            &[],
            Some(Method::Linear),
        );
        let late: Vec<AngleSample> = (400..4_400)
            .map(|i| sample(i, if i == 2_000 { 6 } else { 2 }))
            .collect();
        let found = without_shared_delay(&late, &curve.unwrap());
        assert_eq!(found.len(), 4_000);
        for (at, off_deg) in found {
            let truth = if at == late[1_600].host { -0.04 } else { 0.0 };
            assert!((off_deg - truth).abs() < 1e-3, "{at:?}: {off_deg}");
        }
    }

    /// A curve that connects the samples has their angles.
    #[test]
    fn connected_samples_have_no_residuals() {
        let arrivals = packets();
        let clock = clock(&arrivals);
        let samples = (0..4_800).map(|i| sample(i, 0)).collect();
        let curve = Trajectory::through(samples, Degrees(0.0015), &[], Some(Method::Linear));
        let span = (host(SECOND), host(11 * SECOND));
        let found = over_time(&arrivals, &arrivals, &clock, &curve.unwrap(), &[span]);
        assert!(found.iter().all(|interval| interval.angle_deg.is_none()));
    }

    /// After steps of both clocks a device time occurs twice: the stamp of the recording tells
    /// which.
    #[test]
    fn delays_after_steps_of_both_clocks_are_small() {
        let mut packets = packets();
        packets.truncate(6_000);
        let seen: Vec<Arrival> = packets
            .iter()
            .enumerate()
            .map(|(i, packet)| Arrival {
                device: packet.device - Span::from_secs(if i >= 4_000 { 2 } else { 0 }),
                host: packet.host - Span::from_secs(if i >= 2_000 { 3_600 } else { 0 }),
            })
            .collect();
        let clock_steps = ClockSteps::default();
        let line = Timeline::new(&seen, &[], &clock_steps).unwrap();
        assert_eq!(line.steps.len(), 2);
        let still = Trajectory::fixed(Degrees(0.0));
        for interval in over_time(&line.arrivals, &seen, &line.clock, &still, &[]) {
            let (median, most) = interval.delay.unwrap();
            assert!(
                median.as_nanos().abs() < 20_000 && most.as_nanos().abs() < 20_000,
                "{interval:?}"
            );
        }
    }
}
