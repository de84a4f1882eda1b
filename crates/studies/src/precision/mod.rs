//! Study of the number types of ray casting: error, rays that slip through edges, and time.

mod kernels;
mod reference;

use std::hint::black_box;

use crate::placing::{Float, LEAST_MM};
use analysis::tradeoff::{
    Bench, Row, SeededNoise, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade, Work,
};
use glam::DVec3;

use crate::ball::BallMesh;

use kernels::{Cast, Eight, KERNELS, Kernel, LANES, Patch};

/// The study.
pub(super) const PRECISION: Study = Study {
    name: "precision",
    title: "Numbers in which rays are cast",
    choice: "coordinates, test",
    columns: &[
        ("time_ns_per_test", "ns per test"),
        ("rms_error_mm", "RMS error, mm"),
        ("worst_error_mm", "worst error, mm"),
        ("missed_per_million", "slipped through, of a million"),
    ],
    trades: &[
        Trade::new(0, 2).by_group().down_to(LEAST_MM),
        Trade::new(0, 3).by_group(),
    ],
    finding,
    measure,
};

/// f32 and f64 far from the origin.
fn finding(findings: &StudyFindings) -> String {
    let of = |test: &str, column| findings.text(&format!("at 5e5 m as they are, {test}"), column);
    let ours = "watertight in f64 (velomotion's)";
    format!(
        "500 km from the origin f32 errs by {} mm in {} ns, f64 by {} mm in {} ns. Of a million rays {} slip through",
        of("watertight in f32", 2),
        of("watertight in f32", 0),
        of(ours, 2),
        of(ours, 0),
        of(ours, 3),
    )
}

/// The surface: a bumpy ball around the scanner with triangles 0.8 m wide.
const SURFACE: BallMesh = BallMesh {
    rings: 160,
    sectors: 320,
};
/// Its mean radius and the relative size of the bumps.
const RADIUS_M: f64 = 40.0;
const LUMPS: f64 = 0.25;
/// Map coordinates of its centre, metres.
const MAP_M: DVec3 = DVec3::new(500_012.345_6, 500_345.678_9, 312.5);
/// Cells along a side of a patch; rays go to those in the middle.
const SIDE: usize = 4;
/// Triangles per patch.
const TRIANGLES: usize = 2 * SIDE * SIDE;
/// Packets of eight rays per patch.
const PACKETS: usize = 8;

/// Positions of the surface and of the origin.
#[derive(Clone, Copy)]
struct CastingCase {
    name: &'static str,
    group: &'static str,
    middle_m: DVec3,
    origin_m: DVec3,
}

fn circumstances() -> [CastingCase; 3] {
    let on_map = CastingCase {
        name: "at 5e5 m as they are",
        group: "at 5e5 m",
        middle_m: MAP_M,
        origin_m: DVec3::ZERO,
    };
    [
        CastingCase {
            name: "about the origin",
            group: "about the origin",
            middle_m: DVec3::ZERO,
            origin_m: DVec3::ZERO,
        },
        on_map,
        CastingCase {
            name: "at 5e5 m, local origin",
            // As in meshes: coordinates of 24 bits.
            origin_m: MAP_M.as_vec3().as_dvec3(),
            ..on_map
        },
    ]
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let patches = bench.pick(12, 4_096);
    let rays = patches * PACKETS * LANES;
    let plan = bench.plan(&format!("{rays} rays of each"), 3, 15);
    let sets = circumstances().map(|circumstance| (circumstance, Set::new(circumstance, patches)));
    let mut choices = Vec::new();
    for (circumstance, set) in &sets {
        for (name, label, kernel) in KERNELS {
            let off = set.off(kernel)?;
            choices.push(TimedChoice {
                row: Row::new(
                    format!("{}, {name}", circumstance.name),
                    label,
                    circumstance.group,
                    [off.rms_m * 1e3, off.worst_m * 1e3, off.missed * 1e6],
                ),
                scale: 1e9 / (rays * TRIANGLES) as f64,
                work: set.work(kernel),
            });
        }
    }
    Ok((about(rays), bench.rows(plan, choices)?))
}

fn about(rays: usize) -> Vec<String> {
    vec![
        format!(
            "{rays} rays start inside a rough closed sphere {:.0} to {:.0} m in radius. About one third go exactly to vertices \
             of its triangles, one third to edges, one third in random directions. Eight at a time are tested against the \
             {TRIANGLES} nearest triangles and hit the first. The error is the distance to the hit of exact rays and triangles \
             in double-double arithmetic (106 bits), including rounding of coordinates. A ray without a hit has slipped \
             through. A test is one ray and one triangle.",
            RADIUS_M * (1.0 - LUMPS),
            RADIUS_M * (1.0 + LUMPS)
        ),
        "Moeller and Trumbore's test solves for each triangle separately. The watertight test (Woop, Benthin and Wald) \
         translates and shears vertices until the ray is an axis, with Kahan's difference of products. A local origin is \
         subtracted in f64 before coordinates are rounded, as for velomotion's meshes. A register holds twice as many f32 \
         numbers, but triangle tests are only a part of a cast, whose boxes are f32 anyway."
            .to_owned(),
    ]
}

