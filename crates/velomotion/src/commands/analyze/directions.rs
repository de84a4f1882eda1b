//! Directions of an input: in memory, or of a pattern that is too large for it, part by part.

use std::borrow::Cow;

use analysis::density::{BinCounts, DensityError, Locator, gaps};
use analysis::figures::{Planes, SpherePoints};
use glam::DVec3;
use sim::patterns::Pattern;

/// Most points of a pattern in memory: 0.4 GB, and twice as much again for their search.
const MOST_STORED: u64 = 16_000_000;
/// Points made at a time; few in tests, where there are several parts.
const PART: usize = if cfg!(test) { 40_000 } else { 4_000_000 };
/// Most points among which holes are looked for if not all are in memory.
const MOST_THINNED: u64 = 4 * PART as u64;

/// Directions of points.
pub enum Directions {
    /// In memory.
    Stored(Vec<DVec3>),
    /// Made when they are needed.
    Streamed(Box<Pattern>),
}

impl Default for Directions {
    fn default() -> Self {
        Self::Stored(Vec::new())
    }
}

impl Directions {
    /// Those of a pattern.
    pub fn of_pattern(pattern: &Pattern) -> Self {
        match pattern.points() {
            0..=MOST_STORED => Self::Stored(pattern.directions()),
            _ => Self::Streamed(Box::new(pattern.clone())),
        }
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        match self {
            Self::Stored(directions) => directions.len() as u64,
            Self::Streamed(pattern) => pattern.points(),
        }
    }

    /// Passes all directions to `add`, part by part.
    fn each_part<E>(&self, mut add: impl FnMut(&[DVec3]) -> Result<(), E>) -> Result<(), E> {
        let pattern = match self {
            Self::Stored(directions) => return add(directions),
            Self::Streamed(pattern) => pattern,
        };
        let mut part = Vec::with_capacity(2 * PART);
        for frame in 0..pattern.frames() {
            part.append(&mut pattern.frame(frame));
            if part.len() >= PART {
                add(&part)?;
                part.clear();
            }
        }
        add(&part)
    }

    /// Points per bin.
    pub fn counts(&self, locator: &Locator) -> Result<BinCounts, DensityError> {
        let mut counts = BinCounts::empty(locator);
        self.each_part(|part| counts.add(locator, part))?;
        Ok(counts)
    }

    /// Intersections of rays with the planes of the figure, and points on the sphere.
    pub fn pictures(&self) -> (Planes, SpherePoints) {
        let (mut planes, mut sphere) = (Planes::default(), SpherePoints::default());
        let Ok(()) = self.each_part::<std::convert::Infallible>(|part| {
            planes.add(part);
            sphere.add(part);
            Ok(())
        });
        (planes, sphere)
    }

    /// The angle from each place to the nearest point, radians.
    pub fn gaps(&self, places: &[DVec3]) -> Result<Vec<f64>, DensityError> {
        let mut nearest = vec![f64::INFINITY; places.len()];
        self.each_part(|part| {
            for (nearest, gap) in nearest.iter_mut().zip(gaps(part, places)?) {
                *nearest = nearest.min(gap);
            }
            Ok(())
        })?;
        Ok(nearest)
    }

    /// All directions; of a streamed pattern those of every so many frames. Each direction left out
    /// is within the second value, radians, of one that is not: the frames are copies of each
    /// other, turned about the axis.
    pub fn thinned(&self) -> (Cow<'_, [DVec3]>, f64) {
        let pattern = match self {
            Self::Stored(directions) => return (Cow::Borrowed(directions), 0.0),
            Self::Streamed(pattern) => pattern,
        };
        let frames = pattern.frames();
        let every = pattern.points().div_ceil(MOST_THINNED) as u32;
        // The last frame may be cut off.
        let kept = (0..frames).filter(|frame| frame.is_multiple_of(every) || frame + 2 >= frames);
        let kept: Vec<DVec3> = kept.flat_map(|frame| pattern.frame(frame)).collect();
        let settings = pattern.settings();
        let step_deg = settings.tilt.speed_deg_s * 60.0 / settings.rpm;
        (
            Cow::Owned(kept),
            f64::from(every / 2) * step_deg.to_radians(),
        )
    }
}

#[cfg(test)]
mod tests {
    use analysis::density::Icosahedron;
    use sim::patterns::PatternRequest;

    use super::*;

    fn both(text: &str) -> [Directions; 2] {
        let request = PatternRequest::parse(text).unwrap();
        let pattern = request.build().unwrap();
        let all = Directions::of_pattern(&pattern);
        assert!(matches!(all, Directions::Stored(_)));
        [all, Directions::Streamed(Box::new(pattern))]
    }

    #[test]
    fn parts_give_what_all_points_give() {
        for text in ["velomotion16:50,accel=100,d=0.06", "lms151:9,spin"] {
            let [all, parts] = both(text);
            assert!(all.points() == parts.points() && all.points() > 2 * PART as u64);
            let bins = Icosahedron::new(3).unwrap();
            let locator = Locator::new(&bins);
            assert_eq!(all.counts(&locator), parts.counts(&locator));
            assert_eq!(all.pictures(), parts.pictures());
            let places: Vec<DVec3> = bins.bins().iter().map(|bin| bin.centre).collect();
            assert_eq!(all.gaps(&places), parts.gaps(&places));
        }
    }

    #[test]
    fn thinned_points_are_near_those_left_out() {
        for text in [
            "velomotion16:13,d=0.5",
            "velomotion16:20,accel=30",
            "hdl64e:30,spin,tilt=stepped",
        ] {
            let [all, parts] = both(text);
            let (kept, within_rad) = parts.thinned();
            assert!(kept.len() as u64 <= MOST_THINNED + all.points() / 5);
            assert!(all.points() > MOST_THINNED && within_rad > 0.0, "{text}");
            let (all, _) = all.thinned();
            let some: Vec<DVec3> = all.iter().copied().step_by(7).collect();
            let farthest = gaps(&kept, &some).unwrap().into_iter().fold(0.0, f64::max);
            assert!(
                farthest <= within_rad + 1e-9,
                "{text}: {farthest} {within_rad}"
            );
            assert!(
                farthest >= 0.1 * within_rad,
                "{text}: {farthest} {within_rad}"
            );
        }
    }
}
