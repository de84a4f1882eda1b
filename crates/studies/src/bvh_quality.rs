//! Study of the quality of the bounding volume hierarchy: time to build it against time per ray.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;

use analysis::tradeoff::{
    Bench, Measurement, Row, Study, StudyError, StudyFindings, StudyRows, TimingSpread, Trade,
    Work, in_rounds,
};
use glam::DVec3;
use sim::cast::{Caster, Hit, Mesh, Object, Quality, Ray, Reach, Surface};
use sim::scenery::{Scenery, no_files, shipped};

use crate::ball::BallMesh;
use crate::shots::SampledFirings;

/// The study.
pub(crate) const BVH_QUALITY: Study = Study {
    name: "bvh-quality",
    title: "Quality of the tree of boxes",
    choice: "scene, tree",
    columns: &[
        ("build_ms", "build, ms"),
        ("trace_ns_per_ray", "ns per ray"),
        ("scan_ms", "built and 3 M rays, ms"),
        ("hits_that_differ", "hits that differ"),
    ],
    trades: &[Trade::new(0, 1).by_group()],
    finding,
    measure,
};

/// The time of a whole simulation with velomotion's tree, and with a box per triangle.
fn finding(findings: &StudyFindings) -> String {
    let of = |tree: &str| {
        let value = |scene: &str| findings.text(&format!("{scene}, {tree}"), 2);
        format!("{} and {}", value("cave"), value("quarry"))
    };
    format!(
        "velomotion's tree and 3 million rays take {} ms in cave and quarry, {} with a box per triangle",
        of("16 bins, 4 a box (velomotion's)"),
        of("16 bins"),
    )
}

/// Lasers per firing.
const BEAMS: usize = 16;
/// About the rays of ten seconds of a VLP-16.
const SCAN_RAYS: f64 = 3_000_000.0;

/// 100,000 triangles with its boulders.
const CAVE: BallMesh = BallMesh {
    rings: 201,
    sectors: 220,
};
const CAVE_AT_A_LOOK: BallMesh = BallMesh {
    rings: 31,
    sectors: 40,
};

/// Name, label and quality. Meshes have 16 bins and boxes of four triangles.
const QUALITIES: [(&str, &str, Quality); 10] = [
    ("middle cuts", "middle", of(0, 1)),
    ("middle cuts, 4 a box", "middle, 4", of(0, 4)),
    ("4 bins", "4", of(4, 1)),
    ("8 bins", "8", of(8, 1)),
    ("16 bins", "16", of(16, 1)),
    ("32 bins", "32", of(32, 1)),
    ("64 bins", "64", of(64, 1)),
    ("16 bins, 2 a box", "16, 2", of(16, 2)),
    ("16 bins, 4 a box (velomotion's)", "16, 4", of(16, 4)),
    ("16 bins, 8 a box", "16, 8", of(16, 8)),
];

const fn of(bins: usize, sharing: usize) -> Quality {
    Quality { bins, sharing }
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let shots = SampledFirings::of("quarry", bench.pick(48, 14_000))?;
    let rays = rays(&shots)?;
    let scenes = [
        BvhScene::new("cave", cave(bench.pick(CAVE_AT_A_LOOK, CAVE))?)?,
        BvhScene::new("quarry", quarry(shots.seed)?)?,
    ];
    let plan = bench.plan(&format!("{} rays", rays.len()), 3, 9);
    let mut work: Vec<Work<'_>> = Vec::new();
    let mut named = Vec::new();
    for scene in &scenes {
        let expected = hits(&scene.caster(Quality::MESH)?, &rays);
        for (name, label, quality) in QUALITIES {
            let caster = scene.caster(quality)?;
            let got = hits(&caster, &rays);
            named.push((name, label, scene.name, differing(&got, &expected)));
            work.push(Box::new(move || {
                scene.meshes().for_each(|mesh| {
                    black_box(mesh.rebuilt(quality));
                });
                Ok(())
            }));
            let (rays, mut hits) = (&rays, vec![None; rays.len()]);
            work.push(Box::new(move || {
                cast(&caster, black_box(rays), &mut hits);
                black_box(&hits);
                Ok(())
            }));
        }
    }
    let times = in_rounds(bench.clock, plan, &mut work)?;
    let rows = named.into_iter().zip(times.as_chunks().0);
    let rows = rows.map(|((name, label, scene, differ), [build, trace])| Row {
        name: format!("{scene}, {name}"),
        label: label.to_owned(),
        group: scene,
        values: values(*build, trace.times(1.0 / rays.len() as f64), differ),
    });
    Ok((about(&scenes, rays.len()), rows.collect()))
}

