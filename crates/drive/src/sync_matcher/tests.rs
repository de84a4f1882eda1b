use proptest::prelude::*;

use super::*;

fn us(us: i64) -> Stamp<Host> {
    Stamp::from_nanos(us * 1_000)
}

/// /// A matcher that observes from 0 and has matched a single SYNC at 200 ms, whose sample was
/// taken 300 us later.
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
fn a_beat_that_is_not_alone_begins_nothing() {
    let mut syncs = SyncMatcher::default();
    syncs.observe(us(0));
    syncs.handle_sync(us(9_000));
    assert_eq!(
        syncs.handle_pdo(7, us(9_500)),
        None,
        "to one before the log?"
    );
    syncs.handle_sync(us(100_000));
    assert_eq!(syncs.handle_pdo(8, us(100_500)), None, "or to the first?");
    syncs.handle_sync(us(200_000));
    assert_eq!(syncs.handle_pdo(9, us(200_500)), Some(us(200_000)));
}

#[test]
fn answers_that_come_after_the_next_beat_are_paired_in_order() {
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
fn after_a_loss_the_lost_beat_is_skipped() {
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
fn a_pause_does_not_break_the_chain_and_a_long_one_does() {
    let mut syncs = started(0);
    syncs.handle_sync(us(1_000_000));
    assert_eq!(
        syncs.handle_pdo(1_000_290, us(1_000_500)),
        Some(us(1_000_000))
    );
    assert!(
        syncs.earliest_sync(us(4_000_000)) < us(4_000_000),
        "none is open"
    );
    syncs.handle_sync(us(4_000_000));
    assert_eq!(syncs.handle_pdo(77, us(4_000_500)), Some(us(4_000_000)));
}

#[derive(Clone, Copy, Debug)]
struct Delivery {
    /// /// From SYNC to sample, and from there to arrival.
    forth_us: i64,
    back_us: i64,
    lost: bool,
    twice: bool,
    /// /// The drive, or the way to it, is delayed by this before the SYNC.
    stall_us: i64,
}

fn delivery() -> impl Strategy<Value = Delivery> {
    (
        60..1_400i64,
        60..900i64,
        prop::bool::weighted(0.03),
        prop::bool::weighted(0.03),
        prop_oneof![30 => Just(0i64), 1 => 0..8_000i64],
    )
        .prop_map(|(forth_us, back_us, lost, twice, stall_us)| Delivery {
            forth_us,
            back_us,
            lost,
            twice,
            stall_us,
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// /// With any loss, delay and repetition, the sample lies between SYNC and arrival.
    #[test]
    fn a_position_always_lies_between_its_stamps(
        deliveries in proptest::collection::vec(delivery(), 1..300),
        drift_ppm in -100..100i64,
        zero in any::<u32>(),
    ) {
        let device = |at: i64| {
            zero.wrapping_add((at + at * drift_ppm / 1_000_000) as u32)
        };
        let mut syncs = started_with_drift(&device);
        // // SYNCs and arrivals in order of time.
        let mut events: Vec<(i64, Option<i64>)> = Vec::new();
        let (mut free, mut arrived) = (0, 0);
        for (n, way) in (1..).zip(&deliveries) {
            let sync = 200_000 + 1_000 * n;
            events.push((sync, None));
            free = (sync + way.forth_us + way.stall_us).max(free + 40);
            arrived = (free + way.back_us).max(arrived + 1);
            if !way.lost {
                events.push((arrived, Some(free)));
                if way.twice {
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
        let sent = deliveries.iter().filter(|way| !way.lost).count();
        prop_assert_eq!(given, sent, "none that arrived is thrown away");
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
