//! One firing of all lasers, and its returns as points in the sensor's frame.
//!
//! Points are computed on request, so times alone cost no geometry.

use protocol::vlp16::{ChannelReturn, LidarModel};
use units::{Lidar, Span, Stamp};

use crate::geometry::LaserRay;

/// Treatment of dual-return pairs with equal distances: one pulse reported twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Duplicates {
    /// Yields it once.
    #[default]
    Unique,
    /// Yields both.
    All,
}

/// Kind of a return within its pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnKind {
    /// The strongest return.
    Strongest,
    /// The last return; in dual mode, one that is not the strongest or has no partner.
    Last,
    /// Dual mode: the last return is the strongest, at one distance.
    LastAndStrongest,
    /// Dual mode's second return: the strongest, or the second strongest if the last is the
    /// strongest. Packets do not state which.
    StrongestOrSecond,
    /// The return mode is unknown.
    Unknown,
}

impl ReturnKind {
    /// Code in a cloud's column `echo`.
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

/// Measurement of one laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LaserReturn {
    /// Index in the firing order.
    pub laser: u8,
    /// Distance in the model's unit; never 0.
    pub distance_raw: u16,
    /// Calibrated reflectivity.
    pub reflectivity: u8,
    /// Kind of the return.
    pub echo: ReturnKind,
}

/// A return as a point in the sensor's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPoint {
    /// Firing time of its laser.
    pub time: Stamp<Lidar>,
    /// Position in metres: x right, y forward, z up.
    pub position_m: [f64; 3],
    /// Measured distance in metres without corrections.
    pub range_m: f64,
    /// Variance of the azimuth in square radians, from its resolution in packets
    /// ([`crate::azimuth_variance_rad2`]).
    pub azimuth_variance_rad2: f64,
    /// Index in the firing order.
    pub laser: u8,
    /// Ring by elevation, 0 the lowest.
    pub ring: u8,
    /// Calibrated reflectivity: 0 to 100 diffuse, 101 to 255 retro-reflective.
    pub reflectivity: u8,
    /// Kind of the return.
    pub echo: ReturnKind,
}

/// Variance in square radians of an azimuth interpolated at `part` of a block's period.
///
/// Packets have the azimuth of each block in steps of 0.01 deg, with uniform errors: s = 0.01 deg /
/// sqrt 12. Interpolation gives (1 - p) a + p b, with the variance s^2 ((1 - p)^2 + p^2). Uneven
/// rotation and the offset of the encoder are not included.
#[must_use]
pub fn azimuth_variance_rad2(part: f64) -> f64 {
    let step_rad = 0.01_f64.to_radians();
    step_rad * step_rad / 12.0 * ((1.0 - part) * (1.0 - part) + part * part)
}

/// The channels of one firing as in the packet, one per laser.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FiringChannels<'a> {
    One {
        raw: &'a [[u8; 3]],
        echo: ReturnKind,
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
    /// Firing time of laser 0.
    pub start: Stamp<Lidar>,
    /// Azimuth at `start` in degrees, 0 to 360, clockwise from y seen from above.
    pub azimuth_deg: f64,
    /// Rate of the azimuth in degrees per second.
    pub azimuth_rate_deg_s: f64,
    /// The decoded model.
    pub model: &'static LidarModel,
    pub(crate) rays: &'a [LaserRay],
    pub(crate) channels: FiringChannels<'a>,
    /// Start within its block, as a fraction of the block's period.
    pub(crate) part: f64,
}

impl<'a> Firing<'a> {
    /// The returns in firing order, without lasers that have none. In a dual pair the last return
    /// comes first.
    #[must_use]
    pub const fn returns(&self) -> LaserReturns<'a> {
        LaserReturns {
            channels: self.channels,
            laser: 0,
            partner: None,
        }
    }

    /// The returns as points in the sensor's frame, in firing order.
    ///
    /// x = R cos w sin a, y = R cos w cos a, z = R sin w + vertical offset (manual 9.2; the paper's
    /// Eq. 1-3), with the azimuth a extrapolated at the rotor's rate to the firing time of each
    /// laser. Corrections follow the formula of [`crate::LaserCorrection`].
    pub fn points(&self) -> impl Iterator<Item = SensorPoint> + use<'a> {
        let firing = *self;
        self.returns().filter_map(move |measurement| {
            Some(firing.place(
                measurement,
                firing.rays.get(usize::from(measurement.laser))?,
            ))
        })
    }

    /// Azimuth at which a laser fired in degrees, possibly above 360; `None` for a laser that the
    /// model lacks.
    #[must_use]
    pub fn laser_azimuth_deg(&self, laser: u8) -> Option<f64> {
        let ray = self.rays.get(usize::from(laser))?;
        Some(self.azimuth_of(ray))
    }

    fn azimuth_of(&self, ray: &LaserRay) -> f64 {
        self.azimuth_deg + self.azimuth_rate_deg_s * ray.delay_s + ray.azimuth_offset_deg
    }

    /// A laser's delay as a fraction of the block's period.
    fn part_of(&self, ray: &LaserRay) -> f64 {
        ray.delay_ns as f64 / f64::from(self.model.block_period_ns())
    }

    fn place(&self, measurement: LaserReturn, ray: &LaserRay) -> SensorPoint {
        let range_m = f64::from(measurement.distance_raw) * self.model.distance_unit_m;
        let (sin_azimuth, cos_azimuth) = self.azimuth_of(ray).to_radians().sin_cos();
        let corrected_m = range_m + ray.range_offset_m;
        let horizontal_m = corrected_m * ray.cos_elevation + ray.radial_offset_m;
        let tangential_m = ray.tangential_offset_m;
        SensorPoint {
            time: self.start + Span::from_nanos(ray.delay_ns),
            position_m: [
                horizontal_m * sin_azimuth - tangential_m * cos_azimuth,
                horizontal_m * cos_azimuth + tangential_m * sin_azimuth,
                corrected_m * ray.sin_elevation + ray.vertical_offset_m,
            ],
            range_m,
            azimuth_variance_rad2: azimuth_variance_rad2(self.part + self.part_of(ray)),
            laser: measurement.laser,
            ring: ray.ring,
            reflectivity: measurement.reflectivity,
            echo: measurement.echo,
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
            let to_return = |channel: ChannelReturn, echo| {
                (channel.distance_raw != 0).then_some(LaserReturn {
                    laser,
                    distance_raw: channel.distance_raw,
                    reflectivity: channel.reflectivity,
                    echo,
                })
            };
            let found = match self.channels {
                FiringChannels::One { raw, echo } => {
                    to_return(ChannelReturn::from_bytes(*raw.get(i)?), echo)
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
                            self.partner = to_return(odd, ReturnKind::LastAndStrongest);
                        }
                        to_return(even, ReturnKind::LastAndStrongest)
                    } else {
                        let first = to_return(even, ReturnKind::Last);
                        let second = to_return(odd, ReturnKind::StrongestOrSecond);
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

    fn pair(duplicates: Duplicates) -> Vec<(u8, u16, ReturnKind)> {
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
    fn dual_returns_are_labelled_and_equal_pairs_unique() {
        use ReturnKind::{Last, LastAndStrongest, StrongestOrSecond};
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
                echo: ReturnKind::Strongest,
            },
            part: 0.0,
        }
    }

    #[test]
    fn points_follow_equations_1_to_3() {
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
    fn vertical_offsets_can_be_omitted() {
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
