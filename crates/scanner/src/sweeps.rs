//! Which stretches of time were sweeps: found from what the host wrote to the drive and from how the angle then moved.
//!
//! The commands say when a profile move was asked for and where to; the samples say when the axis left its place and
//! when it came to rest. A move is a sweep of the plan if it starts at one end of the plan and heads for the other, so moves to
//! the starting place, homing and returns drop out without marks in the log. A sweep that was cut short stays one, with the angle it reached.

use drive::objects::{self, Address};
use units::{DegPerS, DegPerS2, Degrees, Gearing, Host, Quadcounts, Rpm, RpmPerS, Span, Stamp};

use crate::config::SweepPlan;
use crate::trajectory::AngleSample;

/// One sweep as it happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Angle at its start.
    pub from: Degrees,
    /// Angle where it came to rest.
    pub to: Degrees,
    /// Measured speed in the cruise (signed: negative when the angle falls).
    pub cruise: DegPerS,
    /// Last sample at rest before it.
    pub start: Stamp<Host>,
    /// First sample at rest after it.
    pub end: Stamp<Host>,
    /// What the drive was told of its motion.
    pub commanded: Commanded,
}

/// What a drive was told of a profile move; zero where it was not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commanded {
    /// Speed of the cruise.
    pub speed: DegPerS,
    /// Acceleration.
    pub acceleration: DegPerS2,
    /// Deceleration.
    pub deceleration: DegPerS2,
}

impl Commanded {
    /// Nothing.
    pub const NOTHING: Self = Self {
        speed: DegPerS(0.0),
        acceleration: DegPerS2(0.0),
        deceleration: DegPerS2(0.0),
    };
}

/// A profile move as commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Move {
    commanded: Stamp<Host>,
    target: Degrees,
    motion: Commanded,
}

/// Follows the writes that start profile moves.
#[derive(Clone, Debug)]
pub struct MoveWatch {
    gearing: Gearing,
    target: Option<Quadcounts>,
    speed: Rpm,
    ramps: [RpmPerS; 2],
    controlword: u16,
    mode: u32,
    moves: Vec<Move>,
}

const PROFILE_POSITION: u32 = 1;
const NEW_SETPOINT: u16 = 0x0010;
const RELATIVE: u16 = 0x0040;
/// How far a move may start or aim from the plan's ends and still be one of its sweeps.
const END_TOLERANCE_DEG: f64 = 0.1;
/// A jump is more than this and than the way at three times the commanded speed.
const JUMP_DEG: f64 = 0.1;
const JUMP_SPEEDS: f64 = 3.0;
/// The axis is at rest while it stays within this of its place: an encoder at an edge flickers by one count.
const REST_QC: f64 = 1.5;

impl MoveWatch {
    /// A watch behind `gearing`.
    #[must_use]
    pub fn new(gearing: Gearing) -> Self {
        Self {
            gearing,
            target: None,
            speed: Rpm(0),
            ramps: [RpmPerS(0); 2],
            controlword: 0,
            mode: PROFILE_POSITION,
            moves: Vec::new(),
        }
    }

    /// Takes note of an acknowledged write of `value` to `address`, asked for at `host`.
    pub fn wrote(&mut self, address: Address, value: u32, host: Stamp<Host>) {
        if address == objects::TARGET_POSITION.address {
            self.target = Some(Quadcounts(value as i32));
        } else if address == objects::PROFILE_VELOCITY.address {
            self.speed = Rpm(value);
        } else if address == objects::PROFILE_ACCELERATION.address {
            self.ramps[0] = RpmPerS(value);
        } else if address == objects::PROFILE_DECELERATION.address {
            self.ramps[1] = RpmPerS(value);
        } else if address == objects::MODE.address {
            self.mode = value & 0xFF;
        } else if address == objects::CONTROLWORD.address {
            self.control(value as u16, host);
        }
    }

