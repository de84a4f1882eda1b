//! Statistics of a cloud while it is made: density, gaps, ranges, stated standard deviations.
//!
//! Points are not kept: parts of them are measured one after the other.

use cloud::{Fields, Points, Sink, SinkError, TiltTrack};
use glam::DVec3;
use serde::Serialize;
use utoipa::ToSchema;

use crate::density::{
    BinCounts, DensityError, Icosahedron, Locator, RegionDepth, Statistics, gaps, quantile,
};
use crate::plan::GapQuantiles;

/// Subdivisions of the icosahedron whose faces are the bins of densities: 5120 bins.
const BIN_LEVEL: u32 = 4;
/// Those whose centres are the directions of gaps, as of `analyze`.
const GAP_LEVEL: u32 = 5;
/// Points measured at once: 24 MB, and as much for their search. Few in tests, which have several
/// parts.
const PART: usize = if cfg!(test) { 7_000 } else { 1_000_000 };
/// Classes that count ranges.
const RANGE_STEP_M: f64 = 0.01;
/// Ranges of 300 m and more are in the last one.
const RANGE_STEPS: usize = 30_000;
/// Most classes of the reported histogram.
const CLASSES: f64 = 40.0;
/// Ratio of neighbouring classes of standard deviations, from 1 micrometre on.
const SD_RATIO: f64 = 1.005;
const SD_LEAST_M: f64 = 1e-6;
/// The last class begins at 30 m.
const SD_STEPS: usize = 3_450;
/// Share of the nearest and of the farthest points that does not count for the field of view.
const FEW: f64 = 0.01;

/// A class of ranges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct RangeClass {
    /// Smallest range, metres.
    pub from_m: f64,
    /// Largest range; the last class has all beyond.
    pub to_m: f64,
    /// Points.
    pub points: u64,
}

/// A bin of the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct BinPoints {
    /// Direction of its centre from the origin, a unit vector in the cloud's frame, to 0.0001.
    pub direction: [f64; 3],
    /// Points.
    pub points: u64,
}

/// Standard deviations that a cloud states for its points, millimetres, to half a per cent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct SdQuantiles {
    /// Half of the points state no more.
    pub p50: f64,
    /// 95 % of the points.
    pub p95: f64,
    /// 99 % of the points.
    pub p99: f64,
}

/// Statistics of a cloud.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct CloudStatistics {
    /// Points with a direction.
    pub points: u64,
    /// `view` where density and gaps are of the directions in view, `all` where the view is not
    /// known.
    pub of: &'static str,
    /// Points per bin of 5120 on a small sphere around the origin.
    pub density: Statistics,
    /// Those bins.
    pub bins: Vec<BinPoints>,
    /// Angles from a direction to the nearest point, degrees.
    pub gap_deg: GapQuantiles,
    /// Histogram of the ranges from the origin.
    pub ranges: Vec<RangeClass>,
    /// Stated standard deviations; null for a cloud that states none.
    pub sd_mm: Option<SdQuantiles>,
}

/// Collects the statistics of the points that it gets.
pub struct StatisticsCollector {
    locator: Locator,
    centres: Vec<DVec3>,
    counts: BinCounts,
    /// Directions of gaps, and the angle from each to the nearest point so far, radians.
    places: Vec<DVec3>,
    nearest_rad: Vec<f64>,
    part: Vec<DVec3>,
    points: u64,
    ranges: Vec<u64>,
    sds: Vec<u64>,
    track: TiltTrack,
}

fn centres(level: u32) -> Result<(Icosahedron, Vec<DVec3>), DensityError> {
    let grid = Icosahedron::new(level)?;
    let centres = grid.bins().iter().map(|bin| bin.centre).collect();
    Ok((grid, centres))
}

fn count(classes: &mut [u64], class: usize) {
    let last = classes.len().saturating_sub(1);
    if let Some(count) = classes.get_mut(class.min(last)) {
        *count += 1;
    }
}

/// The class of the value that a share of all values does not exceed; `None` without values.
fn class_of(classes: &[u64], share: f64) -> Option<usize> {
    let all: u64 = classes.iter().sum();
    let wanted = (share * all as f64).ceil().max(1.0) as u64;
    let mut below = 0;
    classes.iter().position(|count| {
        below += count;
        below >= wanted
    })
}

impl StatisticsCollector {
    /// A collector without points.
    ///
    /// # Errors
    /// None with its own numbers of bins.
    pub fn new() -> Result<Self, DensityError> {
        let (grid, bin_centres) = centres(BIN_LEVEL)?;
        let (_, places) = centres(GAP_LEVEL)?;
        let locator = Locator::new(&grid);
        Ok(Self {
            counts: BinCounts::empty(&locator),
            locator,
            centres: bin_centres,
            nearest_rad: vec![f64::INFINITY; places.len()],
            places,
            part: Vec::new(),
            points: 0,
            ranges: vec![0; RANGE_STEPS],
            sds: vec![0; SD_STEPS],
            track: TiltTrack::default(),
        })
    }