/// Errors of a kernel.
#[derive(Clone, Copy, Debug)]
struct RayError {
    rms_m: f64,
    worst_m: f64,
    /// Share of the rays without a hit.
    missed: f64,
}

/// The same rays and triangles in both number types, with the true hits.
struct Set {
    wide: Vec<Patch<f64>>,
    narrow: Vec<Patch<f32>>,
    truth_m: Vec<[f64; LANES]>,
}

impl Set {
    fn new(circumstance: CastingCase, patches: usize) -> Self {
        let exact = patches_of(circumstance.middle_m, patches);
        let origin_m = circumstance.origin_m;
        Self {
            truth_m: reference::ranges(&exact),
            wide: exact.iter().map(|patch| patch.rounded(origin_m)).collect(),
            narrow: exact.iter().map(|patch| patch.rounded(origin_m)).collect(),
        }
    }

    fn off(&self, kernel: Kernel) -> Result<RayError, StudyError> {
        let ranges_m = match kernel {
            Kernel::F64(cast) => ranges(&self.wide, cast),
            Kernel::F32(cast) => ranges(&self.narrow, cast),
        };
        let (mut squares, mut worst_m, mut met, mut missed) = (0.0, 0.0_f64, 0_u32, 0_u32);
        for (got, truth) in ranges_m.iter().flatten().zip(self.truth_m.iter().flatten()) {
            if !truth.is_finite() {
                return Err(StudyError::workload(
                    "a ray that meets nothing in a closed ball",
                ));
            }
            if got.is_finite() {
                let off_m = (got - truth).abs();
                squares += off_m * off_m;
                worst_m = worst_m.max(off_m);
                met += 1;
            } else {
                missed += 1;
            }
        }
        Ok(RayError {
            rms_m: (squares / f64::from(met)).sqrt(),
            worst_m,
            missed: f64::from(missed) / f64::from(met + missed),
        })
    }

    fn work(&self, kernel: Kernel) -> Work<'_> {
        match kernel {
            Kernel::F64(cast) => work(&self.wide, cast),
            Kernel::F32(cast) => work(&self.narrow, cast),
        }
    }
}

fn room<T: Float>(patches: &[Patch<T>]) -> Vec<[T; LANES]> {
    let packets: usize = patches.iter().map(|patch| patch.packets.len()).sum();
    vec![[T::of(f64::INFINITY); LANES]; packets]
}

fn ranges<T: Float>(patches: &[Patch<T>], cast: Cast<T>) -> Vec<[f64; LANES]> {
    let mut ranges = room(patches);
    cast(patches, &mut ranges);
    ranges.iter().map(|eight| eight.map(T::f64)).collect()
}

fn work<T: Float>(patches: &[Patch<T>], cast: Cast<T>) -> Work<'_> {
    let mut ranges = room(patches);
    Box::new(move || {
        cast(black_box(patches), &mut ranges);
        black_box(&ranges);
        Ok(())
    })
}

impl Patch<f64> {
    /// The patches in other numbers, from another origin.
    fn rounded<T: Float>(&self, origin_m: DVec3) -> Patch<T> {
        let from = origin_m.to_array();
        let moved = |at: [f64; 3]| [0, 1, 2].map(|axis| T::of(at[axis] - from[axis]));
        let packets = self.packets.iter().map(|eight| Eight {
            axis: eight.axis,
            origin: [0, 1, 2].map(|axis| eight.origin[axis].map(|at| T::of(at - from[axis]))),
            direction: eight.direction.map(|along| along.map(T::of)),
        });
        Patch {
            triangles: self.triangles.iter().map(|of| of.map(moved)).collect(),
            packets: packets.collect(),
        }
    }
}

/// Patches of the ball around `middle_m` and rays towards them, without rounding.
fn patches_of(middle_m: DVec3, count: usize) -> Vec<Patch<f64>> {
    let vertices = SURFACE.vertices(|along| {
        let lumps = (5.0 * along.x + 2.0).sin() * (7.0 * along.y).sin() * (6.0 * along.z).cos();
        middle_m + along * RADIUS_M * (1.0 + LUMPS * lumps)
    });
    let mut chance = SeededNoise(6);
    let mut below = move |end: usize| ((chance.uniform() * end as f64) as usize).min(end - 1);
    let mut patches = Vec::with_capacity(count);
    while patches.len() < count {
        // Away from the ends, where cells are not square.
        let (ring, sector) = (
            30 + below(SURFACE.rings - 60 - SIDE),
            below(SURFACE.sectors),
        );
        let cells = (0..SIDE * SIDE)
            .flat_map(|at| SURFACE.cell(ring + at / SIDE, sector + at % SIDE))
            .map(|corners| corners.map(|at| vertex(&vertices, at)));
        let triangles: Vec<[DVec3; 3]> = cells.collect();
        let packets: Vec<Eight<f64>> = (0..PACKETS)
            .filter_map(|_| eight(&triangles, middle_m, &mut below))
            .collect();
        if packets.len() == PACKETS {
            let triangles = triangles.iter().map(|of| of.map(|at| at.to_array()));
            patches.push(Patch {
                triangles: triangles.collect(),
                packets,
            });
        }
    }
    patches
}