    fn control(&mut self, word: u16, host: Stamp<Host>) {
        let rising = word & !self.controlword & NEW_SETPOINT != 0;
        self.controlword = word;
        if let (true, PROFILE_POSITION, 0, Some(target)) =
            (rising, self.mode, word & RELATIVE, self.target)
        {
            self.moves.push(Move {
                commanded: host,
                target: self.gearing.angle(target),
                motion: Commanded {
                    speed: self.gearing.rate(self.speed),
                    acceleration: self.gearing.acceleration(self.ramps[0]),
                    deceleration: self.gearing.acceleration(self.ramps[1]),
                },
            });
        }
    }

    /// How many moves were commanded so far, and where the newest goes to.
    fn newest(&self) -> Option<(usize, Degrees)> {
        Some((self.moves.len(), self.moves.last()?.target))
    }

    /// The sweeps among the moves, from samples in order of time. Without a plan every move is one.
    #[must_use]
    pub fn sweeps(&self, samples: &[AngleSample], plan: Option<&SweepPlan>) -> Vec<Sweep> {
        let rest = REST_QC * self.gearing.degrees_per_qc();
        let ends = self
            .moves
            .iter()
            .skip(1)
            .map(|next| next.commanded)
            .chain([Stamp::from_nanos(i64::MAX)]);
        let moved = self
            .moves
            .iter()
            .zip(ends)
            .filter_map(|(command, end)| sweep(command, end, samples, rest));
        match plan {
            None => moved.map(|(sweep, _)| sweep).collect(),
            Some(plan) => planned(moved, plan),
        }
    }
}

/// Follows the samples of an axis while it sweeps: when sweeps begin and end, as far as it is known by then.
#[derive(Clone, Debug)]
pub(crate) struct SweepWatch {
    rest_deg: f64,
    spans: Vec<(Stamp<Host>, Stamp<Host>)>,
    /// Moves that were looked at.
    seen: usize,
    last: Option<AngleSample>,
    state: Watched,
}

#[derive(Clone, Copy, Debug)]
enum Watched {
    Nothing,
    /// A sweep was commanded and the axis is still where it was.
    Rest(Degrees),
    /// Where the axis was last seen to have moved to, and when.
    Motion(AngleSample),
}

/// An axis that stays in its place for so long has ended its sweep.
const STILL: Span = Span::from_millis(50);

impl SweepWatch {
    /// A watch behind `gearing`.
    pub(crate) fn new(gearing: Gearing) -> Self {
        Self {
            rest_deg: REST_QC * gearing.degrees_per_qc(),
            spans: Vec::new(),
            seen: 0,
            last: None,
            state: Watched::Nothing,
        }
    }

    /// The sweeps so far; one that goes on has no end.
    pub(crate) fn spans(&self) -> &[(Stamp<Host>, Stamp<Host>)] {
        &self.spans
    }

    /// Takes a sample, in order of time. Without a plan every move is a sweep.
    pub(crate) fn sample(
        &mut self,
        sample: &AngleSample,
        moves: &MoveWatch,
        plan: Option<&SweepPlan>,
    ) {
        let last = *self.last.get_or_insert(*sample);
        if let Some((count, target)) = moves.newest().filter(|(count, _)| *count > self.seen) {
            self.seen = count;
            self.end(sample.host);
            let back = plan.is_some_and(|plan| plan.both_ways) && self.spans.len() % 2 == 1;
            let is_sweep = plan.is_none_or(|plan| {
                (self.spans.len() as u64) < u64::from(plan.sweeps)
                    && plan.is_sweep(last.angle, target, back, END_TOLERANCE_DEG)
            });
            if is_sweep {
                self.state = Watched::Rest(last.angle);
            }
        }
        let moved = |from: Degrees| (sample.angle.0 - from.0).abs() > self.rest_deg;
        match self.state {
            Watched::Rest(from) if moved(from) => {
                self.spans.push((last.host, Stamp::from_nanos(i64::MAX)));
                self.state = Watched::Motion(*sample);
            }
            Watched::Motion(_) if moves.newest().is_some_and(|(_, target)| !moved(target)) => {
                self.end(sample.host);
            }
            Watched::Motion(seen) if moved(seen.angle) => self.state = Watched::Motion(*sample),
            Watched::Motion(seen) if sample.host.saturating_since(seen.host) > STILL => {
                self.end(sample.host);
            }
            _ => {}
        }
        self.last = Some(*sample);
    }

