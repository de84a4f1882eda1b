//! Homing on the positive limit switch (method 18).

use crate::drive::Drive;
use crate::motion::{DEG_S_PER_RPM, Profile, QC_PER_DEG};

#[derive(Clone, Copy, Debug, Default)]
enum Phase {
    #[default]
    Idle,
    Towards,
    Off,
    Leave(Profile),
    Done,
    Failed,
}

/// State of a homing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Homing {
    phase: Phase,
    since: Option<f64>,
    speed: f64,
    /// Degrees of demand.
    pub travelled: f64,
}

impl Homing {
    pub fn is_done(&self) -> bool {
        matches!(self.phase, Phase::Done)
    }

    pub fn has_failed(&self) -> bool {
        matches!(self.phase, Phase::Failed)
    }

    /// Seconds since its start; zero unless it runs.
    pub fn seconds(&self, now: f64) -> f64 {
        match self.phase {
            Phase::Idle | Phase::Done | Phase::Failed => 0.0,
            _ => self.since.map_or(0.0, |since| now - since),
        }
    }
}

impl Drive {
    pub(crate) fn start_homing(&mut self) {
        // Other methods are not needed here: they fail as an unreachable home does.
        let phase = match self.value(0x6098, 0) {
            18 => Phase::Towards,
            _ => Phase::Failed,
        };
        self.referenced = false;
        self.homing = Homing {
            phase,
            since: Some(self.now),
            speed: 0.0,
            travelled: 0.0,
        };
    }

    /// Demand of a running homing after `dt` more seconds.
    pub(crate) fn search(&mut self, dt: f64) -> (f64, f64) {
        let pressed = self.is_positive_pressed();
        let step = f64::from(self.value(0x609A, 0)) * DEG_S_PER_RPM * dt;
        let towards = |from: f64, to: f64| from + (to - from).clamp(-step, step);
        let rate = |rpm: u32| f64::from(rpm) * DEG_S_PER_RPM;
        let (mut demand, speed) = (self.demand.0, self.homing.speed);
        match self.homing.phase {
            Phase::Idle | Phase::Done | Phase::Failed => return (demand, 0.0),
            Phase::Towards if pressed => self.homing.phase = Phase::Off,
            Phase::Towards => self.homing.speed = towards(speed, rate(self.value(0x6099, 1))),
            Phase::Off if !pressed && speed < 0.0 => {
                self.homing.phase = Phase::Leave(Profile {
                    from: demand,
                    to: demand + self.signed(0x607C) / QC_PER_DEG,
                    speed: rate(self.value(0x6099, 1)),
                    acceleration: f64::from(self.value(0x609A, 0)) * DEG_S_PER_RPM,
                    start: self.now,
                });
                return (demand, 0.0);
            }
            Phase::Off => self.homing.speed = towards(speed, -rate(self.value(0x6099, 2))),
            Phase::Leave(profile) => {
                if self.now >= profile.start + profile.duration() {
                    let home = self.value(0x2081, 0).cast_signed();
                    // The axis may still lag: the demand becomes the home position.
                    let at = (profile.to * QC_PER_DEG).round() as i64;
                    self.offset += i64::from(home) - at;
                    self.record.homed = Some(self.now);
                    (self.referenced, self.homing.phase) = (true, Phase::Done);
                    self.past.clear();
                    return (f64::from(home) / QC_PER_DEG, 0.0);
                }
                return profile.at(self.now);
            }
        }
        demand += self.homing.speed * dt;
        self.homing.travelled += self.homing.speed.abs() * dt;
        (demand, self.homing.speed)
    }
}
