use units::Span;

use super::*;

mod hours;
mod live;
mod pushed;
mod unfinished;

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

/// Held for a quarter of a second, the axis catches up at many times the speed of its sweep.
#[test]
fn a_slow_sweep_goes_on_after_its_head_was_held() {
    let mut axis = Axis::new();
    axis.command_partly(&Written {
        speed: Some(20),
        ..WHOLE
    });
    axis.travel(-20.0, 1.0);
    axis.stay(250);
    axis.travel(-0.5, 120.0);
    axis.travel(-24.5, 1.0);
    let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN)).seen;
    assert!((sweeps[0].to.0 + 45.0).abs() < 1e-6, "{sweeps:?}");
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

/// Settings of a move; `None` leaves its write out of the log.
struct Written {
    target: Option<f64>,
    is_read_back: bool,
    speed: Option<u32>,
    word: Option<u16>,
}

const WHOLE: Written = Written {
    target: Some(-45.0),
    is_read_back: false,
    speed: Some(1_125),
    word: Some(0x1F),
};

impl Axis {
    fn write(&mut self, address: Address, value: u32) {
        self.watch.wrote(address, value, ms(self.now));
    }

    fn command_partly(&mut self, written: &Written) {
        let qc = |target: f64| (target / 0.0015).round() as i32 as u32;
        self.write(objects::MODE.address, 1);
        if let Some(speed) = written.speed {
            self.write(objects::PROFILE_VELOCITY.address, speed);
        }
        if let Some(target) = written.target {
            self.write(objects::TARGET_POSITION.address, qc(target));
        }
        if written.is_read_back {
            let now = ms(self.now);
            self.watch
                .read(objects::TARGET_POSITION.address, qc(-45.0), now);
        }
        self.write(objects::CONTROLWORD.address, 0x0F);
        if let Some(word) = written.word {
            self.write(objects::CONTROLWORD.address, u32::from(word));
        }
    }
}

/// A recorder that falls behind drops requests.
#[test]
fn a_sweep_whose_command_lacks_a_request_is_found_by_its_samples() {
    let partly = [
        (
            "start",
            Written {
                word: None,
                ..WHOLE
            },
        ),
        (
            "target",
            Written {
                target: None,
                ..WHOLE
            },
        ),
        (
            "speed",
            Written {
                speed: None,
                ..WHOLE
            },
        ),
        (
            "target and start",
            Written {
                target: None,
                word: None,
                ..WHOLE
            },
        ),
    ];
    let mut whole = Axis::new();
    whole.stay(60);
    whole.command_partly(&WHOLE);
    whole.travel(-45.0, 45.0);
    let expected = whole.watch.sweeps(&whole.samples, Some(&PLAN));
    assert!(expected.inferred.is_empty() && expected.seen.len() == 1);
    for (missing, written) in partly {
        let mut axis = Axis::new();
        axis.stay(60);
        axis.command_partly(&written);
        axis.travel(-45.0, 45.0);
        let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        let (&[sweep], &[known]) = (&found.seen[..], &expected.seen[..]) else {
            panic!("{missing}: {found:?}");
        };
        assert_eq!(
            (sweep.start, sweep.end),
            (known.start, known.end),
            "{missing}"
        );
        assert_eq!((sweep.from, sweep.to), (known.from, known.to), "{missing}");
        assert_eq!(sweep.commanded.speed, DegPerS(56.25), "{missing}");
        let is_complete = written.word.is_some() && written.target.is_some();
        assert_eq!(found.inferred.is_empty(), is_complete, "{missing}");
    }
}

#[test]
fn second_sweeps_without_a_start_or_a_target_are_found() {
    let plan = SweepPlan {
        sweeps: 2,
        both_ways: true,
        ..PLAN
    };
    for second in [
        Written {
            target: Some(0.0),
            word: None,
            ..WHOLE
        },
        Written {
            target: None,
            ..WHOLE
        },
        Written {
            target: None,
            word: None,
            ..WHOLE
        },
    ] {
        let mut axis = Axis::new();
        axis.command_partly(&WHOLE);
        axis.travel(-45.0, 45.0);
        let turn = axis.now;
        axis.command_partly(&second);
        axis.travel(45.0, 45.0);
        let found = axis.watch.sweeps(&axis.samples, Some(&plan));
        let [first, back] = found.seen[..] else {
            panic!("{found:?}");
        };
        assert!(
            first.end < ms(turn) && back.start >= ms(turn - 1),
            "{found:?}"
        );
        assert!(back.to.0.abs() < 0.01, "{found:?}");
        assert_eq!(found.inferred, [1]);
    }
}

