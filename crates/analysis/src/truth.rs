//! Comparison of a cloud with the simulated truth: the distance of each point from the place that
//! its laser hit.
//!
//! Points are matched by device time and laser of their firing, which only the sensor determines.
//! So an error of the clock fit or of the tilt angle shows as a distance and cannot hide in the
//! matching. Points without a truth and non-finite points are counted separately and never
//! averaged. The cloud is not aligned first, since that would hide errors.

use cloud::{Fields, MissingColumns, Points, Sink, SinkError};
use glam::DVec3;
use units::{Lidar, Stamp};

/// The columns that a comparison needs.
pub const FIELDS: Fields = Fields::DEVICE_TIME.union(Fields::LASER);

/// Distance of a cloud from the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TruthReport {
    /// Points that were compared.
    pub points: u64,
    /// Points without a hit in the truth.
    pub unmatched: u64,
    /// Points whose distance from the truth is not finite.
    pub not_finite: u64,
    /// Root mean square distance in metres; NaN without compared points, which no limit accepts.
    pub rms_m: f64,
    /// Largest distance in metres; NaN without compared points.
    pub worst_m: f64,
    /// Index of the point with the largest distance; the first of equal ones.
    pub worst_index: Option<u64>,
}

/// Compares every point with `truth`, which returns the place (metres) that a laser hit when it
/// fired at a given time of the lidar's clock.
///
/// # Errors
/// [`MissingColumns`] if the points lack device time or laser.
pub fn compare(
    points: &Points,
    truth: impl FnMut(Stamp<Lidar>, u8) -> Option<[f64; 3]>,
) -> Result<TruthReport, MissingColumns> {
    let mut comparison = Comparison::new(truth);
    comparison.add(points)?;
    Ok(comparison.report())
}

/// An incremental comparison: a [`Sink`] that keeps no points.
#[derive(Clone, Debug)]
pub struct Comparison<F> {
    truth: F,
    given: u64,
    compared: u64,
    unmatched: u64,
    not_finite: u64,
    sum_of_squares_m2: f64,
    worst: Option<(f64, u64)>,
}

impl<F: FnMut(Stamp<Lidar>, u8) -> Option<[f64; 3]>> Comparison<F> {
    /// A comparison with `truth`, without points.
    pub const fn new(truth: F) -> Self {
        Self {
            truth,
            given: 0,
            compared: 0,
            unmatched: 0,
            not_finite: 0,
            sum_of_squares_m2: 0.0,
            worst: None,
        }
    }

    /// Adds a batch.
    ///
    /// # Errors
    /// [`MissingColumns`] if it lacks device time or laser; nothing is added then.
    pub fn add(&mut self, batch: &Points) -> Result<(), MissingColumns> {
        batch.fields().require(FIELDS)?;
        let firings = batch.device_time().iter().zip(batch.laser());
        for (position_m, (&time, &laser)) in batch.positions().zip(firings) {
            let hit = (self.truth)(time, laser);
            self.add_point(position_m, hit);
        }
        Ok(())
    }

    fn add_point(&mut self, position_m: [f64; 3], hit_m: Option<[f64; 3]>) {
        let index = self.given;
        self.given += 1;
        let Some(hit_m) = hit_m else {
            self.unmatched += 1;
            return;
        };
        let square = DVec3::from_array(position_m).distance_squared(DVec3::from_array(hit_m));
        if !square.is_finite() {
            self.not_finite += 1;
            return;
        }
        self.compared += 1;
        self.sum_of_squares_m2 += square;
        let distance_m = square.sqrt();
        if self.worst.is_none_or(|(worst_m, _)| distance_m > worst_m) {
            self.worst = Some((distance_m, index));
        }
    }

    /// The results so far.
    #[must_use]
    pub fn report(&self) -> TruthReport {
        TruthReport {
            points: self.compared,
            unmatched: self.unmatched,
            not_finite: self.not_finite,
            rms_m: (self.sum_of_squares_m2 / self.compared as f64).sqrt(),
            worst_m: self.worst.map_or(f64::NAN, |(distance_m, _)| distance_m),
            worst_index: self.worst.map(|(_, index)| index),
        }
    }
}

impl<F: FnMut(Stamp<Lidar>, u8) -> Option<[f64; 3]>> Sink for Comparison<F> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        Ok(self.add(batch)?)
    }

    fn fields(&self) -> Fields {
        FIELDS
    }
}

#[cfg(test)]
mod tests {
    use cloud::Point;
    use proptest::prelude::*;

    use super::*;

