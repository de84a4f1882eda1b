//! Angles from given directions to the nearest point of a scan.

use glam::DVec3;
use rayon::prelude::*;

use super::hole::angle;
use super::nearby::Nearby;
use super::{DensityError, check};

/// The angle from each place to the nearest direction in radians; infinite without directions.
///
/// # Errors
/// [`DensityError::Direction`] for an invalid direction or place, of the directions first.
pub fn gaps(directions: &[DVec3], places: &[DVec3]) -> Result<Vec<f64>, DensityError> {
    check(directions)?;
    check(places)?;
    let nearby = Nearby::new(directions);
    let gap = |place: &DVec3| match nearby.nearest(*place) {
        nearest if nearest.is_finite() => angle(nearest),
        none => none,
    };
    Ok(places.par_iter().map(gap).collect())
}

/// The smallest number that a `share` (0..=1) of the numbers does not exceed; `None` without
/// numbers.
#[must_use]
pub fn quantile(numbers: &[f64], share: f64) -> Option<f64> {
    let place = (share * numbers.len() as f64).ceil() as usize;
    let place = place.min(numbers.len()).saturating_sub(1);
    let mut numbers = numbers.to_vec();
    let found =
        (!numbers.is_empty()).then(|| numbers.select_nth_unstable_by(place, f64::total_cmp));
    found.map(|(_, found, _)| *found)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn gaps_are_angles_to_the_nearest_neighbour() {
        let directions = [DVec3::X, DVec3::Y];
        let places = [DVec3::Z, DVec3::X, DVec3::new(0.6, 0.8, 0.0)];
        let found = gaps(&directions, &places).unwrap();
        for (found, expected) in found.iter().zip([FRAC_PI_2, 0.0, 0.8_f64.acos()]) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert_eq!(gaps(&[], &[DVec3::X]).unwrap(), [f64::INFINITY]);
        assert!(gaps(&[DVec3::ZERO], &[]).is_err());
        assert!(gaps(&[], &[DVec3::NAN]).is_err());
    }

    #[test]
    fn quantiles_are_values_of_the_input() {
        let numbers = [5.0, 1.0, 4.0, 2.0, 3.0];
        let expected = [
            (0.0, 1.0),
            (0.2, 1.0),
            (0.21, 2.0),
            (0.5, 3.0),
            (0.99, 5.0),
            (1.0, 5.0),
        ];
        for (share, expected) in expected {
            assert_eq!(quantile(&numbers, share), Some(expected), "{share}");
        }
        assert_eq!(quantile(&[], 0.5), None);
    }
}
