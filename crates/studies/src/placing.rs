//! Plain loops that place the returns of firings (Eq. 1-6 of the paper), by how often the angles
//! are computed, by number type and by sine.
//!
//! The loop of velomotion itself is in `scanner`. Time enters as an angle and its rate.

use std::ops::{Add, Mul, Sub};

/// Errors of a point below this do not matter: a two-thousandth of the step of the ranges, 2 mm.
pub(crate) const LEAST_MM: f64 = 1e-3;

/// Lasers per firing.
pub const LASERS: usize = 16;
/// Firings per block.
pub const BLOCK_FIRINGS: usize = 2;
/// Firings per packet.
pub const PACKET_FIRINGS: usize = 24;
/// The sine table has an entry per hundredth of a degree.
pub const TABLE_STEPS: usize = 36_000;

/// Angles once per packet, those of its first firing.
pub const PACKET: u8 = 0;
/// Angles once per block.
pub const BLOCK: u8 = 1;
/// Angles once per firing.
pub const FIRING: u8 = 2;
/// Angles once per return.
pub const RETURN: u8 = 3;

/// A firing: its angles when its first laser fires, their rates, and its returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainFiring {
    /// Azimuth, degrees.
    pub azimuth_deg: f64,
    /// Rate of the azimuth, degrees per nanosecond.
    pub azimuth_deg_ns: f64,
    /// Tilt (gamma), degrees.
    pub tilt_deg: f64,
    /// Rate of the tilt, degrees per nanosecond.
    pub tilt_deg_ns: f64,
    /// Distances in counts; 0 for none.
    pub counts: [u16; LASERS],
}

/// One laser.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserGeometry {
    /// Elevation, degrees.
    pub elevation_deg: f64,
    /// Height above the lidar's origin, metres.
    pub rise_m: f64,
    /// Delay after the start of the firing, nanoseconds.
    pub delay_ns: f64,
}

/// The lidar and its mount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorGeometry {
    /// Lasers in firing order.
    pub beams: [LaserGeometry; LASERS],
    /// Unit of distance, metres.
    pub unit_m: f64,
    /// Height above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
}

/// f32 or f64.
pub trait Float:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + 'static
{
    /// Conversion from f64 with rounding.
    fn of(x: f64) -> Self;
    /// Conversion to f64.
    fn f64(self) -> f64;
    /// Sine and cosine of radians.
    fn sin_cos(self) -> (Self, Self);
    /// Degrees to radians.
    fn radians(self) -> Self;
}

macro_rules! number {
    ($float:ty) => {
        impl Float for $float {
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $float
            }
            #[inline(always)]
            fn f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                self.sin_cos()
            }
            #[inline(always)]
            fn radians(self) -> Self {
                self.to_radians()
            }
        }
    };
}
number!(f32);
number!(f64);

/// Sine and cosine of an angle that changes.
pub trait Sine<T: Float> {
    /// Sine and cosine of an angle in degrees: the standard library's.
    #[inline(always)]
    fn at(&self, degrees: T) -> (T, T) {
        degrees.radians().sin_cos()
    }

    /// Sine and cosine of an angle `ahead_deg` beyond `degrees`; `from` has those of `degrees`.
    #[inline(always)]
    fn ahead(&self, from: (T, T), degrees: T, ahead_deg: T) -> (T, T) {
        let _ = from;
        self.at(degrees + ahead_deg)
    }
}

/// The sine and cosine of the standard library.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl<T: Float> Sine<T> for Exact {}

/// A table with an entry per hundredth of a degree.
#[derive(Clone, Debug)]
pub struct SineTable<T>(Vec<(T, T)>);

impl<T: Float> SineTable<T> {
    /// The table, [`TABLE_STEPS`] long.
    #[must_use]
    pub fn new() -> Self {
        let of = |i: usize| {
            let (sin, cos) = (i as f64 * 0.01).to_radians().sin_cos();
            (T::of(sin), T::of(cos))
        };
        Self((0..TABLE_STEPS).map(of).collect())
    }
}