/// The values of a row from the seconds of a build and of a ray.
fn values(build: TimingSpread, ray: TimingSpread, differ: usize) -> Vec<Measurement> {
    let scan = TimingSpread {
        median: build.median + SCAN_RAYS * ray.median,
        min: build.min + SCAN_RAYS * ray.min,
        max: build.max + SCAN_RAYS * ray.max,
        runs: build.runs,
    };
    vec![
        Measurement::Timed(build.times(1e3)),
        Measurement::Timed(ray.times(1e9)),
        Measurement::Timed(scan.times(1e3)),
        Measurement::Computed(differ as f64),
    ]
}

fn about(scenes: &[BvhScene], rays: usize) -> Vec<String> {
    let counts: Vec<String> = scenes
        .iter()
        .map(|scene| {
            let triangles: usize = scene.meshes().map(|mesh| mesh.triangles()).sum();
            format!("{} of {triangles} triangles", scene.name)
        })
        .collect();
    vec![
        format!(
            "Scenes are the simulator's {} and a {}. One thread casts {rays} rays of a sweep through the quarry, in the order \
             of a lidar. A middle cut halves the triangles along their widest axis. Bins divide each axis; the cut between two \
             with the smallest cost by the surface area heuristic is taken. Triangles in one box are tested together.",
            counts.get(1).map_or("", String::as_str),
            counts.first().map_or("", String::as_str),
        ),
        "Every tree gives the same object, triangle and distance, bit for bit. A tree is built once per run, so the number of \
         rays decides which is best: 3 million are ten seconds of a VLP-16. Each scene has its own front."
            .to_owned(),
    ]
}

/// A scene to cast rays at.
struct BvhScene {
    name: &'static str,
    objects: Vec<Object>,
}

impl BvhScene {
    fn new(name: &'static str, objects: Vec<Object>) -> Result<Self, StudyError> {
        let scene = Self { name, objects };
        if scene.meshes().next().is_none() {
            return Err(StudyError::workload(format!(
                "{name}: a scene without a mesh"
            )));
        }
        Ok(scene)
    }

    fn meshes(&self) -> impl Iterator<Item = &Arc<Mesh>> {
        self.objects
            .iter()
            .filter_map(|object| match &object.surface {
                Surface::Mesh(mesh) => Some(mesh),
                _ => None,
            })
    }

    /// All meshes with hierarchies of this quality.
    fn caster(&self, quality: Quality) -> Result<Caster, StudyError> {
        let objects = self.objects.iter().map(|object| match &object.surface {
            Surface::Mesh(mesh) => Object::new(mesh.rebuilt(quality)).placed(object.placement),
            _ => object.clone(),
        });
        Caster::new(objects).map_err(StudyError::workload)
    }
}

/// Number of rays with another hit, or at another place.
fn differing(hits: &[Option<Hit>], others: &[Option<Hit>]) -> usize {
    let both = hits.iter().zip(others);
    both.filter(|(a, b)| a != b).count()
}

fn hits(caster: &Caster, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    cast(caster, rays, &mut hits);
    hits
}

fn cast(caster: &Caster, rays: &[Ray], hits: &mut [Option<Hit>]) {
    caster.nearest_of(rays, BEAMS, Reach::default(), hits);
}

/// The rays of all lasers, firing after firing.
fn rays(shots: &SampledFirings) -> Result<Vec<Ray>, StudyError> {
    let mut rays = Vec::with_capacity(shots.count());
    for (firing, _) in &shots.firings {
        let both = firing.origins_m.iter().zip(&firing.directions);
        for (from, way) in both.take(BEAMS) {
            rays.push(Ray::new(*from, *way).map_err(StudyError::workload)?);
        }
    }
    Ok(rays)
}

