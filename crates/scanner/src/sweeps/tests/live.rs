//! Sweeps while they are measured.

use super::*;

/// The spans of the live cloud after each sample.
fn live_spans(axis: &Axis) -> Vec<Vec<(Stamp<Host>, Stamp<Host>)>> {
    let mut live = SweepWatch::new(Gearing::new(500, 120, 1).unwrap());
    let after = |sample: &AngleSample| {
        live.sample(sample, &axis.watch, Some(&PLAN));
        live.spans().to_vec()
    };
    axis.samples.iter().map(after).collect()
}

/// Held for a quarter of a second, the axis goes on to its target: one span, until there.
#[test]
fn a_sweep_goes_on_after_its_head_was_held() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-20.0, 56.25);
    axis.stay(250);
    axis.travel(-25.0, 56.25);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    let spans = live_spans(&axis);
    let &[(start, end)] = spans.last().unwrap().as_slice() else {
        panic!("{:?}", spans.last());
    };
    assert_eq!(start, sweeps[0].start);
    assert!(
        (end - sweeps[0].end).as_nanos().abs() <= 2_000_000,
        "{end:?}"
    );
}

/// Two counts of the encoder take 60 ms.
#[test]
fn the_slowest_sweep_does_not_end_between_two_counts() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-1.0, 0.05);
    for sample in &mut axis.samples {
        sample.angle.0 = (sample.angle.0 / 0.0015).ceil() * 0.0015;
    }
    let moving = axis.samples.len() - 50;
    let spans = live_spans(&axis);
    let open = Stamp::from_nanos(i64::MAX);
    let begun = spans.iter().position(|spans| !spans.is_empty()).unwrap();
    for spans in &spans[begun..moving] {
        assert!(matches!(spans[..], [(_, end)] if end == open), "{spans:?}");
    }
}

/// A drive that restarts stands at zero; what the axis does then is not its sweep.
#[test]
fn a_restarted_drive_does_not_go_on_with_its_sweep() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-20.0, 56.25);
    axis.angle = 0.0;
    axis.stay(200);
    axis.travel(-0.3, 1.0);
    let spans = live_spans(&axis);
    let &[(_, end)] = spans.last().unwrap().as_slice() else {
        panic!("{:?}", spans.last());
    };
    assert!(end < ms(axis.now - 400), "{end:?}");
}