    fn end(&mut self, host: Stamp<Host>) {
        if let (Watched::Motion(_), Some((_, end))) = (self.state, self.spans.last_mut()) {
            *end = host;
        }
        self.state = Watched::Nothing;
    }
}

/// The plan's sweeps among the moves: the first goes along, with `both_ways` the next one back, and so on, and no more than were
/// planned. So the way to the starting place is none, though it may go from end to end.
fn planned(moved: impl Iterator<Item = (Sweep, Degrees)>, plan: &SweepPlan) -> Vec<Sweep> {
    let mut sweeps: Vec<Sweep> = Vec::new();
    for (sweep, target) in moved {
        let back = plan.both_ways && sweeps.len() % 2 == 1;
        if (sweeps.len() as u64) < u64::from(plan.sweeps)
            && plan.is_sweep(sweep.from, target, back, END_TOLERANCE_DEG)
        {
            sweeps.push(sweep);
        }
    }
    sweeps
}

/// The motion between `command` and `end`, with its target; `None` where the axis did not move.
fn sweep(
    command: &Move,
    end: Stamp<Host>,
    samples: &[AngleSample],
    rest: f64,
) -> Option<(Sweep, Degrees)> {
    // One sample before the command, so that the place at rest is known.
    let first = samples
        .partition_point(|s| s.host < command.commanded)
        .saturating_sub(1);
    let last = samples.partition_point(|s| s.host < end);
    let window = samples.get(first..last)?;
    let window = window.get(..unbroken(window, command.motion.speed))?;
    let (from, to) = (window.first()?.angle, window.last()?.angle);
    let leaves = window
        .iter()
        .position(|s| (s.angle.0 - from.0).abs() > rest)?;
    let moving_last = window
        .iter()
        .rposition(|s| (s.angle.0 - to.0).abs() > rest)?;
    let start = window.get(leaves.saturating_sub(1))?.host;
    let stop = window.get((moving_last + 1).min(window.len() - 1))?.host;
    if stop <= start {
        return None;
    }
    let moving = window.get(leaves..=moving_last.max(leaves))?;
    let sweep = Sweep {
        from,
        to,
        cruise: cruise(moving, from, to),
        start,
        end: stop,
        commanded: command.motion,
    };
    Some((sweep, command.target))
}

/// How many samples there are before the angle jumps farther than the axis can have gone: a drive that lost its supply counts from
/// zero again, and what follows is no angle of this axis.
fn unbroken(window: &[AngleSample], speed: DegPerS) -> usize {
    let jump = window.windows(2).position(|pair| match pair {
        [a, b] => {
            let time = b.host.saturating_since(a.host) + a.bound + b.bound;
            (b.angle.0 - a.angle.0).abs() > JUMP_DEG + JUMP_SPEEDS * speed.0 * time.as_secs_f64()
        }
        _ => false,
    });
    jump.map_or(window.len(), |before| before + 1)
}

