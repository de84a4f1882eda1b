//! Ranges, fields of view and resolution of a tilted sensor, from the data sheet of the sensor and
//! the mount.
//!
//! All is seen from the origin of the base, on the tilt axis (Eq. 4-6 and 9 of the 2018 paper).
//! Obstacles are ignored.

use serde::Serialize;
use utoipa::ToSchema;

/// A sensor on a tilt axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedSensor {
    /// Smallest and largest range of the sensor, metres.
    pub reach_m: [f64; 2],
    /// Lowest and highest laser, degrees above the sensor's horizontal plane.
    pub elevations_deg: [f64; 2],
    /// Height of the sensor's origin above the tilt axis, metres (d).
    pub d_m: f64,
    /// Smallest and largest tilt, degrees (gamma).
    pub tilt_deg: [f64; 2],
    /// Whether its azimuths include the one towards -x, and the one towards +x.
    pub sees: [bool; 2],
}

/// Ranges and elevations that a tilted sensor covers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct VisibleRange {
    /// Smallest and largest distance of a point from the origin of the base, metres.
    pub range_m: [f64; 2],
    /// Lowest and highest ray towards -x in degrees above the horizontal; the paper's forward
    /// direction. Null if there is none.
    pub forwards_deg: Option<[f64; 2]>,
    /// The same towards +x, backward.
    pub backwards_deg: Option<[f64; 2]>,
}

impl TiltedSensor {
    /// The ranges and elevations that it covers.
    #[must_use]
    pub fn view(&self) -> VisibleRange {
        let [low, high] = self.elevations_deg;
        let [least, most] = self.tilt_deg;
        // Rays to the left and to the right of the sensor, by their angle above -x: 90 at the
        // zenith, 180 at +x.
        let fans = [
            [low + least, high + most],
            [180.0 - high + least, 180.0 - low + most],
        ];
        let fans = fans.iter().zip(self.sees).filter(|(_, sees)| *sees);
        let fans: Vec<[f64; 2]> = fans.map(|(fan, _)| *fan).collect();
        let from_behind = |[highest, lowest]: [f64; 2]| [180.0 - lowest, 180.0 - highest];
        VisibleRange {
            range_m: self.range_m(),
            forwards_deg: side(&fans, 0.0),
            backwards_deg: side(&fans, 180.0).map(from_behind),
        }
    }

    /// Eq. 9: a point at range R of a laser at elevation w is at distance P from the base's origin
    /// with P2 = R2 + d2 + 2 R d sin w, independent of azimuth and tilt. P2 is linear in sin w, so
    /// the outermost lasers decide. In R it falls before -d sin w and rises after.
    fn range_m(&self) -> [f64; 2] {
        let [near, far] = self.reach_m;
        let mut range = [f64::INFINITY, 0.0_f64];
        for elevation_deg in self.elevations_deg {
            let sin = elevation_deg.to_radians().sin();
            let lowest = (-self.d_m * sin).clamp(near.min(far), far.max(near));
            for r in [near, far, lowest] {
                // A sum of squares, which cannot be negative.
                let (along, across) = (r + self.d_m * sin, self.d_m * self.d_m * (1.0 - sin * sin));
                let p = (along * along + across).sqrt();
                range = [range[0].min(p), range[1].max(p)];
            }
        }
        range
    }
}

/// The outermost angles of fans within 90 degrees of `middle_deg`, modulo 360 degrees.
fn side(fans: &[[f64; 2]], middle_deg: f64) -> Option<[f64; 2]> {
    let (first, last) = (middle_deg - 90.0, middle_deg + 90.0);
    let mut found = [f64::INFINITY, f64::NEG_INFINITY];
    for [from, to] in fans {
        for turn in [-720.0, -360.0, 0.0, 360.0, 720.0] {
            let (from, to) = ((from + turn).max(first), (to + turn).min(last));
            if from <= to {
                found = [found[0].min(from), found[1].max(to)];
            }
        }
    }
    (found[0] <= found[1]).then_some(found)
}

/// The mean vertical angle between neighbouring rays in degrees: a field of view of `fov_deg`
/// divided by lasers and frames.
#[must_use]
pub fn vertical_resolution_deg(fov_deg: f64, lasers: u32, frames: f64) -> f64 {
    fov_deg / (f64::from(lasers) * frames)
}

#[cfg(test)]
mod tests {
    use cloud::mount::{Mount, Tilt};
    use units::{Degrees, Metres};

    use super::*;

    const VELOMOTION: TiltedSensor = TiltedSensor {
        reach_m: [1.0, 100.0],
        elevations_deg: [-15.0, 15.0],
        d_m: 0.06,
        tilt_deg: [-45.0, 0.0],
        sees: [true; 2],
    };

    #[test]
    fn fields_of_view_match_the_paper() {
        let view = VELOMOTION.view();
        assert_eq!(view.forwards_deg, Some([-60.0, 15.0]));
        assert_eq!(view.backwards_deg, Some([-15.0, 60.0]));
        // A planar scanner that looks towards -x.
        let nodding = TiltedSensor {
            elevations_deg: [0.0; 2],
            sees: [true, false],
            ..VELOMOTION
        };
        let view = nodding.view();
        assert_eq!(
            (view.forwards_deg, view.backwards_deg),
            (Some([-45.0, 0.0]), None)
        );
    }

