//! Sweeps: intervals of time, from the host's commands to the drive and the angles that follow.
//!
//! The commands show when a profile move was requested and its target; the samples show when the
//! axis left its place and came to rest. A move is a sweep of the plan if it starts at one end of
//! the plan and heads for the other. Moves to the starting place, homing and returns are thereby
//! excluded without marks in the log. A sweep that was cut short counts, with the angle it reached,
//! and so does one whose beginning no sample shows. One that happens between two samples does not:
//! only the command would place its points.
//!
//! A recorder may drop the requests of a command. A target that the log lacks is read back by the
//! client, or is the place where the axis comes to rest; a move whose start the log lacks begins
//! where the axis leaves its place (`uncommanded`).

mod streaming;
mod uncommanded;

use drive::cia402::{control, mode};
use drive::objects::{self, Address};
use units::{DegPerS, DegPerS2, Degrees, Gearing, Host, Quadcounts, Rpm, RpmPerS, Span, Stamp};

use crate::angles::{AngleSample, MAX_SPEED_DEG_S, is_reached};
use crate::config::SweepPlan;
pub(crate) use streaming::SweepWatch;

/// A sweep as measured.
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
    /// The command of its motion.
    pub commanded: Commanded,
}

/// A silence in a sweep that shows whole hours too many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HoursTooMany {
    /// Angle before it.
    pub at: Degrees,
    /// Its length.
    pub silence: Span,
    /// Time that the axis needed for the way meanwhile.
    pub motion: Span,
}

impl Sweep {
    /// The host's clock was set by hours during a silence: the axis moved on as far as without
    /// these hours. The lidar's clock repeats hourly and cannot show such a step.
    pub(crate) fn hours_too_many(&self, samples: &[AngleSample]) -> Option<HoursTooMany> {
        let speed = self.commanded.speed.0.abs();
        let is_on_its_way = |s: &AngleSample| {
            let ends = [self.from, self.to];
            let is_away = |end: Degrees| (s.angle.0 - end.0).abs() > END_TOLERANCE_DEG;
            (self.start..=self.end).contains(&s.host) && ends.into_iter().all(is_away)
        };
        samples.windows(2).find_map(|pair| {
            let &[a, b] = pair else { return None };
            let silence = b.host.saturating_since(a.host);
            let motion_s = (b.angle.0 - a.angle.0).abs() / speed;
            let hours = (silence.as_secs_f64() / HOUR_S).round();
            let rest_s = silence.as_secs_f64() - hours * HOUR_S;
            // A head may be held or pushed meanwhile.
            let is_as_long = motion_s / 2.0 - 1.0 <= rest_s && rest_s <= 2.0 * motion_s + 1.0;
            (hours >= 1.0 && is_on_its_way(&a) && is_on_its_way(&b) && is_as_long).then(|| {
                HoursTooMany {
                    at: a.angle,
                    silence,
                    motion: Span::from_secs_f64(motion_s),
                }
            })
        })
    }
}

/// Command of a profile move; zero where it was not written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commanded {
    /// Speed of the cruise.
    pub speed: DegPerS,
    /// Acceleration.
    pub acceleration: DegPerS2,
    /// Deceleration.
    pub deceleration: DegPerS2,
}

/// The sweeps of a log.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FoundSweeps {
    /// Those that the samples show, in order of time.
    pub seen: Vec<Sweep>,
    /// Beginnings and ends of those that happened between two samples.
    pub unseen: Vec<(Degrees, Degrees)>,
    /// Indices, among those seen, of sweeps whose command is not complete in the log: they follow
    /// from the samples.
    pub inferred: Vec<usize>,
    /// Indices, among those seen, of sweeps whose last sample shows an axis in motion.
    pub unfinished: Vec<usize>,
    /// Beginnings and ends of motions that begin like a sweep of the plan, but neither the log has
    /// their target nor do they end like one.
    pub ambiguous: Vec<(Degrees, Degrees)>,
    /// Beginnings and ends of further sweeps of a plan that was complete.
    pub surplus: Vec<(Degrees, Degrees)>,
}

/// A log that goes on for longer after the last position of a sweep lacks positions.
const LEAST_REST: Span = Span::from_millis(100);

