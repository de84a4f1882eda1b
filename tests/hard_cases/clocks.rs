//! Clocks that are set or restarted, and times that make arithmetic hard.

use scanner::clock::{Arrival, LidarClock, OnlineClock};
use scanner::clock_steps::SetClock;
use sim::Attachment;
use units::{Host, Lidar, Span, Stamp};
use velomotion_tests::capture::{Captured, Setting};

/// The middle of the usual setting's sweep, which follows homing.
fn mid_sweep(setting: Setting) -> Span {
    let (begin, end) = Captured::new(setting).sweep_span();
    begin.saturating_since(setting.start) + (end - begin).half()
}

/// NTP sets the host's clock during the sweep. Half of the packets and polls carry stamps of
/// another clock, and the pairing of requests and answers sees time run back. The cloud must be as
/// accurate as usual.
#[test]
fn a_step_of_the_host_clock_in_mid_sweep_is_corrected() {
    for attached in [Attachment::Usb, Attachment::Rs232, Attachment::Can] {
        let usual = Setting::over(attached);
        let (undisturbed, points) = {
            let captured = Captured::new(usual);
            (captured.error(), captured.cloud().len())
        };
        let middle = mid_sweep(usual);
        for by_ms in [20, 128, 1_000, 2_500, 61_000, 5_000_000] {
            for by in [Span::from_millis(by_ms), Span::from_millis(-by_ms)] {
                let setting = Setting {
                    host_set: Some((middle, by)),
                    ..usual
                };
                let captured = Captured::new(setting);
                let (scan, cloud) = captured.scan();
                let printed = format!("{attached:?} {} s", by.as_secs_f64());
                let [step] = scan.sync.steps[..] else {
                    panic!("{printed}: {:?}", scan.sync.steps);
                };
                assert_eq!(step.clock, SetClock::Host, "{printed}");
                assert!(
                    (step.by_s - by.as_secs_f64()).abs() < 50e-6,
                    "{printed}: {step:?}"
                );
                let when = step.when_s - (setting.start + middle).as_secs_f64();
                assert!(when.abs() < 10e-3, "{printed}: {step:?}");
                let warned = scan
                    .contents
                    .warnings
                    .iter()
                    .filter(|w| w.contains("host's clock was set"));
                assert_eq!(warned.count(), 1, "{printed}: {:?}", scan.contents.warnings);
                let error = captured.error();
                assert!(
                    cloud.len().abs_diff(points) < 2_000,
                    "{printed}: {} points",
                    cloud.len()
                );
                assert!(
                    error.worst_m < undisturbed.worst_m * 1.2 + 1e-3
                        && error.rms_m < undisturbed.rms_m * 1.1,
                    "{printed}: {error:?}, undisturbed {undisturbed:?}"
                );
                assert!(cloud.time().is_sorted(), "{printed}");
            }
        }
    }
}

/// A leap second sets the clock back at midnight UTC: 2016-12-31 23:59:60, the latest so far,
/// during the sweep.
#[test]
fn a_leap_second_in_mid_scan_is_corrected() {
    let midnight = Stamp::<Host>::from_nanos(1_483_228_800_000_000_000);
    let middle = mid_sweep(Setting::default());
    let setting = Setting {
        start: midnight - middle,
        host_set: Some((middle, Span::from_secs(-1))),
        ..Setting::default()
    };
    let captured = Captured::new(setting);
    let error = captured.error();
    assert!(error.worst_m < 10e-3 && error.points > 180_000, "{error:?}");
    assert!(captured.cloud().time().is_sorted());
    let info = velomotion::commands::info::run(&velomotion::cli::Info {
        files: vec![captured.log()],
        model: None,
    });
    let text = info.unwrap().text;
    assert!(
        text.contains("the host's clock was set back by 1.0000"),
        "{text}"
    );
}

