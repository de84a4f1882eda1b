//! The fast way into columns: rows beyond the last point are written as whole arrays, then those that hold a point are kept.
//!
//! A producer that makes points by the dozen writes them where they are to stay, in loops without a branch, and says
//! afterwards which of them count. Left out: any meaning of the rows.

use units::{Host, Lidar, Stamp};

use super::{Order, Points};
use crate::Fields;

/// `L` times `N` rows beyond the last point, to be written; what stands in them is of no meaning.
#[derive(Debug)]
pub struct Spare<'a, const N: usize, const L: usize> {
    /// x (right), metres.
    pub x_m: &'a mut [[f64; N]; L],
    /// y (forward), metres.
    pub y_m: &'a mut [[f64; N]; L],
    /// z (up), metres.
    pub z_m: &'a mut [[f64; N]; L],
    /// Reflectivity, if asked for.
    pub intensity: Option<&'a mut [[u8; N]; L]>,
    /// Ring, if asked for.
    pub ring: Option<&'a mut [[u8; N]; L]>,
    /// Laser number, if asked for.
    pub laser: Option<&'a mut [[u8; N]; L]>,
    /// Time on the host's clock, if asked for.
    pub time: Option<&'a mut [[Stamp<Host>; N]; L]>,
    /// Time on the lidar's clock, if asked for.
    pub device_time: Option<&'a mut [[Stamp<Lidar>; N]; L]>,
    /// Tilt angle in degrees, if asked for.
    pub tilt_deg: Option<&'a mut [[f64; N]; L]>,
    /// How far the point is off, as a root mean square expected, metres, if asked for.
    pub sd_m: Option<&'a mut [[f64; N]; L]>,
}

impl Points {
    /// Room for `L` times `N` more points, to be written and then counted by [`Points::keep_all`].
    ///
    /// `None` never happens: the room is made first.
    #[inline]
    pub fn spare<const N: usize, const L: usize>(&mut self) -> Option<Spare<'_, N, L>> {
        self.rows_from(self.len)
    }

    /// The same, beyond room for as many: where points are written of which [`Points::keep`] then keeps some.
    #[inline]
    pub fn spare_beyond<const N: usize, const L: usize>(&mut self) -> Option<Spare<'_, N, L>> {
        self.rows_from(self.len + N * L)
    }

    #[inline(always)]
    fn rows_from<const N: usize, const L: usize>(&mut self, row: usize) -> Option<Spare<'_, N, L>> {
        let end = row + N * L;
        if self.x_m.len() < end {
            self.grow(end);
        }
        let fields = self.fields;
        Some(Spare {
            x_m: rows(&mut self.x_m, row)?,
            y_m: rows(&mut self.y_m, row)?,
            z_m: rows(&mut self.z_m, row)?,
            intensity: wanted(fields, Fields::INTENSITY, &mut self.intensity, row),
            ring: wanted(fields, Fields::RING, &mut self.ring, row),
            laser: wanted(fields, Fields::LASER, &mut self.laser, row),
            time: wanted(fields, Fields::TIME, &mut self.time, row),
            device_time: wanted(fields, Fields::DEVICE_TIME, &mut self.device_time, row),
            tilt_deg: wanted(fields, Fields::TILT, &mut self.tilt_deg, row),
            sd_m: wanted(fields, Fields::SD, &mut self.sd_m, row),
        })
    }

    /// Makes points of the first `count` rows that were spare; of no more than there are.
    #[inline]
    pub fn keep_all(&mut self, count: usize) {
        self.len = (self.len + count).min(self.x_m.len());
    }

    /// Makes points of some of the `R` rows beyond `R` spare ones, in their order.
    #[inline]
    pub fn keep<const R: usize>(&mut self, order: &Order<R>) {
        let row = self.len;
        gather(&mut self.x_m, row, order);
        gather(&mut self.y_m, row, order);
        gather(&mut self.z_m, row, order);
        gather(&mut self.intensity, row, order);
        gather(&mut self.ring, row, order);
        gather(&mut self.laser, row, order);
        gather(&mut self.time, row, order);
        gather(&mut self.device_time, row, order);
        gather(&mut self.tilt_deg, row, order);
        gather(&mut self.sd_m, row, order);
        self.keep_all(order.len());
    }

    /// Lengthens every column asked for to `end` rows or more: all that is reserved, or twice that.
    #[cold]
    fn grow(&mut self, end: usize) {
        let reserved = self.x_m.capacity();
        let end = if end <= reserved {
            reserved
        } else {
            end.max(2 * reserved)
        };
        let wanted = |field| self.fields.contains(field);
        self.x_m.resize(end, 0.0);
        self.y_m.resize(end, 0.0);
        self.z_m.resize(end, 0.0);
        if wanted(Fields::INTENSITY) {
            self.intensity.resize(end, 0);
        }
        if wanted(Fields::RING) {
            self.ring.resize(end, 0);
        }
        if wanted(Fields::LASER) {
            self.laser.resize(end, 0);
        }
        if wanted(Fields::TIME) {
            self.time.resize(end, Stamp::from_nanos(0));
        }
        if wanted(Fields::DEVICE_TIME) {
            self.device_time.resize(end, Stamp::from_nanos(0));
        }
        if wanted(Fields::TILT) {
            self.tilt_deg.resize(end, 0.0);
        }
        if wanted(Fields::SD) {
            self.sd_m.resize(end, 0.0);
        }
    }
}

