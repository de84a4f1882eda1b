//! One firing of all lasers, and its returns as points of the sensor's frame.
//!
//! Points are made as they are asked for: who only needs the times pays for no geometry. Left out:
//! where the sensor stood.

use protocol::vlp16::{ChannelReturn, Model};
use units::{Lidar, Span, Stamp};

use crate::geometry::LaserRay;

/// What to do where both returns of a dual-return pair have the same distance: one pulse reported
/// twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Duplicates {
    /// Give it once.
    #[default]
    Unique,
    /// Give both.
    All,
}

/// Which return of its pulse a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// The strongest.
    Strongest,
    /// The last; in dual mode not the strongest, or one whose partner is missing.
    Last,
    /// Dual mode, both returns at one distance: the last is the strongest.
    LastAndStrongest,
    /// Dual mode's second return: the strongest, or the second strongest where the last is the
    /// strongest. The packet does not say which.
    StrongestOrSecond,
    /// The return mode is not known.
    Unknown,
}

impl Echo {
    /// Its number in a cloud's column `echo`.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Unknown => 0,
            Self::Strongest => 1,
            Self::Last => 2,
            Self::LastAndStrongest => 3,
            Self::StrongestOrSecond => 4,
        }
    }
}

/// One laser's measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaserReturn {
    /// Place in the firing order, from 0.
    pub laser: u8,
    /// Distance in the model's unit; never 0.
    pub distance_raw: u16,
    /// Calibrated reflectivity.
    pub reflectivity: u8,
    /// Which return of its pulse it is.
    pub echo: Echo,
}

/// A return as a point of the sensor's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPoint {
    /// When its laser fired.
    pub time: Stamp<Lidar>,
    /// x right, y forward, z up, from the sensor's origin, in metres.
    pub position_m: [f64; 3],
    /// Measured distance in metres, uncorrected.
    pub range_m: f64,
    /// Variance of its azimuth, square radians: what the wire's steps of it leave after
    /// interpolation ([`crate::azimuth_variance_rad2`]).
    pub azimuth_variance_rad2: f64,
    /// Place in the firing order, from 0.
    pub laser: u8,
    /// Place by elevation, 0 the lowest.
    pub ring: u8,
    /// Calibrated reflectivity: 0 to 100 diffuse, 101 to 255 retro-reflective.
    pub reflectivity: u8,
    /// Which return of its pulse it is.
    pub echo: Echo,
}

/// Variance of an azimuth, square radians, that is carried on over `part` of a block's period.
///
/// The wire has the azimuth of each block's begin in steps of 0.01 degrees, whose errors are even
/// over a step: s = 0.01 deg / sqrt 12. Between two of them it is (1 - p) a + p b, so that its
/// variance is s^2 ((1 - p)^2 + p^2). Left out: how unevenly the rotor turns, and the zero of its
/// encoder, which no packet tells.
#[must_use]
pub fn azimuth_variance_rad2(part: f64) -> f64 {
    let step_rad = 0.01_f64.to_radians();
    step_rad * step_rad / 12.0 * ((1.0 - part) * (1.0 - part) + part * part)
}

/// The channels of one firing as they are on the wire, one entry a laser.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FiringChannels<'a> {
    One {
        raw: &'a [[u8; 3]],
        echo: Echo,
    },
    Two {
        last: &'a [[u8; 3]],
        strongest: &'a [[u8; 3]],
        duplicates: Duplicates,
    },
}

/// One firing of all lasers.
#[derive(Clone, Copy, Debug)]
pub struct Firing<'a> {
    /// When laser 0 fired.
    pub start: Stamp<Lidar>,
    /// Azimuth at `start` in degrees, 0 up to 360, clockwise from y seen from above.
    pub azimuth_deg: f64,
    /// How fast the azimuth grows, in degrees per second.
    pub azimuth_rate_deg_s: f64,
    /// The model it was decoded as.
    pub model: &'static Model,
    pub(crate) rays: &'a [LaserRay],
    pub(crate) channels: FiringChannels<'a>,
    /// Its start after its block's, over the block's period.
    pub(crate) part: f64,
}

