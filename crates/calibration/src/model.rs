//! The measurement model: where a shot goes under a set of parameters, and its derivatives.
//!
//! p = Ry(g') (T + M s(R + b, w + e, a + c)) with g' = (1 + k) g + rate dt + A sin n g + B cos n g
//! + sign(rate) play / 2, then the drift of the base, p + (v + omega x p) t.

use cloud::mount::Mount;

use crate::linear::{Vec3, add, apply, cross};
use crate::parameters::{
    DELAY, DEVICE, Layout, PLAY, POSITION_X, POSITION_Z, RIPPLE_COS, RIPPLE_SIN, ROTATION_X,
    ROTATION_Z, SCALE,
};
use crate::shots::{NominalLaser, RangeShot};

/// Columns of a shot's derivatives: the device, the shot's laser (range, elevation, azimuth), the
/// drift of its log.
pub(crate) const COLUMNS: usize = DEVICE + 3 + 6;
/// First column of the laser.
pub(crate) const LASER: usize = DEVICE;
/// First column of the drift.
pub(crate) const DRIFT: usize = DEVICE + 3;

/// The parts of the model that are not estimated.
#[derive(Clone, Debug)]
pub(crate) struct Fixed {
    /// Rotation of the mount about the tilt axis, radians: the zero of the encoder.
    pub rotation_y: f64,
    /// Position along the tilt axis, metres.
    pub position_y: f64,
    /// Periods of the ripple per turn of the axis.
    pub ripple_periods: f64,
    pub lasers: Vec<NominalLaser>,
}

/// The model with values of its parameters.
#[derive(Clone, Debug)]
pub(crate) struct ScannerModel<'a> {
    layout: &'a Layout,
    values: &'a [f64],
    position: Vec3,
    rotation: [Vec3; 3],
    /// Derivatives of the rotation by its angles about x and z.
    by_x: [Vec3; 3],
    by_z: [Vec3; 3],
    ripple_periods: f64,
    lasers: Vec<LaserModel>,
}

#[derive(Clone, Copy, Debug)]
struct LaserModel {
    range_m: f64,
    /// Sine and cosine of the elevation and of the azimuth's correction.
    elevation: [f64; 2],
    azimuth: [f64; 2],
    vertical_offset_m: f64,
}

/// End point of a shot, and its direction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ShotRay {
    pub end: Vec3,
    pub direction: Vec3,
}

type Rows = [Vec3; 3];

fn product(a: &Rows, b: &Rows) -> Rows {
    let column = |j: usize| [b[0][j], b[1][j], b[2][j]];
    let columns = [
        apply(a, column(0)),
        apply(a, column(1)),
        apply(a, column(2)),
    ];
    [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]])
}

/// Rotation matrices about x, y and z.
fn rotations([x, y, z]: Vec3) -> [Rows; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (x.sin_cos(), y.sin_cos(), z.sin_cos());
    [
        [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]],
        [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]],
        [[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]],
    ]
}

impl<'a> ScannerModel<'a> {
    pub fn new(layout: &'a Layout, fixed: &Fixed, values: &'a [f64]) -> Self {
        let angles = [values[ROTATION_X], fixed.rotation_y, values[ROTATION_Z]];
        let [about_x, about_y, about_z] = rotations(angles);
        let (sx, cx) = angles[0].sin_cos();
        let (sz, cz) = angles[2].sin_cos();
        let x_slope = [[0.0; 3], [0.0, -sx, -cx], [0.0, cx, -sx]];
        let z_slope = [[-sz, -cz, 0.0], [cz, -sz, 0.0], [0.0; 3]];
        let after_x = product(&about_z, &about_y);
        let lasers = fixed.lasers.iter().enumerate();
        Self {
            layout,
            values,
            position: [values[POSITION_X], fixed.position_y, values[POSITION_Z]],
            rotation: product(&after_x, &about_x),
            by_x: product(&after_x, &x_slope),
            by_z: product(&product(&z_slope, &about_y), &about_x),
            ripple_periods: fixed.ripple_periods,
            lasers: lasers
                .map(|(laser, table)| {
                    let elevation =
                        table.elevation_deg.to_radians() + values[layout.elevation(laser)];
                    LaserModel {
                        range_m: values[layout.range(laser)],
                        elevation: [elevation.sin(), elevation.cos()],
                        azimuth: [
                            values[layout.azimuth(laser)].sin(),
                            values[layout.azimuth(laser)].cos(),
                        ],
                        vertical_offset_m: table.vertical_offset_m,
                    }
                })
                .collect(),
        }
    }