impl FoundSweeps {
    /// Indices of the sweeps whose end the positions do not show, though packets go on.
    pub(crate) fn unobserved_ends(&self, last_packet: Option<Stamp<Host>>) -> Vec<usize> {
        let goes_on = |index: &usize| {
            let sweep = self.seen.get(*index);
            sweep.map(|sweep| sweep.end + LEAST_REST) < last_packet
        };
        self.unfinished.iter().copied().filter(goes_on).collect()
    }
}

/// The motion after a command.
struct Motion {
    sweep: Sweep,
    /// Target; the place where it ended if the log lacks the target.
    target: Degrees,
    /// The log lacks the target.
    has_no_target: bool,
    /// The log lacks the start.
    has_no_start: bool,
    /// No sample shows where it began.
    is_cut_off: bool,
    /// No sample shows where it ended.
    is_unfinished: bool,
    is_seen: bool,
}

/// A profile move as commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Move {
    commanded: Stamp<Host>,
    /// `None` if the log lacks it.
    target: Option<Degrees>,
    motion: Commanded,
    /// The log lacks the command that starts it.
    has_no_start: bool,
}

/// Follows the writes that start profile moves.
#[derive(Clone, Debug)]
pub struct MoveWatch {
    gearing: Gearing,
    target: Option<Quadcounts>,
    speed: Rpm,
    ramps: [RpmPerS; 2],
    controlword: u16,
    mode: i8,
    moves: Vec<Move>,
    /// Targets and motions of moves, by the time from which they start.
    settings: Vec<Setting>,
}

/// Target and motion of a move that starts from this time on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Setting {
    from: Stamp<Host>,
    is_position_mode: bool,
    target: Option<Degrees>,
    motion: Commanded,
}

/// Greatest distance of a sweep's start and target from the ends of the plan.
const END_TOLERANCE_DEG: f64 = 0.1;
/// A jump exceeds the way at three times the commanded speed, or at the greatest speed.
const JUMP_SPEEDS: f64 = 3.0;
const HOUR_S: f64 = 3_600.0;
/// A sweep is not seen if so much of its way is between two samples, and little between others.
const UNSEEN_SHARE: f64 = 0.75;
/// Range of an axis at rest: an encoder at an edge flickers by one count.
const REST_QC: f64 = 1.5;

impl MoveWatch {
    /// An observer of an axis with `gearing`.
    #[must_use]
    pub fn new(gearing: Gearing) -> Self {
        Self {
            gearing,
            target: None,
            speed: Rpm(0),
            ramps: [RpmPerS(0); 2],
            controlword: 0,
            mode: mode::PROFILE_POSITION,
            moves: Vec::new(),
            settings: Vec::new(),
        }
    }

    /// Takes a write of `value` to `address`, requested at `host`. The log may lack its
    /// confirmation: the samples show whether the axis moved.
    pub fn wrote(&mut self, address: Address, value: u32, host: Stamp<Host>) {
        if address == objects::CONTROLWORD.address {
            self.control(value as u16, host);
        } else if address == objects::MODE.address {
            self.set(objects::MODE_DISPLAY.address, value, host);
        } else {
            self.set(address, value, host);
        }
    }

    /// Whether reads of `address` show what a move will do.
    pub(crate) fn reads(address: Address) -> bool {
        [
            objects::TARGET_POSITION.address,
            objects::PROFILE_VELOCITY.address,
            objects::PROFILE_ACCELERATION.address,
            objects::PROFILE_DECELERATION.address,
            objects::MODE_DISPLAY.address,
        ]
        .contains(&address)
    }

    /// Takes a read of `address` that returned `value`, requested at `host`: the client reads back
    /// what it wrote, and the log may lack the write.
    pub fn read(&mut self, address: Address, value: u32, host: Stamp<Host>) {
        self.set(address, value, host);
    }