    #[test]
    fn ranges_follow_the_equation() {
        let [near, far] = VELOMOTION.view().range_m;
        let sin15 = (6.0_f64.sqrt() - 2.0_f64.sqrt()) / 4.0;
        assert!((near - (1.0 + 0.0036 - 0.12 * sin15).sqrt()).abs() < 1e-15);
        assert!((far - (10_000.0 + 0.0036 + 12.0 * sin15).sqrt()).abs() < 1e-13);
        assert!(
            (near - 0.986_176).abs() < 1e-6 && (far - 100.015_546).abs() < 1e-6,
            "{near} {far}"
        );
        let on_axis = TiltedSensor {
            d_m: 0.0,
            ..VELOMOTION
        };
        assert_eq!(on_axis.view().range_m, [1.0, 100.0]);
    }

    /// By Eq. 4-6, ray by ray.
    fn sampled(device: &TiltedSensor) -> ([f64; 2], [f64; 2], [f64; 2]) {
        let mount = Mount::new(Metres(device.d_m));
        let wider =
            |range: &mut [f64; 2], value: f64| *range = [range[0].min(value), range[1].max(value)];
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let (mut range, mut forwards, mut backwards) = (none, none, none);
        let between = |[a, b]: [f64; 2], k: u32, n: u32| a + (b - a) * f64::from(k) / f64::from(n);
        for g in 0..=40 {
            let tilt = Tilt::new(Degrees(between(device.tilt_deg, g, 40)));
            for w in 0..=30 {
                let (sw, cw) = between(device.elevations_deg, w, 30).to_radians().sin_cos();
                for a in 0..72 {
                    let (sa, ca) = (f64::from(a) * 5.0).to_radians().sin_cos();
                    for r in 0..=20 {
                        let r = between(device.reach_m, r, 20);
                        let [x, y, z] = mount.place([r * cw * sa, r * cw * ca, r * sw], tilt);
                        wider(&mut range, (x * x + y * y + z * z).sqrt());
                    }
                    // Direction of the rays in the plane across the axis.
                    let [x, _, z] = Mount::new(Metres(0.0)).place([cw * sa, cw * ca, sw], tilt);
                    if a == 18 || a == 54 {
                        let (side, x) = match x < 0.0 {
                            true => (&mut forwards, -x),
                            false => (&mut backwards, x),
                        };
                        wider(side, z.atan2(x).to_degrees());
                    }
                }
            }
        }
        (range, forwards, backwards)
    }

    #[test]
    fn sampling_agrees_with_the_equations() {
        let devices = [
            VELOMOTION,
            TiltedSensor {
                d_m: -0.2,
                ..VELOMOTION
            },
            TiltedSensor {
                elevations_deg: [-30.67, 10.67],
                tilt_deg: [-20.0, 35.0],
                ..VELOMOTION
            },
            // Past the zenith.
            TiltedSensor {
                tilt_deg: [0.0, 180.0],
                ..VELOMOTION
            },
            TiltedSensor {
                tilt_deg: [40.0, 100.0],
                ..VELOMOTION
            },
            // High above the axis the nearest point is not at the smallest range.
            TiltedSensor {
                d_m: 3.0,
                reach_m: [0.0, 10.0],
                elevations_deg: [-30.0, 0.0],
                tilt_deg: [0.0, 45.0],
                ..VELOMOTION
            },
        ];
        for device in devices {
            let view = device.view();
            let (range, forwards, backwards) = sampled(&device);
            for (exact, sampled) in [
                (view.forwards_deg, forwards),
                (view.backwards_deg, backwards),
            ] {
                for (a, b) in exact.unwrap().iter().zip(sampled) {
                    // The step of tilt, if a side ends at the zenith.
                    let steps = if a.abs() == 90.0 { 1.3 } else { 1e-9 };
                    assert!((a - b).abs() < steps, "{device:?}: {exact:?} {sampled:?}");
                }
            }
            // The step of range has an error of second order.
            assert!(view.range_m[0] <= range[0] + 1e-12 && range[0] - view.range_m[0] < 0.02);
            assert!((view.range_m[1] - range[1]).abs() < 1e-9);
        }
    }

    #[test]
    fn vertical_resolutions_match_the_paper_where_it_is_right() {
        // 45 deg at 56.25 deg/s are 8 frames of 10 Hz.
        let at = |deg_per_s: f64| vertical_resolution_deg(75.0, 16, 45.0 / deg_per_s * 10.0);
        assert!((at(56.25) - 0.586).abs() < 1e-3);
        // 0.0052 belongs to 0.5 deg/s; at 0.05, the slowest, it is a tenth of that.
        assert!((at(0.5) - 5.2e-3).abs() < 1e-4);
        assert!((at(0.05) - 5.2e-4).abs() < 1e-5);
    }
}
