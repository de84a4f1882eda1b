use units::Span;

use super::*;

const PLAN: SweepPlan = SweepPlan {
    from_deg: 0.0,
    to_deg: -45.0,
    cruise_deg_s: 56.25,
    accel_deg_s2: 500.0,
    sweeps: 1,
    both_ways: false,
};

fn ms(ms: i64) -> Stamp<Host> {
    Stamp::from_nanos(ms * 1_000_000)
}

/// Samples of an axis that goes to each angle in turn, at `speed` without ramps, 1 s apart.
struct Axis {
    watch: MoveWatch,
    samples: Vec<AngleSample>,
    angle: f64,
    now: i64,
}

impl Axis {
    fn new() -> Self {
        let mut axis = Self {
            watch: MoveWatch::new(Gearing::new(500, 120, 1).unwrap()),
            samples: Vec::new(),
            angle: 0.0,
            now: 0,
        };
        axis.stay(20);
        axis
    }

    fn stay(&mut self, duration: i64) {
        for _ in 0..duration {
            self.samples.push(AngleSample {
                host: ms(self.now),
                bound: Span::ZERO,
                angle: Degrees(self.angle),
            });
            self.now += 1;
        }
    }

    fn command(&mut self, target: f64, word: u16) {
        self.watch
            .wrote(objects::PROFILE_VELOCITY.address, 1_125, ms(self.now));
        let qc = (target / 0.0015).round() as i32;
        self.watch
            .wrote(objects::TARGET_POSITION.address, qc as u32, ms(self.now));
        self.watch
            .wrote(objects::CONTROLWORD.address, 0x000F, ms(self.now));
        self.watch
            .wrote(objects::CONTROLWORD.address, u32::from(word), ms(self.now));
    }

    /// Moves by `way` degrees at `speed` degrees per second, then rests.
    fn travel(&mut self, way: f64, speed: f64) {
        let steps = (way.abs() / speed * 1_000.0).round();
        for _ in 0..steps as i64 {
            self.angle += way / steps;
            self.stay(1);
        }
        self.stay(50);
    }
}

#[test]
fn a_move_between_the_limits_is_a_sweep_with_its_measured_speed() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-45.0, 45.0);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    let [sweep] = sweeps[..] else {
        panic!("{sweeps:?}");
    };
    assert_eq!((sweep.from.0, sweep.to.0.round()), (0.0, -45.0));
    assert!((sweep.cruise.0 + 45.0).abs() < 1e-6, "{sweep:?}");
    assert_eq!(sweep.start, ms(19));
    assert_eq!((sweep.end - sweep.start).as_nanos(), 1_000_000_000);
}

#[test]
fn the_return_move_is_a_sweep_only_if_planned() {
    let mut axis = Axis::new();
    for way in [-45.0, 45.0] {
        axis.command(axis.angle + way, 0x1F);
        axis.travel(way, 45.0);
    }
    assert_eq!(axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen.len(), 1);
    let both_ways = SweepPlan {
        both_ways: true,
        sweeps: 2,
        ..PLAN
    };
    assert_eq!(
        axis.watch
            .sweeps(&axis.samples, Some(&both_ways))
            .seen
            .len(),
        2
    );
    assert_eq!(axis.watch.sweeps(&axis.samples, None).seen.len(), 2);
}

#[test]
fn moves_to_the_start_and_homing_are_not_sweeps() {
    let mut axis = Axis::new();
    axis.angle = -10.0;
    axis.stay(20);
    axis.watch.wrote(objects::MODE.address, 6, ms(axis.now));
    axis.command(-45.0, 0x1F);
    axis.travel(10.0, 45.0);
    axis.watch.wrote(objects::MODE.address, 1, ms(axis.now));
    axis.command(-20.0, 0x1F);
    axis.travel(-20.0, 45.0);
    axis.command(-45.0, 0x1F);
    axis.travel(-25.0, 45.0);
    assert!(
        axis.watch
            .sweeps(&axis.samples, Some(&PLAN))
            .seen
            .is_empty()
    );
}

#[test]
fn the_approach_from_the_far_end_is_never_a_sweep() {
    let plan = SweepPlan {
        from_deg: -45.0,
        to_deg: 0.0,
        both_ways: true,
        ..PLAN
    };
    let mut axis = Axis::new();
    for way in [-45.0, 45.0, -45.0] {
        axis.command(axis.angle + way, 0x1F);
        axis.travel(way, 45.0);
    }
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&plan)).seen;
    assert_eq!(sweeps.len(), 1, "{sweeps:?}");
    assert!(sweeps[0].cruise.0 > 0.0, "{sweeps:?}");
}

#[test]
fn an_interrupted_sweep_ends_at_the_angle_it_reached() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-12.0, 45.0);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    assert!((sweeps[0].to.0 + 12.0).abs() < 1e-9, "{sweeps:?}");
}

#[test]
fn a_drive_that_lost_its_position_ends_the_sweep() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-20.0, 45.0);
    let known = axis.now;
    axis.angle = 0.0;
    axis.stay(100);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    assert!((sweeps[0].to.0 + 20.0).abs() < 1e-9, "{sweeps:?}");
    assert!(sweeps[0].end < ms(known), "{sweeps:?}");
}

#[test]
fn an_axis_at_rest_has_no_sweep() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.stay(100);
    assert!(
        axis.watch
            .sweeps(&axis.samples, Some(&PLAN))
            .seen
            .is_empty()
    );
    assert!(axis.watch.sweeps(&[], Some(&PLAN)).seen.is_empty());
}

#[test]
fn encoder_flicker_at_rest_does_not_start_a_sweep() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    for i in 0..40 {
        axis.angle = if i % 2 == 0 { 0.0 } else { 0.0015 };
        axis.stay(1);
    }
    axis.angle = 0.0;
    axis.travel(-45.0, 45.0);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    assert_eq!((sweeps[0].end - sweeps[0].start).as_nanos(), 1_000_000_000);
}

/// The command alone would place its points.
#[test]
fn a_sweep_between_two_samples_is_not_seen() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-45.0, 45.0);
    // All but the first degree.
    let silence = ms(45)..ms(1_020);
    axis.samples
        .retain(|sample| !silence.contains(&sample.host));
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    let [(from, to)] = found.unseen[..] else {
        panic!("{found:?}")
    };
    assert!(found.seen.is_empty() && from.0 == 0.0 && (to.0 + 45.0).abs() < 1e-9);
    // It was the planned one.
    axis.command(0.0, 0x1F);
    axis.travel(45.0, 45.0);
    let again = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    assert_eq!(again, found);
}

#[test]
fn a_sweep_whose_beginning_was_not_recorded_begins_with_the_samples() {
    let mut axis = Axis::new();
    axis.command(-45.0, 0x1F);
    axis.travel(-45.0, 45.0);
    axis.samples.retain(|sample| sample.host > ms(120));
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    let [sweep] = sweeps[..] else {
        panic!("{sweeps:?}");
    };
    assert!((sweep.from.0 + 4.5).abs() < 0.1, "{sweep:?}");
    assert_eq!(sweep.start, ms(121));
}
