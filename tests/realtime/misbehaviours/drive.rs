//! The firmware of the fake drive: its objects, its state machine and its servo. Written from the
//! facts about the EPOS2 alone: it shares no code with the client, its codec or the simulator.

use std::collections::{BTreeMap, VecDeque};

use crate::faults::{Faults, Report};
use crate::homing::Homing;
use crate::motion::{Axis, DEG_S_PER_RPM, Profile, QC_PER_DEG, SWITCHES};
use crate::objects::OBJECTS;
use crate::record::{self, Event, Record};

/// Travel after which homing without a switch must end: the range, the home offset and 10 deg.
const HOMING_BOUND: f64 = 45.0 + 1.0 + 10.0;

/// States of CiA 402.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Switch-on disabled.
    Disabled,
    /// Ready to switch on.
    Ready,
    /// Switched on.
    SwitchedOn,
    /// Operation enabled.
    Enabled,
    /// Quick stop active.
    QuickStop,
    /// A fault stops the axis by a ramp.
    Reaction,
    /// Fault.
    Fault,
}

/// A drive with its axis.
pub struct Drive {
    /// Seconds since it was made.
    pub now: f64,
    /// The axis.
    pub axis: Axis,
    /// What is wrong with it.
    pub faults: Faults,
    /// What happened.
    pub record: Record,
    /// State of the power stage.
    pub state: State,
    /// EMCY messages to send.
    pub emergencies: VecDeque<u16>,
    /// Switched on at this time after a loss of supply.
    pub boots_at: Option<f64>,
    /// A boot-up message is due.
    pub booted: bool,
    /// NMT state operational.
    pub operational: bool,
    pub(crate) objects: BTreeMap<(u16, u8), (u8, bool, u32)>,
    pub(crate) referenced: bool,
    /// Quadcounts added to those of the encoder.
    pub(crate) offset: i64,
    acknowledged: bool,
    control: u16,
    pub(crate) profile: Option<Profile>,
    pub(crate) homing: Homing,
    /// Demand, degrees of the drive's zero, and its speed.
    pub(crate) demand: (f64, f64),
    pub(crate) ramp: f64,
    pub(crate) quick_stop_at: Option<f64>,
    pub(crate) power_off_at: Option<f64>,
    pub(crate) power_since: f64,
    /// Positions of the last half second.
    pub(crate) past: VecDeque<(f64, i32)>,
    /// Shown position minus demand before the misbehaviour of homing.
    homing_lag: f64,
}

impl Drive {
    /// A drive that was just switched on.
    pub fn new(deg: f64) -> Self {
        let mut drive = Self {
            now: 0.0,
            axis: Axis::new(deg),
            faults: Faults::default(),
            record: Record::default(),
            state: State::Disabled,
            emergencies: VecDeque::new(),
            boots_at: None,
            booted: true,
            operational: false,
            objects: BTreeMap::new(),
            referenced: false,
            offset: 0,
            acknowledged: false,
            control: 0,
            profile: None,
            homing: Homing::default(),
            demand: (0.0, 0.0),
            ramp: 0.0,
            quick_stop_at: None,
            power_off_at: None,
            power_since: 0.0,
            past: VecDeque::new(),
            homing_lag: 0.0,
        };
        drive.forget();
        drive
    }

    /// The client is shown what it must not overlook.
    pub fn show(&mut self) {
        self.record.show(self.now);
    }

    /// Everything that a loss of supply loses.
    fn forget(&mut self) {
        self.objects = OBJECTS
            .iter()
            .map(|&(index, sub, width, writable, value)| ((index, sub), (width, writable, value)))
            .collect();
        self.state = State::Disabled;
        self.referenced = false;
        self.offset = -(self.axis.counted * QC_PER_DEG) as i64;
        (self.acknowledged, self.control) = (false, 0);
        self.profile = None;
        self.homing = Homing::default();
        self.operational = false;
        self.emergencies.clear();
        (self.quick_stop_at, self.power_off_at) = (None, None);
        (self.axis.powered, self.axis.braked) = (false, true);
    }

    /// The supply fails for `seconds`.
    pub fn lose_supply(&mut self, seconds: f64) {
        self.forget();
        self.boots_at = Some(self.now + seconds);
    }

    /// Value of an object as unsigned number.
    pub fn value(&self, index: u16, sub: u8) -> u32 {
        self.objects.get(&(index, sub)).map_or(0, |object| object.2)
    }

    /// Sets an object from within.
    pub fn set(&mut self, index: u16, sub: u8, value: u32) {
        if let Some(object) = self.objects.get_mut(&(index, sub)) {
            object.2 = value;
        }
    }

    pub(crate) fn signed(&self, index: u16) -> f64 {
        f64::from(self.value(index, 0).cast_signed())
    }