fn vertex(vertices: &[DVec3], at: u32) -> DVec3 {
    vertices.get(at as usize).copied().unwrap_or_default()
}

/// Eight rays towards the cells in the middle of a patch; `None` if their largest component is not
/// on one axis.
fn eight(
    triangles: &[[DVec3; 3]],
    middle_m: DVec3,
    below: &mut impl FnMut(usize) -> usize,
) -> Option<Eight<f64>> {
    const STEPS: usize = 1 << 20;
    let mut part = || below(STEPS) as f64 / STEPS as f64;
    let from = middle_m + DVec3::new(part(), part(), part()) - 0.5;
    let mut eight = Eight {
        axis: 0,
        origin: from.to_array().map(|at| [at; LANES]),
        direction: [[0.0; LANES]; 3],
    };
    let mut axes = [0; LANES];
    for (lane, axis) in axes.iter_mut().enumerate() {
        // The four cells in the middle, both triangles of each.
        let cell = (1 + lane / 4) * SIDE + 1 + lane / 2 % 2;
        let [a, b, c] = *triangles.get(2 * cell + lane % 2)?;
        let (u, v) = (part(), part());
        let target = match lane % 3 {
            0 => a,
            1 => a + u * (b - a),
            _ => a + u.min(v) * (b - a) + (1.0 - u.max(v)) * (c - a),
        };
        let along = (target - from).normalize();
        *axis = steepest(along);
        for (direction, along) in eight.direction.iter_mut().zip(along.to_array()) {
            if let Some(place) = direction.get_mut(lane) {
                *place = along;
            }
        }
    }
    let [first, ..] = axes;
    eight.axis = first;
    axes.iter().all(|axis| *axis == first).then_some(eight)
}

/// The axis of a direction's largest component.
fn steepest(along: DVec3) -> usize {
    along.abs().max_position()
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::Effort;

    use super::*;

    /// Errors of a test by its index in [`KERNELS`].
    fn off(circumstance: usize, kernel: usize, patches: usize) -> RayError {
        let set = Set::new(circumstances()[circumstance], patches);
        set.off(KERNELS[kernel].2).unwrap()
    }

    #[test]
    fn errors_match_the_resolution_of_the_number_format() {
        let near = |off: RayError, least_m: f64, most_m: f64| {
            assert!((least_m..most_m).contains(&off.worst_m), "{off:?}");
            assert!(off.rms_m <= off.worst_m && off.rms_m > 0.0, "{off:?}");
        };
        // Steps of f32 at 50 m are 3.8 um, at 5e5 m 31 mm; of f64 7e-15 m and 5.8e-11 m.
        for kernel in [0, 2] {
            near(off(0, kernel, 40), 1e-6, 1e-4);
            near(off(1, kernel, 40), 1e-2, 0.5);
            near(off(2, kernel, 40), 1e-6, 1e-4);
        }
        for kernel in [1, 3] {
            near(off(0, kernel, 40), 1e-15, 1e-12);
            near(off(1, kernel, 40), 1e-15, 1e-9);
            near(off(2, kernel, 40), 1e-15, 1e-12);
        }
    }

    #[test]
    fn only_the_watertight_test_misses_nothing() {
        for circumstance in 0..3 {
            for kernel in [2, 3] {
                let off = off(circumstance, kernel, 100);
                assert_eq!(off.missed, 0.0, "{circumstance} {}", KERNELS[kernel].0);
            }
        }
        assert!(off(0, 0, 100).missed > 0.0);
    }

    /// In f64 the study's watertight test equals the caster's bit for bit, so in f32 it is the same
    /// test.
    #[test]
    fn the_watertight_test_equals_the_casters() {
        for circumstance in circumstances() {
            let set = Set::new(circumstance, 40);
            let own = ranges(&set.wide, kernels::watertight_f64);
            let casters = ranges(&set.wide, kernels::casters);
            assert_eq!(own, casters);
        }
    }

    #[test]
    fn a_quick_run_has_every_row() {
        let mut now = 0;
        let mut clock = || {
            now += 3_000_000;
            units::Stamp::from_nanos(now)
        };
        let mut bench = Bench {
            clock: &mut clock,
            effort: Effort::Quick,
            say: &mut |_| {},
        };
        let (_, rows) = measure(&mut bench).unwrap();
        assert_eq!(rows.len(), 12);
        let rays = (12 * PACKETS * LANES * TRIANGLES) as f64;
        for row in &rows {
            assert!(
                (row.values[0].middle() - 3e6 / rays).abs() < 1e-9,
                "{row:?}"
            );
        }
    }
}