/// The objects of the quarry's scene file.
fn quarry(seed: u64) -> Result<Vec<Object>, StudyError> {
    let scenery =
        Scenery::parse(shipped("quarry").unwrap_or_default()).map_err(StudyError::workload)?;
    let placed = scenery
        .place(seed, &mut no_files)
        .map_err(StudyError::workload)?;
    Ok(placed.objects)
}

/// Boulders in the cave, and their resolution.
const BOULDERS: u32 = 50;
const BOULDER: BallMesh = BallMesh {
    rings: 11,
    sectors: 12,
};

/// A cave around the origin with boulders in it.
fn cave(walls: BallMesh) -> Result<Vec<Object>, StudyError> {
    let mut vertices = walls.vertices(|along| {
        let lumps = (7.0 * along.x).sin() * (9.0 * along.y).cos()
            + 0.3 * (31.0 * along.z + 17.0 * along.x).sin();
        along * (20.0 + 3.0 * lumps) * DVec3::new(1.0, 1.0, 0.4)
    });
    let mut triangles = walls.triangles();
    for boulder in (0..BOULDERS).map(f64::from) {
        let turn = boulder / f64::from(BOULDERS) * TAU;
        let away_m = 6.0 + 8.0 * (boulder * 0.618).fract();
        let height_m = 3.0 * (boulder * 0.382).fract() - 3.0;
        let middle_m = DVec3::new(away_m * turn.cos(), away_m * turn.sin(), height_m);
        let first = u32::try_from(vertices.len()).map_err(StudyError::workload)?;
        vertices.extend(
            BOULDER.vertices(|along| middle_m + along * (0.4 + 0.1 * (5.0 * along.x).sin())),
        );
        let own = BOULDER.triangles().into_iter();
        triangles.extend(own.map(|corners| corners.map(|at| at + first)));
    }
    let mesh = Mesh::new(&vertices, &triangles).map_err(StudyError::workload)?;
    Ok(vec![Object::new(mesh)])
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::Effort;
    use units::{Span, Stamp};

    use super::*;

    #[test]
    fn rays_hit_the_same_in_every_tree() {
        let mut now = Stamp::from_nanos(0);
        // The clock advances by 3 ms per reading, so every measurement takes equally long.
        let mut clock = || {
            now = now.saturating_add(Span::from_micros(3_000));
            now
        };
        let mut bench = Bench {
            clock: &mut clock,
            effort: Effort::Quick,
            say: &mut |_| {},
        };
        let (_, rows) = measure(&mut bench).unwrap();
        assert_eq!(rows.len(), 2 * QUALITIES.len());
        for row in &rows {
            let values: Vec<f64> = row.values.iter().map(Measurement::middle).collect();
            assert_eq!(values[3], 0.0, "{row:?}");
            assert!((values[0] - 3.0).abs() < 1e-9, "{row:?}");
            assert!(values[1] > 0.0, "{row:?}");
            assert!((values[2] - 3.0 - 3.0 * values[1]).abs() < 1e-9, "{row:?}");
        }
        let velomotions = QUALITIES
            .iter()
            .find(|(name, ..)| name.contains("velomotion"));
        assert_eq!(velomotions.unwrap().2, Quality::MESH);
    }

    #[test]
    fn differing_hits_are_counted() {
        let shots = SampledFirings::of("quarry", 8).unwrap();
        let rays = rays(&shots).unwrap();
        let moved = cave(BOULDER).unwrap();
        let scene = BvhScene::new("cave", moved).unwrap();
        let caster = scene.caster(Quality::MESH).unwrap();
        let mut met = hits(&caster, &rays);
        assert!(met.iter().flatten().count() * 2 > rays.len());
        assert_eq!(differing(&met, &hits(&caster, &rays)), 0);
        let first = met.iter_mut().flatten().next().unwrap();
        first.range_m = first.range_m.next_up();
        assert_eq!(differing(&met, &hits(&caster, &rays)), 1);
        assert!(BvhScene::new("empty", Vec::new()).is_err());
    }
}