    /// Position actual value, as the servo knows it.
    pub fn position(&self) -> i32 {
        let counts = (self.axis.counted * QC_PER_DEG).round() as i64 + self.offset;
        let dither = match self.axis.speed.abs() < 0.5 {
            true => (self.faults.dither * (self.now * 700.0).sin()).round() as i64,
            false => 0,
        };
        (counts + dither) as i32
    }

    /// Position as reported.
    fn reported(&mut self) -> i32 {
        let now = self.position();
        match self.faults.report {
            Report::Truth => now,
            Report::Held => *self.faults.held.get_or_insert(now),
            Report::Shifted(qc) => now.wrapping_add(qc),
            Report::Late(by) => {
                let at = self.now - by;
                let known = self.past.iter().rev().find(|(t, _)| *t <= at);
                known.map_or(now, |(_, position)| *position)
            }
        }
    }

    /// Reads an object: its value and bytes, or an error code.
    pub fn read(&mut self, index: u16, sub: u8) -> Result<(u32, u8), u32> {
        self.judge(index, sub);
        let signed = |value: i32| value.cast_unsigned();
        let value = match (index, sub) {
            (0x6041, 0) => u32::from(self.statusword()),
            (0x6064, 0) => {
                let reported = self.reported();
                let shown = match self.faults.wrong_object {
                    true => i32::from(self.statusword()),
                    false => reported,
                };
                let deg = f64::from(shown) / QC_PER_DEG;
                self.record.sample(self.now, deg, self.referenced);
                self.sample_homing(deg);
                signed(shown)
            }
            (0x6062, 0) => signed((self.demand.0 * QC_PER_DEG) as i32),
            (0x606C | 0x2028, 0) if self.faults.speed_lies => signed(-1_234),
            (0x606C | 0x2028, 0) => signed((self.axis.speed / DEG_S_PER_RPM) as i32),
            (0x6061, 0) if self.faults.mode_lies => 3,
            (0x6061, 0) => self.value(0x6060, 0),
            (0x2071, 1) => u32::from(self.inputs()),
            (0x1013, 0) => (self.now * 1e6) as u64 as u32,
            (0x1001, 0) => u32::from(self.state == State::Fault),
            _ => self.value(index, sub),
        };
        match self.objects.get(&(index, sub)) {
            Some((width, ..)) => Ok((value, *width)),
            None if self.objects.keys().any(|key| key.0 == index) => Err(0x0609_0011),
            None => Err(0x0602_0000),
        }
    }

    /// The client is shown a position while the axis homes: judges it by the demand.
    fn sample_homing(&mut self, deg: f64) {
        let lag = deg - self.demand.0;
        if self.homing.seconds(self.now) == 0.0 || !self.record.has_begun() {
            self.homing_lag = lag;
            return;
        }
        let speed = f64::from(self.value(0x6099, 1)) * DEG_S_PER_RPM;
        if (lag - self.homing_lag).abs() > record::SHARE * (0.53 + speed * 0.05) {
            self.show();
        }
    }

    /// Whether this answer shows the misbehaviour: a fault, a lost state, a pressed switch.
    fn judge(&mut self, index: u16, sub: u8) {
        let is_moving = self.profile.is_some() || self.homing.seconds(self.now) > 0.0;
        let shows = match (index, sub) {
            (0x6041, 0) => is_moving && self.statusword() & 0x6F != 0x27,
            (0x2071, 1) => is_moving && self.referenced && self.inputs() & 3 != 0,
            (0x6062, 0) => self.homing.travelled > HOMING_BOUND,
            _ => false,
        };
        if shows {
            self.show();
        }
    }

    /// Writes an object.
    pub fn write(&mut self, index: u16, sub: u8, value: u32) -> Result<(), u32> {
        if (index, sub) == (0x6040, 0) {
            self.record.event(self.now, Event::Control(value as u16));
            self.trigger_at_stop(value as u16);
        }
        let object = self.objects.get_mut(&(index, sub));
        let Some((width, writable, held)) = object else {
            return Err(0x0602_0000);
        };
        if !*writable {
            return Err(0x0601_0002);
        }
        if self.faults.ignores_writes {
            return Ok(());
        }
        *held = match *width {
            1 => value & 0xFF,
            2 => value & 0xFFFF,
            _ => value,
        };
        match (index, sub) {
            (0x6040, 0) => self.obey(value as u16),
            (0x1003, 0) if value == 0 => (0..6).for_each(|sub| self.set(0x1003, sub, 0)),
            _ => {}
        }
        Ok(())
    }

