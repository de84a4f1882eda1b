//! Accuracy requested as a length at a distance: `2mm@20m`.
//!
//! Every method for the angle has an error bound and a cost. The cheapest one with a sufficient
//! bound at the given distance is chosen. If none is sufficient, the error reports how far the best
//! one comes. The bound is [`crate::trajectory::Trajectory::bound_deg`] plus the error of the
//! lidar's clock at the greatest speed. It does not contain the lidar's ranges and a delay common
//! to all packets, which timing cannot observe.

use core::fmt;
use core::str::FromStr;

use thiserror::Error;
use units::{DegPerS, Degrees, Metres, Span};

use crate::trajectory::{Method, Trajectory};

/// Greatest error of points at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Error, across the line of sight.
    pub off: Metres,
    /// Distance from the tilt axis.
    pub at: Metres,
}

/// Requested accuracy of the angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Accuracy {
    /// Best accuracy that the recording allows.
    #[default]
    Best,
    /// A given method.
    By(Method),
    /// The cheapest method that is sufficient.
    Within(Tolerance),
}

/// Reason for a method.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MethodChoice {
    /// The requested tolerance.
    pub tolerance: Tolerance,
    /// Bounds at the requested distance, in order of cost; the last one is that of the chosen
    /// method.
    pub bounds: Vec<(Method, Metres)>,
}

/// A tolerance that no method meets.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "no method is within {tolerance}: the best, {}, is within {} mm there ({:.4} deg at {:.2} deg/s)",
    .best.name(), three_digits(.bound.0 * 1e3), .bound_angle.0, .fastest.0.abs()
)]
#[non_exhaustive]
pub struct UnreachableTolerance {
    /// The requested tolerance.
    pub tolerance: Tolerance,
    /// The best method.
    pub best: Method,
    /// Greatest error of its points at that distance.
    pub bound: Metres,
    /// The bound as an angle.
    pub bound_angle: Degrees,
    /// Share of the bound due to a delay common to all samples.
    pub delay_share: f64,
    /// The greatest speed of the sweeps.
    pub fastest: DegPerS,
}

/// A number with three significant digits: with one or two a bound may look equal to the tolerance
/// it misses.
fn three_digits(number: f64) -> String {
    let decimals = 2.0 - number.abs().max(1e-6).log10().floor();
    format!("{number:.*}", decimals.clamp(0.0, 9.0) as usize)
}

impl UnreachableTolerance {
    /// The tolerance that the best method meets with 10 % to spare, rounded up to two digits.
    #[must_use]
    pub fn tolerance_that_would_do(&self) -> Tolerance {
        let least_mm = 1.1e3 * self.bound.0;
        let digit = 10_f64.powi(least_mm.log10().floor() as i32 - 1);
        // Multiples of a digit such as 0.01 are inexact; parsing two digits is exact.
        let up = format!("{:.1e}", (least_mm / digit).ceil() * digit);
        let mm = up.parse().unwrap_or(least_mm);
        Tolerance {
            off: Metres(mm * 1e-3),
            at: self.tolerance.at,
        }
    }

    /// The speed at which the best method would be sufficient, if a slower sweep helps: all of its
    /// bound but the encoder's count shrinks with the speed.
    #[must_use]
    pub fn speed_that_would_do(&self) -> Option<DegPerS> {
        /// Below it a motor does not turn evenly.
        const SLOWEST_DEG_S: f64 = 0.05;
        // A tenth less, for the variation from scan to scan.
        let speed = 0.9 * self.fastest.0.abs() * self.tolerance.angle().0 / self.bound_angle.0;
        (speed >= SLOWEST_DEG_S).then_some(DegPerS(speed))
    }
}

impl Tolerance {
    /// The tolerance as an angle.
    #[must_use]
    pub fn angle(&self) -> Degrees {
        Degrees((self.off.0 / self.at.0).to_degrees())
    }

    /// Displacement of a point by an angle at this distance.
    fn off_by(&self, angle_deg: f64) -> Metres {
        Metres(angle_deg.to_radians() * self.at.0)
    }