impl<'a> Firing<'a> {
    /// The returns in firing order; a laser without one is absent. Of a dual pair the last return
    /// comes first.
    #[must_use]
    pub const fn returns(&self) -> LaserReturns<'a> {
        LaserReturns {
            channels: self.channels,
            laser: 0,
            partner: None,
        }
    }

    /// The returns as points of the sensor's frame, in firing order.
    ///
    /// x = R cos w sin a, y = R cos w cos a, z = R sin w + vertical offset (manual 9.2; the paper's
    /// Eq. 1-3), with the azimuth a carried on at the rotor's rate to when each laser fired; with
    /// corrections by the formula of [`crate::LaserCorrection`].
    pub fn points(&self) -> impl Iterator<Item = SensorPoint> + use<'a> {
        let firing = *self;
        self.returns().filter_map(move |seen| {
            Some(firing.place(seen, firing.rays.get(usize::from(seen.laser))?))
        })
    }

    /// Azimuth at which a laser fired, in degrees, not brought back below 360; `None` for a laser
    /// the model lacks.
    #[must_use]
    pub fn laser_azimuth_deg(&self, laser: u8) -> Option<f64> {
        let ray = self.rays.get(usize::from(laser))?;
        Some(self.azimuth_of(ray))
    }

    fn azimuth_of(&self, ray: &LaserRay) -> f64 {
        self.azimuth_deg + self.azimuth_rate_deg_s * ray.delay_s + ray.azimuth_offset_deg
    }

    /// A laser's delay over the block's period.
    fn part_of(&self, ray: &LaserRay) -> f64 {
        ray.delay_ns as f64 / f64::from(self.model.block_period_ns())
    }

    fn place(&self, seen: LaserReturn, ray: &LaserRay) -> SensorPoint {
        let range_m = f64::from(seen.distance_raw) * self.model.distance_unit_m;
        let (sin_azimuth, cos_azimuth) = self.azimuth_of(ray).to_radians().sin_cos();
        let corrected_m = range_m + ray.range_offset_m;
        let across_m = corrected_m * ray.cos_elevation + ray.radial_offset_m;
        let aside_m = ray.tangential_offset_m;
        SensorPoint {
            time: self.start + Span::from_nanos(ray.delay_ns),
            position_m: [
                across_m * sin_azimuth - aside_m * cos_azimuth,
                across_m * cos_azimuth + aside_m * sin_azimuth,
                corrected_m * ray.sin_elevation + ray.vertical_offset_m,
            ],
            range_m,
            azimuth_variance_rad2: azimuth_variance_rad2(self.part + self.part_of(ray)),
            laser: seen.laser,
            ring: ray.ring,
            reflectivity: seen.reflectivity,
            echo: seen.echo,
        }
    }
}

/// Iterator over the returns of a firing.
#[derive(Clone, Debug)]
pub struct LaserReturns<'a> {
    channels: FiringChannels<'a>,
    laser: u8,
    partner: Option<LaserReturn>,
}

