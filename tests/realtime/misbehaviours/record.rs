//! The truth over time, and what the client was shown and sent.

use crate::motion::{Axis, Profile};

/// Range that the configuration allows, degrees.
pub const LIMITS: (f64, f64) = (-45.0, 0.0);
/// Share of the documented tolerances that shows a misbehaviour: the client's plan starts a little
/// later or earlier than the drive's.
pub const SHARE: f64 = 0.95;

/// Something that happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A controlword arrived.
    Control(u16),
    /// The drive entered a fault.
    Fault(u16),
}

/// The axis at a time.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Seconds.
    pub at: f64,
    /// The axis.
    pub axis: Axis,
    /// The axis has been homed.
    pub homed: bool,
}

/// What happened to a drive.
#[derive(Default)]
pub struct Record {
    /// On a CAN bus, where NMT decides about process data.
    pub can: bool,
    /// Truth, every millisecond.
    pub truth: Vec<Truth>,
    /// Events with their times.
    pub events: Vec<(f64, Event)>,
    /// When the misbehaviour began.
    pub began: Option<f64>,
    /// When the client was first shown what it cannot overlook.
    pub shown: Option<f64>,
    /// When the sweep was half done.
    pub half: Option<f64>,
    /// When homing ended.
    pub homed: Option<f64>,
    /// When the client was signalled to end.
    pub signalled: Option<f64>,
    plan: Option<Profile>,
}

impl Record {
    /// Stores the truth of a step.
    pub fn truth(&mut self, now: f64, axis: &Axis) {
        if self.truth.last().is_none_or(|last| now - last.at >= 0.001) {
            self.truth.push(Truth {
                at: now,
                axis: *axis,
                homed: self.homed.is_some(),
            });
        }
    }

    /// Stores an event.
    pub fn event(&mut self, now: f64, event: Event) {
        self.events.push((now, event));
    }

    /// The misbehaviour begins.
    pub fn begin(&mut self, now: f64) {
        self.began = Some(now);
    }

    /// Whether it has begun.
    pub fn has_begun(&self) -> bool {
        self.began.is_some()
    }

    /// A new move: what a healthy drive does from now on.
    pub fn plan(&mut self, plan: Profile) {
        self.plan = Some(plan);
    }

    /// The sweep is half done.
    pub fn mid_sweep(&mut self, now: f64) {
        self.half.get_or_insert(now);
    }

    /// Whether the client was signalled.
    pub fn is_signalled(&self) -> bool {
        self.signalled.is_some()
    }

    /// The client is shown a position: judges it by the documented limits.
    pub fn sample(&mut self, now: f64, shown: f64, referenced: bool) {
        if !referenced || !self.has_begun() {
            return;
        }
        // Before the sweep the axis holds where homing ends.
        let (expected, from, sign, speed) = match self.plan {
            Some(plan) => {
                let sign = (plan.to - plan.from).signum();
                (plan.at(now).0, plan.from, sign, plan.speed)
            }
            None => (LIMITS.1, LIMITS.1, 1.0, 0.0),
        };
        let ahead = (shown - expected) * sign;
        let is_outside = shown < LIMITS.0 - 0.13 || shown > LIMITS.1 + 0.13;
        let behind = SHARE * (0.53 + speed * 0.05);
        let most = SHARE * 0.53;
        if is_outside || ahead > most || ahead < -behind || (shown - from) * sign < -most {
            self.show(now);
        }
    }

    /// The client is shown what it must not overlook.
    pub fn show(&mut self, now: f64) {
        let Some(began) = self.began else { return };
        if self.first_stop(began).is_none() {
            self.shown.get_or_insert(now);
        }
    }

    /// First quick stop or disable voltage after a time.
    pub fn first_stop(&self, after: f64) -> Option<f64> {
        self.events.iter().find_map(|(at, event)| match event {
            Event::Control(word) if *at >= after && (word & 2 == 0 || word & 4 == 0) => Some(*at),
            _ => None,
        })
    }

    /// Highest speed of the axis.
    pub fn highest_speed(&self) -> f64 {
        let speeds = self.truth.iter().map(|truth| truth.axis.speed.abs());
        speeds.fold(0.0, f64::max)
    }

    /// Degrees travelled after a time.
    pub fn travel(&self, after: f64) -> f64 {
        let later = || self.truth.iter().filter(|truth| truth.at >= after);
        let pairs = later().zip(later().skip(1));
        pairs.map(|(a, b)| (b.axis.deg - a.axis.deg).abs()).sum()
    }

    /// Farthest degrees beyond the limits; in homing, beyond the switches.
    pub fn beyond(&self, after: f64) -> f64 {
        let later = self.truth.iter().filter(|truth| truth.at >= after);
        later
            .map(|truth| {
                let (low, high) = match truth.homed {
                    true => LIMITS,
                    false => (LIMITS.0 - 1.0, LIMITS.1 + 1.25),
                };
                (truth.axis.deg - high).max(low - truth.axis.deg).max(0.0)
            })
            .fold(0.0, f64::max)
    }
}