    /// The tilt that came with the points.
    #[must_use]
    pub const fn track(&self) -> &TiltTrack {
        &self.track
    }

    /// Range of distances that holds 98 % of the points, metres; `None` without points.
    #[must_use]
    pub fn distance_m(&self) -> Option<[f64; 2]> {
        let at = |share| Some(class_of(&self.ranges, share)? as f64 * RANGE_STEP_M);
        Some([at(FEW)?.max(RANGE_STEP_M), at(1.0 - FEW)? + RANGE_STEP_M])
    }

    /// The statistics, those of density and gaps in the view if it is known.
    ///
    /// # Errors
    /// None for the directions that [`Sink::points`] makes.
    pub fn finish(
        mut self,
        view: Option<RegionDepth<'_>>,
    ) -> Result<CloudStatistics, DensityError> {
        self.measure()?;
        let sees = |place: &DVec3| view.is_none_or(|depth_rad| depth_rad(*place) >= 0.0);
        let gaps_deg: Vec<f64> = self
            .places
            .iter()
            .zip(&self.nearest_rad)
            .filter(|(place, _)| sees(place))
            .map(|(_, gap)| gap.to_degrees())
            .collect();
        let gap = |share| quantile(&gaps_deg, share).unwrap_or(180.0).min(180.0);
        let sd = |share| {
            Some(1e3 * SD_LEAST_M * SD_RATIO.powf(class_of(&self.sds, share)? as f64 + 0.5))
        };
        let sds = || {
            Some(SdQuantiles {
                p50: sd(0.5)?,
                p95: sd(0.95)?,
                p99: sd(0.99)?,
            })
        };
        Ok(CloudStatistics {
            points: self.points,
            of: match view {
                Some(_) => "view",
                None => "all",
            },
            density: self
                .counts
                .statistics_of(|bin| self.centres.get(bin).is_some_and(sees)),
            bins: self
                .centres
                .iter()
                .zip(self.counts.by_bin())
                .filter(|(centre, _)| sees(centre))
                .map(|(centre, &points)| BinPoints {
                    direction: ((*centre * 1e4).round() / 1e4).to_array(),
                    points,
                })
                .collect(),
            gap_deg: GapQuantiles {
                p50: gap(0.5),
                p95: gap(0.95),
                p99: gap(0.99),
                worst: gap(1.0),
            },
            ranges: self.range_classes(),
            sd_mm: sds(),
        })
    }

    /// Few classes of a round width.
    fn range_classes(&self) -> Vec<RangeClass> {
        let Some(last) = self.ranges.iter().rposition(|count| *count > 0) else {
            return Vec::new();
        };
        let all_m = (last + 1) as f64 * RANGE_STEP_M;
        let widths =
            (-1..4).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
        let width_m = widths.into_iter().find(|width| all_m / width <= CLASSES);
        let width_m = width_m.unwrap_or(all_m);
        let steps = (width_m / RANGE_STEP_M).round() as usize;
        let classes = self
            .ranges
            .get(..=last)
            .unwrap_or_default()
            .chunks(steps.max(1));
        classes
            .enumerate()
            .map(|(i, counts)| RangeClass {
                from_m: i as f64 * width_m,
                to_m: (i + 1) as f64 * width_m,
                points: counts.iter().sum(),
            })
            .collect()
    }

    /// Measures the points of the part and forgets them.
    fn measure(&mut self) -> Result<(), DensityError> {
        if self.part.is_empty() {
            return Ok(());
        }
        self.counts.add(&self.locator, &self.part)?;
        for (nearest, gap) in self
            .nearest_rad
            .iter_mut()
            .zip(gaps(&self.part, &self.places)?)
        {
            *nearest = nearest.min(gap);
        }
        self.part.clear();
        Ok(())
    }
}