impl<T: Float> Sine<T> for SineTable<T> {
    #[inline(always)]
    fn at(&self, degrees: T) -> (T, T) {
        // Angles here are above -360 degrees.
        let hundredths = (degrees * T::of(100.0)).f64() + (TABLE_STEPS as f64 + 0.5);
        let of = self.0.get(hundredths as usize % TABLE_STEPS);
        of.copied().unwrap_or((T::of(0.0), T::of(1.0)))
    }
}

/// The standard library's values once per firing, and addition theorems from there on, with series
/// to the third power for the small angle. For a thousandth of a radian they are exact to 1e-13.
#[derive(Clone, Copy, Debug)]
pub struct Addition;

impl<T: Float> Sine<T> for Addition {
    #[inline(always)]
    fn ahead(&self, (sin, cos): (T, T), degrees: T, ahead_deg: T) -> (T, T) {
        let _ = degrees;
        let e = ahead_deg.radians();
        let (half, sixth) = (T::of(0.5), T::of(1.0 / 6.0));
        (
            sin + e * (cos - e * (half * sin + sixth * e * cos)),
            cos - e * (sin + e * (half * cos - sixth * e * sin)),
        )
    }
}

/// Columns of coordinates, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedPoints<T> {
    /// x (right).
    pub x_m: Vec<T>,
    /// y (forward).
    pub y_m: Vec<T>,
    /// z (up).
    pub z_m: Vec<T>,
}

impl<T: Float> PlacedPoints<T> {
    /// Columns for so many points.
    #[must_use]
    pub fn new(len: usize) -> Self {
        let column = || vec![T::of(0.0); len];
        Self {
            x_m: column(),
            y_m: column(),
            z_m: column(),
        }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x_m.len()
    }

    /// The largest distance of any point from `truth`, metres; infinite if their numbers differ.
    #[must_use]
    pub fn worst_m(&self, truth: &PlacedPoints<f64>) -> f64 {
        worst_m(
            [&self.x_m, &self.y_m, &self.z_m],
            [&truth.x_m, &truth.y_m, &truth.z_m],
        )
    }
}

/// The largest distance of any point of columns x, y, z from `truth`, metres. Infinite if lengths
/// differ or a distance is not a number.
#[must_use]
pub fn worst_m<T: Float>(places_m: [&[T]; 3], truth_m: [&[f64]; 3]) -> f64 {
    let [x, y, z] = places_m;
    let [tx, ty, tz] = truth_m;
    let lengths = [y.len(), z.len(), tx.len(), ty.len(), tz.len()];
    if lengths.iter().any(|len| *len != x.len()) {
        return f64::INFINITY;
    }
    let axes = [x.iter().zip(tx), y.iter().zip(ty), z.iter().zip(tz)];
    let [xs, ys, zs] = axes.map(|axis| axis.map(|(a, b)| (a.f64() - b).powi(2)));
    let squares = xs.zip(ys).zip(zs).map(|((x, y), z)| x + y + z);
    let worst = squares.fold(0.0, |worst: f64, square| {
        if square.is_nan() {
            f64::INFINITY
        } else {
            worst.max(square)
        }
    });
    worst.sqrt()
}

