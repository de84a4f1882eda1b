use proptest::prelude::*;

use super::*;

fn us(us: i64) -> Stamp<Host> {
    Stamp::from_nanos(us * 1_000)
}

/// A matcher that observes from 0 and has matched a single SYNC at 200 ms, whose sample was taken
/// 300 us later.
fn started(device_at_zero: u32) -> SyncMatcher {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    assert_eq!(syncs.earliest_sync(us(0)), us(10_000));
    syncs.handle_sync(us(200_000));
    let device = device_at_zero.wrapping_add(200_300);
    assert_eq!(syncs.handle_pdo(device, us(200_600)), Some(us(200_000)));
    assert_eq!(syncs.earliest_sync(us(200_700)), us(200_700));
    syncs
}

#[test]
fn matching_starts_only_with_a_single_sync() {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_sync(us(9_000));
    assert_eq!(
        syncs.handle_pdo(7, us(9_500)),
        None,
        "its SYNC may precede the log"
    );
    syncs.handle_sync(us(100_000));
    assert_eq!(
        syncs.handle_pdo(8, us(100_500)),
        None,
        "it may belong to the first SYNC"
    );
    syncs.handle_sync(us(200_000));
    assert_eq!(syncs.handle_pdo(9, us(200_500)), Some(us(200_000)));
}

/// The PDO of the first SYNC is not in the log; the second SYNC follows as soon as the client had
/// it.
#[test]
fn matching_starts_with_the_second_sync_if_the_first_pdo_was_dropped() {
    let mut matcher = SyncMatcher::default();
    matcher.observe(us(0));
    matcher.handle_sync(us(200_000));
    matcher.handle_sync(us(200_300));
    assert_eq!(matcher.handle_pdo(1_300, us(200_600)), Some(us(200_300)));
    // A master that does not wait: the PDO may be that of the first SYNC.
    let mut matcher = SyncMatcher::default();
    matcher.observe(us(0));
    matcher.handle_sync(us(200_000));
    matcher.handle_sync(us(201_000));
    assert_eq!(matcher.handle_pdo(1_300, us(201_600)), None);
}

/// An adapter so slow that the second SYNC goes out before the first PDO arrives.
#[test]
fn matching_starts_with_the_first_sync_since_the_pdos_were_enabled() {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_enabled();
    for n in 200..260 {
        syncs.handle_sync(us(1_000 * n));
        let before = 1_000 * (n - 1);
        if n > 200 {
            let matched = syncs.handle_pdo((before + 300) as u32, us(1_000 * n + 500));
            assert_eq!(matched, Some(us(before)));
        }
    }
}

/// The second SYNC follows early by jitter, while the PDO of the first is under way.
#[test]
fn a_sync_that_jitter_sends_early_leaves_the_first_its_pdo() {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_enabled();
    syncs.handle_sync(us(200_000));
    syncs.handle_sync(us(200_400));
    assert_eq!(syncs.handle_pdo(300, us(200_900)), Some(us(200_000)));
    assert_eq!(syncs.handle_pdo(700, us(201_300)), Some(us(200_400)));
}

#[test]
fn matching_needs_a_single_sync_again_if_none_was_answered() {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_enabled();
    for n in 0..200 {
        syncs.handle_sync(us(1_000 * n));
    }
    assert_eq!(syncs.handle_pdo(300, us(199_500)), None);
}

#[test]
fn pdos_after_the_next_sync_are_matched_in_order() {
    let mut syncs = started(0);
    for n in 1..1000 {
        syncs.handle_sync(us(200_000 + 1000 * n));
        if n > 1 {
            let sync = 200_000 + 1000 * (n - 1);
            assert_eq!(
                syncs.handle_pdo((sync + 350) as u32, us(sync + 1_200)),
                Some(us(sync))
            );
        }
    }
}

#[test]
fn after_a_loss_the_lost_sync_is_skipped() {
    let mut syncs = started(0);
    syncs.handle_sync(us(201_000));
    syncs.handle_sync(us(202_000));
    assert_eq!(syncs.handle_pdo(202_300, us(202_600)), Some(us(202_000)));
}

#[test]
fn a_repeated_frame_counts_once() {
    let mut syncs = started(0);
    syncs.handle_sync(us(201_000));
    assert_eq!(syncs.handle_pdo(200_300, us(201_100)), None);
    assert_eq!(syncs.handle_pdo(201_310, us(201_600)), Some(us(201_000)));
}