    /// The tilt of the platform at a shot.
    fn tilt_rad(&self, shot: &RangeShot) -> f64 {
        let v = self.values;
        let (sin, cos) = (self.ripple_periods * shot.tilt_rad).sin_cos();
        (1.0 + v[SCALE]) * shot.tilt_rad
            + shot.rate_rad_s * v[DELAY]
            + v[RIPPLE_SIN] * sin
            + v[RIPPLE_COS] * cos
            + 0.5 * sign(shot.rate_rad_s) * v[PLAY]
    }

    /// End and direction of a shot of log `log`.
    pub fn ray(&self, shot: &RangeShot, log: usize) -> ShotRay {
        let (head, aim) = self.head(shot);
        let (sin, cos) = self.tilt_rad(shot).sin_cos();
        let end = tilted(
            add(self.position, 1.0, apply(&self.rotation, head)),
            sin,
            cos,
        );
        let direction = tilted(apply(&self.rotation, aim), sin, cos);
        let (velocity, turn) = self.drift(log);
        let moved = add(velocity, 1.0, cross(turn, end));
        ShotRay {
            end: add(end, shot.time_s, moved),
            direction: add(direction, shot.time_s, cross(turn, direction)),
        }
    }

    /// The ray, with the derivatives of its end by each column.
    pub fn ray_and_slopes(&self, shot: &RangeShot, log: usize) -> (ShotRay, [Vec3; COLUMNS]) {
        let (head, aim) = self.head(shot);
        let laser = &self.lasers[usize::from(shot.laser)];
        let (sin, cos) = self.tilt_rad(shot).sin_cos();
        let to_base = |v: Vec3| tilted(v, sin, cos);
        let end = to_base(add(self.position, 1.0, apply(&self.rotation, head)));
        let direction = to_base(apply(&self.rotation, aim));
        let by_tilt = [end[2], 0.0, -end[0]];
        let (ripple_sin, ripple_cos) = (self.ripple_periods * shot.tilt_rad).sin_cos();
        let tilt_slopes = [
            (DELAY, shot.rate_rad_s),
            (SCALE, shot.tilt_rad),
            (RIPPLE_SIN, ripple_sin),
            (RIPPLE_COS, ripple_cos),
            (PLAY, 0.5 * sign(shot.rate_rad_s)),
        ];
        let mut slopes = [[0.0; 3]; COLUMNS];
        slopes[ROTATION_X] = to_base(apply(&self.by_x, head));
        slopes[ROTATION_Z] = to_base(apply(&self.by_z, head));
        slopes[POSITION_X] = to_base([1.0, 0.0, 0.0]);
        slopes[POSITION_Z] = to_base([0.0, 0.0, 1.0]);
        for (column, factor) in tilt_slopes {
            slopes[column] = by_tilt.map(|part| part * factor);
        }
        let range_m = shot.range_m + laser.range_m;
        let [sin_w, cos_w] = laser.elevation;
        let [sin_a, cos_a] = turned(shot.azimuth, laser.azimuth);
        let by_elevation = [
            -range_m * sin_w * sin_a,
            -range_m * sin_w * cos_a,
            range_m * cos_w,
        ];
        let by_azimuth = [head[1], -head[0], 0.0];
        slopes[LASER] = direction;
        slopes[LASER + 1] = to_base(apply(&self.rotation, by_elevation));
        slopes[LASER + 2] = to_base(apply(&self.rotation, by_azimuth));
        let (velocity, turn) = self.drift(log);
        for slope in &mut slopes {
            *slope = add(*slope, shot.time_s, cross(turn, *slope));
        }
        for axis in 0..3 {
            let mut unit = [0.0; 3];
            unit[axis] = shot.time_s;
            slopes[DRIFT + axis] = unit;
            slopes[DRIFT + 3 + axis] = cross(unit, end);
        }
        let moved = add(velocity, 1.0, cross(turn, end));
        let ray = ShotRay {
            end: add(end, shot.time_s, moved),
            direction: add(direction, shot.time_s, cross(turn, direction)),
        };
        (ray, slopes)
    }

    /// Point and direction of a shot in the lidar's frame.
    fn head(&self, shot: &RangeShot) -> (Vec3, Vec3) {
        let laser = &self.lasers[usize::from(shot.laser)];
        let range_m = shot.range_m + laser.range_m;
        let [sin_w, cos_w] = laser.elevation;
        let [sin_a, cos_a] = turned(shot.azimuth, laser.azimuth);
        let aim = [cos_w * sin_a, cos_w * cos_a, sin_w];
        let start = [0.0, 0.0, laser.vertical_offset_m];
        (add(start, range_m, aim), aim)
    }

    fn drift(&self, log: usize) -> (Vec3, Vec3) {
        let first = self.layout.drift(log);
        let three = |from: usize| [0, 1, 2].map(|axis| self.values[from + axis]);
        (three(first), three(first + 3))
    }

