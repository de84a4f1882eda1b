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
