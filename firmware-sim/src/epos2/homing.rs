//! Homing mode (Firmware Specification, "Homing Mode"; methods as in CiA 402).
//!
//! A [`HomingMethod`] detects the edge of a switch once per control cycle; a mechanical stop, where
//! the current reaches its threshold (2080); or the next index pulse, which is latched exactly.
//! After detection the axis moves by the home offset (607C) from the reference, and that position
//! becomes 2081.

use protocol::epos2::cia402::{control, status};
use protocol::epos2::objects::{self, input};

use super::fixed::{Speed, fine, floor_qc};
use super::homing_method::{HomingMethod, ReferenceSearch, method};
use super::node::{SimulatedDrive, bit};
use super::profile::MotionLimits;
use super::ramp::RampShape;

/// State of the present homing and result of the last one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct HomingState {
    phase: Phase,
    method: HomingMethod,
    attained: bool,
    failed: bool,
    /// Bit 10: at rest after homing or its interruption.
    reached: bool,
    /// Count at the last control cycle, for index pulses.
    last: i64,
}

/// Directions are 1 and -1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Idle,
    /// Interrupted: ramping down.
    Stopping,
    /// Towards the switch.
    Search { direction: i32 },
    /// Towards the mechanical stop.
    Press { direction: i32 },
    /// A limit switch came before the home switch: back to the other side of the home switch.
    Back { direction: i32 },
    /// Slowly off the switch; `on` once it was active in this direction.
    Leave { direction: i32, on: bool },
    /// Slowly to the index pulse.
    Index { direction: i32 },
    /// To the home offset from the reference (world qc).
    Return { reference: i64 },
}

impl HomingState {
    /// Whether it moves the axis.
    pub fn is_active(&self) -> bool {
        !matches!(self.phase, Phase::Idle | Phase::Stopping)
    }

    pub fn status_bits(&self) -> u16 {
        bit(self.reached, status::TARGET_REACHED)
            | bit(self.attained, status::HOMING_ATTAINED)
            | bit(self.failed, status::HOMING_ERROR)
    }

    /// Ends homing.
    pub fn abandon(&mut self) {
        self.phase = Phase::Idle;
    }
}

impl SimulatedDrive {
    /// Handles a change of the controlword while operation is enabled: the rising edge of bit 4
    /// starts, its falling edge or a halt interrupts.
    pub(super) fn homing_command(&mut self, old: u16, word: u16) {
        let (rising, falling) = (word & !old, old & !word);
        let interrupted = falling & control::HOMING_START != 0 || rising & control::HALT != 0;
        if self.homing.is_active() && interrupted {
            self.homing.phase = Phase::Stopping;
            self.ramp_down(objects::HOMING_ACCELERATION);
        } else if rising & control::HOMING_START != 0 && word & control::HALT == 0 {
            self.start_homing();
        }
    }

    fn start_homing(&mut self) {
        let number = self.dictionary.get(objects::HOMING_METHOD);
        let chosen = method(number).unwrap_or_default();
        self.homing = HomingState {
            method: chosen,
            last: floor_qc(self.shaft.position),
            ..HomingState::default()
        };
        // 2210:2: only type 1 has an index channel.
        let no_index = self.dictionary.get(objects::SENSOR_TYPE) != 1;
        let rates = [self.homing_speed(true), self.homing_speed(false)];
        let moves = chosen != HomingMethod::default();
        if chosen.index.is_some() && no_index
            || moves && (rates.contains(&Speed::ZERO) || self.homing_acceleration() == 0)
        {
            self.fail_homing();
            return;
        }
        match (chosen.search, chosen.index) {
            (Some(ReferenceSearch::Switch { bit, direction }), _) if self.inputs & bit != 0 => {
                self.leave_switch(-direction, false);
            }
            (Some(ReferenceSearch::Switch { direction, .. }), _) => {
                self.run(direction, true);
                self.homing.phase = Phase::Search { direction };
            }
            (Some(ReferenceSearch::Stop { direction }), _) => {
                self.run(direction, true);
                self.homing.phase = Phase::Press { direction };
            }
            (None, Some(direction)) => {
                self.run(direction, false);
                self.homing.phase = Phase::Index { direction };
            }
            (None, None) => self.home_here(number == 35),
        }
    }

    /// Methods without motion: 35 takes the present position as home, 0 does nothing.
    fn home_here(&mut self, reference: bool) {
        if reference {
            self.set_home(floor_qc(self.shaft.position));
        } else {
            self.homing.attained = true;
            self.homing.reached = true;
        }
    }

    /// Advances the mode by one millisecond.
    pub(super) fn advance_homing(&mut self) {
        let now = floor_qc(self.shaft.position);
        let last = core::mem::replace(&mut self.homing.last, now);
        let moving = self.generator.is_moving();
        match self.homing.phase {
            Phase::Idle => {}
            Phase::Stopping => {
                if !moving {
                    self.homing.phase = Phase::Idle;
                    self.homing.reached = true;
                }
            }
            Phase::Return { reference } => {
                if !moving {
                    let offset = self.dictionary.get(objects::HOME_OFFSET);
                    self.set_home(reference.saturating_add(offset.into()));
                }
            }
            // In these phases only the end of the simulated range stops the shaft.
            _ if !moving => self.fail_homing(),
            Phase::Search { direction } => self.search(direction),
            Phase::Press { direction } => self.watch_current(direction, now),
            Phase::Back { direction } => self.search_back(direction),
            Phase::Leave { direction, on } => self.watch_edge(direction, on, now),
            Phase::Index { direction } => self.watch_index(direction, last, now),
        }
    }