#[inline(always)]
fn rows<T, const N: usize, const L: usize>(
    column: &mut [T],
    row: usize,
) -> Option<&mut [[T; N]; L]> {
    column.get_mut(row..)?.as_chunks_mut().0.first_chunk_mut()
}

#[inline(always)]
fn wanted<T, const N: usize, const L: usize>(
    fields: Fields,
    field: Fields,
    column: &mut [T],
    row: usize,
) -> Option<&mut [[T; N]; L]> {
    if fields.contains(field) {
        rows(column, row)
    } else {
        None
    }
}

/// Brings rows of beyond to the front. A column that was not asked for has none.
#[inline(always)]
fn gather<T: Copy, const R: usize>(column: &mut [T], row: usize, order: &Order<R>) {
    let rest = column.get_mut(row..).unwrap_or_default();
    let Some((to, beyond)) = rest.split_first_chunk_mut::<R>() else {
        return;
    };
    let Some(from) = beyond.first_chunk::<R>() else {
        return;
    };
    for (to, &row) in to.iter_mut().zip(order.rows()) {
        // The remainder changes no row that is one, and spares a check.
        *to = from[usize::from(row) % R];
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
        }
    }

    /// Writes points `first`, `first + 1` and so on into the rows.
    fn write<const L: usize>(rows: &mut Spare<'_, 32, L>, first: u8) {
        for row in 0..32 * L {
            let (layer, place) = (row / 32, row % 32);
            let point = point(first + row as u8);
            [
                rows.x_m[layer][place],
                rows.y_m[layer][place],
                rows.z_m[layer][place],
            ] = point.position_m;
            let narrow = [
                (&mut rows.intensity, point.intensity),
                (&mut rows.ring, point.ring),
                (&mut rows.laser, point.laser),
            ];
            for (column, value) in narrow {
                if let Some(column) = column {
                    column[layer][place] = value;
                }
            }
            if let Some(column) = &mut rows.time {
                column[layer][place] = point.time;
            }
            if let Some(column) = &mut rows.device_time {
                column[layer][place] = point.device_time;
            }
            if let Some(column) = &mut rows.tilt_deg {
                column[layer][place] = point.tilt.0;
            }
            if let Some(column) = &mut rows.sd_m {
                column[layer][place] = point.sd_m;
            }
        }
    }

    #[derive(Clone, Debug)]
    enum Step {
        Push(u8),
        All(u8),
        Some(u32),
        Pairs(u32, u32),
        Append,
        Clear,
    }

    fn any_step() -> impl Strategy<Value = Step> {
        prop_oneof![
            any::<u8>().prop_map(Step::Push),
            (0u8..200).prop_map(Step::All),
            any::<u32>().prop_map(Step::Some),
            any::<(u32, u32)>().prop_map(|(a, b)| Step::Pairs(a, b)),
            Just(Step::Append),
            Just(Step::Clear),
        ]
    }

    proptest! {
        #[test]
        fn rows_that_are_kept_are_points_that_were_pushed(
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
                    Step::All(first) => {
                        write::<1>(&mut fast.spare().unwrap(), first);
                        fast.keep_all(32);
                        (0..32).for_each(|row| slow.push(point(first + row)));
                    }
                    Step::Some(mask) => {
                        write::<1>(&mut fast.spare_beyond().unwrap(), 7);
                        fast.keep(&Order::of(mask));
                        (0..32)
                            .filter(|row| mask >> row & 1 != 0)
                            .for_each(|row| slow.push(point(7 + row)));
                    }
                    Step::Pairs(first, second) => {
                        write::<2>(&mut fast.spare_beyond().unwrap(), 3);
                        fast.keep(&Order::of_pairs(first, second));
                        for row in 0..32 {
                            if first >> row & 1 != 0 {
                                slow.push(point(3 + row));
                            }
                            if second >> row & 1 != 0 {
                                slow.push(point(35 + row));
                            }
                        }
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
    fn room_for_a_column_nobody_asked_for_is_not_made() {
        let mut points = Points::new(Fields::RING);
        let rows = points.spare::<32, 2>().unwrap();
        assert!(rows.ring.is_some() && rows.time.is_none() && rows.tilt_deg.is_none());
        assert_eq!(points.time.capacity(), 0);
        assert!(points.is_empty());
    }
}
