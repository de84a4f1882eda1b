//! Echoes of a firing.

use glam::DVec3;

use super::surroundings::SurfaceHit;
use crate::sensor::MAX_LASERS;

/// An echo of one pulse, of which the receiver makes a return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// Measured distance, metres; infinite without a return.
    pub range_m: f64,
    /// True distance of the surface along the beam's axis, metres: for the truth only, unchanged by
    /// effects that disturb the measurement.
    pub true_range_m: f64,
    /// Reported calibrated reflectivity: 0..=100 diffuse, above that retroreflecting, 255 at most.
    pub reflectivity: f64,
    /// Share of the pulse's light on the surface, 0..=1: less for one of several returns.
    pub share: f64,
    /// The surface's normal, length 1, on either side; 0 where no effect needs it.
    pub normal: DVec3,
    /// Share of specularly reflected light, 0..=1; 0 where no effect needs the normal.
    pub specular: f64,
}

/// The echoes of all lasers: the strongest of each, and another.
#[derive(Clone, Debug)]
pub struct Echoes {
    /// The strongest echoes.
    pub strongest: [Echo; MAX_LASERS],
    /// The last return where that is not the strongest, else the second strongest; none for a
    /// single return.
    pub other: [Echo; MAX_LASERS],
    /// Whether `other` is reported.
    pub two: bool,
    /// Distance of the first static surface, returning or not; the sensor's range without one. Set
    /// only where objects move.
    pub(super) static_m: [f64; MAX_LASERS],
    lasers: usize,
}

impl Echo {
    /// No return.
    pub const NONE: Self = Self {
        range_m: f64::INFINITY,
        true_range_m: f64::INFINITY,
        reflectivity: 0.0,
        share: 0.0,
        normal: DVec3::ZERO,
        specular: 0.0,
    };

    /// The return of a whole pulse from one surface.
    #[inline]
    #[must_use]
    pub const fn of(met: &SurfaceHit) -> Self {
        Self {
            range_m: met.range_m,
            true_range_m: met.range_m,
            reflectivity: met.reflectivity,
            share: 1.0,
            normal: met.normal,
            specular: met.specular,
        }
    }

    #[inline]
    pub(super) fn from_met(met: Option<SurfaceHit>) -> Self {
        met.map_or(Self::NONE, |met| Self::of(&met))
    }

    /// Whether there is a return.
    #[inline]
    #[must_use]
    pub const fn is_present(&self) -> bool {
        self.range_m < f64::INFINITY
    }
}

impl Echoes {
    pub(crate) const fn new(lasers: usize, two: bool) -> Self {
        Self {
            strongest: [Echo::NONE; MAX_LASERS],
            other: [Echo::NONE; MAX_LASERS],
            two,
            static_m: [0.0; MAX_LASERS],
            lasers,
        }
    }

    /// The reported returns as one slice of all lasers each: the strongest, and the others if they
    /// are reported.
    #[inline]
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut [Echo]> {
        let lasers = self.lasers;
        let other = if self.two {
            &mut self.other[..]
        } else {
            &mut []
        };
        [&mut self.strongest[..], other]
            .into_iter()
            .filter(|echoes| !echoes.is_empty())
            .map(move |echoes| echoes.get_mut(..lasers).unwrap_or_default())
    }
}
