//! The error register (1001), the error history (1003), and pending emergency messages.

use protocol::epos2::DeviceError;

/// Depth of the history.
const DEPTH: usize = 5;
/// Capacity of pending emergency messages.
const PENDING: usize = 8;

/// Errors of the drive.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    register: u8,
    /// Latest first.
    history: [u32; DEPTH],
    count: usize,
    /// Oldest first.
    pending: [PendingEmergency; PENDING],
    pending_count: usize,
}

/// An emergency message to send: the error ([`DeviceError::NONE`] if all are gone) and the register
/// after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PendingEmergency {
    pub error: DeviceError,
    pub register: u8,
}

impl Errors {
    pub fn push(&mut self, error: DeviceError) {
        self.register |= register_bits(error);
        self.queue(error);
        self.history.copy_within(..DEPTH - 1, 1);
        self.history[0] = error.0.into();
        self.count = (self.count + 1).min(DEPTH);
    }

    pub const fn register(&self) -> u8 {
        self.register
    }

    /// Fault reset: no error is active any more; the history remains.
    pub fn acknowledge(&mut self) {
        self.register = 0;
        self.queue(DeviceError::NONE);
    }

    /// Queues an emergency message; a full queue drops its oldest.
    fn queue(&mut self, error: DeviceError) {
        if self.pending_count == PENDING {
            self.next_pending();
        }
        let register = self.register;
        if let Some(free) = self.pending.get_mut(self.pending_count) {
            *free = PendingEmergency { error, register };
            self.pending_count += 1;
        }
    }

    /// Takes the oldest pending emergency message.
    pub fn next_pending(&mut self) -> Option<PendingEmergency> {
        let pending = *self.pending.first().filter(|_| self.pending_count > 0)?;
        self.pending.rotate_left(1);
        self.pending_count -= 1;
        Some(pending)
    }

    pub fn clear_history(&mut self) {
        self.history = [0; DEPTH];
        self.count = 0;
    }

    /// 1003: the number of entries at subindex 0, the entries from 1 on; unused entries are 0.
    pub fn history(&self, sub: u8) -> u32 {
        match usize::from(sub).checked_sub(1) {
            None => self.count as u32,
            Some(i) => self.history.get(i).copied().unwrap_or_default(),
        }
    }
}

/// Bits of the error register as in CiA 301; bit 7 is maxon's "motion error". The specification
/// does not list motion errors; here they are the errors of switches and limits.
const fn register_bits(error: DeviceError) -> u8 {
    const GENERIC: u8 = 1 << 0;
    GENERIC
        | match error.0 {
            0x2000..0x3000 => 1 << 1,
            0x3000..0x4000 | 0x5113 | 0x5114 => 1 << 2,
            0x4000..0x5000 => 1 << 3,
            0x8100..0x8300 => 1 << 4,
            0x8600..0x8700 | 0xFF01..=0xFF05 => 1 << 5,
            0xFF06..=0xFF09 => 1 << 7,
            _ => 0,
        }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_history_keeps_the_latest_five() {
        let mut errors = Errors::default();
        for code in 1..=7 {
            errors.push(DeviceError(code));
        }
        assert_eq!(errors.history(0), 5);
        assert_eq!(
            [1, 2, 3, 4, 5, 6].map(|sub| errors.history(sub)),
            [7, 6, 5, 4, 3, 0]
        );
        errors.clear_history();
        assert_eq!((errors.history(0), errors.history(1)), (0, 0));
    }

    #[test]
    fn new_errors_are_reported_once_in_order_and_limited_to_eight() {
        let mut errors = Errors::default();
        for code in 1..=9 {
            errors.push(DeviceError(code));
        }
        errors.acknowledge();
        let mut reported = [0; 8];
        for reported in &mut reported {
            *reported = errors.next_pending().unwrap().error.0;
        }
        assert_eq!(reported, [3, 4, 5, 6, 7, 8, 9, 0]);
        assert_eq!(errors.next_pending(), None);
    }

    #[test]
    fn the_error_register_has_the_bit_of_the_error() {
        let mut errors = Errors::default();
        errors.push(DeviceError::CAN_PASSIVE);
        assert_eq!(errors.register(), 0x11);
        errors.push(DeviceError::NEGATIVE_LIMIT);
        assert_eq!(errors.register(), 0x91);
        errors.acknowledge();
        assert_eq!(errors.register(), 0);
    }
}