impl Iterator for LaserReturns<'_> {
    type Item = LaserReturn;

    fn next(&mut self) -> Option<LaserReturn> {
        if let Some(partner) = self.partner.take() {
            return Some(partner);
        }
        loop {
            let laser = self.laser;
            let i = usize::from(laser);
            let seen = |channel: ChannelReturn, echo| {
                (channel.distance_raw != 0).then_some(LaserReturn {
                    laser,
                    distance_raw: channel.distance_raw,
                    reflectivity: channel.reflectivity,
                    echo,
                })
            };
            let found = match self.channels {
                FiringChannels::One { raw, echo } => {
                    seen(ChannelReturn::from_bytes(*raw.get(i)?), echo)
                }
                FiringChannels::Two {
                    last,
                    strongest,
                    duplicates,
                } => {
                    let even = ChannelReturn::from_bytes(*last.get(i)?);
                    let odd = ChannelReturn::from_bytes(*strongest.get(i)?);
                    if even.distance_raw == odd.distance_raw {
                        if duplicates == Duplicates::All {
                            self.partner = seen(odd, Echo::LastAndStrongest);
                        }
                        seen(even, Echo::LastAndStrongest)
                    } else {
                        let first = seen(even, Echo::Last);
                        let second = seen(odd, Echo::StrongestOrSecond);
                        if first.is_some() {
                            self.partner = second;
                        }
                        first.or(second)
                    }
                }
            };
            self.laser = laser.checked_add(1)?;
            if found.is_some() {
                return found;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use protocol::vlp16::models::{VLP_16, VLP_32C};

    use super::*;
    use crate::geometry::Geometry;

    fn raw(channels: &[(u16, u8)]) -> Vec<[u8; 3]> {
        let bytes = |&(d, r): &(u16, u8)| [d.to_le_bytes()[0], d.to_le_bytes()[1], r];
        channels.iter().map(bytes).collect()
    }

    fn pair(duplicates: Duplicates) -> Vec<(u8, u16, Echo)> {
        let last = raw(&[(500, 1), (0, 0), (700, 3), (0, 0), (900, 5)]);
        let strongest = raw(&[(500, 1), (600, 2), (300, 9), (0, 0), (0, 0)]);
        let returns = LaserReturns {
            channels: FiringChannels::Two {
                last: &last,
                strongest: &strongest,
                duplicates,
            },
            laser: 0,
            partner: None,
        };
        returns.map(|r| (r.laser, r.distance_raw, r.echo)).collect()
    }

    #[test]
    fn dual_returns_are_labelled_and_equal_pairs_given_once() {
        use Echo::{Last, LastAndStrongest, StrongestOrSecond};
        let unique = [
            (0, 500, LastAndStrongest),
            (1, 600, StrongestOrSecond),
            (2, 700, Last),
            (2, 300, StrongestOrSecond),
            (4, 900, Last),
        ];
        assert_eq!(pair(Duplicates::Unique), unique);
        let mut all = unique.to_vec();
        all.insert(1, (0, 500, LastAndStrongest));
        assert_eq!(pair(Duplicates::All), all);
    }

    fn firing<'a>(geometry: &'a Geometry, raw: &'a [[u8; 3]]) -> Firing<'a> {
        Firing {
            start: Stamp::from_nanos(1_000_000),
            azimuth_deg: 90.0,
            azimuth_rate_deg_s: 3_600.0,
            model: geometry.model,
            rays: &geometry.rays,
            channels: FiringChannels::One {
                raw,
                echo: Echo::Strongest,
            },
            part: 0.0,
        }
    }

    #[test]
    fn a_point_is_where_equations_1_to_3_put_it() {
        let raw = raw(&[(5_000, 7); 16]);
        let geometry = Geometry::new(&VLP_16, true, None);
        let firing = firing(&geometry, &raw);
        let points: Vec<SensorPoint> = firing.points().collect();
        assert_eq!(points.len(), 16);
        // Laser 15: 34.56 us later, so 0.124416 deg on; 15 deg up; it starts 11.2 mm below the
        // origin.
        let p = points[15];
        let (azimuth, elevation) = (90.124_416_f64.to_radians(), 15f64.to_radians());
        let expected = [
            10.0 * elevation.cos() * azimuth.sin(),
            10.0 * elevation.cos() * azimuth.cos(),
            10.0 * elevation.sin() - 0.0112,
        ];
        for (got, expected) in p.position_m.iter().zip(expected) {
            assert!((got - expected).abs() < 1e-12, "{p:?}");
        }
        assert_eq!(p.time, Stamp::from_nanos(1_034_560));
        assert_eq!((p.laser, p.ring, p.reflectivity), (15, 15, 7));
        assert!((p.range_m - 10.0).abs() < 1e-12);
        // Clockwise from y: at 90 deg a point lies to the right.
        assert!(points[0].position_m[0] > 9.6 && points[0].position_m[1].abs() < 1e-9);
    }

    #[test]
    fn vertical_offsets_can_be_left_out() {
        let raw = raw(&[(5_000, 7); 16]);
        let (with, without) = (
            Geometry::new(&VLP_16, true, None),
            Geometry::new(&VLP_16, false, None),
        );
        let pairs = firing(&with, &raw)
            .points()
            .zip(firing(&without, &raw).points());
        for ((a, b), laser) in pairs.zip(VLP_16.lasers) {
            assert!((a.position_m[2] - b.position_m[2] - laser.vertical_offset_m).abs() < 1e-12);
        }
    }

    #[test]
    fn a_vlp_32c_counts_in_4_mm_and_fires_pairs_off_the_centre_line() {
        let raw = raw(&[(2_500, 7); 32]);
        let geometry = Geometry::new(&VLP_32C, true, None);
        let firing = firing(&geometry, &raw);
        let points: Vec<SensorPoint> = firing.points().collect();
        assert_eq!(points.len(), 32);
        assert!((points[0].range_m - 10.0).abs() < 1e-12);
        assert_eq!(points[0].time, points[1].time);
        assert_eq!(firing.laser_azimuth_deg(0), Some(91.4));
        assert_eq!(firing.laser_azimuth_deg(1), Some(85.8));
        assert_eq!(firing.laser_azimuth_deg(32), None);
    }
}