    /// Statusword.
    pub fn statusword(&self) -> u16 {
        let state = match self.state {
            _ if self.faults.claims_off => 0x0140,
            State::Disabled => 0x0140,
            State::Ready => 0x0121,
            State::SwitchedOn => 0x0123,
            State::Enabled => 0x0137,
            State::QuickStop => 0x0117,
            State::Reaction => 0x011F,
            State::Fault => 0x0108,
        };
        let is_homing = self.value(0x6060, 0) == 6;
        let reached = match is_homing {
            true => self.homing.is_done(),
            false => self
                .profile
                .is_none_or(|p| self.now >= p.start + p.duration()),
        };
        let reached = match self.faults.reached {
            Some(claimed) if !is_homing => claimed,
            _ => reached,
        };
        let bit12 = match is_homing {
            true => self.homing.is_done(),
            false => self.acknowledged && !self.faults.never_acknowledges,
        };
        state
            | u16::from(self.operational || !self.record.can) << 9
            | u16::from(reached) << 10
            | u16::from(bit12) << 12
            | u16::from(is_homing && self.homing.has_failed()) << 13
            | u16::from(self.referenced) << 15
    }

    fn obey(&mut self, word: u16) {
        let rising = word & !self.control;
        self.control = word;
        let is_on = matches!(self.state, State::Enabled | State::QuickStop);
        if matches!(self.state, State::Fault | State::Reaction) {
            if rising & 0x80 != 0 && self.state == State::Fault {
                self.state = State::Disabled;
            }
            return;
        }
        if word & 0x02 == 0 {
            if let Some(fewer) = self.faults.lost_disables.checked_sub(1) {
                self.faults.lost_disables = fewer;
            } else if !(is_on && self.faults.ignores_disable) {
                self.power_off_at = Some(self.now + self.faults.disables_after);
            }
            return;
        }
        if word & 0x04 == 0 {
            match self.state {
                State::Enabled if self.faults.ignores_quick_stop => {}
                State::Enabled => {
                    self.quick_stop_at = Some(self.now + self.faults.stops_after);
                }
                State::QuickStop => {}
                _ => self.state = State::Disabled,
            }
            return;
        }
        match (word & 0x0F, self.state) {
            (0x06 | 0x0E, State::Enabled) if self.faults.ignores_disable => {}
            (0x06 | 0x0E, State::Enabled | State::SwitchedOn | State::Disabled) => {
                self.power(false);
                self.state = State::Ready;
            }
            (0x07, State::Ready) => self.state = State::SwitchedOn,
            (0x07, State::Enabled) if !self.faults.ignores_disable => {
                self.power(false);
                self.state = State::SwitchedOn;
            }
            (0x0F, State::Ready | State::SwitchedOn) => {
                self.state = State::Enabled;
                self.demand = (f64::from(self.position()) / QC_PER_DEG, 0.0);
                self.profile = None;
                self.power(true);
            }
            _ => {}
        }
        if word & 0x10 == 0 {
            self.acknowledged = false;
        }
        if self.state == State::Enabled && rising & 0x10 != 0 {
            match self.value(0x6060, 0) {
                1 => self.start(),
                6 => self.start_homing(),
                _ => {}
            }
        }
    }

    fn start(&mut self) {
        let speed = f64::from(self.value(0x6081, 0).min(self.value(0x607F, 0)));
        let plan = Profile {
            from: self.demand.0,
            to: self.signed(0x607A) / QC_PER_DEG,
            speed: speed * DEG_S_PER_RPM,
            acceleration: f64::from(self.value(0x6083, 0)) * DEG_S_PER_RPM,
            start: self.now,
        };
        self.record.plan(plan);
        self.trigger_at_start(&plan);
        if self.faults.ignores_targets {
            return;
        }
        self.acknowledged = true;
        self.profile = Some(Profile {
            speed: plan.speed * self.faults.speed_factor,
            ..plan
        });
    }

    /// Switches the motor; the brake follows.
    pub(crate) fn power(&mut self, on: bool) {
        if self.axis.powered != on {
            self.axis.powered = on;
            self.power_since = self.now;
        }
    }

    /// Enters a fault.
    pub fn fail(&mut self, code: u16, by_ramp: bool) {
        if matches!(self.state, State::Fault | State::Reaction) {
            return;
        }
        for sub in (2..=5).rev() {
            self.set(0x1003, sub, self.value(0x1003, sub - 1));
        }
        self.set(0x1003, 1, u32::from(code));
        self.set(0x1003, 0, (self.value(0x1003, 0) + 1).min(5));
        if self.faults.sends_emcy {
            self.emergencies.push_back(code);
        }
        self.record.event(self.now, Event::Fault(code));
        if by_ramp && self.state == State::Enabled {
            self.ramp = self.axis.speed;
            self.state = State::Reaction;
        } else {
            self.state = State::Fault;
            self.power(false);
        }
    }

    /// Bits of the limit switches that are pressed.
    pub(crate) fn inputs(&self) -> u16 {
        let pressed =
            u16::from(self.axis.deg <= SWITCHES.0) | u16::from(self.axis.deg >= SWITCHES.1) << 1;
        self.faults.switches.seen(pressed, self.now)
    }

    /// Whether the positive switch is pressed, for homing.
    pub(crate) fn is_positive_pressed(&self) -> bool {
        self.inputs() & 2 != 0
    }
}
