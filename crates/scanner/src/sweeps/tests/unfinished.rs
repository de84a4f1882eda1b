//! Sweeps whose end no sample shows.

use super::*;

/// The drive's positions end while the axis moves. One that was stopped on the way rests there.
#[test]
fn a_sweep_whose_samples_end_in_motion_is_unfinished() {
    for (way, rests, unfinished) in [(-45.0, true, 0), (-20.0, true, 0), (-20.0, false, 1)] {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.travel(way, 45.0);
        if !rests {
            axis.samples.truncate(axis.samples.len() - 50);
        }
        let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        assert_eq!(found.seen.len(), 1, "{way}");
        assert!((found.seen[0].to.0 - way).abs() < 1e-6, "{found:?}");
        assert_eq!(found.unfinished.len(), unfinished, "{way}, rests: {rests}");
    }
}