    /// Points at the given positions, firing by firing 1 us apart, lasers 0..16.
    fn cloud(positions: &[[f64; 3]]) -> Points {
        let mut points = Points::new(FIELDS);
        for (i, &position_m) in positions.iter().enumerate() {
            points.push(Point {
                position_m,
                laser: (i % 16) as u8,
                device_time: Stamp::from_nanos(i as i64 * 1_000),
                ..Point::default()
            });
        }
        points
    }

    fn index(time: Stamp<Lidar>) -> usize {
        (time.as_nanos() / 1_000) as usize
    }

    #[test]
    fn the_truth_compared_with_itself_has_no_error() {
        let positions = [[1.0, 2.0, 3.0], [-4.0, 5.0, 6.0], [100.0, 0.0, -7.0]];
        let report = compare(&cloud(&positions), |time, laser| {
            assert_eq!(index(time) % 16, usize::from(laser));
            Some(positions[index(time)])
        });
        assert_eq!(
            report,
            Ok(TruthReport {
                points: 3,
                unmatched: 0,
                not_finite: 0,
                rms_m: 0.0,
                worst_m: 0.0,
                worst_index: Some(0),
            })
        );
    }

    #[test]
    fn a_known_error_is_located() {
        // 3-4-5 triangles: distances 0, 5 and 13 m.
        let positions = [[0.0; 3], [3.0, 0.0, 4.0], [0.0, 5.0, -12.0]];
        let report = compare(&cloud(&positions), |_, _| Some([0.0; 3])).unwrap();
        assert_eq!((report.worst_m, report.worst_index), (13.0, Some(2)));
        assert!((report.rms_m - (194.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn points_without_truth_or_finite_values_are_counted_separately() {
        let positions = [
            [1.0, 0.0, 0.0],
            [f64::NAN, 0.0, 0.0],
            [0.0; 3],
            [0.0, f64::INFINITY, 0.0],
            [0.0; 3],
            [0.0, 1e200, 0.0],
        ];
        let report = compare(&cloud(&positions), |time, _| match index(time) {
            2 => None,
            4 => Some([f64::NAN; 3]),
            _ => Some([0.0; 3]),
        })
        .unwrap();
        assert_eq!(
            (report.points, report.unmatched, report.not_finite),
            (1, 1, 4)
        );
        assert_eq!((report.rms_m, report.worst_m), (1.0, 1.0));
        assert_eq!(report.worst_index, Some(0));
    }

    #[test]
    fn an_empty_comparison_passes_no_limit() {
        for cloud in [cloud(&[]), cloud(&[[0.0; 3]; 4])] {
            let report = compare(&cloud, |_, _| None).unwrap();
            assert!(report.rms_m.is_nan() && report.worst_m.is_nan());
            assert_eq!((report.points, report.worst_index), (0, None));
            assert_eq!(report.unmatched, cloud.len() as u64);
        }
    }

    #[test]
    fn a_cloud_without_device_time_is_refused() {
        let error = compare(&Points::new(Fields::LASER), |_, _| None).unwrap_err();
        assert_eq!(error.missing, Fields::DEVICE_TIME);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Batches through the sink against a plain two-pass computation over the whole.
        #[test]
        fn comparing_in_batches_agrees_with_comparing_at_once(
            pairs in prop::collection::vec(
                (prop::array::uniform3(-100.0..100.0f64), prop::array::uniform3(-0.1..0.1f64)),
                1..60,
            ),
            cut in 0usize..60,
        ) {
            let truth: Vec<_> = pairs.iter().map(|(hit, _)| *hit).collect();
            let positions: Vec<_> = pairs
                .iter()
                .map(|(hit, error)| [hit[0] + error[0], hit[1] + error[1], hit[2] + error[2]])
                .collect();
            let whole = cloud(&positions);

            let mut comparison = Comparison::new(|time, _| truth.get(index(time)).copied());
            let cut = cut.min(whole.len());
            let mut batch = Points::new(comparison.fields());
            for (i, point) in whole.iter().enumerate() {
                if i == cut {
                    comparison.points(&batch).unwrap();
                    batch.clear();
                }
                batch.push(point);
            }
            comparison.points(&batch).unwrap();
            let report = comparison.report();

            let errors: Vec<f64> = positions
                .iter()
                .zip(&truth)
                .map(|(p, t)| (0..3).map(|k| (p[k] - t[k]).powi(2)).sum::<f64>().sqrt())
                .collect();
            let worst = errors.iter().copied().fold(0.0, f64::max);
            let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
            prop_assert_eq!(report.points, errors.len() as u64);
            prop_assert!((report.worst_m - worst).abs() < 1e-12);
            prop_assert!((report.rms_m - mean.sqrt()).abs() < 1e-12);
            let at = report.worst_index.map(|i| errors[i as usize]);
            prop_assert!((at.unwrap() - worst).abs() < 1e-12);
        }
    }
}
