//! The fast way into columns: whole arrays are written beyond the last point, then counted as far
//! as they hold points.

use units::{Host, Lidar, Stamp};

use super::Points;
use crate::Fields;
use crate::columns::for_each_column;

macro_rules! define_spare {
    ($($(#[$doc:meta])* $variant:ident $constant:ident $name:literal
        ($column:ident: $element:ty) ($field:ident: $value:ty) $to:expr, $from:expr;)*) => {
        /// `R` rows beyond the last point, to be written; their content is unspecified.
        #[derive(Debug)]
        pub struct Spare<'a, const R: usize> {
            /// x (right), metres.
            pub x_m: &'a mut [f64; R],
            /// y (forward), metres.
            pub y_m: &'a mut [f64; R],
            /// z (up), metres.
            pub z_m: &'a mut [f64; R],
            $($(#[$doc])* pub $column: Option<&'a mut [$element; R]>,)*
        }

        impl Points {
            /// Room for `R` more points, to be written and then counted by [`Points::keep`].
            ///
            /// Never `None`: the room is made first.
            #[inline(always)]
            pub fn spare<const R: usize>(&mut self) -> Option<Spare<'_, R>> {
                let (fields, row) = (self.fields, self.len);
                let end = row + R;
                if self.x_m.len() < end {
                    self.grow(end);
                }
                Some(Spare {
                    x_m: rows(&mut self.x_m, row)?,
                    y_m: rows(&mut self.y_m, row)?,
                    z_m: rows(&mut self.z_m, row)?,
                    $($column: wanted(fields, Fields::$constant, &mut self.$column, row),)*
                })
            }
        }
    };
}
for_each_column!(define_spare);

impl Points {
    /// Counts the first `count` spare rows as points, as far as they exist.
    #[inline]
    pub fn keep(&mut self, count: usize) {
        self.len = (self.len + count).min(self.x_m.len());
    }
}

#[inline(always)]
fn rows<T, const R: usize>(column: &mut [T], row: usize) -> Option<&mut [T; R]> {
    column.get_mut(row..)?.first_chunk_mut()
}

#[inline(always)]
fn wanted<T, const R: usize>(
    fields: Fields,
    field: Fields,
    column: &mut [T],
    row: usize,
) -> Option<&mut [T; R]> {
    if fields.contains(field) {
        rows(column, row)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Column, Point};
    use units::Degrees;

    fn point(n: u8) -> Point {
        let far = f64::from(n);
        Point {
            position_m: [far, far + 0.25, far + 0.5],
            intensity: n,
            ring: n ^ 1,
            laser: n ^ 2,
            time: Stamp::from_nanos(1_000 + i64::from(n)),
            device_time: Stamp::from_nanos(2_000 + i64::from(n)),
            tilt: Degrees(-far),
            sd_m: far / 8.0,
            echo: n ^ 3,
        }
    }

    /// Writes points `first`, `first + 1` and so on into the rows.
    fn write(rows: &mut Spare<'_, 32>, first: u8) {
        for row in 0..32 {
            let point = point(first + row as u8);
            [rows.x_m[row], rows.y_m[row], rows.z_m[row]] = point.position_m;
            let narrow = [
                (&mut rows.intensity, point.intensity),
                (&mut rows.ring, point.ring),
                (&mut rows.laser, point.laser),
                (&mut rows.echo, point.echo),
            ];
            for (column, value) in narrow {
                if let Some(column) = column {
                    column[row] = value;
                }
            }
            if let Some(column) = &mut rows.time {
                column[row] = point.time;
            }
            if let Some(column) = &mut rows.device_time {
                column[row] = point.device_time;
            }
            if let Some(column) = &mut rows.tilt_deg {
                column[row] = point.tilt.0;
            }
            if let Some(column) = &mut rows.sd_m {
                column[row] = point.sd_m;
            }
        }
    }

    #[derive(Clone, Debug)]
    enum Step {
        Push(u8),
        Some(u8, usize),
        Append,
        Clear,
    }

    fn any_step() -> impl Strategy<Value = Step> {
        prop_oneof![
            any::<u8>().prop_map(Step::Push),
            (0u8..200, 0..=32usize).prop_map(|(first, count)| Step::Some(first, count)),
            Just(Step::Append),
            Just(Step::Clear),
        ]
    }

    proptest! {
        #[test]
        fn kept_rows_equal_pushed_points(
            steps in prop::collection::vec(any_step(), 0..12),
            columns in prop::sample::subsequence(Column::ALL.to_vec(), 0..=Column::ALL.len()),
        ) {
            let fields = columns.into_iter().fold(Fields::NONE, |set, column| set | column.field());
            let (mut fast, mut slow) = (Points::new(fields), Points::new(fields));
            for step in steps {
                match step {
                    Step::Push(n) => {
                        fast.push(point(n));
                        slow.push(point(n));
                    }
                    Step::Some(first, count) => {
                        write(&mut fast.spare().unwrap(), first);
                        fast.keep(count);
                        (0..count).for_each(|row| slow.push(point(first + row as u8)));
                    }
                    Step::Append => {
                        let batch = slow.clone();
                        fast.append(&batch).unwrap();
                        slow.append(&batch).unwrap();
                    }
                    Step::Clear => {
                        fast.clear();
                        slow.clear();
                    }
                }
                prop_assert_eq!(&fast, &slow);
                prop_assert_eq!(fast.summary(), slow.summary());
            }
        }
    }

    #[test]
    fn columns_not_requested_are_not_allocated() {
        let mut points = Points::new(Fields::RING);
        let rows = points.spare::<64>().unwrap();
        assert!(rows.ring.is_some() && rows.time.is_none() && rows.tilt_deg.is_none());
        assert_eq!(points.time.capacity(), 0);
        assert!(points.is_empty());
    }
}
