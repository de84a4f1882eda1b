//! Sphere, box, cylinder and plane, each in its own frame.
//!
//! A ray's line crosses each of them at most twice; it hits the first crossing ahead, from inside
//! as from outside. Nothing is computed from an edge, so that edges and corners have no cracks.
//! [`Placement`] places them, `solids8` casts eight rays at once.
//!
//! [`Placement`]: super::Placement

use glam::DVec3;

use super::bvh::BoundingBox;

/// Intersections of a line with a surface in order: distance along the ray and primitive; NaN for
/// none.
pub(crate) type Crossings = [(f64, u32); 2];

/// A line that crosses nothing.
const NOWHERE: Crossings = [(f64::NAN, 0); 2];

/// The first crossing farther than this.
#[inline(always)]
pub(super) fn first_above(crossings: Crossings, above_m: f64) -> Option<(f64, u32)> {
    let [first, second] = crossings;
    if first.0 > above_m {
        Some(first)
    } else if second.0 > above_m {
        Some(second)
    } else {
        None
    }
}

/// The sphere about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Metres; its sign does not matter.
    pub radius_m: f64,
}

impl Sphere {
    /// By the perpendicular from the centre to the ray: the discriminant of the quadratic subtracts
    /// squares of the distance, which loses the radius of a small distant sphere.
    #[inline]
    pub(crate) fn crossings(&self, origin: DVec3, direction: DVec3) -> Crossings {
        let nearest = -origin.dot(direction);
        let miss = (origin + nearest * direction).length();
        let radius_m = self.radius_m.abs();
        let half_squared = (radius_m - miss) * (radius_m + miss);
        if half_squared < 0.0 {
            return NOWHERE;
        }
        let half = half_squared.sqrt();
        [(nearest - half, 0), (nearest + half, 0)]
    }

    pub(super) fn bounds(&self) -> BoundingBox {
        let radius_m = self.radius_m.abs();
        BoundingBox {
            low: [-radius_m; 3],
            high: [radius_m; 3],
        }
    }

    /// At a point of the surface.
    pub(super) fn normal(point: DVec3) -> DVec3 {
        point.normalize_or_zero()
    }
}

/// The endless plane z = 0, seen from both sides; its normal is +z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane;

impl Plane {
    /// A ray along the plane does not cross it.
    #[inline]
    pub(crate) fn crossings(origin: DVec3, direction: DVec3) -> Crossings {
        if direction.z == 0.0 {
            return NOWHERE;
        }
        [(-origin.z / direction.z, 0), (f64::NAN, 0)]
    }
}

/// A box along the axes, visible from inside and outside. Its primitives are the faces -x, +x, -y,
/// +y, -z, +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    pub(super) low_m: DVec3,
    pub(super) high_m: DVec3,
}

impl Cuboid {
    /// Between two opposite corners, metres, in any order.
    #[must_use]
    pub fn new(corner_m: DVec3, opposite_m: DVec3) -> Self {
        Self {
            low_m: corner_m.min(opposite_m),
            high_m: corner_m.max(opposite_m),
        }
    }

    /// The corner with the smallest coordinates, metres.
    #[must_use]
    pub const fn low_m(&self) -> DVec3 {
        self.low_m
    }

    /// The corner with the greatest coordinates, metres.
    #[must_use]
    pub const fn high_m(&self) -> DVec3 {
        self.high_m
    }

    /// The overlap of the three slabs, closed at both ends, so that a ray exactly through an edge
    /// meets it.
    #[inline]
    pub(crate) fn crossings(&self, origin: DVec3, direction: DVec3) -> Crossings {
        let mut enter = (f64::NEG_INFINITY, 0);
        let mut leave = (f64::INFINITY, 0);
        let (o, d) = (origin, direction);
        for (o, d, low, high, face) in [
            (o.x, d.x, self.low_m.x, self.high_m.x, 0),
            (o.y, d.y, self.low_m.y, self.high_m.y, 2),
            (o.z, d.z, self.low_m.z, self.high_m.z, 4),
        ] {
            let Some((near, far)) = slab(o, d, low, high) else {
                return NOWHERE;
            };
            let backward = u32::from(d <= 0.0);
            if near > enter.0 {
                enter = (near, face + backward);
            }
            if far < leave.0 {
                leave = (far, face + 1 - backward);
            }
        }
        if enter.0 <= leave.0 {
            [enter, leave]
        } else {
            NOWHERE
        }
    }

