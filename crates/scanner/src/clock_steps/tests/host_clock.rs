//! Steps of the host's clock.

use super::*;

/// Steps by NTP, a leap second or a user, from 12 ms to a year, both ways, with and without a
/// polled drive.
#[test]
fn a_step_of_the_host_clock_is_found() {
    for poll_us in [Some(2_500), Some(1_000), Some(60_000), None] {
        let recorded = Recorded::new(40, poll_us);
        for by_ms in [
            12,
            30,
            128,
            400,
            1_000,
            1_700,
            3_000,
            60_000,
            3_600_000,
            31_536_000_000,
        ] {
            for by in [by_ms * 1_000_000, -by_ms * 1_000_000] {
                let when = 21 * S + 345_678;
                let seen = recorded.stepped(&[(when, by)]);
                let timeline = seen.timeline();
                let step = only(&timeline);
                assert_eq!(step.clock, SetClock::Host, "{by} {poll_us:?}");
                let off = (step.by.as_nanos() - by).abs();
                assert!(off < 5_000, "{by} by {off} ns, {poll_us:?}");
                let apart = (step.when.as_nanos() - EPOCH - when).abs();
                assert!(apart < 30_000_000, "{by} at {apart} ns, {poll_us:?}");
                let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
                assert!(worst_us < 5.0, "{by}, {poll_us:?}: {worst_us} us");
                // With a poll every 60 ms a pause may hide a smaller step.
                let most = usize::from(poll_us == Some(60_000) && by_ms < 60) * 2;
                assert!(polls_off <= most, "{by}, {poll_us:?}: {polls_off} polls");
            }
        }
    }
}

/// Two steps in one recording add up, and may undo each other.
#[test]
fn two_steps_of_the_host_clock_are_found() {
    let recorded = Recorded::new(60, Some(2_500));
    for (first, second) in [(S, -S), (S, S), (-90 * S, 25_000_000), (-S, -7_200 * S)] {
        let seen = recorded.stepped(&[(20 * S, first), (41 * S, second)]);
        let timeline = seen.timeline();
        let found: Vec<i64> = timeline.steps.iter().map(|s| s.by.as_nanos()).collect();
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - first).abs() < 5_000 && (found[1] - second).abs() < 5_000);
        let apart = timeline.steps[1].when.as_nanos() - EPOCH - 41 * S;
        assert!(apart.abs() < 30_000_000, "{apart}");
        let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
        assert!(
            worst_us < 5.0 && polls_off == 0,
            "{worst_us} us, {polls_off} polls"
        );
    }
}

/// Steps in the first and the last second are found too.
#[test]
fn steps_of_the_host_clock_near_the_ends_are_found() {
    let recorded = Recorded::new(20, Some(2_500));
    for when in [S / 4, S, 19 * S, 19 * S + S / 2] {
        for by in [S, -S] {
            let seen = recorded.stepped(&[(when, by)]);
            let timeline = seen.timeline();
            let step = only(&timeline);
            assert!((step.by.as_nanos() - by).abs() < 10_000, "{step:?}");
            let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
            assert!(
                worst_us < 20.0 && polls_off == 0,
                "{when} {by}: {worst_us} us, {polls_off}"
            );
        }
    }
}

/// While the axis moves at 56.25 deg/s, its positions show steps of the host's clock.
#[test]
fn a_small_step_of_the_host_clock_while_the_axis_moves_is_found() {
    for poll_us in [2_500, 1_000] {
        let recorded = Recorded {
            counts_per_s: 37_500,
            ..Recorded::new(20, Some(poll_us))
        };
        for by in [
            1_200_000, 3_000_000, 6_000_000, -1_200_000, -3_000_000, -6_000_000,
        ] {
            let seen = recorded.stepped(&[(7 * S + 345_678, by)]);
            let timeline = seen.timeline();
            let step = only(&timeline);
            assert_eq!(step.clock, SetClock::Host, "{by}");
            assert!((step.by.as_nanos() - by).abs() < 10_000, "{by}: {step:?}");
            let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
            assert!(
                worst_us < 5.0 && polls_off <= 3,
                "{by}: {worst_us} us, {polls_off}"
            );
        }
    }
}

/// On a quiet network smaller ones are found where polls are quick: here to 0.1 ms.
#[test]
fn a_step_of_the_host_clock_by_a_tenth_of_a_millisecond_is_found() {
    for by in [300_000, -300_000, 500_000, -500_000, 120_000, -120_000] {
        let mut recorded = Recorded {
            counts_per_s: 37_500,
            ..Recorded::new(20, Some(1_000))
        };
        for (request, answer) in &mut recorded.polls {
            *answer = *request + 200_000 + (*answer - *request) / 16;
        }
        let seen = recorded.stepped(&[(7 * S + 345_678, by)]);
        let timeline = seen.timeline();
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Host, "{by}");
        assert!((step.by.as_nanos() - by).abs() < 10_000, "{by}: {step:?}");
        let (worst_us, _) = seen.errors(&timeline, &recorded);
        assert!(worst_us < 5.0, "{by}: {worst_us} us");
    }
}