/// Places every return with azimuth and tilt once per `AZIMUTH` and `TILT` ([`PACKET`], [`BLOCK`],
/// [`FIRING`] or [`RETURN`]), each with its own sine. Returns beyond the length of `out` are
/// dropped.
pub fn place<T: Float, A: Sine<T>, G: Sine<T>, const AZIMUTH: u8, const TILT: u8>(
    shots: &[PlainFiring],
    head: &SensorGeometry,
    (azimuth_sine, tilt_sine): (&A, &G),
    out: &mut PlacedPoints<T>,
) {
    let unit = T::of(head.unit_m);
    let rays: [(T, T, T); LASERS] = head.beams.map(|beam| {
        let (sin, cos) = beam.elevation_deg.to_radians().sin_cos();
        (T::of(sin), T::of(cos), T::of(beam.rise_m + head.d_m))
    });
    let delays: [T; LASERS] = head.beams.map(|beam| T::of(beam.delay_ns));
    let (mut azimuth, mut tilt) = ((unit, unit), (unit, unit));
    let mut row = 0;
    for (i, shot) in shots.iter().enumerate() {
        let (azimuth_deg, tilt_deg) = (T::of(shot.azimuth_deg), T::of(shot.tilt_deg));
        let azimuth_rate = T::of(shot.azimuth_deg_ns);
        let tilt_rate = T::of(shot.tilt_deg_ns);
        if begins(AZIMUTH, i) {
            azimuth = azimuth_sine.at(azimuth_deg);
        }
        if begins(TILT, i) {
            tilt = tilt_sine.at(tilt_deg);
        }
        for ((&count, &delay), &(sin_w, cos_w, up)) in shot.counts.iter().zip(&delays).zip(&rays) {
            if count == 0 {
                continue;
            }
            let (mut a, mut g) = (azimuth, tilt);
            if AZIMUTH == RETURN {
                a = azimuth_sine.ahead(azimuth, azimuth_deg, azimuth_rate * delay);
            }
            if TILT == RETURN {
                g = tilt_sine.ahead(tilt, tilt_deg, tilt_rate * delay);
            }
            let range = T::of(f64::from(count)) * unit;
            let across = range * cos_w;
            let (x, height) = (across * a.0, range * sin_w + up);
            let rows = (
                out.x_m.get_mut(row),
                out.y_m.get_mut(row),
                out.z_m.get_mut(row),
            );
            if let (Some(to_x), Some(to_y), Some(to_z)) = rows {
                *to_x = x * g.1 + height * g.0;
                *to_y = across * a.1;
                *to_z = height * g.1 - x * g.0;
            }
            row += 1;
        }
    }
}