    fn search(&mut self, direction: i32) {
        let switch = self.homing.method.switch_bit();
        let limit = limit_switch(direction);
        if self.inputs & switch != 0 {
            self.leave_switch(-direction, false);
        } else if self.inputs & limit != 0 {
            self.run(-direction, true);
            self.homing.phase = Phase::Back {
                direction: -direction,
            };
        }
    }

    fn search_back(&mut self, direction: i32) {
        let switch = self.homing.method.switch_bit();
        if self.inputs & switch != 0 {
            self.leave_switch(direction, true);
        } else if self.is_going(direction) && self.inputs & limit_switch(direction) != 0 {
            self.fail_homing();
        }
    }

    fn leave_switch(&mut self, direction: i32, on: bool) {
        self.run(direction, false);
        self.homing.phase = Phase::Leave { direction, on };
    }

    /// The edge counts if the switch was active in this direction: deceleration may have passed a
    /// home switch.
    fn watch_edge(&mut self, direction: i32, on: bool, now: i64) {
        let switch = self.homing.method.switch_bit();
        let pressed = self.inputs & switch != 0;
        if !self.is_going(direction) {
            return;
        }
        if pressed {
            self.homing.phase = Phase::Leave {
                direction,
                on: true,
            };
        } else if on {
            match self.homing.method.index {
                Some(direction) => self.homing.phase = Phase::Index { direction },
                None => self.return_to(now),
            }
        }
    }

    /// The stop is the position at which the current reaches the threshold; the demand continues
    /// from there.
    fn watch_current(&mut self, direction: i32, now: i64) {
        let current = i32::from(self.current_actual_ma()) * direction;
        if current < i32::from(self.dictionary.get(objects::HOMING_CURRENT)) {
            return;
        }
        self.shaft.rest();
        self.generator.rest_at(self.shaft.position);
        match self.homing.method.index {
            Some(direction) => {
                self.run(direction, false);
                self.homing.phase = Phase::Index { direction };
            }
            None => self.return_to(now),
        }
    }

    fn watch_index(&mut self, direction: i32, last: i64, now: i64) {
        let turn = i64::from(self.config.qc_per_turn.max(1));
        let first = i64::from(self.config.index_position);
        let pulse = |count: i64| first + (count - first).div_euclid(turn) * turn;
        // Upwards, the last pulse at or below the higher count was passed if it is above the lower
        // count; downwards, a pulse at the lower count was passed, one at the higher was not.
        let passed = if direction > 0 {
            Some(pulse(now)).filter(|&at| at > last)
        } else {
            Some(pulse(last - 1)).filter(|&at| at >= now)
        };
        if self.is_going(direction)
            && let Some(reference) = passed
        {
            self.return_to(reference);
        }
    }

    /// Moves from the reference to the home offset, at the speed of the switch search (the speed is
    /// not specified).
    fn return_to(&mut self, reference: i64) {
        let offset = self.dictionary.get(objects::HOME_OFFSET);
        let acceleration = self.homing_acceleration();
        let limits = MotionLimits {
            speed: self.homing_speed(true),
            acceleration,
            deceleration: acceleration,
            shape: RampShape::Linear,
        };
        let target = fine(reference.saturating_add(offset.into()));
        if self.generator.go_to(target, limits).is_ok() {
            self.homing.phase = Phase::Return { reference };
        } else {
            self.fail_homing();
        }
    }

    /// Makes the position `world` qc home.
    fn set_home(&mut self, world: i64) {
        let position = self.dictionary.get(objects::HOME_POSITION);
        self.origin = world.saturating_sub(position.into());
        self.referenced = true;
        self.homing.phase = Phase::Idle;
        self.homing.attained = true;
        self.homing.reached = true;
    }

    fn fail_homing(&mut self) {
        self.homing.phase = Phase::Idle;
        self.homing.failed = true;
        self.ramp_down(objects::HOMING_ACCELERATION);
    }

    fn run(&mut self, direction: i32, fast: bool) {
        let Speed(speed) = self.homing_speed(fast);
        let acceleration = self.homing_acceleration();
        self.generator.run_at(MotionLimits {
            speed: Speed(speed * i64::from(direction)),
            acceleration,
            deceleration: acceleration,
            shape: RampShape::Linear,
        });
    }

    fn is_going(&self, direction: i32) -> bool {
        self.generator.speed.0.signum() == i64::from(direction)
    }

    fn homing_speed(&self, fast: bool) -> Speed {
        self.speed_within_limits(self.dictionary.get(if fast {
            objects::HOMING_SWITCH_SPEED
        } else {
            objects::HOMING_ZERO_SPEED
        }))
    }

    fn homing_acceleration(&self) -> u32 {
        self.acceleration(objects::HOMING_ACCELERATION)
    }
}

/// The limit switch in a direction.
const fn limit_switch(direction: i32) -> u16 {
    if direction < 0 {
        input::NEGATIVE_LIMIT
    } else {
        input::POSITIVE_LIMIT
    }
}