/// The first pulse per second sets the lidar's clock back, so that its times repeat within the
/// sweep; or the clock restarts. Host times and angles stay the same.
#[test]
fn a_step_of_the_lidar_clock_in_mid_sweep_is_corrected() {
    let middle = mid_sweep(Setting::default());
    for by_us in [300_700_123, 137_001, -137_001, -412_345_000] {
        let by = Span::from_micros(by_us);
        let setting = Setting {
            lidar_set: Some((middle, by)),
            ..Setting::default()
        };
        let captured = Captured::new(setting);
        let (scan, cloud) = captured.scan();
        let [step] = scan.sync.steps[..] else {
            panic!("{by_us}: {:?}", scan.sync.steps);
        };
        assert_eq!(step.clock, SetClock::Lidar, "{by_us}");
        assert!(
            (step.by_s - by.as_secs_f64()).abs() < 1e-3,
            "{by_us}: {step:?}"
        );
        assert!(cloud.time().is_sorted(), "{by_us}");
        // The simulator's times are those of the clock before it was set.
        let (mut last, mut set) = (None::<Stamp<Lidar>>, false);
        let truth = |time: Stamp<Lidar>, laser| {
            let went = last.map_or(Span::ZERO, |last| time - last);
            set |= (went - by).as_nanos().abs() < 10_000_000;
            last = Some(time);
            let unset = if set { time - by } else { time };
            captured.truth().point(unset.as_nanos(), laser)
        };
        let error = analysis::truth::compare(&cloud, truth).unwrap();
        assert!(
            error.worst_m < 10e-3 && error.points > 180_000,
            "{by_us}: {error:?}"
        );
    }
}

/// Both clocks are set in one recording.
#[test]
fn steps_of_both_clocks_are_corrected() {
    let middle = mid_sweep(Setting::default());
    let setting = Setting {
        host_set: Some((middle - Span::from_millis(300), Span::from_secs(-1))),
        lidar_set: Some((middle + Span::from_millis(100), Span::from_secs(700))),
        ..Setting::default()
    };
    let (scan, cloud) = Captured::new(setting).scan();
    let clocks: Vec<_> = scan.sync.steps.iter().map(|step| step.clock).collect();
    assert_eq!(clocks, [SetClock::Host, SetClock::Lidar]);
    assert!(cloud.time().is_sorted() && cloud.len() > 180_000);
}

fn arrival(device: i64, host: i64) -> Arrival {
    Arrival {
        device: Stamp::from_nanos(device),
        host: Stamp::from_nanos(host),
    }
}

/// 2100-01-01 in nanoseconds needs 62 bits, a double has 53: conversion to one costs half a
/// microsecond.
#[test]
fn clocks_are_exact_in_the_year_2100() {
    const EPOCH: i64 = 4_102_444_800_000_000_001;
    let arrivals: Vec<Arrival> = (0..40_000)
        .map(|i| i * 1_327_104)
        .map(|t| arrival(t, EPOCH + t + t / 25_000))
        .collect();
    let clock = LidarClock::fit(&arrivals).unwrap();
    let mut online = OnlineClock::default();
    for a in &arrivals {
        online.observe(*a);
        assert!((clock.host(a.device) - a.host).as_nanos().abs() <= 1);
    }
    let last = arrivals.last().unwrap();
    let moment = online.moment(last.device).unwrap();
    assert!((moment.host - last.host).as_nanos().abs() < 50_000);
}

/// Identical stamps have no slope: the earliest arrival counts.
#[test]
fn packets_of_one_instant_give_a_clock() {
    let arrivals = [30, 10, 20].map(|late| arrival(0, late));
    let clock = LidarClock::fit(&arrivals).unwrap();
    assert_eq!(clock.host(Stamp::from_nanos(0)).as_nanos(), 10);
    assert_eq!(clock.drift_ppm(), 0.0);
    // A thousand identical stamps have no spread.
    let clock = LidarClock::fit(&[arrival(5, 7); 1_000]).unwrap();
    assert_eq!(clock.host(Stamp::from_nanos(5)).as_nanos(), 7);
    assert!(clock.bound() < Span::from_millis(1));
}

