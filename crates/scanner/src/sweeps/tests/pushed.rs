//! Heads that are pushed.

use super::*;

/// A push of most of a short sweep's way between two samples hides none of it.
#[test]
fn a_short_sweep_whose_head_was_pushed_is_seen() {
    let mut axis = Axis::new();
    axis.command(-1.6, 0x1F);
    let go = |axis: &mut Axis| {
        for _ in 0..500 {
            axis.angle -= 0.0016;
            axis.stay(1);
        }
    };
    go(&mut axis);
    for push in [-1.3, 1.3] {
        axis.now += 9;
        axis.angle += push;
        axis.stay(1);
    }
    go(&mut axis);
    axis.stay(50);
    let plan = SweepPlan {
        to_deg: -1.6,
        ..PLAN
    };
    let found = axis.watch.sweeps(&axis.samples, Some(&plan));
    let [sweep] = found.seen[..] else {
        panic!("{found:?}");
    };
    assert!((sweep.to.0 + 1.6).abs() < 1e-9, "{sweep:?}");
}
