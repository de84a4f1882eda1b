//! open3d, over embree, hits a mesh of 100,000 triangles where the simulator does.

use std::fs;
use std::path::{Path, PathBuf};

use sim::cast::{Caster, Hit, Mesh, Object, Ray, Reach};

/// Rounds to f32, so that both cast at the same mesh.
fn short(value: f64) -> f64 {
    f64::from(value as f32)
}

/// A field of hills, 224 x 224 cells of 0.25 m: 100,352 triangles; heights up to 2 m.
fn hills() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let side = 225_u32;
    let mut vertices = Vec::new();
    for at in 0..side * side {
        let (x, y) = (
            f64::from(at % side) * 0.25 - 28.0,
            f64::from(at / side) * 0.25 - 28.0,
        );
        let hill = (0.9 * x).sin() * (0.7 * y).cos() + 0.3 * (3.1 * x + 1.7 * y).sin();
        vertices.push([x, y, short(hill * (x * x + y * y).sqrt().min(8.0) / 5.0)]);
    }
    let mut triangles = Vec::new();
    for row in 0..side - 1 {
        for at in row * side..row * side + side - 1 {
            triangles.extend([[at, at + 1, at + side], [at + 1, at + side + 1, at + side]]);
        }
    }
    (vertices, triangles)
}

/// Revolutions of a VLP-16 two metres above the ground, each slightly lower.
fn firings() -> Vec<Ray> {
    let mut rays = Vec::new();
    for firing in 0..7_200_u32 {
        let azimuth = (f64::from(firing) * 0.2).to_radians();
        let lower = 5.0 * f64::from(firing / 1_800);
        for beam in 0..16 {
            let elevation = (2.0 * f64::from(beam) - 15.0 - lower).to_radians();
            let along = [
                elevation.cos() * azimuth.sin(),
                elevation.cos() * azimuth.cos(),
                elevation.sin(),
            ]
            .map(short);
            // f32 keeps the length within 1e-7 of 1: the same ray for both.
            rays.push(Ray::new([0.25, 0.125, 2.0].into(), along.into()).unwrap());
        }
    }
    rays
}

fn write(path: &Path, rows: impl Iterator<Item = f64>) -> PathBuf {
    let bytes: Vec<u8> = rows.flat_map(f64::to_le_bytes).collect();
    fs::write(path, bytes).unwrap();
    path.to_owned()
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn open3d_hits_a_mesh_of_100_000_triangles_at_the_same_ranges() {
    let (vertices, triangles) = hills();
    let corners: Vec<_> = vertices.iter().map(|&corner| corner.into()).collect();
    let mesh = Mesh::new(&corners, &triangles).unwrap();
    assert_eq!(mesh.triangles(), 100_352);
    let caster = Caster::new([Object::new(mesh)]).unwrap();
    let rays = firings();
    let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
    caster.nearest_of(&rays, 16, Reach::default(), &mut hits);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let files = [
        write(&at("vertices"), vertices.iter().flatten().copied()),
        write(
            &at("triangles"),
            triangles.iter().flatten().map(|&at| f64::from(at)),
        ),
        write(
            &at("rays"),
            rays.iter().flat_map(|ray| {
                let ([a, b, c], [d, e, f]) =
                    (ray.origin_m().to_array(), ray.direction().to_array());
                [a, b, c, d, e, f]
            }),
        ),
        write(
            &at("ranges"),
            hits.iter()
                .map(|hit| hit.map_or(f64::INFINITY, |hit| hit.range_m)),
        ),
    ];
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let result = super::run_script("open3d_ranges.py", &paths);
    eprintln!("{result}");
    let of = |name: &str| result[name].as_u64().unwrap();
    assert_eq!(of("rays"), 115_200);
    assert!(of("hits") > 50_000, "{result}");
    assert_eq!(of("apart_elsewhere"), 0, "{result}");
    // Rays at silhouettes are few, and few of them differ.
    assert!(
        of("silhouette") < 3_000 && of("apart_at_silhouettes") < 300,
        "{result}"
    );
    assert!(result["median_m"].as_f64().unwrap() < 1e-6, "{result}");
}
