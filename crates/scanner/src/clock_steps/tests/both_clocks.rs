//! Steps on busy networks, of both clocks at once, and of the host's clock beside a drive whose
//! samples have its own time.

use super::*;

impl Recorded {
    /// The same behind a network whose delay has three stages of 0.27 ms each.
    pub(super) fn on_busy_network(mut self) -> Self {
        let mut noise = Noise(29);
        let mut last = 0;
        for packet in &mut self.packets {
            let stages = [noise.next(), noise.next(), noise.next()];
            let late: f64 = stages.iter().map(|x| -267e3 * (1.0 - x).ln()).sum();
            last = (packet.host.as_nanos() + late as i64).max(last);
            packet.host = Stamp::from_nanos(last);
        }
        self
    }

    pub(super) fn with_lidar_step(mut self, when: i64, by: i64) -> Self {
        for packet in &mut self.packets {
            if packet.device.as_nanos() >= EPOCH + when {
                packet.device += Span::from_nanos(by);
            }
        }
        self
    }
}

/// The grid of the stamps shows the step, though the delays vary by more; the few packets before it
/// share the line of those after it.
#[test]
fn a_step_of_the_lidar_clock_on_a_busy_network_is_found() {
    for by in [60_000, -60_000, 110_000, -110_000, 1_700_000, -47_400_000] {
        let when = 7 * S / 10;
        let truth = Recorded::new(4, Some(2_500)).on_busy_network();
        let recorded = Recorded::new(4, Some(2_500)).on_busy_network();
        let seen = recorded.with_lidar_step(when, by).stepped(&[]);
        let timeline = seen.timeline();
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Lidar, "{by}");
        assert!((step.by.as_nanos() - by).abs() < 1_500, "{by}: {step:?}");
        let (worst_us, polls_off) = seen.errors(&timeline, &truth);
        let bound_us = timeline.clock.bound().as_secs_f64() * 1e6;
        assert!(worst_us < bound_us && polls_off == 0, "{worst_us} us");
        assert!(bound_us < 130.0, "{bound_us} us");
    }
}

#[test]
fn steps_of_both_clocks_within_some_packets_are_found() {
    for (by_lidar, by_host) in [
        (-141_000, -1_437 * S / 1_000),
        (488_000, -11_100_000),
        (-133_700_000, 325_000_000),
        (9_200_000, 51_000_000),
    ] {
        let truth = Recorded::new(20, Some(2_500));
        let recorded = Recorded::new(20, Some(2_500)).with_lidar_step(9 * S, by_lidar);
        let seen = recorded.stepped(&[(9 * S + 15_000_000, by_host)]);
        let timeline = seen.timeline();
        let found: Vec<(SetClock, i64)> = timeline
            .steps
            .iter()
            .map(|step| (step.clock, step.by.as_nanos()))
            .collect();
        let [(SetClock::Lidar, lidar), (SetClock::Host, host)] = found[..] else {
            panic!("{by_lidar} and {by_host}: {found:?}");
        };
        assert!((lidar - by_lidar).abs() < 1_500, "{by_lidar}: {lidar}");
        assert!((host - by_host).abs() < 10_000, "{by_host}: {host}");
        let (worst_us, polls_off) = seen.errors(&timeline, &truth);
        assert!(worst_us < 6.0 && polls_off == 0, "{worst_us} us");
    }
}

/// SYNCs of 1 kHz and answers that are late by up to two milliseconds. Stamps near a step may be of
/// either clock: no sample may seem to be taken before its SYNC or after its answer.
#[test]
fn samples_with_the_drives_time_enclose_the_truth_across_a_step() {
    for by in [-1_170_000, 1_170_000, -600_000, 7_580_000] {
        let mut noise = Noise(5);
        let mut taken = Vec::new();
        let when = 1_000 * 1_000_000 + 423_000;
        let clock = |at: i64| EPOCH + at + if at >= when { by } else { 0 };
        let samples = (0..2_000i64).map(|i| {
            let sent = i * 1_000_000 + (50e3 * noise.next()) as i64;
            let at = sent + 250_000 + (1e6 * noise.next()) as i64;
            let answer = at + 350_000 + (1e6 * noise.next()) as i64;
            taken.push(EPOCH + at);
            ShaftSample {
                request: Stamp::from_nanos(clock(sent)),
                answer: Stamp::from_nanos(clock(answer)),
                position: Quadcounts(0),
                trigger: SampleTrigger::Sync,
                drive_us: Some((at / 1_000) as u32),
            }
        });
        let mut samples: Vec<ShaftSample> = samples.collect();
        let span = Span::from_nanos(by);
        let around = drive_clock::step(&samples, 990, span).unwrap();
        assert!(around.contains(&1_000) && around.len() < 80, "{around:?}");
        assert_eq!(drive_clock::step(&samples, 500, span), None);
        let from = samples[around.start].request;
        let mut line = HostTimeline::new(&ClockSteps::default());
        line.set(Some(from), span, Some(around));
        line.convert(&mut samples);
        for (sample, taken) in samples.iter().zip(taken) {
            let inside = sample.request.as_nanos() < taken && taken < sample.answer.as_nanos();
            assert!(inside, "{by}: {sample:?} taken at {taken}");
        }
        // All but those near the step are as tight as before.
        let is_wide =
            |s: &&ShaftSample| s.answer.saturating_since(s.request).as_nanos() > 2_700_000;
        assert!(samples.iter().filter(is_wide).count() < 80);
    }
}

/// While the host's clock seems to be earlier than it is, each answer is matched with the SYNC
/// after its own, up to a pause of the SYNCs. The drive's clock drifts by a period meanwhile.
#[test]
fn samples_matched_with_a_later_sync_are_matched_again() {
    const PAUSE: i64 = 3_000;
    for has_pause in [false, true] {
        let sent = |i: i64| i * 1_000_000 + i64::from(has_pause && i >= PAUSE) * 50_000_000;
        let mut noise = Noise(7);
        let samples = (0..12_000i64).map(|i| {
            let at = sent(i) + 250_000 + (600e3 * noise.next()) as i64;
            // The last one before the pause has no later SYNC.
            let later = i64::from(i >= 500 && !(has_pause && i >= PAUSE - 1));
            ShaftSample {
                request: Stamp::from_nanos(EPOCH + sent(i + later)),
                answer: Stamp::from_nanos(EPOCH + at + 1_350_000),
                position: Quadcounts(0),
                trigger: SampleTrigger::Sync,
                drive_us: Some((at / 1_000 - at / 10_000_000) as u32),
            }
        });
        let mut samples: Vec<ShaftSample> = samples.collect();
        drive_clock::rematch(&mut samples, &(498..503));
        for (i, sample) in (0..).zip(&samples) {
            let matched = sample.request.as_nanos() - EPOCH;
            // Of those near the step and after the pause an earlier one may be taken.
            let is_early = (498..504).contains(&i) || (PAUSE..PAUSE + 96).contains(&i);
            let is_earlier = is_early && matched == sent(i - 1);
            assert!(is_earlier || matched == sent(i), "{i}: {matched}");
        }
    }
}
