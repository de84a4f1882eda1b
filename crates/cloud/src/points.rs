//! Points as a structure of arrays, with only the columns that were asked for.
//!
//! The columns are always equally long, which is why they are not public. One `Points` serves as a reusable
//! batch ([`Points::clear`] keeps the memory) and as a whole cloud ([`Points::append`]). There is no per-point
//! heap and no row type in storage; [`Point`] exists only on the way in and out. [`Points::spare`] is the fast way in.

mod spare;

use units::{Degrees, Host, Lidar, Stamp};

use crate::{Bounds, Fields, MissingColumns, Summary};

pub use spare::Spare;

/// One point with every column, as it goes in and comes out. A column that its [`Points`] lacks is dropped on the way
/// in and has the default's value on the way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// x (right), y (forward), z (up) in metres.
    pub position_m: [f64; 3],
    /// Calibrated reflectivity, 0..=255.
    pub intensity: u8,
    /// Ring, 0 = lowest elevation.
    pub ring: u8,
    /// Laser number in firing order.
    pub laser: u8,
    /// Time of the firing on the host's clock.
    pub time: Stamp<Host>,
    /// Time of the firing on the lidar's own clock.
    pub device_time: Stamp<Lidar>,
    /// Tilt angle of the platform at the firing.
    pub tilt: Degrees,
    /// How far the point is off, as a root mean square expected, metres.
    pub sd_m: f64,
    /// Which return of its pulse it is, by the numbers of [`crate::Column::Echo`].
    pub echo: u8,
}

impl Default for Point {
    /// Zero in every column.
    fn default() -> Self {
        Self {
            position_m: [0.0; 3],
            intensity: 0,
            ring: 0,
            laser: 0,
            time: Stamp::from_nanos(0),
            device_time: Stamp::from_nanos(0),
            tilt: Degrees(0.0),
            sd_m: 0.0,
            echo: 0,
        }
    }
}

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
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Column;

    fn any_point() -> impl Strategy<Value = Point> {
        (
            prop::array::uniform3(-120.0..120.0),
            any::<(u8, u8, u8, u8)>(),
            any::<(i64, i64)>(),
            (-180.0..180.0, 0.0..1.0),
        )
            .prop_map(
                |(position_m, (intensity, ring, laser, echo), (host, device), (tilt, sd_m))| {
                    Point {
                        position_m,
                        intensity,
                        ring,
                        laser,
                        time: Stamp::from_nanos(host),
                        device_time: Stamp::from_nanos(device),
                        tilt: Degrees(tilt),
                        sd_m,
                        echo,
                    }
                },
            )
    }

    fn any_fields() -> impl Strategy<Value = Fields> {
        prop::sample::subsequence(Column::ALL.to_vec(), 0..=Column::ALL.len()).prop_map(|columns| {
            columns
                .into_iter()
                .fold(Fields::NONE, |set, column| set | column.field())
        })
    }

    fn lengths(points: &Points) -> Vec<(Fields, usize)> {
        vec![
            (Fields::NONE, points.y_m().len()),
            (Fields::NONE, points.z_m().len()),
            (Fields::INTENSITY, points.intensity().len()),
            (Fields::RING, points.ring().len()),
            (Fields::LASER, points.laser().len()),
            (Fields::TIME, points.time().len()),
            (Fields::DEVICE_TIME, points.device_time().len()),
            (Fields::TILT, points.tilt_deg().len()),
            (Fields::SD, points.sd_m().len()),
            (Fields::ECHO, points.echo().len()),
        ]
    }

    /// The point as it should come out of columns `fields`.
    fn kept(point: Point, fields: Fields) -> Point {
        let none = Point::default();
        Point {
            position_m: point.position_m,
            intensity: if fields.contains(Fields::INTENSITY) {
                point.intensity
            } else {
                none.intensity
            },
            ring: if fields.contains(Fields::RING) {
                point.ring
            } else {
                none.ring
            },
            laser: if fields.contains(Fields::LASER) {
                point.laser
            } else {
                none.laser
            },
            time: if fields.contains(Fields::TIME) {
                point.time
            } else {
                none.time
            },
            device_time: if fields.contains(Fields::DEVICE_TIME) {
                point.device_time
            } else {
                none.device_time
            },
            tilt: if fields.contains(Fields::TILT) {
                point.tilt
            } else {
                none.tilt
            },
            sd_m: if fields.contains(Fields::SD) {
                point.sd_m
            } else {
                none.sd_m
            },
            echo: if fields.contains(Fields::ECHO) {
                point.echo
            } else {
                none.echo
            },
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn columns_asked_for_are_kept_and_the_others_stay_empty(
            fields in any_fields(),
            given in prop::collection::vec(any_point(), 0..40),
        ) {
            let mut points = Points::with_capacity(fields, given.len());
            for &point in &given {
                points.push(point);
            }
            prop_assert_eq!(points.len(), given.len());
            for (column, length) in lengths(&points) {
                let expected = if fields.contains(column) { given.len() } else { 0 };
                prop_assert_eq!(length, expected, "{:?}", column);
            }
            let expected: Vec<_> = given.iter().map(|&point| kept(point, fields)).collect();
            prop_assert_eq!(points.iter().collect::<Vec<_>>(), expected);
        }

        #[test]
        fn appending_batches_is_pushing_their_points(
            fields in any_fields(),
            wider in any_fields(),
            given in prop::collection::vec(any_point(), 0..40),
            cut in 0usize..40,
        ) {
            let mut whole = Points::new(fields);
            let mut batch = Points::new(fields | wider);
            let mut pushed = Points::new(fields);
            for (index, &point) in given.iter().enumerate() {
                if index == cut {
                    whole.append(&batch).unwrap();
                    batch.clear();
                    prop_assert!(batch.is_empty());
                }
                batch.push(point);
                pushed.push(point);
            }
            whole.append(&batch).unwrap();
            prop_assert_eq!(whole, pushed);
        }
    }

    #[test]
    fn a_batch_without_a_column_is_refused_whole() {
        let mut whole = Points::new(Fields::TIME);
        let mut batch = Points::new(Fields::RING);
        batch.push(Point::default());
        let error = whole.append(&batch).unwrap_err();
        assert_eq!((error.missing, error.got), (Fields::TIME, Fields::RING));
        assert!(whole.is_empty());
    }

    #[test]
    fn a_column_nobody_asked_for_costs_no_memory() {
        let points = Points::with_capacity(Fields::NONE, 1000);
        assert_eq!(points.time.capacity(), 0);
        assert_eq!(points.tilt_deg.capacity(), 0);
        assert_eq!(points.sd_m.capacity(), 0);
        assert_eq!(points.echo.capacity(), 0);
        assert!(points.x_m.capacity() >= 1000);
    }

    #[test]
    fn clearing_keeps_the_memory() {
        let mut points = Points::with_capacity(Fields::TILT, 100);
        for _ in 0..100 {
            points.push(Point::default());
        }
        let before = points.tilt_deg.as_ptr();
        points.clear();
        assert_eq!(points.len(), 0);
        assert!(points.tilt_deg().is_empty());
        points.push(Point::default());
        assert_eq!(points.tilt_deg.as_ptr(), before);
    }
}