    fn set(&mut self, address: Address, value: u32, host: Stamp<Host>) {
        if address == objects::TARGET_POSITION.address {
            self.target = Some(Quadcounts(value as i32));
        } else if address == objects::PROFILE_VELOCITY.address {
            self.speed = Rpm(value);
        } else if address == objects::PROFILE_ACCELERATION.address {
            self.ramps[0] = RpmPerS(value);
        } else if address == objects::PROFILE_DECELERATION.address {
            self.ramps[1] = RpmPerS(value);
        } else if address == objects::MODE_DISPLAY.address {
            self.mode = objects::MODE_DISPLAY.decode(value);
        } else {
            return;
        }
        let setting = self.setting(host);
        let is_same = |last: &Setting| {
            Setting {
                from: host,
                ..*last
            } == setting
        };
        if !self.settings.last().is_some_and(is_same) {
            self.settings.push(setting);
        }
    }

    fn setting(&self, from: Stamp<Host>) -> Setting {
        Setting {
            from,
            is_position_mode: self.is_position_mode(),
            target: self.target.map(|target| self.gearing.angle(target)),
            motion: Commanded {
                speed: self.gearing.rate(self.speed),
                acceleration: self.gearing.acceleration(self.ramps[0]),
                deceleration: self.gearing.acceleration(self.ramps[1]),
            },
        }
    }

    fn control(&mut self, word: u16, host: Stamp<Host>) {
        let rising = word & !self.controlword & control::NEW_SETPOINT != 0;
        self.controlword = word;
        let Setting {
            is_position_mode,
            target,
            motion,
            ..
        } = self.setting(host);
        if rising && is_position_mode && word & control::RELATIVE == 0 {
            self.moves.push(Move {
                commanded: host,
                target,
                motion,
                has_no_start: false,
            });
        }
    }

    /// Number of moves so far.
    const fn count(&self) -> usize {
        self.moves.len()
    }

    /// Target of the newest move, if the log has it.
    fn newest_target(&self) -> Option<Degrees> {
        self.moves.last()?.target
    }

    const fn is_position_mode(&self) -> bool {
        self.mode == mode::PROFILE_POSITION
    }

    /// The sweeps among the moves, from samples in order of time. Without a plan every commanded
    /// move is one.
    #[must_use]
    pub fn sweeps(&self, samples: &[AngleSample], plan: Option<&SweepPlan>) -> FoundSweeps {
        let rest = REST_QC * self.gearing.degrees_per_qc();
        let mut found = FoundSweeps::default();
        for moved in self.motions(samples, rest, plan) {
            let done = found.seen.len() + found.unseen.len();
            let sweep = moved.sweep;
            let from = match plan {
                Some(plan) if moved.is_cut_off && plan.is_between(sweep.from) => plan.ends(done).0,
                _ => sweep.from,
            };
            let is_next = |target| {
                plan.is_none_or(|plan| plan.is_next_sweep(done, from, target, END_TOLERANCE_DEG))
            };
            // Where it would have to go.
            let due = plan.map_or(moved.target, |plan| plan.ends(done).1);
            let way = (sweep.to.0 - from.0) * (due.0 - from.0).signum();
            match (is_next(moved.target), moved.is_seen) {
                // Positions that jump without a command are no motion.
                (true, false) if moved.has_no_start => {}
                (true, true) => {
                    let number = found.seen.len();
                    let is_inferred = moved.has_no_target || moved.has_no_start;
                    found.inferred.extend(is_inferred.then_some(number));
                    found
                        .unfinished
                        .extend(moved.is_unfinished.then_some(number));
                    found.seen.push(sweep);
                }
                (true, false) => found.unseen.push((sweep.from, sweep.to)),
                (false, true)
                    if plan.is_some_and(|plan| {
                        done as u64 >= u64::from(plan.sweeps)
                            && plan.is_next_sweep(0, from, moved.target, END_TOLERANCE_DEG)
                    }) =>
                {
                    found.surplus.push((sweep.from, sweep.to));
                }
                (false, true) if moved.has_no_target && is_next(due) && way > END_TOLERANCE_DEG => {
                    found.ambiguous.push((sweep.from, sweep.to));
                }
                (false, _) => {}
            }
        }
        found
    }