/// One packet gives an offset. Two must not give a drift of 1000 ppm out of jitter, and the bound
/// shows how little is known.
#[test]
fn one_packet_and_two_packets_give_a_clock() {
    let one = LidarClock::fit(&[arrival(5, 1_000)]).unwrap();
    assert_eq!(one.host(Stamp::from_nanos(1_005)).as_nanos(), 2_000);
    let two = LidarClock::fit(&[arrival(0, 0), arrival(1_327_104, 2_327_104)]).unwrap();
    assert!(two.drift_ppm().abs() <= 200.0);
    for clock in [one, two] {
        assert!(
            clock.bound() >= Span::from_millis(100),
            "{:?}",
            clock.bound()
        );
    }
    assert!(LidarClock::fit(&[]).is_none());
}

/// Packets that overtake each other are the same packets.
#[test]
fn packets_out_of_order_do_not_affect_the_clock() {
    let in_order: Vec<Arrival> = (0..20_000)
        .map(|i| arrival(i * 1_327_104, i * 1_327_104 + i * i % 40_000))
        .collect();
    let mut shuffled = in_order.clone();
    for some in shuffled.chunks_mut(5) {
        some.reverse();
    }
    let (a, b) = (
        LidarClock::fit(&in_order).unwrap(),
        LidarClock::fit(&shuffled).unwrap(),
    );
    let mut online = OnlineClock::default();
    for a in &shuffled {
        assert!(!online.observe(*a));
    }
    for i in (0..20_000).step_by(77) {
        let device = Stamp::from_nanos(i * 1_327_104);
        assert_eq!(a.moment(device), b.moment(device));
    }
    let device = Stamp::from_nanos(20_000 * 1_327_104);
    let apart = online.moment(device).unwrap().host - a.host(device);
    assert!(apart.as_nanos().abs() < 40_000, "{apart:?}");
}

/// Two crystals may differ by 200 ppm: the online clock follows the faster one.
#[test]
fn the_online_clock_follows_two_crystals_at_their_limits() {
    for ppm in [-200, 200] {
        let mut online = OnlineClock::default();
        let mut worst = 0;
        for i in 0..40_000i64 {
            let device = i * 1_327_104;
            let host = device + device / 1_000_000 * ppm;
            online.observe(arrival(device, host + i * 7_919 % 60_000));
            let moment = online.moment(Stamp::from_nanos(device)).unwrap();
            // The first packets are late.
            if i > 1_000 {
                worst = worst.max((moment.host.as_nanos() - host).abs());
            }
        }
        assert!(worst < 100_000, "{ppm} ppm: {worst} ns");
    }
}

/// Online, a clock that was set is detected: at once if time runs back, within five seconds if it
/// jumps forward.
#[test]
fn the_online_clock_starts_again() {
    for (device_by, host_by, within) in [
        (0, -1_000_000_000, 1),
        (0, -50_000_000, 1),
        (0, 1_000_000_000, 5_000_000_000 / 1_327_104 + 2),
        (-400_000_000, 0, 1),
        (800_000_000_000, 0, 1),
    ] {
        let mut online = OnlineClock::default();
        let mut noticed = None;
        for i in 0..20_000i64 {
            let (mut device, mut host) = (i * 1_327_104, i * 1_327_104 + i * 7_919 % 60_000);
            if i >= 9_000 {
                (device, host) = (device + device_by, host + host_by);
            }
            if online.observe(arrival(device, host)) {
                assert!(noticed.is_none(), "{device_by} {host_by}: twice");
                noticed = Some(i - 9_000);
            }
        }
        let noticed = noticed.unwrap();
        assert!(
            (0..within).contains(&noticed),
            "{device_by} {host_by}: {noticed}"
        );
        let device = Stamp::from_nanos(20_000 * 1_327_104 + device_by);
        let off = online.moment(device).unwrap().host.as_nanos() - 20_000 * 1_327_104 - host_by;
        assert!((0..60_000).contains(&off), "{device_by} {host_by}: {off}");
    }
}
