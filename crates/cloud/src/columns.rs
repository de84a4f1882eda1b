//! The columns of a cloud other than positions, in one table.
//!
//! [`for_each_column`] hands the table to a macro: [`Column`] and [`Fields`] are made here,
//! `Point`, `Points` and `Spare` in `points`. A new column is a row here, its number types in the
//! formats, and its value in `scanner`.

use std::fmt;
use std::ops::{BitOr, BitOrAssign, Sub};

/// Calls a macro with a row for each column, in the order in which files list them: [`Column`]
/// variant, [`Fields`] constant, name in files; column of `Points` and its element; field of
/// `Point` and its type; conversions from field to element and back.
macro_rules! for_each_column {
    ($callback:ident) => {
        $callback! {
            /// Calibrated reflectivity as the lidar reports it, 0..=255.
            Intensity INTENSITY "intensity" (intensity: u8) (intensity: u8) identity, identity;
            /// Ring, 0 = lowest elevation.
            Ring RING "ring" (ring: u8) (ring: u8) identity, identity;
            /// Time of the firing on the host's clock.
            Time TIME "time" (time: Stamp<Host>) (time: Stamp<Host>) identity, identity;
            /// Tilt angle of the platform at the firing, degrees.
            Tilt TILT "tilt" (tilt_deg: f64) (tilt: Degrees) |tilt: Degrees| tilt.0, Degrees;
            /// Laser number in firing order.
            Laser LASER "laser" (laser: u8) (laser: u8) identity, identity;
            /// Time of the firing on the lidar's own clock.
            DeviceTime DEVICE_TIME "device_time"
                (device_time: Stamp<Lidar>) (device_time: Stamp<Lidar>) identity, identity;
            /// Standard error of the point in three dimensions, metres.
            Sd SD "sd" (sd_m: f64) (sd_m: f64) identity, identity;
            /// Return of its pulse: 1 strongest, 2 last, 3 both at one distance, 4 second return, 0
            /// unknown. The second return of dual mode is the strongest, or the second strongest if
            /// the last is the strongest.
            Echo ECHO "echo" (echo: u8) (echo: u8) identity, identity;
        }
    };
}
pub(crate) use for_each_column;

macro_rules! define_columns {
    ($($(#[$doc:meta])* $variant:ident $constant:ident $name:literal
        ($column:ident: $element:ty) ($field:ident: $value:ty) $to:expr, $from:expr;)*) => {
        /// A column other than the position.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Column {
            $($(#[$doc])* $variant,)*
        }

        impl Column {
            /// Every column, in the order in which files list them.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Name in files and messages.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }
        }

        impl Fields {
            $(
                #[doc = concat!("[`Column::", stringify!($variant), "`].")]
                pub const $constant: Self = Column::$variant.field();
            )*
            /// Every column.
            pub const ALL: Self = Self(0 $(| Self::$constant.0)*);
        }
    };
}
for_each_column!(define_columns);

impl Column {
    /// The set of this column alone.
    #[must_use]
    pub const fn field(self) -> Fields {
        Fields(1 << self as u8)
    }
}

/// A set of columns: those that a sink requests, or that a cloud has.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Fields(u8);

impl Fields {
    /// Positions alone.
    pub const NONE: Self = Self(0);
    /// Default columns of a file: intensity, ring, time and tilt.
    pub const FILE: Self = Self(Self::INTENSITY.0 | Self::RING.0 | Self::TIME.0 | Self::TILT.0);

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
#[non_exhaustive]
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
    fn every_column_has_a_distinct_bit_and_name() {
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
