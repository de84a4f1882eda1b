//! Boxes: along the axes, or in any attitude.

use glam::{DMat3, DVec3};

use super::{Crossing, Passage, Ray, slab};

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    low: DVec3,
    high: DVec3,
    reflectivity: [u8; 6],
}

impl Cuboid {
    /// The box between two opposite corners (metres, in any order), of one reflectivity.
    #[must_use]
    pub fn new(corner: DVec3, opposite: DVec3, reflectivity: u8) -> Self {
        Self::with_faces(corner, opposite, [reflectivity; 6])
    }

    /// The box between two opposite corners (metres, in any order), with the reflectivity of each face in the order
    /// -x, +x, -y, +y, -z, +z.
    #[must_use]
    pub fn with_faces(corner: DVec3, opposite: DVec3, reflectivity: [u8; 6]) -> Self {
        Self {
            low: corner.min(opposite),
            high: corner.max(opposite),
            reflectivity,
        }
    }

    /// The corner with the smallest coordinates, metres.
    #[must_use]
    pub const fn low(&self) -> DVec3 {
        self.low
    }

    /// The corner with the greatest coordinates, metres.
    #[must_use]
    pub const fn high(&self) -> DVec3 {
        self.high
    }

    /// The overlap of the three slabs. Closed at both ends, so that a ray exactly through an edge counts as meeting it.
    #[inline]
    pub(crate) fn passage(&self, ray: &Ray) -> Option<Passage> {
        let [face_x0, face_x1, face_y0, face_y1, face_z0, face_z1] = self.reflectivity;
        let (o, d) = (ray.origin, ray.direction);
        let mut passage = Passage {
            enter: Crossing {
                at_m: f64::NEG_INFINITY,
                reflectivity: 0,
            },
            leave: Crossing {
                at_m: f64::INFINITY,
                reflectivity: 0,
            },
        };
        for (origin, direction, low, high, low_face, high_face) in [
            (o.x, d.x, self.low.x, self.high.x, face_x0, face_x1),
            (o.y, d.y, self.low.y, self.high.y, face_y0, face_y1),
            (o.z, d.z, self.low.z, self.high.z, face_z0, face_z1),
        ] {
            let (near, far) = slab(origin, direction, low, high)?;
            let forward = direction > 0.0;
            if near > passage.enter.at_m {
                passage.enter = Crossing {
                    at_m: near,
                    reflectivity: if forward { low_face } else { high_face },
                };
            }
            if far < passage.leave.at_m {
                passage.leave = Crossing {
                    at_m: far,
                    reflectivity: if forward { high_face } else { low_face },
                };
            }
        }
        (passage.enter.at_m <= passage.leave.at_m).then_some(passage)
    }
}

/// A box in any attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedCuboid {
    centre: DVec3,
    to_own: DMat3,
    own: Cuboid,
}

impl TurnedCuboid {
    /// The box of edge lengths `size` (metres) whose centre is at `centre` and whose own axes are the columns of the
    /// rotation `attitude`.
    #[must_use]
    pub fn new(centre: DVec3, size: DVec3, attitude: DMat3, reflectivity: u8) -> Self {
        Self {
            centre,
            to_own: attitude.transpose(),
            own: Cuboid::new(-0.5 * size, 0.5 * size, reflectivity),
        }
    }

    #[inline]
    pub(crate) fn passage(&self, ray: &Ray) -> Option<Passage> {
        self.own.passage(&Ray {
            origin: self.to_own * (ray.origin - self.centre),
            direction: self.to_own * ray.direction,
        })
    }
}
