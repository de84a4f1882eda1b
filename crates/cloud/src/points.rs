//! Points as a structure of arrays, with only the columns that were asked for.
//!
//! The columns are always equally long, which is why they are not public. One `Points` serves as a reusable
//! batch ([`Points::clear`] keeps the memory) and as a whole cloud ([`Points::append`]). There is no per-point
//! heap and no row type in storage; [`Point`] exists only on the way in and out. [`Points::spare`] is the fast way in.

mod point;
mod spare;

use units::{Degrees, Host, Lidar, Stamp};

use crate::{Bounds, Fields, MissingColumns, Summary};

pub use point::Point;
pub use spare::Spare;

/// Columns of points, all of one length.
#[derive(Clone, Debug, Default)]
pub struct Points {
    fields: Fields,
    /// Points there are. The columns asked for are all of one length, which may be greater: the rows beyond are room that is
    /// written before it is counted.
    len: usize,
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    z_m: Vec<f64>,
    intensity: Vec<u8>,
    ring: Vec<u8>,
    laser: Vec<u8>,
    time: Vec<Stamp<Host>>,
    device_time: Vec<Stamp<Lidar>>,
    tilt_deg: Vec<f64>,
    sd_m: Vec<f64>,
    echo: Vec<u8>,
}

impl Points {
    /// No points yet, with the columns `fields` beside the position.
    #[must_use]
    pub fn new(fields: Fields) -> Self {
        Self {
            fields,
            ..Self::default()
        }
    }

    /// No points yet, with room for `points` of them in every column asked for.
    #[must_use]
    pub fn with_capacity(fields: Fields, points: usize) -> Self {
        let mut columns = Self::new(fields);
        columns.reserve(points);
        columns
    }

    /// Makes room for `additional` more points.
    pub fn reserve(&mut self, additional: usize) {
        self.x_m.reserve(additional);
        self.y_m.reserve(additional);
        self.z_m.reserve(additional);
        let room = |column| {
            if self.fields.contains(column) {
                additional
            } else {
                0
            }
        };
        self.intensity.reserve(room(Fields::INTENSITY));
        self.ring.reserve(room(Fields::RING));
        self.laser.reserve(room(Fields::LASER));
        self.time.reserve(room(Fields::TIME));
        self.device_time.reserve(room(Fields::DEVICE_TIME));
        self.tilt_deg.reserve(room(Fields::TILT));
        self.sd_m.reserve(room(Fields::SD));
        self.echo.reserve(room(Fields::ECHO));
    }

    /// Forgets the points and keeps the memory.
    pub const fn clear(&mut self) {
        self.len = 0;
    }

    /// The columns beside the position.
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

    /// Adds a point; what it has in columns not asked for is dropped.
    #[inline]
    pub fn push(&mut self, point: Point) {
        let [x, y, z] = point.position_m;
        let row = self.len;
        put(&mut self.x_m, row, x);
        put(&mut self.y_m, row, y);
        put(&mut self.z_m, row, z);
        if self.fields.contains(Fields::INTENSITY) {
            put(&mut self.intensity, row, point.intensity);
        }
        if self.fields.contains(Fields::RING) {
            put(&mut self.ring, row, point.ring);
        }
        if self.fields.contains(Fields::LASER) {
            put(&mut self.laser, row, point.laser);
        }
        if self.fields.contains(Fields::TIME) {
            put(&mut self.time, row, point.time);
        }
        if self.fields.contains(Fields::DEVICE_TIME) {
            put(&mut self.device_time, row, point.device_time);
        }
        if self.fields.contains(Fields::TILT) {
            put(&mut self.tilt_deg, row, point.tilt.0);
        }
        if self.fields.contains(Fields::SD) {
            put(&mut self.sd_m, row, point.sd_m);
        }
        if self.fields.contains(Fields::ECHO) {
            put(&mut self.echo, row, point.echo);
        }
        self.len += 1;
    }

