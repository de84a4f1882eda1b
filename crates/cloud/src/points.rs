//! Points as a structure of arrays, with only the requested columns.
//!
//! The columns are private, so that they always have one length. [`Points`] serves as a reusable
//! batch ([`Points::clear`] keeps the memory) and as a whole cloud ([`Points::append`]). [`Point`]
//! is a row on its way in or out; [`Points::spare`] is the fast way in.

mod spare;

use std::convert::identity;

use units::{Degrees, Host, Lidar, Stamp};

use crate::columns::for_each_column;
use crate::{Bounds, Column, Fields, MissingColumns, SinkError, Summary};

pub use spare::Spare;

/// A column's elements.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ColumnValues<'a> {
    Bytes(&'a [u8]),
    Floats(&'a [f64]),
    HostTimes(&'a [Stamp<Host>]),
    LidarTimes(&'a [Stamp<Lidar>]),
}

/// An element of a column.
trait Element: Copy {
    const ZERO: Self;
    fn values(column: &[Self]) -> ColumnValues<'_>;
}

macro_rules! element {
    ($($element:ty, $zero:expr, $values:ident;)*) => {$(
        impl Element for $element {
            const ZERO: Self = $zero;
            fn values(column: &[Self]) -> ColumnValues<'_> {
                ColumnValues::$values(column)
            }
        }
    )*};
}
element! {
    u8, 0, Bytes;
    f64, 0.0, Floats;
    Stamp<Host>, Self::from_nanos(0), HostTimes;
    Stamp<Lidar>, Self::from_nanos(0), LidarTimes;
}

macro_rules! define_points {
    ($($(#[$doc:meta])* $variant:ident $constant:ident $name:literal
        ($column:ident: $element:ty) ($field:ident: $value:ty) $to:expr, $from:expr;)*) => {
        /// One point with every column. A column that its [`Points`] lack is dropped on the way in,
        /// and zero on the way out.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Point {
            /// x (right), y (forward), z (up) in metres.
            pub position_m: [f64; 3],
            $($(#[$doc])* pub $field: $value,)*
        }

        impl Default for Point {
            /// Zero in every column.
            fn default() -> Self {
                Self {
                    position_m: [0.0; 3],
                    $($field: ($from)(Element::ZERO),)*
                }
            }
        }

        /// Columns of points, all of one length.
        #[derive(Clone, Debug, Default)]
        pub struct Points {
            fields: Fields,
            /// Number of points. The requested columns have one length, which may be greater: rows
            /// beyond are written before they are counted.
            len: usize,
            x_m: Vec<f64>,
            y_m: Vec<f64>,
            z_m: Vec<f64>,
            $($column: Vec<$element>,)*
        }

        impl Points {
            /// Makes room for `additional` more points.
            pub fn reserve(&mut self, additional: usize) {
                for axis in [&mut self.x_m, &mut self.y_m, &mut self.z_m] {
                    axis.reserve(additional);
                }
                $(if self.fields.contains(Fields::$constant) {
                    self.$column.reserve(additional);
                })*
            }

            /// Adds a point; its values of columns that these points lack are dropped.
            #[inline]
            pub fn push(&mut self, point: Point) {
                let [x, y, z] = point.position_m;
                let row = self.len;
                put(&mut self.x_m, row, x);
                put(&mut self.y_m, row, y);
                put(&mut self.z_m, row, z);
                $(if self.fields.contains(Fields::$constant) {
                    put(&mut self.$column, row, ($to)(point.$field));
                })*
                self.len += 1;
            }

            /// Adds every point of `batch`; columns that these points lack are dropped.
            ///
            /// # Errors
            /// [`MissingColumns`] if the batch lacks a column that these points have; nothing is
            /// added then.
            pub fn append(&mut self, batch: &Self) -> Result<(), MissingColumns> {
                batch.fields.require(self.fields)?;
                let row = self.len;
                extend(&mut self.x_m, row, batch.x_m());
                extend(&mut self.y_m, row, batch.y_m());
                extend(&mut self.z_m, row, batch.z_m());
                $(if self.fields.contains(Fields::$constant) {
                    extend(&mut self.$column, row, batch.$column());
                })*
                self.len += batch.len;
                Ok(())
            }

            $(
                $(#[$doc])*
                ///
                /// Empty if not requested.
                #[must_use]
                pub fn $column(&self) -> &[$element] {
                    self.column(&self.$column)
                }
            )*

            /// The elements of a column.
            pub(crate) fn values(&self, column: Column) -> ColumnValues<'_> {
                match column {
                    $(Column::$variant => Element::values(self.$column()),)*
                }
            }

            /// The point at `index`; columns that these points lack are zero.
            #[must_use]
            pub fn get(&self, index: usize) -> Option<Point> {
                let position_m = [
                    *self.x_m().get(index)?,
                    *self.y_m().get(index)?,
                    *self.z_m().get(index)?,
                ];
                Some(Point {
                    position_m,
                    $($field: ($from)(
                        self.$column().get(index).copied().unwrap_or(Element::ZERO),
                    ),)*
                })
            }

            /// Lengthens every requested column to `end` rows or more: all that is reserved, or
            /// twice that.
            #[cold]
            fn grow(&mut self, end: usize) {
                let reserved = self.x_m.capacity();
                let end = if end <= reserved {
                    reserved
                } else {
                    end.max(2 * reserved)
                };
                for axis in [&mut self.x_m, &mut self.y_m, &mut self.z_m] {
                    axis.resize(end, 0.0);
                }
                $(if self.fields.contains(Fields::$constant) {
                    self.$column.resize(end, Element::ZERO);
                })*
            }
        }

        /// Points are equal if their counted rows are.
        impl PartialEq for Points {
            fn eq(&self, other: &Self) -> bool {
                self.fields == other.fields
                    && self.x_m() == other.x_m()
                    && self.y_m() == other.y_m()
                    && self.z_m() == other.z_m()
                    $(&& self.$column() == other.$column())*
            }
        }
    };
}
for_each_column!(define_points);

impl Points {
    /// No points yet, with the position and the columns `fields`.
    #[must_use]
    pub fn new(fields: Fields) -> Self {
        Self {
            fields,
            ..Self::default()
        }
    }

    /// No points yet, with room for `points` of them in every requested column.
    #[must_use]
    pub fn with_capacity(fields: Fields, points: usize) -> Self {
        let mut columns = Self::new(fields);
        columns.reserve(points);
        columns
    }

    /// Removes the points and keeps the memory.
    pub const fn clear(&mut self) {
        self.len = 0;
    }

    /// The columns other than the position.
    #[must_use]
    pub const fn fields(&self) -> Fields {
        self.fields
    }

    /// Number of points.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no points.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// x (right), metres.
    #[must_use]
    pub fn x_m(&self) -> &[f64] {
        self.column(&self.x_m)
    }

    /// y (forward), metres.
    #[must_use]
    pub fn y_m(&self) -> &[f64] {
        self.column(&self.y_m)
    }

    /// z (up), metres.
    #[must_use]
    pub fn z_m(&self) -> &[f64] {
        self.column(&self.z_m)
    }

    /// The counted rows of a column.
    #[inline]
    fn column<'a, T>(&self, column: &'a [T]) -> &'a [T] {
        column.get(..self.len).unwrap_or_default()
    }

    /// The points one by one, each as [`Points::get`] returns it.
    pub fn iter(&self) -> impl Iterator<Item = Point> + '_ {
        (0..self.len()).filter_map(|index| self.get(index))
    }

    /// The positions one by one, metres.
    pub fn positions(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.x_m()
            .iter()
            .zip(self.y_m())
            .zip(self.z_m())
            .map(|((&x, &y), &z)| [x, y, z])
    }

    /// Replaces every position by `place` of it, metres.
    pub(crate) fn map_positions(&mut self, place: impl Fn([f64; 3]) -> [f64; 3]) {
        let len = self.len;
        let rows = self.x_m.iter_mut().zip(&mut self.y_m).zip(&mut self.z_m);
        for ((x, y), z) in rows.take(len) {
            [*x, *y, *z] = place([*x, *y, *z]);
        }
    }

    /// Count and bounds.
    #[must_use]
    pub fn summary(&self) -> Summary {
        Summary {
            points: self.len() as u64,
            bounds: Bounds::of([self.x_m(), self.y_m(), self.z_m()]),
        }
    }
}

impl Points {
    /// Checks that every coordinate is a number within `limit_m`, for a format that cannot hold
    /// others. `before` points came before these.
    pub(crate) fn check_coordinates(
        &self,
        format: &'static str,
        limit_m: f64,
        before: u64,
    ) -> Result<(), SinkError> {
        for (axis, column) in [('x', self.x_m()), ('y', self.y_m()), ('z', self.z_m())] {
            let is_outside = |value: &f64| value.is_nan() || value.abs() > limit_m;
            if let Some(index) = column.iter().position(is_outside) {
                return Err(SinkError::Coordinate {
                    format,
                    axis,
                    point: before + index as u64,
                    got_m: column.get(index).copied().unwrap_or(f64::NAN),
                    limit_m,
                });
            }
        }
        Ok(())
    }
}

/// Writes `row` of a column, which has it or ends before it.
#[inline]
fn put<T>(column: &mut Vec<T>, row: usize, value: T) {
    match column.get_mut(row) {
        Some(cell) => *cell = value,
        None => column.push(value),
    }
}

/// Writes rows from `row` on, where the column's counted rows end.
fn extend<T: Copy>(column: &mut Vec<T>, row: usize, values: &[T]) {
    column.truncate(row);
    column.extend_from_slice(values);
}

#[cfg(test)]
mod tests;
