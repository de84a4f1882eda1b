//! Limit switches during a motion. A healthy drive stops at them by itself; the client reads them
//! (2071:1) for the others.

use protocol::epos2::objects::{self, input};

use crate::config::AxisConfig;
use crate::error::DriveError;
use crate::ops::Ops;

use super::power::check_enabled;

/// The limit switches that must not be pressed.
pub(super) struct SwitchWatch {
    /// Bits of 2071 that end the motion.
    watched: u16,
    /// Bits that do once they are released: the axis stands on these switches and leaves them.
    leaving: u16,
}

impl SwitchWatch {
    /// Watch of a move from `from` to `to`, qc, which may leave the switch behind it.
    pub fn of_move(config: &AxisConfig, from: i32, to: i32) -> Self {
        let tolerance = config.tolerance_qc(config.arrival_tolerance).0;
        let leaving = match to.saturating_sub(from) {
            way if way > tolerance => input::NEGATIVE_LIMIT,
            way if way < -tolerance => input::POSITIVE_LIMIT,
            // It stays where it is.
            _ => input::NEGATIVE_LIMIT | input::POSITIVE_LIMIT,
        };
        Self::new(config, leaving)
    }

    /// Watch of homing: a method that searches a limit switch must not reach the other one. A
    /// search for a home switch may turn at either.
    pub fn of_homing(config: &AxisConfig) -> Self {
        let ignored = match config.homing.method {
            1 | 17 => input::NEGATIVE_LIMIT,
            2 | 18 => input::POSITIVE_LIMIT,
            7 | 11 | 23 | 27 => input::NEGATIVE_LIMIT | input::POSITIVE_LIMIT,
            _ => 0,
        };
        let both = input::NEGATIVE_LIMIT | input::POSITIVE_LIMIT;
        let watch = Self::new(config, both);
        Self {
            leaving: watch.leaving & !ignored,
            ..watch
        }
    }

    fn new(config: &AxisConfig, leaving: u16) -> Self {
        let fitted = config.limit_switches.mask();
        Self {
            watched: fitted & !leaving,
            leaving: fitted & leaving,
        }
    }

    /// Reads the switches.
    ///
    /// # Errors
    /// [`DriveError::LimitSwitch`], or the drive's own reaction, which has a better reason.
    pub async fn check(&mut self, ops: &Ops) -> Result<(), DriveError> {
        let mut inputs = ops.read(objects::INPUT_STATE).await?;
        if inputs & self.watched != 0 {
            // A single reply may be that to an earlier request.
            inputs = ops.read(objects::INPUT_STATE).await?;
        }
        let released = self.leaving & !inputs;
        let pressed = inputs & self.watched;
        self.watched |= released;
        self.leaving &= !released;
        if pressed == 0 {
            return Ok(());
        }
        check_enabled(ops).await?;
        Err(DriveError::LimitSwitch {
            positive: pressed & input::POSITIVE_LIMIT != 0,
            inputs,
        })
    }
}