/// As in a file that holds the logs of two scans.
#[test]
fn a_plan_that_begins_once_more_after_its_last_sweep_is_reported() {
    let mut axis = Axis::new();
    for way in [-45.0, 45.0] {
        axis.command(axis.angle + way, 0x1F);
        axis.travel(way, 45.0);
        let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        assert_eq!((found.seen.len(), found.surplus.len()), (1, 0));
    }
    axis.command(-45.0, 0x1F);
    axis.travel(-45.0, 45.0);
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    let [(from, to)] = found.surplus[..] else {
        panic!("{found:?}");
    };
    assert!(from.0.abs() < 1e-9 && (to.0 + 45.0).abs() < 1e-9);
}

/// The axis stopped on its way, and the log does not show where it was going.
#[test]
fn a_motion_of_unknown_target_that_ends_elsewhere_is_ambiguous() {
    let mut axis = Axis::new();
    axis.command_partly(&Written {
        target: None,
        ..WHOLE
    });
    axis.travel(-12.0, 45.0);
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    let [(from, to)] = found.ambiguous[..] else {
        panic!("{found:?}");
    };
    assert!(found.seen.is_empty() && from.0 == 0.0 && (to.0 + 12.0).abs() < 1e-9);
    // The client read the target back: a sweep cut short.
    let mut axis = Axis::new();
    axis.command_partly(&Written {
        target: None,
        is_read_back: true,
        ..WHOLE
    });
    axis.travel(-12.0, 45.0);
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    assert!(
        found.ambiguous.is_empty() && found.seen.len() == 1,
        "{found:?}"
    );
    assert!(found.inferred.is_empty(), "{found:?}");
}

/// Homing and jogging move the axis without a profile move; a restarted drive counts from zero.
#[test]
fn motions_in_other_modes_and_jumps_are_no_sweeps() {
    let mut axis = Axis::new();
    axis.write(objects::MODE.address, 6);
    axis.travel(-45.0, 45.0);
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    assert_eq!(found, FoundSweeps::default());
    let mut axis = Axis::new();
    axis.command_partly(&Written {
        word: None,
        ..WHOLE
    });
    axis.angle = -45.0;
    axis.stay(100);
    let found = axis.watch.sweeps(&axis.samples, Some(&PLAN));
    assert_eq!(found, FoundSweeps::default());
}

/// At the least speed the axis is in its place for longer than many a pause.
#[test]
fn a_slow_sweep_of_which_the_start_is_missing_keeps_its_ends() {
    let plan = SweepPlan {
        to_deg: -0.3,
        sweeps: 2,
        both_ways: true,
        ..PLAN
    };
    let mut axis = Axis::new();
    for _ in 0..100 {
        axis.stay(1);
    }
    for target in [-0.3, 0.0] {
        axis.command_partly(&Written {
            target: Some(target),
            word: None,
            speed: Some(1),
            ..WHOLE
        });
        axis.stay(60);
        axis.travel(target - axis.angle, 0.05);
    }
    let found = axis.watch.sweeps(&axis.samples, Some(&plan));
    let [first, back] = found.seen[..] else {
        panic!("{found:?}");
    };
    // The speed is measured over the middle half of the way.
    assert!((first.cruise.0 + 0.05).abs() < 1e-6 && (back.cruise.0 - 0.05).abs() < 1e-6);
    assert!(
        (first.to.0 + 0.3).abs() < 0.003 && back.to.0.abs() < 0.003,
        "{found:?}"
    );
    let length = |sweep: &Sweep| (sweep.end - sweep.start).as_secs_f64();
    assert!((length(&first) - 6.0).abs() < 0.1 && (length(&back) - 6.0).abs() < 0.1);
}
