//! Changes of the packets' delay whose cause is not known.

use super::*;

/// The delay changed once, near that second and by about so much.
pub fn assert_changed_once(timeline: &Timeline, second: f64, by: i64) {
    let [change] = timeline.delay_changes[..] else {
        panic!("{by}: {:?}", timeline.delay_changes);
    };
    let off = change.by.as_nanos() - by;
    assert!(off.abs() < 20_000 + by.abs() / 10, "{by}: {change:?}");
    let after = change.after.as_secs_f64();
    assert!((after - second).abs() < 0.1, "{by}: {change:?}");
}

/// Neither a busy network nor drift changes the delay.
#[test]
fn a_delay_that_varies_does_not_change() {
    for seconds in [1, 2, 12, 60] {
        for busy in [false, true] {
            let mut recorded = Recorded::new(seconds, Some(2_500));
            if busy {
                recorded = recorded.on_busy_network();
            }
            let changes = recorded.stepped(&[]).timeline().delay_changes;
            assert_eq!(changes, [], "{seconds} s, busy: {busy}");
        }
    }
}

/// A clock that is slewed, a queue that grows, and packets that are late at the beginning or the
/// end are no changes at an instant.
#[test]
fn gradual_and_short_delays_are_no_changes() {
    let slewed =
        |from: i64, to: i64, ppm: i64| move |t: i64| (t.clamp(from, to) - from) / 1_000_000 * ppm;
    let late =
        |from: i64, to: i64, by: i64| move |t: i64| if (from..to).contains(&t) { by } else { 0 };
    type Delay = Box<dyn Fn(i64) -> i64>;
    let delays: [(&str, Delay); 6] = [
        ("500 ppm for 6 s", Box::new(slewed(5 * S, 11 * S, 500))),
        ("300 ppm for 6 s", Box::new(slewed(5 * S, 11 * S, 300))),
        ("1 % for 2 s", Box::new(slewed(8 * S, 10 * S, 10_000))),
        ("the first 60 ms", Box::new(late(0, 60_000_000, 200_000))),
        (
            "the last 60 ms",
            Box::new(late(20 * S - 60_000_000, 20 * S, 200_000)),
        ),
        ("5 s in the middle", Box::new(late(8 * S, 13 * S, 300_000))),
    ];
    for (what, delay) in delays {
        let mut recorded = Recorded::new(20, Some(2_500));
        for packet in &mut recorded.packets {
            packet.host += Span::from_nanos(delay(packet.host.as_nanos() - EPOCH));
        }
        let timeline = recorded.stepped(&[]).timeline();
        assert_eq!(timeline.delay_changes, [], "{what}");
    }
}

/// Least delays that wander by more than a millisecond make no change certain.
#[test]
fn wandering_delays_are_no_changes() {
    for (sd_ns, seed) in [(2e6, 1), (2e6, 2), (2e5, 3), (2e5, 4)] {
        let mut noise = Noise(seed * 7_919);
        let mut wander = 0.0;
        let mut recorded = Recorded::new(60, Some(2_500));
        // A first-order autoregression over 3 s, of uniform numbers.
        let kept = 1.0 - PACKET_NS as f64 / 3e9;
        for packet in &mut recorded.packets {
            let step = (noise.next() - 0.5) * f64::sqrt(12.0 * (1.0 - kept * kept)) * sd_ns;
            wander = kept * wander + step;
            packet.host += Span::from_nanos((4.0 * sd_ns + wander).max(0.0) as i64);
        }
        let timeline = recorded.stepped(&[]).timeline();
        assert_eq!(timeline.delay_changes, [], "{sd_ns} ns, seed {seed}");
    }
}

/// Drift while packets are lost is no change, and times after a step of the host's clock are those
/// of the clock before it.
#[test]
fn lost_packets_and_earlier_steps_do_not_move_a_change() {
    let mut recorded = Recorded::new(20, Some(2_500));
    for packet in &mut recorded.packets {
        let since = packet.device.as_nanos() - EPOCH;
        packet.host += Span::from_nanos(since / 1_000_000 * 170);
    }
    let lost = EPOCH + 9 * S..EPOCH + 9 * S + 450_000_000;
    recorded
        .packets
        .retain(|packet| !lost.contains(&packet.device.as_nanos()));
    assert_eq!(recorded.stepped(&[]).timeline().delay_changes, []);

    let mut recorded = Recorded::new(40, Some(2_500));
    for packet in &mut recorded.packets {
        if packet.host.as_nanos() >= EPOCH + 20 * S {
            packet.host += Span::from_micros(300);
        }
    }
    let timeline = recorded.stepped(&[(10 * S, -3_600 * S)]).timeline();
    assert_changed_once(&timeline, 20.0, 300_000);
}

/// Damaged stamps: the lidar's clock runs backwards, or leaps by half an hour with each packet.
/// There is no spacing to go by then, and no change is certain.
#[test]
fn impossible_stamps_are_no_changes() {
    for leap_ns in [-2 * PACKET_NS, 1_700 * S, -1_700 * S] {
        let mut recorded = Recorded::new(3, Some(2_500));
        for (i, packet) in (0_i64..).zip(&mut recorded.packets) {
            let leaps = if leap_ns.abs() > S { i % 2 } else { i };
            packet.device = Stamp::from_nanos(EPOCH + i * PACKET_NS + leaps * leap_ns);
        }
        let changes = recorded.stepped(&[]).timeline().delay_changes;
        assert_eq!(changes, [], "{leap_ns} ns");
    }
}

/// In a recording of a second, too.
#[test]
fn a_small_step_in_a_short_recording_changes_the_delay() {
    for by in [100_000, 300_000, -100_000, -300_000] {
        let recorded = Recorded::new(1, Some(2_500));
        let timeline = recorded.stepped(&[(S / 2, by)]).timeline();
        assert_eq!(timeline.steps, []);
        assert_changed_once(&timeline, 0.5, by);
    }
}
