//! Which columns a cloud has beside its positions.
//!
//! A position is what makes a point, so x, y and z are always there and have no bit here.

use std::fmt;
use std::ops::{BitOr, BitOrAssign, Sub};

/// A column beside the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Column {
    /// Calibrated reflectivity as the lidar reports it, 0..=255.
    Intensity,
    /// Ring, 0 = lowest elevation.
    Ring,
    /// Time of the firing on the host's clock.
    Time,
    /// Tilt angle of the platform at the firing, degrees.
    Tilt,
    /// Laser number in firing order.
    Laser,
    /// Time of the firing on the lidar's own clock.
    DeviceTime,
    /// How far the point is off, as a root mean square expected, metres.
    Sd,
    /// Which return of its pulse the point is: 1 the strongest, 2 the last, 3 both at one distance, 4 dual mode's other one (the
    /// strongest, or the second strongest where the last is the strongest), 0 not told.
    Echo,
}

impl Column {
    /// Every column, in the order in which files list them.
    pub const ALL: [Self; 8] = [
        Self::Intensity,
        Self::Ring,
        Self::Time,
        Self::Tilt,
        Self::Laser,
        Self::DeviceTime,
        Self::Sd,
        Self::Echo,
    ];

    /// The column's name in files and messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Intensity => "intensity",
            Self::Ring => "ring",
            Self::Time => "time",
            Self::Tilt => "tilt",
            Self::Laser => "laser",
            Self::DeviceTime => "device_time",
            Self::Sd => "sd",
            Self::Echo => "echo",
        }
    }

    /// The set of this column alone.
    #[must_use]
    pub const fn field(self) -> Fields {
        Fields(1 << self as u8)
    }
}

/// A set of columns: what a sink wants, what a cloud has.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Fields(u8);

impl Fields {
    /// Positions alone.
    pub const NONE: Self = Self(0);
    /// [`Column::Intensity`].
    pub const INTENSITY: Self = Column::Intensity.field();
    /// [`Column::Ring`].
    pub const RING: Self = Column::Ring.field();
    /// [`Column::Time`].
    pub const TIME: Self = Column::Time.field();
    /// [`Column::Tilt`].
    pub const TILT: Self = Column::Tilt.field();
    /// [`Column::Laser`].
    pub const LASER: Self = Column::Laser.field();
    /// [`Column::DeviceTime`].
    pub const DEVICE_TIME: Self = Column::DeviceTime.field();
    /// [`Column::Sd`].
    pub const SD: Self = Column::Sd.field();
    /// [`Column::Echo`].
    pub const ECHO: Self = Column::Echo.field();
    /// What a file carries unless asked otherwise: intensity, ring, time and tilt.
    pub const FILE: Self = Self(Self::INTENSITY.0 | Self::RING.0 | Self::TIME.0 | Self::TILT.0);
    /// Every column.
    pub const ALL: Self =
        Self(Self::FILE.0 | Self::LASER.0 | Self::DEVICE_TIME.0 | Self::SD.0 | Self::ECHO.0);

    /// Whether every column of `other` is in this set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The columns of either set.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether no column is in this set.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The set's columns, in the order of [`Column::ALL`].
    pub fn columns(self) -> impl Iterator<Item = Column> {
        Column::ALL
            .into_iter()
            .filter(move |column| self.contains(column.field()))
    }

    /// Checks that every column of `wanted` is in this set.
    ///
    /// # Errors
    /// [`MissingColumns`] naming those that are not.
    pub fn require(self, wanted: Self) -> Result<(), MissingColumns> {
        let missing = wanted - self;
        if missing.is_empty() {
            Ok(())
        } else {
            Err(MissingColumns { missing, got: self })
        }
    }
}

impl BitOr for Fields {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        self.union(other)
    }
}

impl BitOrAssign for Fields {
    fn bitor_assign(&mut self, other: Self) {
        *self = self.union(other);
    }
}

/// The columns of the first set that are not in the second.
impl Sub for Fields {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

impl fmt::Display for Fields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("position")?;
        for column in self.columns() {
            write!(f, ", {}", column.name())?;
        }
        Ok(())
    }
}

impl fmt::Debug for Fields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.columns()).finish()
    }
}

/// Points lack columns that their reader needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the points lack columns: wanted also {}, got {got}", names(*.missing))]
pub struct MissingColumns {
    /// Columns that were wanted and are not there.
    pub missing: Fields,
    /// Columns that are there.
    pub got: Fields,
}

fn names(fields: Fields) -> String {
    let names: Vec<_> = fields.columns().map(Column::name).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_its_own_bit_and_name() {
        let mut seen = Fields::NONE;
        let mut names = std::collections::BTreeSet::new();
        for column in Column::ALL {
            assert!((seen - column.field()) == seen, "{column:?} shares a bit");
            seen |= column.field();
            names.insert(column.name());
        }
        assert_eq!(seen, Fields::ALL);
        assert_eq!(names.len(), Column::ALL.len());
        assert_eq!(Fields::ALL.columns().collect::<Vec<_>>(), Column::ALL);
    }

    #[test]
    fn missing_columns_are_named() {
        let got = Fields::INTENSITY | Fields::RING;
        assert_eq!(got.require(Fields::RING), Ok(()));
        let error = got.require(Fields::RING | Fields::TIME | Fields::TILT);
        assert_eq!(
            error.unwrap_err().to_string(),
            "the points lack columns: wanted also time, tilt, got position, intensity, ring"
        );
    }
}
