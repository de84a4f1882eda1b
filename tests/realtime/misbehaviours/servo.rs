//! Time passes: demand, servo, brake, switches, the drive's own protection, and triggers of faults.

use crate::drive::{Drive, State};
use crate::faults::{Misbehaviour, Motor, When};
use crate::motion::{DEG_S_PER_RPM, Profile, QC_PER_DEG};

/// Seconds of one step.
const STEP: f64 = 0.000_25;
/// Speed per degree of distance from the demand, 1/s.
const GAIN: f64 = 30.0;
/// A move of at least this many degrees is a sweep.
const SWEEP_DEG: f64 = 20.0;

impl Drive {
    /// Moves on to a time.
    pub fn advance(&mut self, to: f64) {
        while self.now + STEP <= to {
            self.now += STEP;
            self.step();
        }
    }

    fn step(&mut self) {
        if let Some(at) = self.boots_at
            && self.now >= at
        {
            (self.boots_at, self.booted) = (None, true);
        }
        self.trigger_in_motion();
        if self.quick_stop_at.is_some_and(|at| self.now >= at) {
            self.quick_stop_at = None;
            if self.state == State::Enabled {
                (self.state, self.ramp) = (State::QuickStop, self.axis.speed);
            }
        }
        if self.power_off_at.is_some_and(|at| self.now >= at) {
            self.power_off_at = None;
            if self.state != State::Fault {
                self.state = State::Disabled;
            }
            self.power(false);
        }
        self.protect();
        self.brake();
        let wanted = self.wanted();
        self.axis.step(STEP, wanted);
        let position = self.position();
        self.past.push_back((self.now, position));
        if self.past.len() > 4_000 {
            self.past.pop_front();
        }
        self.record.truth(self.now, &self.axis);
    }

    /// Speed that the servo asks of the motor.
    fn wanted(&mut self) -> f64 {
        let measured = f64::from(self.position()) / QC_PER_DEG;
        match self.state {
            State::Enabled => {
                self.demand = match (self.value(0x6060, 0), self.profile) {
                    (6, _) => self.search(STEP),
                    (_, Some(profile)) => profile.at(self.now),
                    (_, None) => (self.demand.0, 0.0),
                };
                let (demand, speed) = self.demand;
                match self.faults.motor {
                    Motor::Follows => speed + GAIN * (demand - measured),
                    Motor::Backwards => -speed,
                    Motor::RunsAt(speed) => speed,
                    Motor::KeepsOn => *self.faults.kept.get_or_insert(self.axis.speed),
                }
            }
            State::QuickStop | State::Reaction => {
                self.demand = (measured, 0.0);
                let step = f64::from(self.value(0x6085, 0)) * DEG_S_PER_RPM * STEP;
                self.ramp -= self.ramp.clamp(-step, step);
                if self.state == State::Reaction && self.ramp == 0.0 {
                    self.state = State::Fault;
                    self.power(false);
                }
                match self.faults.creeps {
                    Some(speed) => speed,
                    None => self.ramp,
                }
            }
            _ => {
                self.demand = (measured, 0.0);
                0.0
            }
        }
    }

    fn brake(&mut self) {
        // Only an output with purpose 2, enabled in the mask, moves the brake.
        let is_wired = (1..=5).any(|output| self.value(0x2079, output) == 2);
        let has_brake = is_wired && self.value(0x2078, 2) & 4 != 0;
        let ms = |sub| f64::from(self.value(0x2100, sub)) / 1e3;
        let since = self.now - self.power_since;
        if self.faults.brake_stays_shut {
            self.axis.braked = true;
        } else if self.axis.powered {
            self.axis.braked &= has_brake && since < ms(1);
        } else {
            self.axis.braked |= has_brake && since >= ms(2) && !self.faults.brake_stays_open;
        }
    }

    /// What a healthy drive does by itself.
    fn protect(&mut self) {
        if self.state != State::Enabled || self.faults.unprotected {
            return;
        }
        let measured = f64::from(self.position());
        let error = (self.demand.0 * QC_PER_DEG - measured).abs();
        if error > f64::from(self.value(0x6065, 0)) {
            self.fail(0x8611, true);
        }
        if self.value(0x6060, 0) == 6 || self.faults.ignores_switches {
            return;
        }
        let pressed = self.inputs() as u32 & self.value(0x2071, 2) & self.value(0x2071, 4);
        match pressed & 3 {
            0 => {}
            1 => self.fail(0xFF06, true),
            _ => self.fail(0xFF07, true),
        }
    }

    /// Installs a misbehaviour; it acts when its time comes.
    pub fn arm(&mut self, misbehaviour: &'static Misbehaviour) {
        self.faults.armed = Some(misbehaviour);
        self.trigger(When::Start);
    }

    fn trigger(&mut self, when: When) {
        if let Some(armed) = self.faults.armed
            && armed.when == when
            && !self.record.has_begun()
        {
            self.record.begin(self.now);
            (armed.act)(self);
        }
    }

    pub(crate) fn trigger_at_start(&mut self, plan: &Profile) {
        if (plan.to - plan.from).abs() > SWEEP_DEG {
            self.trigger(When::SweepStart);
        }
    }

    pub(crate) fn trigger_at_stop(&mut self, word: u16) {
        let stops = word & 0x02 == 0 || word & 0x04 == 0;
        if stops && self.record.is_signalled() {
            self.trigger(When::Stopping);
        }
    }

    fn trigger_in_motion(&mut self) {
        if self.homing.seconds(self.now) > 0.2 {
            self.trigger(When::Homing);
        }
        if let Some(homed) = self.record.homed
            && self.state == State::Enabled
        {
            self.trigger(When::Homed);
            if self.now - homed > 0.05 && self.profile.is_none() {
                self.trigger(When::Waiting);
            }
        }
        let Some(profile) = self.profile else { return };
        let is_sweep = (profile.to - profile.from).abs() > SWEEP_DEG;
        if is_sweep && self.now > profile.start + 0.4 {
            self.record.mid_sweep(self.now);
            self.trigger(When::MidSweep);
        }
        if is_sweep && self.now > profile.start + profile.duration() - 0.1 {
            self.trigger(When::Braking);
        }
    }
}
