//! Bins on the sphere: the faces of an icosahedron, each cut into four repeatedly, with the corners
//! moved onto the sphere each time.
//!
//! The icosahedron has its corners at (0, +-1, +-phi) and the cyclic permutations. A cut halves the
//! edges of a face. Faces 4f..4f+3 of a level are parts of face f of the level above.
//! [`super::Locator`] finds the bin of a direction.

use glam::DVec3;

use super::DensityError;

/// The largest number of cuts: 20 x 4^8 = 1,310,720 bins.
pub const MOST_LEVEL: u32 = 8;

/// A triangle of great circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcosahedronFace {
    /// Corners as unit vectors, anticlockwise seen from outside.
    pub corners: [DVec3; 3],
    /// Mean of the corners, on the sphere.
    pub centre: DVec3,
    /// Distance of its farthest point from the centre as a chord; a corner, since a cap below a
    /// hemisphere is convex.
    pub chord: f64,
}

/// The faces of every level down to one.
#[derive(Clone, Debug)]
pub struct Icosahedron {
    levels: Vec<Vec<IcosahedronFace>>,
}

impl IcosahedronFace {
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let centre = (a + b + c).normalize();
        let chords = corners.map(|corner| corner.distance_squared(centre));
        Self {
            corners,
            centre,
            chord: chords.into_iter().fold(0.0, f64::max).sqrt(),
        }
    }

    /// The four parts of the face: at its three corners, and in the middle.
    #[must_use]
    pub fn cut(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let middle = |a: DVec3, b: DVec3| (a + b).normalize();
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(Self::new)
    }
}

impl Icosahedron {
    /// The icosahedron cut `level` times.
    ///
    /// # Errors
    /// [`DensityError::Level`] above [`MOST_LEVEL`].
    pub fn new(level: u32) -> Result<Self, DensityError> {
        if level > MOST_LEVEL {
            return Err(DensityError::Level { got: level });
        }
        let mut levels = vec![base()];
        for _ in 0..level {
            let cut = levels
                .last()
                .map(|faces| faces.iter().flat_map(IcosahedronFace::cut));
            let cut = cut.map(Iterator::collect).unwrap_or_default();
            levels.push(cut);
        }
        Ok(Self { levels })
    }

    /// Number of cuts.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.levels.len().saturating_sub(1) as u32
    }

    /// The bins: the faces of the last level.
    #[must_use]
    pub fn bins(&self) -> &[IcosahedronFace] {
        self.levels.last().map_or(&[], Vec::as_slice)
    }

    /// The faces of all levels, beginning with the 20.
    #[must_use]
    pub fn levels(&self) -> &[Vec<IcosahedronFace>] {
        &self.levels
    }
}

/// The 20 faces.
fn base() -> Vec<IcosahedronFace> {
    let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut corners = Vec::with_capacity(12);
    for short in [1.0, -1.0] {
        for long in [phi, -phi] {
            corners.extend([
                DVec3::new(0.0, short, long),
                DVec3::new(short, long, 0.0),
                DVec3::new(long, 0.0, short),
            ]);
        }
    }
    // Neighbours are 2 apart, all others farther.
    let near = |a: DVec3, b: DVec3| a.distance(b) < 2.1;
    let mut faces = Vec::with_capacity(20);
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1) {
            for &c in corners.iter().skip(j + 1) {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outwards = a.dot(b.cross(c)) > 0.0;
                    let corners = if outwards { [a, b, c] } else { [a, c, b] };
                    faces.push(IcosahedronFace::new(corners.map(DVec3::normalize)));
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The solid angle, steradians (van Oosterom and Strackee 1983).
    fn area_sr(face: &IcosahedronFace) -> f64 {
        let [a, b, c] = face.corners;
        let volume = a.dot(b.cross(c));
        2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    }

    #[test]
    fn faces_tile_the_sphere() {
        for level in 0..=6 {
            let bins = Icosahedron::new(level).unwrap();
            assert_eq!(bins.bins().len(), 20 << (2 * level));
            assert_eq!(bins.level(), level);
            let area: f64 = bins.bins().iter().map(area_sr).sum();
            assert!((area - 4.0 * PI).abs() < 1e-11, "{level}: {area}");
        }
        assert_eq!(
            Icosahedron::new(9).unwrap_err(),
            DensityError::Level { got: 9 }
        );
    }

    #[test]
    fn the_paper_uses_5120_bins_of_unequal_size() {
        let bins = Icosahedron::new(4).unwrap();
        assert_eq!(bins.bins().len(), 5_120);
        let areas = bins
            .bins()
            .iter()
            .map(|bin| area_sr(bin).to_degrees().to_degrees());
        let [least, most] = areas.fold([f64::MAX, 0.0_f64], |[least, most], area| {
            [least.min(area), most.max(area)]
        });
        // The mean is 8.057 deg2.
        assert!(
            (least - 7.478).abs() < 0.001 && (most - 9.714).abs() < 0.001,
            "{least} {most}"
        );
    }

    #[test]
    fn faces_lie_in_their_caps_and_parent_faces() {
        let all = Icosahedron::new(5).unwrap();
        for (above, below) in all.levels().iter().zip(&all.levels()[1..]) {
            for (number, face) in below.iter().enumerate() {
                let parent = &above[number / 4];
                let [a, b, c] = parent.corners;
                for corner in face.corners {
                    assert!(corner.distance(face.centre) <= face.chord * (1.0 + 1e-15));
                    let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|n| n.dot(corner));
                    assert!(sides.into_iter().all(|side| side > -1e-15), "{sides:?}");
                }
            }
        }
    }
}