/// Whether firing `i` starts a group.
#[inline(always)]
const fn begins(per: u8, i: usize) -> bool {
    match per {
        PACKET => i.is_multiple_of(PACKET_FIRINGS),
        BLOCK => i.is_multiple_of(BLOCK_FIRINGS),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;

    fn returns(shots: &[PlainFiring]) -> usize {
        let counts = shots.iter().flat_map(|shot| shot.counts);
        counts.filter(|count| *count != 0).count()
    }

    const RANGE_M: f64 = 100.0;
    /// 10 revolutions and 56.25 degrees per second.
    const AZIMUTH_DEG_NS: f64 = 3_600e-9;
    const TILT_DEG_NS: f64 = -56.25e-9;
    const FIRING_NS: f64 = 55_296.0;

    fn head() -> SensorGeometry {
        SensorGeometry {
            beams: std::array::from_fn(|i| LaserGeometry {
                elevation_deg: 2.0 * i as f64 - 15.0,
                rise_m: 0.0112 - 0.0015 * i as f64,
                delay_ns: 2_304.0 * i as f64,
            }),
            unit_m: 0.002,
            d_m: 0.06,
        }
    }

    fn shots(count: usize) -> Vec<PlainFiring> {
        let shot = |i: usize| PlainFiring {
            azimuth_deg: (i as f64 * FIRING_NS * AZIMUTH_DEG_NS) % 360.0,
            azimuth_deg_ns: AZIMUTH_DEG_NS,
            tilt_deg: i as f64 * FIRING_NS * TILT_DEG_NS,
            tilt_deg_ns: TILT_DEG_NS,
            counts: [(RANGE_M / 0.002) as u16; LASERS],
        };
        (0..count).map(shot).collect()
    }

    /// Every return by rotations composed as matrices.
    fn slow(shots: &[PlainFiring]) -> PlacedPoints<f64> {
        let head = head();
        let mut places = PlacedPoints::new(0);
        for shot in shots {
            for (beam, count) in head.beams.iter().zip(shot.counts) {
                if count == 0 {
                    continue;
                }
                let azimuth = shot.azimuth_deg + shot.azimuth_deg_ns * beam.delay_ns;
                let tilt = shot.tilt_deg + shot.tilt_deg_ns * beam.delay_ns;
                let ray = DMat3::from_rotation_z(-azimuth.to_radians())
                    * DMat3::from_rotation_x(beam.elevation_deg.to_radians())
                    * (DVec3::Y * f64::from(count) * head.unit_m);
                let place = DMat3::from_rotation_y(tilt.to_radians())
                    * (ray + DVec3::Z * (beam.rise_m + head.d_m));
                places.x_m.push(place.x);
                places.y_m.push(place.y);
                places.z_m.push(place.z);
            }
        }
        places
    }

    fn worst_mm<T: Float, S: Sine<T>, const AZIMUTH: u8, const TILT: u8>(sine: &S) -> f64 {
        let shots = shots(15_000);
        let mut out = PlacedPoints::new(returns(&shots));
        place::<T, S, S, AZIMUTH, TILT>(&shots, &head(), (sine, sine), &mut out);
        out.worst_m(&slow(&shots)) * 1e3
    }

    fn within(value: f64, from: f64, to: f64) {
        assert!((from..=to).contains(&value), "{value} not in {from}..={to}");
    }

    #[test]
    fn angles_per_return_agree_with_matrices() {
        within(worst_mm::<f64, _, RETURN, RETURN>(&Exact), 0.0, 1e-9);
        within(worst_mm::<f64, _, RETURN, RETURN>(&Addition), 0.0, 2e-6);
    }

    /// An angle that is late by t causes an error of speed x t x range. A packet lasts 23 firings
    /// and 15 lasers, 1.3064 ms.
    #[test]
    fn coarser_angles_err_by_speed_times_delay_times_range() {
        let expected = |firings: f64, deg_ns: f64| {
            let late_ns = firings * FIRING_NS + 15.0 * 2_304.0;
            (late_ns * deg_ns.abs()).to_radians() * RANGE_M * 1e3
        };
        let near = |value: f64, expected: f64| within(value, 0.93 * expected, 1.01 * expected);
        near(
            worst_mm::<f64, _, RETURN, PACKET>(&Exact),
            expected(23.0, TILT_DEG_NS),
        );
        near(
            worst_mm::<f64, _, RETURN, BLOCK>(&Exact),
            expected(1.0, TILT_DEG_NS),
        );
        near(
            worst_mm::<f64, _, RETURN, FIRING>(&Exact),
            expected(0.0, TILT_DEG_NS),
        );
        // The azimuth is 64 times as fast. Its error is horizontal, perpendicular to that of the
        // tilt.
        near(
            worst_mm::<f64, _, BLOCK, RETURN>(&Exact),
            expected(1.0, AZIMUTH_DEG_NS),
        );
    }

    /// f32: tens of micrometres at 100 m. The table: half a hundredth of a degree of each angle,
    /// 8.7 mm, and up to root 2 of that together.
    #[test]
    fn number_formats_and_tables_err_by_their_resolution() {
        within(worst_mm::<f32, _, RETURN, RETURN>(&Exact), 0.005, 0.1);
        within(worst_mm::<f32, _, RETURN, RETURN>(&Addition), 0.005, 0.1);
        within(
            worst_mm::<f64, _, RETURN, RETURN>(&SineTable::new()),
            8.5,
            12.4,
        );
    }

    #[test]
    fn shots_without_a_return_are_not_placed() {
        let mut shots = shots(2);
        shots[0].counts[3] = 0;
        assert_eq!(returns(&shots), 31);
        let mut out = PlacedPoints::<f64>::new(31);
        place::<f64, _, _, RETURN, RETURN>(&shots, &head(), (&Exact, &Exact), &mut out);
        within(out.worst_m(&slow(&shots)), 0.0, 1e-12);
    }

    #[test]
    fn columns_of_different_length_or_with_nan_have_infinite_error() {
        let two = [[1.0_f64, 2.0].as_slice(); 3];
        let three = [[1.0_f64, 2.0, 3.0].as_slice(); 3];
        assert_eq!(worst_m(two, three), f64::INFINITY);
        assert_eq!(worst_m([[1.0, f64::NAN].as_slice(); 3], two), f64::INFINITY);
        assert_eq!(
            worst_m([[1.0_f32, 4.0].as_slice(), &[1.0, 2.0], &[1.0, 2.0]], two),
            2.0
        );
    }
}
