//! The scene and the origins of rays: the same for every competitor.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use sim::cast::Ray;

/// Firings of 16 beams.
const FIRINGS: usize = 62_500;
/// Beams of a firing.
pub const BEAMS: usize = 16;

/// Vertices and triangles.
pub struct Triangles {
    /// Metres.
    pub vertices: Vec<DVec3>,
    /// Counterclockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A room of 20 x 20 x 5 m.
pub fn room() -> Triangles {
    let corner = |at: u32| {
        let [x, y, z] = [at >> 2 & 1, at >> 1 & 1, at & 1].map(f64::from);
        DVec3::new(20.0 * x - 10.0, 20.0 * y - 10.0, 5.0 * z - 2.0)
    };
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    Triangles {
        vertices: (0..8).map(corner).collect(),
        triangles: faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
    }
}

/// A lumpy cave of 88,000 triangles with 50 boulders of 240 in it: 100,000 together.
pub fn cave() -> Triangles {
    let mut cave = Triangles {
        vertices: Vec::new(),
        triangles: Vec::new(),
    };
    add_ball(&mut cave, 201, 220, |along| {
        let lumps = (7.0 * along.x).sin() * (9.0 * along.y).cos()
            + 0.3 * (31.0 * along.z + 17.0 * along.x).sin();
        along * (20.0 + 3.0 * lumps) * DVec3::new(1.0, 1.0, 0.4)
    });
    for boulder in 0..50_u32 {
        let turn = f64::from(boulder) * TAU / 50.0;
        let away = 6.0 + 8.0 * (f64::from(boulder) * 0.618).fract();
        let centre = DVec3::new(
            away * turn.cos(),
            away * turn.sin(),
            3.0 * (f64::from(boulder) * 0.382).fract() - 3.0,
        );
        add_ball(&mut cave, 11, 12, |along| {
            centre + along * (0.4 + 0.1 * (5.0 * along.x).sin())
        });
    }
    cave
}

/// A sphere's triangles, each vertex moved from its direction to where it belongs.
fn add_ball(to: &mut Triangles, rings: u32, sectors: u32, place: impl Fn(DVec3) -> DVec3) {
    let first = to.vertices.len() as u32;
    to.vertices.push(place(DVec3::NEG_Z));
    for ring in 1..rings {
        let height = -(f64::from(ring) * TAU / 2.0 / f64::from(rings)).cos();
        let radius = (1.0 - height * height).sqrt();
        for sector in 0..sectors {
            let (y, x) = (f64::from(sector) * TAU / f64::from(sectors)).sin_cos();
            to.vertices
                .push(place(DVec3::new(radius * x, radius * y, height)));
        }
    }
    to.vertices.push(place(DVec3::Z));
    let last = to.vertices.len() as u32 - 1;
    let at = |ring: u32, sector: u32| match ring {
        0 => first,
        ring if ring == rings => last,
        ring => first + 1 + (ring - 1) * sectors + sector % sectors,
    };
    for ring in 0..rings {
        for sector in 0..sectors {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [d, c] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            if a != b {
                to.triangles.push([a, b, c]);
            }
            if c != d {
                to.triangles.push([a, c, d]);
            }
        }
    }
}

/// A VLP-16 at 600 rpm, 0.2 m from an axis on which it is tilted from -45 degrees to 0 while it
/// fires.
pub fn rays() -> Vec<Ray> {
    let mut rays = Vec::with_capacity(FIRINGS * BEAMS);
    for firing in 0..FIRINGS {
        let azimuth = (firing as f64 * 0.199_065_6).to_radians();
        let tilt =
            DMat3::from_rotation_x((45.0 * (firing as f64 / FIRINGS as f64 - 1.0)).to_radians());
        for beam in 0..BEAMS {
            let elevation = (2.0 * beam as f64 - 15.0).to_radians();
            let along = DVec3::new(
                elevation.cos() * azimuth.sin(),
                elevation.cos() * azimuth.cos(),
                elevation.sin(),
            );
            let origin = tilt * DVec3::new(0.0, 0.2, 0.0);
            rays.push(Ray::new(origin, (tilt * along).normalize()).expect("finite, of length 1"));
        }
    }
    rays
}