    /// Motions of the axis after each command, and those without one.
    fn motions(&self, samples: &[AngleSample], rest: f64, plan: Option<&SweepPlan>) -> Vec<Motion> {
        let mut motions = Vec::new();
        let mut next = 0;
        let mut from = 0;
        loop {
            let command = self.moves.get(next);
            let until = command.map_or(samples.len(), |command| {
                samples.partition_point(|s| s.host < command.commanded)
            });
            // Without a plan nothing distinguishes a move from a push.
            let before = plan.and_then(|plan| self.uncommanded(samples, from..until, rest, plan));
            let Some(mut command) = before.or(command.copied()) else {
                return motions;
            };
            if let (0.0, Some(plan)) = (command.motion.speed.0, plan) {
                command.motion.speed = DegPerS(plan.cruise_deg_s);
            }
            next += usize::from(!command.has_no_start);
            let end = match self.moves.get(next) {
                Some(next) => samples.partition_point(|s| s.host < next.commanded),
                None => samples.len(),
            };
            // One sample before the command, for the place at rest.
            let start = samples.partition_point(|s| s.host < command.commanded);
            // It is over where the axis leaves its target again.
            let pause = command
                .target
                .filter(|_| plan.is_some())
                .and_then(|target| {
                    uncommanded::rest_before_departure(samples, start..end, target, rest)
                });
            let (next_from, end) = pause.map_or((end, end), |pause| {
                (pause.start, uncommanded::middle(&pause))
            });
            let window = samples
                .get(start.saturating_sub(1)..end)
                .unwrap_or_default();
            motions.extend(motion(&command, window, start == 0, rest));
            from = next_from.max(start);
        }
    }
}

/// The motion in `window` after `command`; `None` if the axis did not move.
fn motion(command: &Move, window: &[AngleSample], is_cut_off: bool, rest: f64) -> Option<Motion> {
    let window = window.get(..unbroken(window, command.motion.speed, rest))?;
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
    let moving = window
        .get(leaves..=moving_last.max(leaves))
        .unwrap_or_default();
    let way = to.0 - from.0;
    let around = window.get(leaves.saturating_sub(1)..=(moving_last + 1).min(window.len() - 1));
    let (mut longest, mut travelled) = (0.0_f64, 0.0);
    for pair in around.unwrap_or_default().windows(2) {
        let &[a, b] = pair else { continue };
        let step = (b.angle.0 - a.angle.0).abs();
        longest = longest.max(step);
        travelled += if step > rest { step } else { 0.0 };
    }
    // A head that is pushed may go farther between two samples than the whole sweep.
    let has_other_steps = travelled - longest >= (1.0 - UNSEEN_SHARE) * way.abs();
    // A target in another direction, or where the axis was, is that of an earlier move.
    let is_headed = |target: &Degrees| {
        (target.0 - from.0) * way.signum() > END_TOLERANCE_DEG.min(way.abs() / 2.0)
    };
    let target = command.target.filter(is_headed);
    Some(Motion {
        sweep: Sweep {
            from,
            to,
            cruise: cruise(moving, from, to),
            start,
            end: stop,
            commanded: command.motion,
        },
        target: target.unwrap_or(to),
        has_no_target: target.is_none(),
        has_no_start: command.has_no_start,
        is_cut_off,
        is_unfinished: moving_last + 2 >= window.len(),
        is_seen: has_other_steps || longest <= END_TOLERANCE_DEG.max(UNSEEN_SHARE * way.abs()),
    })
}

/// Number of samples before the angle jumps farther than the axis can move. A drive that loses its
/// supply restarts at zero and stays there, and the samples after that are no angles of this axis.
fn unbroken(window: &[AngleSample], speed: DegPerS, rest: f64) -> usize {
    // Restarted samples, from the end on.
    let zeros = window.iter().rev().take_while(|s| s.angle.0.abs() <= rest);
    let restart = window.len() - zeros.count();
    let broken = window.windows(2).enumerate().position(|(before, pair)| {
        let &[a, b] = pair else { return false };
        // A head that was held or pushed returns faster than it was commanded to move.
        let speed_deg_s = match before + 1 == restart {
            true => JUMP_SPEEDS * speed.0,
            false => (JUMP_SPEEDS * speed.0).max(MAX_SPEED_DEG_S),
        };
        !is_reached(&a, &b, speed_deg_s)
    });
    broken.map_or(window.len(), |before| before + 1)
}

/// Measured speed over the middle half of the way, by least squares; it excludes ramps of up to
/// half of it.
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
mod tests;
