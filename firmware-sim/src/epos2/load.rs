//! The axis without the servo's hold: gravity, friction, holding brake and encoder dither.
//!
//! Absent unless the configuration has an [`AxisLoad`]: an unpowered shaft then stays in place.

use super::config::AxisLoad;
use super::node::SimulatedDrive;

/// Position of the brake's armature, which follows the output of the drive with a delay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BrakeArmature {
    open: bool,
    /// Time since the output asked for the other position, ms.
    moving_ms: u16,
}

impl SimulatedDrive {
    /// Advances the brake by one millisecond.
    pub(super) fn advance_brake(&mut self) {
        let Some(brake) = self.config.load.and_then(|load| load.brake) else {
            return;
        };
        let open = self.is_brake_energised();
        let armature = &mut self.armature;
        if open == armature.open {
            armature.moving_ms = 0;
        } else {
            let delay = if open {
                brake.opening_ms
            } else {
                brake.closing_ms
            };
            if armature.moving_ms >= delay {
                *armature = BrakeArmature { open, moving_ms: 0 };
            } else {
                armature.moving_ms += 1;
            }
        }
        // The motor cannot turn a closed brake.
        self.shaft.braked = !self.armature.open;
    }

    /// Moves an unpowered shaft by one millisecond; the demand follows it.
    pub(super) fn coast(&mut self, load: AxisLoad) {
        let holding = match load.brake {
            Some(brake) if !self.armature.open => brake.holding_rpm_s,
            _ => 0,
        };
        let friction = load.friction_rpm_s.saturating_add(holding);
        self.shaft
            .coast(load.gravity_rpm_s, friction, self.generator.qc_per_turn);
        self.shaft.rest();
        self.generator.rest_at(self.shaft.position);
    }

    /// Deviation of the encoder's count from the shaft at rest, qc: the servo's limit cycle, a new
    /// value in each control cycle.
    pub(super) fn dither_qc(&self) -> i64 {
        let amplitude = u64::from(self.config.dither_qc);
        let segment = self.segment();
        if amplitude == 0 || !self.is_powered() || segment.start != segment.end {
            return 0;
        }
        // Fibonacci hashing: the product's high bits are spread evenly.
        let hash = (self.time_us() / 1000).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
        (hash % (2 * amplitude + 1)) as i64 - amplitude as i64
    }
}