    /// Adds every point of `batch`, column by column; columns of the batch that these points lack are dropped.
    ///
    /// # Errors
    /// [`MissingColumns`] where the batch lacks a column that these points have; nothing is added then.
    pub fn append(&mut self, batch: &Self) -> Result<(), MissingColumns> {
        batch.fields.require(self.fields)?;
        let row = self.len;
        extend(&mut self.x_m, row, batch.x_m());
        extend(&mut self.y_m, row, batch.y_m());
        extend(&mut self.z_m, row, batch.z_m());
        if self.fields.contains(Fields::INTENSITY) {
            extend(&mut self.intensity, row, batch.intensity());
        }
        if self.fields.contains(Fields::RING) {
            extend(&mut self.ring, row, batch.ring());
        }
        if self.fields.contains(Fields::LASER) {
            extend(&mut self.laser, row, batch.laser());
        }
        if self.fields.contains(Fields::TIME) {
            extend(&mut self.time, row, batch.time());
        }
        if self.fields.contains(Fields::DEVICE_TIME) {
            extend(&mut self.device_time, row, batch.device_time());
        }
        if self.fields.contains(Fields::TILT) {
            extend(&mut self.tilt_deg, row, batch.tilt_deg());
        }
        if self.fields.contains(Fields::SD) {
            extend(&mut self.sd_m, row, batch.sd_m());
        }
        if self.fields.contains(Fields::ECHO) {
            extend(&mut self.echo, row, batch.echo());
        }
        self.len += batch.len;
        Ok(())
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

    /// Reflectivity, 0..=255; empty unless asked for.
    #[must_use]
    pub fn intensity(&self) -> &[u8] {
        self.column(&self.intensity)
    }

    /// Ring, 0 = lowest elevation; empty unless asked for.
    #[must_use]
    pub fn ring(&self) -> &[u8] {
        self.column(&self.ring)
    }

    /// Laser number in firing order; empty unless asked for.
    #[must_use]
    pub fn laser(&self) -> &[u8] {
        self.column(&self.laser)
    }

    /// Time on the host's clock; empty unless asked for.
    #[must_use]
    pub fn time(&self) -> &[Stamp<Host>] {
        self.column(&self.time)
    }

    /// Time on the lidar's clock; empty unless asked for.
    #[must_use]
    pub fn device_time(&self) -> &[Stamp<Lidar>] {
        self.column(&self.device_time)
    }

    /// Tilt angle, degrees; empty unless asked for.
    #[must_use]
    pub fn tilt_deg(&self) -> &[f64] {
        self.column(&self.tilt_deg)
    }

    /// Root mean square distance that each point is expected to be off by, metres; empty unless asked for.
    #[must_use]
    pub fn sd_m(&self) -> &[f64] {
        self.column(&self.sd_m)
    }

    /// Which return of its pulse each point is, by the numbers of [`crate::Column::Echo`]; empty unless asked for.
    #[must_use]
    pub fn echo(&self) -> &[u8] {
        self.column(&self.echo)
    }

    /// The counted rows; an unwanted column has none.
    fn column<'a, T>(&self, column: &'a [T]) -> &'a [T] {
        column.get(..self.len).unwrap_or(column)
    }

    /// Point `index` with every column; [`Point::default`]'s value where a column was not asked for.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<Point> {
        let none = Point::default();
        Some(Point {
            position_m: [
                *self.x_m().get(index)?,
                *self.y_m().get(index)?,
                *self.z_m().get(index)?,
            ],
            intensity: or(self.intensity(), index, none.intensity),
            ring: or(self.ring(), index, none.ring),
            laser: or(self.laser(), index, none.laser),
            time: or(self.time(), index, none.time),
            device_time: or(self.device_time(), index, none.device_time),
            tilt: Degrees(or(self.tilt_deg(), index, none.tilt.0)),
            sd_m: or(self.sd_m(), index, none.sd_m),
            echo: or(self.echo(), index, none.echo),
        })
    }

    /// The points one by one, each as [`Points::get`] gives it.
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

    /// Count and bounds.
    #[must_use]
    pub fn summary(&self) -> Summary {
        Summary {
            points: self.len() as u64,
            bounds: Bounds::of([self.x_m(), self.y_m(), self.z_m()]),
        }
    }
}

/// Points are equal where their columns are; room is nothing.
impl PartialEq for Points {
    fn eq(&self, other: &Self) -> bool {
        self.fields == other.fields
            && self.x_m() == other.x_m()
            && self.y_m() == other.y_m()
            && self.z_m() == other.z_m()
            && self.intensity() == other.intensity()
            && self.ring() == other.ring()
            && self.laser() == other.laser()
            && self.time() == other.time()
            && self.device_time() == other.device_time()
            && self.tilt_deg() == other.tilt_deg()
            && self.sd_m() == other.sd_m()
            && self.echo() == other.echo()
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

fn or<T: Copy>(column: &[T], index: usize, absent: T) -> T {
    column.get(index).copied().unwrap_or(absent)
}

#[cfg(test)]
mod tests;