impl Sink for StatisticsCollector {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        for [x, y, z] in batch.positions() {
            let place = DVec3::new(x, y, z);
            let range_m = place.length();
            let direction = place / range_m;
            if !direction.is_finite() {
                continue;
            }
            self.points += 1;
            self.part.push(direction);
            count(&mut self.ranges, (range_m / RANGE_STEP_M) as usize);
        }
        for sd_m in batch.sd_m().iter().copied().filter(|sd_m| sd_m.is_finite()) {
            let class = (sd_m.max(SD_LEAST_M) / SD_LEAST_M).ln() / SD_RATIO.ln();
            count(&mut self.sds, class as usize);
        }
        if self.part.len() < PART {
            return Ok(());
        }
        self.measure().map_err(|error| SinkError::Encode {
            format: "statistics",
            points: self.points,
            source: Box::new(error),
        })
    }

    fn fields(&self) -> Fields {
        Fields::SD
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.track = track.clone();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use cloud::Point;

    use super::*;

    /// Points evenly around the origin, at ranges from 2 to 10 m, with standard deviations from 2
    /// to 10 mm.
    fn collected(n: usize) -> (StatisticsCollector, Vec<DVec3>) {
        let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let mut collector = StatisticsCollector::new().unwrap();
        let mut directions = Vec::new();
        for batch in (0..n).collect::<Vec<_>>().chunks(1_000) {
            let mut points = Points::new(Fields::SD);
            for &i in batch {
                let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
                let (sin, cos) = (turn * i as f64).sin_cos();
                let r = (1.0 - z * z).sqrt();
                let direction = DVec3::new(r * cos, r * sin, z);
                let range_m = 2.0 + 8.0 * i as f64 / n as f64;
                directions.push(direction);
                points.push(Point {
                    position_m: (range_m * direction).to_array(),
                    sd_m: 1e-3 * range_m,
                    ..Point::default()
                });
            }
            // No direction.
            points.push(Point::default());
            collector.points(&points).unwrap();
        }
        (collector, directions)
    }

    #[test]
    fn parts_give_what_all_points_give() {
        let (collector, directions) = collected(30_000);
        let [near_m, far_m] = collector.distance_m().unwrap();
        assert!((near_m - 2.07).abs() < 1e-9 && (far_m - 9.92).abs() < 1e-9);
        let grid = Icosahedron::new(BIN_LEVEL).unwrap();
        let locator = Locator::new(&grid);
        let counts = BinCounts::new(&locator, &directions).unwrap();
        let (_, places) = centres(GAP_LEVEL).unwrap();
        let nearest = gaps(&directions, &places).unwrap();
        let upper = |direction: DVec3| direction.z;
        for view in [None, Some(&upper as RegionDepth<'_>)] {
            let (collector, _) = collected(30_000);
            let found = collector.finish(view).unwrap();
            let sees = |place: DVec3| view.is_none() || place.z >= 0.0;
            let bins = |bin: usize| sees(grid.bins()[bin].centre);
            let expected = counts.statistics_of(bins);
            assert!(
                (found.density.mean - expected.mean).abs() < 1e-2,
                "{found:?}"
            );
            assert_eq!(found.density.bins, expected.bins);
            assert_eq!(found.bins.len(), found.density.bins);
            for bin in &found.bins {
                let place = counts.by_bin()[locator.bin(DVec3::from(bin.direction)) as usize];
                assert_eq!(bin.points, place, "{bin:?}");
            }
            let seen = places
                .iter()
                .zip(&nearest)
                .filter(|(place, _)| sees(**place));
            let seen: Vec<f64> = seen.map(|(_, gap)| gap.to_degrees()).collect();
            let gap = |share| quantile(&seen, share).unwrap();
            assert!((found.gap_deg.p99 - gap(0.99)).abs() < 1e-6);
            assert!((found.gap_deg.worst - gap(1.0)).abs() < 1e-6);
        }
    }

    #[test]
    fn ranges_and_standard_deviations_are_counted() {
        let (collector, directions) = collected(30_000);
        let found = collector.finish(None).unwrap();
        assert_eq!(found.points, directions.len() as u64);
        let classes = &found.ranges;
        // 10 m in classes of 0.5 m, the first four without a point.
        assert_eq!(
            (classes.len(), classes[0].points, classes[3].points),
            (20, 0, 0)
        );
        for class in &classes[4..] {
            assert!((class.to_m - class.from_m - 0.5).abs() < 1e-9);
            assert!(class.points.abs_diff(30_000 / 16) <= 2, "{class:?}");
        }
        let sd = found.sd_mm.unwrap();
        for (found, expected) in [(sd.p50, 6.0), (sd.p95, 9.6), (sd.p99, 9.92)] {
            assert!((found / expected - 1.0).abs() < 6e-3, "{found} {expected}");
        }
    }

    #[test]
    fn no_point_has_no_statistics() {
        let collector = StatisticsCollector::new().unwrap();
        assert_eq!(collector.distance_m(), None);
        let found = collector.finish(None).unwrap();
        assert_eq!((found.points, found.sd_mm), (0, None));
        assert!(found.ranges.is_empty());
        assert_eq!(found.gap_deg.worst, 180.0);
    }
}