/// A clock set back puts the records of the drive back, too.
#[test]
fn a_small_step_back_of_the_host_clock_is_found_while_the_axis_rests() {
    let recorded = Recorded::new(20, Some(2_500));
    for by in [-6_000_000, -8_000_000] {
        let seen = recorded.stepped(&[(7 * S + 345_678, by)]);
        let timeline = seen.timeline();
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Host, "{by}");
        let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
        assert!(worst_us < 5.0 && polls_off == 0, "{by}: {worst_us} us");
    }
}

/// A host that sleeps for two seconds, and whose clock is set by a little when it wakes.
#[test]
fn a_small_step_of_the_host_clock_while_it_sleeps_is_found() {
    for by in [1_600_000, 5_000_000, -1_600_000, -5_000_000, 0] {
        let mut recorded = Recorded::new(30, Some(2_500));
        let asleep = EPOCH + 9 * S..EPOCH + 11 * S;
        let is_awake = |host: i64| !asleep.contains(&host);
        recorded.packets.retain(|p| is_awake(p.host.as_nanos()));
        recorded.polls.retain(|poll| is_awake(poll.0));
        let seen = recorded.stepped(&[(10 * S, by)]);
        let timeline = seen.timeline();
        if by == 0 {
            assert_eq!(timeline.steps, []);
            continue;
        }
        let step = only(&timeline);
        assert_eq!(step.clock, SetClock::Host, "{by}");
        assert!((step.by.as_nanos() - by).abs() < 10_000, "{by}: {step:?}");
        let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
        assert!(
            worst_us < 5.0 && polls_off == 0,
            "{by}: {worst_us} us, {polls_off}"
        );
    }
}

/// A host that sleeps and is set by more when it wakes: the drive's records pause for the step and
/// the silence together, which is longer than the step alone.
#[test]
fn a_step_of_the_host_clock_is_found_however_long_the_host_sleeps() {
    for asleep_ms in [200, 600, 950, 2_000, 20_000] {
        for by_ms in [20, 50, 300, 7_200_000, -50, -300, -3_000] {
            let mut recorded = Recorded::new(50, Some(2_500));
            let asleep = EPOCH + 9 * S..EPOCH + 9 * S + asleep_ms * 1_000_000;
            let is_awake = |host: i64| !asleep.contains(&host);
            recorded.packets.retain(|p| is_awake(p.host.as_nanos()));
            recorded.polls.retain(|poll| is_awake(poll.0));
            let seen = recorded.stepped(&[(9 * S + 100_000_000, by_ms * 1_000_000)]);
            let timeline = seen.timeline();
            let step = only(&timeline);
            let what = format!("asleep for {asleep_ms} ms, set by {by_ms} ms");
            assert_eq!(step.clock, SetClock::Host, "{what}");
            let off = (step.by.as_nanos() - by_ms * 1_000_000).abs();
            assert!(off < 10_000, "{what}: {step:?}");
            assert_eq!(step.phantom_packets, 0, "{what}");
            let (worst_us, polls_off) = seen.errors(&timeline, &recorded);
            assert!(
                worst_us < 5.0 && polls_off == 0,
                "{what}: {worst_us} us, {polls_off}"
            );
        }
    }
}

/// The lidar's clock is set while the host sleeps: its stamps leave their grid.
#[test]
fn a_step_of_the_lidar_clock_while_the_host_sleeps_is_its_own() {
    for asleep_ms in [200, 600, 2_000] {
        for by in [50_300_000, 300_300_000, -50_300_000, -300_300_000] {
            let asleep = 9 * S..9 * S + asleep_ms * 1_000_000;
            let is_awake = |host: i64| !asleep.contains(&(host - EPOCH));
            let mut truth = Recorded::new(30, Some(2_500));
            truth.packets.retain(|p| is_awake(p.host.as_nanos()));
            truth.polls.retain(|poll| is_awake(poll.0));
            let mut recorded = Recorded::new(30, Some(2_500)).with_lidar_step(9 * S, by);
            recorded.packets.retain(|p| is_awake(p.host.as_nanos()));
            recorded.polls.retain(|poll| is_awake(poll.0));
            let seen = recorded.stepped(&[]);
            let timeline = seen.timeline();
            let what = format!("asleep for {asleep_ms} ms, lidar set by {by} ns");
            assert_eq!(only(&timeline).clock, SetClock::Lidar, "{what}");
            let (worst_us, polls_off) = seen.errors(&timeline, &truth);
            assert!(
                worst_us < 5.0 && polls_off == 0,
                "{what}: {worst_us} us, {polls_off}"
            );
        }
    }
}
