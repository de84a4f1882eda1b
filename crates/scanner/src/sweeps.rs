//! Sweeps: intervals of time, from the host's commands to the drive and the angles that follow.
//!
//! The commands show when a profile move was requested and its target; the samples show when the
//! axis left its place and came to rest. A move is a sweep of the plan if it starts at one end of
//! the plan and heads for the other. Moves to the starting place, homing and returns are thereby
//! excluded without marks in the log. A sweep that was cut short counts, with the angle it reached,
//! and so does one whose beginning no sample shows. One that happens between two samples does not:
//! only the command would place its points.

mod streaming;

use drive::objects::{self, Address};
use units::{DegPerS, DegPerS2, Degrees, Gearing, Host, Quadcounts, Rpm, RpmPerS, Stamp};

use crate::angles::AngleSample;
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
pub struct FoundSweeps {
    /// Those that the samples show, in order of time.
    pub seen: Vec<Sweep>,
    /// Beginnings and ends of those that happened between two samples.
    pub unseen: Vec<(Degrees, Degrees)>,
}

/// The motion after a command.
struct Motion {
    sweep: Sweep,
    target: Degrees,
    /// No sample shows where it began.
    is_cut_off: bool,
    is_seen: bool,
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
/// Greatest distance of a sweep's start and target from the ends of the plan.
const END_TOLERANCE_DEG: f64 = 0.1;
/// A jump exceeds this, and the way at three times the commanded speed.
const JUMP_DEG: f64 = 0.1;
const JUMP_SPEEDS: f64 = 3.0;
/// A sweep is not seen if so much of its way is between two samples.
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
            mode: PROFILE_POSITION,
            moves: Vec::new(),
        }
    }

    /// Takes a write of `value` to `address`, requested at `host`. The log may lack its
    /// confirmation: the samples show whether the axis moved.
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

    /// Number of moves so far, and target of the newest.
    fn newest(&self) -> Option<(usize, Degrees)> {
        Some((self.moves.len(), self.moves.last()?.target))
    }

    /// The sweeps among the moves, from samples in order of time. Without a plan every move is one.
    #[must_use]
    pub fn sweeps(&self, samples: &[AngleSample], plan: Option<&SweepPlan>) -> FoundSweeps {
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
            .filter_map(|(command, end)| motion(command, end, samples, rest));
        let mut found = FoundSweeps::default();
        for moved in moved {
            let done = found.seen.len() + found.unseen.len();
            let sweep = moved.sweep;
            let is_wanted = |plan: &SweepPlan| {
                let from = match moved.is_cut_off && plan.is_between(sweep.from) {
                    true => plan.ends(done).0,
                    false => sweep.from,
                };
                plan.is_next_sweep(done, from, moved.target, END_TOLERANCE_DEG)
            };
            match moved.is_seen {
                _ if !plan.is_none_or(is_wanted) => {}
                true => found.seen.push(sweep),
                false => found.unseen.push((sweep.from, sweep.to)),
            }
        }
        found
    }
}

/// The motion between `command` and `end`; `None` if the axis did not move.
fn motion(command: &Move, end: Stamp<Host>, samples: &[AngleSample], rest: f64) -> Option<Motion> {
    // One sample before the command, for the place at rest.
    let after = samples.partition_point(|s| s.host < command.commanded);
    let last = samples.partition_point(|s| s.host < end);
    let window = samples.get(after.saturating_sub(1)..last)?;
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
    let steps = window.windows(2).filter_map(|pair| match pair {
        [a, b] => Some((b.angle.0 - a.angle.0).abs()),
        _ => None,
    });
    let longest = steps.fold(0.0, f64::max);
    let moving = window
        .get(leaves..=moving_last.max(leaves))
        .unwrap_or_default();
    Some(Motion {
        sweep: Sweep {
            from,
            to,
            cruise: cruise(moving, from, to),
            start,
            end: stop,
            commanded: command.motion,
        },
        target: command.target,
        is_cut_off: after == 0,
        is_seen: longest <= END_TOLERANCE_DEG.max(UNSEEN_SHARE * (to.0 - from.0).abs()),
    })
}

/// Number of samples before the angle jumps farther than the axis can move. A drive that loses its
/// supply restarts at zero, and the samples after that are no angles of this axis.
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
