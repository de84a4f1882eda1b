//! Number formats of the motion: integers, exact at whole milliseconds.
//!
//! An acceleration in whole rpm/s changes the speed by whole millirpm per millisecond, and in one
//! millisecond at `v` millirpm the shaft moves `v * qc_per_turn / 60e6` qc. Positions have units of
//! 1/120e6 qc (the 2 is for the half in `a t^2 / 2`), in which no step leaves a remainder. Instants
//! between two milliseconds, where the phases of a profile meet, have 32 fractional bits.

/// Position units in one quadcount.
pub(super) const FINE_PER_QC: i64 = 120_000_000;
/// Fractional bits of speeds (millirpm) and times (ms).
pub(super) const BITS: u32 = 32;
/// One millisecond.
pub(super) const MS: i128 = 1 << BITS;
/// Largest number of qc per revolution in this arithmetic (the drive permits 2,500,000 lines).
pub(super) const MAX_QC_PER_TURN: u32 = 10_000_000;
/// Largest distance from the world zero; Q32.32 can hold it.
pub(super) const WORLD_END: i64 = (i32::MAX as i64) * FINE_PER_QC;

/// A position in 1/120e6 qc.
pub(super) type Fine = i64;

/// A speed in millirpm with 32 fractional bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Speed(pub i64);

impl Speed {
    pub const ZERO: Self = Self(0);

    /// From whole rpm; the limit of the drive, 25000 rpm (607F), leaves 6 bits.
    pub const fn from_rpm(rpm: i32) -> Self {
        Self((rpm as i64 * 1000) << BITS)
    }

    /// To the nearest rpm.
    pub const fn to_rpm(self) -> i32 {
        let half = 500i64 << BITS;
        (self.0 + half).div_euclid(1000 << BITS) as i32
    }

    pub const fn squared(self) -> i128 {
        self.0 as i128 * self.0 as i128
    }
}

/// The position of an encoder count.
pub(super) const fn fine(qc: i64) -> Fine {
    qc.saturating_mul(FINE_PER_QC)
}

/// The encoder count at a position.
pub(super) const fn floor_qc(position: Fine) -> i64 {
    position.div_euclid(FINE_PER_QC)
}

/// A position in 2^-32 qc, rounded down.
pub(super) const fn q32(position: Fine) -> i64 {
    (((position as i128) << 32).div_euclid(FINE_PER_QC as i128)) as i64
}

/// Position units covered by `work` (millirpm times ms, with 64 fractional bits), clamped far above
/// any distance in use.
pub(super) fn distance(work: i128, qc_per_turn: u32) -> Fine {
    const MOST: i128 = 4 * WORLD_END as i128;
    match work.checked_mul(i128::from(qc_per_turn)) {
        Some(product) => (product >> (2 * BITS)).clamp(-MOST, MOST) as Fine,
        None if work < 0 => -MOST as Fine,
        None => MOST as Fine,
    }
}

/// Quotient towards plus infinity of non-negative numbers.
pub(super) const fn div_ceil(a: i128, b: i128) -> i128 {
    (a + b - 1) / b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_at_one_rpm_is_one_revolution() {
        let work = i128::from(Speed::from_rpm(1).0) * 2 * 60_000 * MS;
        assert_eq!(distance(work, 2000), fine(2000));
        assert_eq!(distance(work, 1999), fine(1999));
        assert_eq!(distance(-work, 2000), fine(-2000));
    }

    #[test]
    fn rpm_round_to_nearest() {
        assert_eq!(Speed::from_rpm(-25_000).to_rpm(), -25_000);
        assert_eq!(Speed(Speed::from_rpm(1).0 / 2).to_rpm(), 1);
        assert_eq!(Speed(Speed::from_rpm(1).0 / 2 - 1).to_rpm(), 0);
    }

    #[test]
    fn counts_round_down() {
        assert_eq!(floor_qc(-1), -1);
        assert_eq!(floor_qc(fine(7)), 7);
        assert_eq!(q32(fine(-3)), -3 << 32);
        assert_eq!(q32(FINE_PER_QC / 2), 1 << 31);
        assert_eq!(q32(WORLD_END) >> 32, i64::from(i32::MAX));
    }

    #[test]
    fn distances_out_of_range_are_clamped() {
        assert_eq!(distance(i128::MAX, MAX_QC_PER_TURN), 4 * WORLD_END);
        assert_eq!(distance(i128::MIN, MAX_QC_PER_TURN), -4 * WORLD_END);
    }
}