    /// The index among all parameters of a column of a shot.
    pub fn index(layout: &Layout, column: usize, laser: usize, log: usize) -> usize {
        match column {
            LASER => layout.range(laser),
            _ if column == LASER + 1 => layout.elevation(laser),
            _ if column == LASER + 2 => layout.azimuth(laser),
            _ if column >= DRIFT => layout.drift(log) + column - DRIFT,
            _ => column,
        }
    }
}

/// The mount of these values.
pub(crate) fn mount(fixed: &Fixed, values: &[f64]) -> Mount {
    let rotation = [values[ROTATION_X], fixed.rotation_y, values[ROTATION_Z]];
    let position = [values[POSITION_X], fixed.position_y, values[POSITION_Z]];
    Mount::at(position, rotation.map(f64::to_degrees))
}

/// 1 forward, -1 back, 0 at rest.
fn sign(rate: f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate.signum() }
}

/// Tilted about y, z towards x.
fn tilted([x, y, z]: Vec3, sin: f64, cos: f64) -> Vec3 {
    [x * cos + z * sin, y, z * cos - x * sin]
}

/// Sine and cosine of a sum of angles.
fn turned([sin_a, cos_a]: [f64; 2], [sin_b, cos_b]: [f64; 2]) -> [f64; 2] {
    [sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b]
}

#[cfg(test)]
mod tests {
    use cloud::mount::Tilt;
    use units::Degrees;

    use super::*;
    use crate::tests::{draws, fixed, shot, values};

    /// The mount of `cloud` and a tilt of the whole angle: the same point without code in common.
    #[test]
    fn without_drift_points_are_those_of_the_mount_in_cloud() {
        let layout = Layout {
            lasers: 16,
            logs: 1,
        };
        let fixed = fixed(0.02, 0.003);
        let mut random = draws(1);
        for _ in 0..200 {
            let mut values = values(&layout, &mut random);
            for value in &mut values[layout.drift(0)..] {
                *value = 0.0;
            }
            let shot = shot(&mut random);
            let laser = usize::from(shot.laser);
            let elevation =
                fixed.lasers[laser].elevation_deg.to_radians() + values[layout.elevation(laser)];
            let azimuth = shot.azimuth[0].atan2(shot.azimuth[1]) + values[layout.azimuth(laser)];
            let range_m = shot.range_m + values[layout.range(laser)];
            let head = [
                range_m * elevation.cos() * azimuth.sin(),
                range_m * elevation.cos() * azimuth.cos(),
                range_m * elevation.sin() + fixed.lasers[laser].vertical_offset_m,
            ];
            let g = shot.tilt_rad;
            let tilt = g
                + values[SCALE] * g
                + values[DELAY] * shot.rate_rad_s
                + values[RIPPLE_SIN] * (120.0 * g).sin()
                + values[RIPPLE_COS] * (120.0 * g).cos()
                + values[PLAY] / 2.0 * if shot.rate_rad_s > 0.0 { 1.0 } else { -1.0 };
            let expected =
                mount(&fixed, &values).place(head, Tilt::new(Degrees(tilt.to_degrees())));
            let got = ScannerModel::new(&layout, &fixed, &values)
                .ray(&shot, 0)
                .end;
            for axis in 0..3 {
                assert!(
                    (got[axis] - expected[axis]).abs() < 1e-11,
                    "{got:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let layout = Layout {
            lasers: 16,
            logs: 2,
        };
        let fixed = fixed(-0.03, 0.001);
        let mut random = draws(2);
        for number in 0..100 {
            let values = values(&layout, &mut random);
            let shot = shot(&mut random);
            let log = number % 2;
            let (ray, slopes) =
                ScannerModel::new(&layout, &fixed, &values).ray_and_slopes(&shot, log);
            let plain = ScannerModel::new(&layout, &fixed, &values).ray(&shot, log);
            for axis in 0..3 {
                assert!((ray.end[axis] - plain.end[axis]).abs() < 1e-12);
                assert!((ray.direction[axis] - plain.direction[axis]).abs() < 1e-14);
            }
            for (column, slope) in slopes.iter().enumerate() {
                let index = ScannerModel::index(&layout, column, usize::from(shot.laser), log);
                let end = |step: f64| {
                    let mut values = values.clone();
                    values[index] += step;
                    ScannerModel::new(&layout, &fixed, &values)
                        .ray(&shot, log)
                        .end
                };
                let (low, high) = (end(-1e-6), end(1e-6));
                for axis in 0..3 {
                    let difference = (high[axis] - low[axis]) / 2e-6;
                    assert!((difference - slope[axis]).abs() < 1e-5, "column {column}");
                }
            }
        }
    }
}