    pub(super) fn bounds(&self) -> BoundingBox {
        BoundingBox {
            low: self.low_m.to_array(),
            high: self.high_m.to_array(),
        }
    }

    /// Normal of a face.
    pub(super) fn normal(face: u32) -> DVec3 {
        let outward = if face & 1 == 0 { -1.0 } else { 1.0 };
        match face >> 1 {
            0 => DVec3::X * outward,
            1 => DVec3::Y * outward,
            _ => DVec3::Z * outward,
        }
    }
}

/// A cylinder about the z axis, visible from inside and outside. Its primitives: 0 the mantle, 1
/// the bottom, 2 the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Metres; its sign does not matter.
    pub radius_m: f64,
    /// Height of one end, metres.
    pub bottom_m: f64,
    /// Height of the other end, metres; not below the first.
    pub top_m: f64,
    /// Whether the ends are closed: a drum, not a pipe.
    pub capped: bool,
}

impl Cylinder {
    /// The overlap of the infinite cylinder, in the form of [`Sphere`], with the slab between the
    /// ends.
    #[inline]
    pub(crate) fn crossings(&self, origin: DVec3, direction: DVec3) -> Crossings {
        let Some((near, far)) = self.round(origin, direction) else {
            return NOWHERE;
        };
        let Some((low, high)) = slab(origin.z, direction.z, self.bottom_m, self.top_m) else {
            return NOWHERE;
        };
        if !self.capped {
            let within = |at: f64| {
                if low <= at && at <= high {
                    at
                } else {
                    f64::NAN
                }
            };
            return [(within(near), 0), (within(far), 0)];
        }
        let (first, last) = if direction.z > 0.0 { (1, 2) } else { (2, 1) };
        let enter = if low > near { (low, first) } else { (near, 0) };
        let leave = if high < far { (high, last) } else { (far, 0) };
        if enter.0 <= leave.0 {
            [enter, leave]
        } else {
            NOWHERE
        }
    }

    /// Between which distances a line is within the endless cylinder.
    #[inline]
    fn round(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let radius_m = self.radius_m.abs();
        let (from, level) = (origin.truncate(), direction.truncate());
        let level_squared = level.length_squared();
        if level_squared == 0.0 {
            // Along the axis: within the circle for ever or never.
            let within = from.length() <= radius_m;
            return within.then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        // The distance of the line from the axis is exact; the foot of the perpendicular, far along
        // a steep ray, is not.
        let miss = from.perp_dot(level).abs() / level_squared.sqrt();
        let half_squared = (radius_m - miss) * (radius_m + miss);
        if half_squared < 0.0 {
            return None;
        }
        let nearest = -from.dot(level) / level_squared;
        let half = (half_squared / level_squared).sqrt();
        Some((nearest - half, nearest + half))
    }

    pub(super) fn bounds(&self) -> BoundingBox {
        let radius_m = self.radius_m.abs();
        BoundingBox {
            low: [-radius_m, -radius_m, self.bottom_m],
            high: [radius_m, radius_m, self.top_m],
        }
    }

    /// Normal of a primitive at a point of it.
    pub(super) fn normal(primitive: u32, point: DVec3) -> DVec3 {
        match primitive {
            1 => DVec3::NEG_Z,
            2 => DVec3::Z,
            _ => point.with_z(0.0).normalize_or_zero(),
        }
    }
}

/// The distances between which a line's coordinate is within `low..=high`; `None` for never.
#[inline(always)]
fn slab(origin: f64, direction: f64, low: f64, high: f64) -> Option<(f64, f64)> {
    if direction == 0.0 {
        // Parallel: in it for ever or never. Dividing would make 0/0 of a ray in the face.
        return (low <= origin && origin <= high).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
    Some(if direction > 0.0 { (a, b) } else { (b, a) })
}