    /// The cheapest sufficient method of `through`, with the reason; `clock` is the bound of the
    /// lidar's clock.
    pub(crate) fn choose(
        &self,
        clock: Span,
        spans: &[(units::Stamp<units::Host>, units::Stamp<units::Host>)],
        through: impl Fn(Method) -> Option<Trajectory>,
    ) -> Result<(Trajectory, MethodChoice), Option<UnreachableTolerance>> {
        let mut bounds = Vec::new();
        let mut best: Option<UnreachableTolerance> = None;
        for method in Method::ALL {
            let Some(trajectory) = through(method) else {
                continue;
            };
            let fastest = trajectory.fastest(spans);
            let bound_deg = trajectory.bound_deg(spans) + fastest.0.abs() * clock.as_secs_f64();
            let bound = self.off_by(bound_deg);
            bounds.push((method, bound));
            if bound.0 <= self.off.0 {
                let choice = MethodChoice {
                    tolerance: *self,
                    bounds,
                };
                return Ok((trajectory, choice));
            }
            if best.as_ref().is_none_or(|best| bound.0 < best.bound.0) {
                best = Some(UnreachableTolerance {
                    tolerance: *self,
                    best: method,
                    bound,
                    bound_angle: Degrees(bound_deg),
                    delay_share: trajectory.delay_deg(spans) / bound_deg,
                    fastest,
                });
            }
        }
        Err(best)
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mm at {} m", self.off.0 * 1e3, self.at.0)
    }
}

impl fmt::Display for MethodChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(((method, bound), cheaper)) = self.bounds.split_last() else {
            return Ok(());
        };
        write!(
            f,
            "{}: within {:.2} mm at {} m, {:.2} mm requested",
            method.name(),
            bound.0 * 1e3,
            self.tolerance.at.0,
            self.tolerance.off.0 * 1e3
        )?;
        match cheaper.last() {
            Some((method, bound)) => write!(
                f,
                "; {}, which is cheaper, only within {:.2} mm",
                method.name(),
                bound.0 * 1e3
            ),
            None => f.write_str("; nothing is cheaper"),
        }?;
        f.write_str("; tilt angle and clock alone, without the error of the ranges")
    }
}

/// A text that is no tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("expected a length at a distance, such as 2mm@20m (mm, cm or m)")]
pub struct ParseToleranceError;

impl FromStr for Tolerance {
    type Err = ParseToleranceError;

    fn from_str(text: &str) -> Result<Self, ParseToleranceError> {
        let (off, at) = text.split_once('@').ok_or(ParseToleranceError)?;
        Ok(Self {
            off: length(off)?,
            at: length(at)?,
        })
    }
}

/// A positive length with its unit.
fn length(text: &str) -> Result<Metres, ParseToleranceError> {
    let text = text.trim();
    let units = [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)];
    let (number, unit) = units
        .iter()
        .find_map(|(name, metres)| Some((text.strip_suffix(name)?, metres)))
        .ok_or(ParseToleranceError)?;
    let number: f64 = number.trim().parse().map_err(|_| ParseToleranceError)?;
    let metres = number * unit;
    (metres > 0.0 && metres.is_finite())
        .then_some(Metres(metres))
        .ok_or(ParseToleranceError)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggested_tolerances_are_as_tight_as_possible() {
        let out = |bound_mm: f64| UnreachableTolerance {
            tolerance: "0.001mm@20m".parse().unwrap(),
            best: Method::Profile,
            bound: Metres(bound_mm * 1e-3),
            bound_angle: Degrees(0.003),
            delay_share: 0.2,
            fastest: DegPerS(-56.25),
        };
        for (bound_mm, would_do_mm, expected) in [
            (0.0512, 0.057, "within 0.0512 mm"),
            (1.018, 1.2, "within 1.02 mm"),
            (5.08, 5.6, "within 5.08 mm"),
            (176.79, 200.0, "within 177 mm"),
        ] {
            let out = out(bound_mm);
            let Tolerance { off, at } = out.tolerance_that_would_do();
            assert!((off.0 * 1e3 - would_do_mm).abs() < 1e-9, "{off:?}");
            assert_eq!(at.0, 20.0);
            assert!(out.to_string().contains(expected), "{out}");
        }
    }

    #[test]
    fn lengths_at_distances_convert_to_tolerances() {
        let two: Tolerance = "2mm@20m".parse().unwrap();
        assert_eq!(two.to_string(), "2 mm at 20 m");
        assert!((two.angle().0 - 0.0057296).abs() < 1e-6);
        let odd: Tolerance = "0.5 cm @ 1500mm".parse().unwrap();
        assert!((odd.off.0 - 0.005).abs() < 1e-15 && (odd.at.0 - 1.5).abs() < 1e-15);
        for wrong in [
            "",
            "2mm",
            "2@20m",
            "@",
            "2mm@",
            "-2mm@20m",
            "0mm@1m",
            "1mm@0m",
            "nanmm@1m",
            "infm@1m",
            "2km@1m",
            "2mm@20m@3",
        ] {
            assert_eq!(
                wrong.parse::<Tolerance>(),
                Err(ParseToleranceError),
                "{wrong}"
            );
        }
    }
}