#[test]
fn a_restarted_drive_is_matched_again() {
    let mut syncs = started(0x8000_0000);
    syncs.handle_sync(us(201_000));
    assert_eq!(syncs.handle_pdo(12, us(201_600)), None);
    assert_eq!(syncs.earliest_sync(us(201_700)), us(301_000));
}

#[test]
fn a_long_pause_restarts_matching_and_a_short_one_does_not() {
    let mut syncs = started(0);
    syncs.handle_sync(us(1_000_000));
    assert_eq!(
        syncs.handle_pdo(1_000_290, us(1_000_500)),
        Some(us(1_000_000))
    );
    assert!(
        syncs.earliest_sync(us(4_000_000)) < us(4_000_000),
        "no SYNC is open"
    );
    syncs.handle_sync(us(4_000_000));
    assert_eq!(syncs.handle_pdo(77, us(4_000_500)), Some(us(4_000_000)));
}

/// The host sleeps for 600 ms, and its clock is set back meanwhile: it shows 20 ms. A bound from
/// before would put every SYNC of the next half second before the sample.
#[test]
fn a_clock_that_was_set_back_moves_no_position_to_a_later_sync() {
    let mut syncs = started(0);
    syncs.handle_sync(us(201_000));
    // The PDO of a SYNC that was not recorded.
    assert_eq!(syncs.handle_pdo(801_300, us(221_600)), Some(us(201_000)));
    for sync in (222_000..400_000).step_by(2_000) {
        syncs.handle_sync(us(sync));
        syncs.handle_sync(us(sync + 1_000));
        for own in [sync, sync + 1_000] {
            let device = (own + 580_300) as u32;
            assert_eq!(syncs.handle_pdo(device, us(own + 1_100)), Some(us(own)));
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Delivery {
    /// From SYNC to sample, and from there to arrival.
    to_drive_us: i64,
    to_host_us: i64,
    lost: bool,
    twice: bool,
    /// The drive, or the delivery to it, is delayed by this before the SYNC.
    stall_us: i64,
}

fn any_delivery() -> impl Strategy<Value = Delivery> {
    (
        60..1_400i64,
        60..900i64,
        prop::bool::weighted(0.03),
        prop::bool::weighted(0.03),
        prop_oneof![30 => Just(0i64), 1 => 0..8_000i64],
    )
        .prop_map(
            |(to_drive_us, to_host_us, lost, twice, stall_us)| Delivery {
                to_drive_us,
                to_host_us,
                lost,
                twice,
                stall_us,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// With any loss, delay and repetition, the sample lies between SYNC and arrival.
    #[test]
    fn a_position_always_lies_between_its_stamps(
        deliveries in proptest::collection::vec(any_delivery(), 1..300),
        drift_ppm in -100..100i64,
        zero in any::<u32>(),
    ) {
        let device = |at: i64| {
            zero.wrapping_add((at + at * drift_ppm / 1_000_000) as u32)
        };
        let mut syncs = started_with_drift(&device);
        // SYNCs and arrivals in order of time.
        let mut events: Vec<(i64, Option<i64>)> = Vec::new();
        let (mut free, mut arrived) = (0, 0);
        for (n, delivery) in (1..).zip(&deliveries) {
            let sync = 200_000 + 1_000 * n;
            events.push((sync, None));
            free = (sync + delivery.to_drive_us + delivery.stall_us).max(free + 40);
            arrived = (free + delivery.to_host_us).max(arrived + 1);
            if !delivery.lost {
                events.push((arrived, Some(free)));
                if delivery.twice {
                    arrived += 100;
                    events.push((arrived, Some(free)));
                }
            }
        }
        events.sort_by_key(|h| h.0);
        let mut given = 0;
        for (at, taken) in events {
            match taken {
                None => syncs.handle_sync(us(at)),
                Some(taken) => {
                    if let Some(sync) = syncs.handle_pdo(device(taken), us(at)) {
                        given += 1;
                        prop_assert!(sync <= us(taken) + SLACK, "{sync:?} {taken}");
                        prop_assert!(us(at) >= us(taken));
                    }
                }
            }
        }
        let sent = deliveries.iter().filter(|delivery| !delivery.lost).count();
        prop_assert_eq!(given, sent, "every PDO that arrived is matched");
    }
}

fn started_with_drift(device: &dyn Fn(i64) -> u32) -> SyncMatcher {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_sync(us(200_000));
    assert_eq!(
        syncs.handle_pdo(device(200_300), us(200_600)),
        Some(us(200_000))
    );
    syncs
}
