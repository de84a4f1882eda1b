use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::*;

mod equality;
mod exact;
mod hard_cases;
mod placing;
mod quality;
mod solids;

/// Numbers that look random (SplitMix64; Steele, Lea and Flood 2014).
pub(super) struct Numbers(pub u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        units::random::split_mix_64(&mut self.0)
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f64 {
        self.bits() as f64 / (1_u64 << 63) as f64 - 1.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let along = self.vector();
            if (0.01..1.0).contains(&along.length()) {
                return along.normalize();
            }
        }
    }

    fn rotation(&mut self) -> DMat3 {
        let x = self.direction();
        let y = x.cross(self.direction()).normalize();
        DMat3::from_cols(x, y, x.cross(y))
    }
}

pub(super) fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin, direction).unwrap()
}

/// A closed, lumpy ball about the origin, of 2 `sectors` (`rings` - 1) triangles; vertices and
/// triangles.
pub(super) fn ball(
    rings: u32,
    sectors: u32,
    radius: f64,
    lumps: f64,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut vertices = vec![DVec3::NEG_Z * radius];
    for ring in 1..rings {
        let polar = f64::from(ring) * std::f64::consts::PI / f64::from(rings);
        for sector in 0..sectors {
            let turn = f64::from(sector) * std::f64::consts::TAU / f64::from(sectors);
            let lump = 1.0 + lumps * (5.0 * turn).sin() * (7.0 * polar).sin();
            let along = DVec3::new(
                polar.sin() * turn.cos(),
                polar.sin() * turn.sin(),
                -polar.cos(),
            );
            vertices.push(along * radius * lump);
        }
    }
    vertices.push(DVec3::Z * radius);
    let last = vertices.len() as u32 - 1;
    let at = |ring: u32, sector: u32| match ring {
        0 => 0,
        ring if ring == rings => last,
        ring => 1 + (ring - 1) * sectors + sector % sectors,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for sector in 0..sectors {
            let (a, b) = (at(ring, sector), at(ring, sector + 1));
            let (d, c) = (at(ring + 1, sector), at(ring + 1, sector + 1));
            if a != b {
                triangles.push([a, b, c]);
            }
            if c != d {
                triangles.push([a, c, d]);
            }
        }
    }
    (vertices, triangles)
}

pub(super) fn mesh((vertices, triangles): &(Vec<DVec3>, Vec<[u32; 3]>)) -> Caster {
    Caster::new([Object::new(Mesh::new(vertices, triangles).unwrap())]).unwrap()
}

pub(super) fn first(caster: &Caster, ray: &Ray) -> Option<Hit> {
    caster.nearest(ray, Reach::default())
}

/// The first hit and the normal there.
pub(super) fn first_with_normal(caster: &Caster, ray: &Ray) -> Option<(Hit, DVec3)> {
    let hit = first(caster, ray)?;
    Some((hit, caster.normal(&hit, ray.at(hit.range_m))))
}