/// Measured speed over the middle half of the way, by least squares: ramps stay outside unless they take over half of it.
fn cruise(moving: &[AngleSample], from: Degrees, to: Degrees) -> DegPerS {
    let way = to.0 - from.0;
    let middle = |s: &&AngleSample| {
        let part = (s.angle.0 - from.0) / way;
        (0.25..=0.75).contains(&part)
    };
    let Some(origin) = moving.iter().find(middle) else {
        return DegPerS(0.0);
    };
    let points = || {
        moving.iter().filter(middle).map(|s| {
            (
                s.host.saturating_since(origin.host).as_secs_f64(),
                s.angle.0 - origin.angle.0,
            )
        })
    };
    let n = points().count() as f64;
    let (mean_t, mean_a) = points().fold((0.0, 0.0), |(t, a), p| (t + p.0 / n, a + p.1 / n));
    let (tt, ta) = points().fold((0.0, 0.0), |(tt, ta), p| {
        let t = p.0 - mean_t;
        (tt + t * t, ta + t * (p.1 - mean_a))
    });
    DegPerS(if tt > 0.0 { ta / tt } else { 0.0 })
}

#[cfg(test)]
mod tests {
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

    /// A watch and the samples of an axis that is told to go to each angle in turn, at `speed` without ramps, 1 s apart.
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
    fn a_move_from_end_to_end_is_a_sweep_with_its_measured_speed() {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.travel(-45.0, 45.0);
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        let [sweep] = sweeps[..] else {
            panic!("{sweeps:?}");
        };
        assert_eq!((sweep.from.0, sweep.to.0.round()), (0.0, -45.0));
        assert!((sweep.cruise.0 + 45.0).abs() < 1e-6, "{sweep:?}");
        assert_eq!(sweep.start, ms(19));
        assert_eq!((sweep.end - sweep.start).as_nanos(), 1_000_000_000);
    }

    #[test]
    fn the_way_back_is_a_sweep_only_if_it_was_planned() {
        let mut axis = Axis::new();
        for way in [-45.0, 45.0] {
            axis.command(axis.angle + way, 0x1F);
            axis.travel(way, 45.0);
        }
        assert_eq!(axis.watch.sweeps(&axis.samples, Some(&PLAN)).len(), 1);
        let both_ways = SweepPlan {
            both_ways: true,
            sweeps: 2,
            ..PLAN
        };
        assert_eq!(axis.watch.sweeps(&axis.samples, Some(&both_ways)).len(), 2);
        assert_eq!(axis.watch.sweeps(&axis.samples, None).len(), 2);
    }

    #[test]
    fn moves_to_the_start_and_homing_are_no_sweeps() {
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
        assert!(axis.watch.sweeps(&axis.samples, Some(&PLAN)).is_empty());
    }

    #[test]
    fn the_approach_from_the_far_end_is_no_sweep_even_both_ways() {
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
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&plan));
        assert_eq!(sweeps.len(), 1, "{sweeps:?}");
        assert!(sweeps[0].cruise.0 > 0.0, "{sweeps:?}");
    }

    #[test]
    fn a_sweep_that_was_cut_short_keeps_the_angle_it_reached() {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.travel(-12.0, 45.0);
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        assert!((sweeps[0].to.0 + 12.0).abs() < 1e-9, "{sweeps:?}");
    }

    #[test]
    fn a_drive_that_forgot_its_position_ends_the_sweep_where_it_last_knew_it() {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.travel(-20.0, 45.0);
        let known = axis.now;
        axis.angle = 0.0;
        axis.stay(100);
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        assert!((sweeps[0].to.0 + 20.0).abs() < 1e-9, "{sweeps:?}");
        assert!(sweeps[0].end < ms(known), "{sweeps:?}");
    }

    #[test]
    fn an_axis_that_never_moved_made_no_sweep() {
        let mut axis = Axis::new();
        axis.command(-45.0, 0x1F);
        axis.stay(100);
        assert!(axis.watch.sweeps(&axis.samples, Some(&PLAN)).is_empty());
        assert!(axis.watch.sweeps(&[], Some(&PLAN)).is_empty());
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
        let sweeps = axis.watch.sweeps(&axis.samples, Some(&PLAN));
        assert_eq!((sweeps[0].end - sweeps[0].start).as_nanos(), 1_000_000_000);
    }
}
