//! Study of the number and place of the sub-rays that sample a beam's footprint.

mod reference;

use std::hint::black_box;

use analysis::tradeoff::{
    Bench, Row, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};
use sim::effect_models::{Divergence, DivergenceSettings};
use sim::effects::BeamEffect;
use sim::firing::{Echo, Echoes, SimulatedFiring};

use crate::shots::SampledFirings;
use reference::ReferenceFootprint;

/// The study.
pub(super) const BEAM_SAMPLING: Study = Study {
    name: "beam-sampling",
    title: "Sub-rays of a beam",
    choice: "scene, sub-rays",
    columns: &[
        ("time_ns_per_shot", "ns per shot"),
        ("off_5mm_percent", "edges off by 5 mm, %"),
        ("off_50mm_percent", "edges off by 50 mm, %"),
        ("dual_wrong_percent", "two returns wrong, %"),
    ],
    trades: &[Trade::new(0, 2).by_group(), Trade::new(0, 3).by_group()],
    finding,
    measure,
};

/// The default beside the middle alone, in both scenes.
fn finding(findings: &StudyFindings) -> String {
    let of = |rays: &str, column| {
        let value = |scene: &str| findings.text(&format!("{scene}, {rays}"), column);
        format!("{} and {}", value("hall"), value("parking"))
    };
    format!(
        "5 x 3 sub-rays at edges leave {} % of edges off by 50 mm, in {} ns. The middle alone leaves {} %, in {} ns",
        of("5 x 3 at edges", 2),
        of("5 x 3 at edges", 0),
        of("the middle alone", 2),
        of("the middle alone", 0),
    )
}

/// Sub-rays along the scan and across it. 5 x 3 is the default of a scene.
const GRIDS: [[usize; 2]; 6] = [[3, 1], [3, 3], [5, 3], [7, 5], [9, 7], [15, 9]];
/// Sub-rays of the reference.
const FINE: [usize; 2] = [33, 17];
const SCENES: [&str; 2] = ["hall", "parking"];
/// A return farther off than this is a different one, metres: half of the sensor's resolution.
const ANOTHER_M: f64 = 0.5;

/// Method of sampling beams.
enum SamplingMethod {
    /// The centre of the beam alone.
    Middle,
    /// Sub-rays where an edge is possible.
    AtEdges(Divergence),
    /// Sub-rays everywhere.
    Everywhere(Divergence),
}

/// A method with its name and label.
struct SamplingChoice {
    name: String,
    label: String,
    way: SamplingMethod,
}

/// A shot across an edge: firing, laser, and the ranges of the reference, infinite for none.
struct SilhouetteEdge {
    firing: usize,
    laser: usize,
    truth_m: [f64; 2],
}

/// Errors of a method at edges, as shares of the shots there. A mean of the errors would be that of
/// the few shots whose strongest return is another surface, metres away.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SamplingError {
    /// The strongest return is off by more than 5 mm, or only one of the two has one.
    off_5mm: f64,
    /// The same for 50 mm.
    off_50mm: f64,
    /// Share of the shots with two returns in which either is a different one or missing.
    wrong: f64,
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    // More for errors than for times: shots at edges are rare.
    let (firings, judged, grids) = bench.pick((48, 48, &GRIDS[1..3]), (1_500, 15_000, &GRIDS[..]));
    let plan = bench.plan(&format!("{firings} firings"), 3, 9);
    let (mut scenes, mut counts) = (Vec::new(), Vec::new());
    for name in SCENES {
        let shots = SampledFirings::of(name, judged)?;
        let edges = edges(&shots)?;
        counts.push(counted(name, &shots, &edges));
        let choices = choices(grids)?.into_iter().map(|choice| {
            let off = errors(&choice.way, &shots, &edges);
            (choice, off)
        });
        let choices: Vec<_> = choices.collect();
        scenes.push((name, SampledFirings::of(name, firings)?, choices));
    }
    let mut timed = Vec::new();
    for (scene, shots, choices) in &scenes {
        for (choice, off) in choices {
            timed.push(TimedChoice {
                row: Row::new(
                    format!("{scene}, {}", choice.name),
                    choice.label.clone(),
                    scene,
                    [off.off_5mm, off.off_50mm, off.wrong].map(|share| 100.0 * share),
                ),
                scale: 1e9 / shots.count().max(1) as f64,
                work: Box::new(|| {
                    choice.way.sample(shots, |_, echoes| {
                        black_box(echoes);
                    });
                    Ok(())
                }),
            });
        }
    }
    let rows = bench.rows(plan, timed)?;
    Ok((about(&counts), rows))
}

fn counted(scene: &str, shots: &SampledFirings, edges: &[SilhouetteEdge]) -> String {
    let two = edges
        .iter()
        .filter(|edge| edge.truth_m[1].is_finite())
        .count();
    let share = 100.0 * edges.len() as f64 / shots.count().max(1) as f64;
    format!(
        "In {scene} {} of {} shots are at edges ({share:.1} %), {two} with two returns",
        edges.len(),
        shots.count()
    )
}

fn about(counts: &[String]) -> Vec<String> {
    let [columns, rows] = FINE;
    vec![
        format!(
            "A VLP-16's shots (divergence 3 x 1.5 mrad) are spread over a sweep through built-in scenes. The reference casts \
             {columns} x {rows} sub-rays per shot; a shot is at an edge unless all hit one plane within 2 mm. {}.",
            counts.join(". ")
        ),
        format!(
            "Errors are shares of shots at edges whose strongest return is more than 5 or 50 mm off, or missing in sampling or \
             reference alone. A mean error would depend on few shots: those with another strongest return, metres off. Two \
             returns are wrong if either is missing or more than {ANOTHER_M} m off, as a share of shots with two in reference \
             or sampling. The time includes the central ray and, \"at edges\", the search for edges, but not the map of flat \
             directions (228,000 rays per run)."
        ),
        "At edges: velomotion casts sub-rays only where map and corners of the footprint permit an edge, and misses edges of \
         objects between the corners. Everywhere: at every shot. 5 x 3 at edges is the default. Each scene has its own front."
            .to_owned(),
    ]
}

fn choices(grids: &[[usize; 2]]) -> Result<Vec<SamplingChoice>, StudyError> {
    let divergence = |columns, rows| {
        let settings = DivergenceSettings {
            columns,
            rows,
            ..DivergenceSettings::default()
        };
        Divergence::new(&settings).map_err(StudyError::workload)
    };
    let mut choices = vec![SamplingChoice {
        name: "the middle alone".to_owned(),
        label: "1".to_owned(),
        way: SamplingMethod::Middle,
    }];
    for (place, mark) in [("at edges", ""), ("everywhere", " all")] {
        for &[columns, rows] in grids {
            choices.push(SamplingChoice {
                name: format!("{columns} x {rows} {place}"),
                label: format!("{columns}x{rows}{mark}"),
                way: match mark {
                    "" => SamplingMethod::AtEdges(divergence(columns, rows)?),
                    _ => SamplingMethod::Everywhere(divergence(columns, rows)?),
                },
            });
        }
    }
    Ok(choices)
}

impl SamplingMethod {
    /// The echoes of every firing, one after the other.
    fn sample(&self, shots: &SampledFirings, mut take: impl FnMut(usize, &Echoes)) {
        let Some((_, first)) = shots.firings.first() else {
            return;
        };
        let mut echoes = first.clone();
        for (number, (firing, _)) in shots.firings.iter().enumerate() {
            middles(firing, shots, &mut echoes);
            match self {
                Self::Middle => 0,
                Self::AtEdges(divergence) => {
                    divergence.receive(firing, &shots.surroundings, &mut echoes)
                }
                Self::Everywhere(divergence) => {
                    divergence.receive_everywhere(firing, &shots.surroundings, &mut echoes)
                }
            };
            take(number, &echoes);
        }
    }
}

/// Casts the centres of beams.
fn middles(firing: &SimulatedFiring, shots: &SampledFirings, echoes: &mut Echoes) {
    let rays = firing.origins_m.iter().zip(&firing.directions);
    let places = echoes.strongest.iter_mut().zip(&mut echoes.other);
    for ((strongest, other), (from, way)) in places.zip(rays).take(firing.lasers) {
        let met = shots.surroundings.meet(*from, *way);
        *strongest = met.map_or(Echo::NONE, |met| Echo::of(&met));
        *other = Echo::NONE;
    }
}

/// The shots across edges, with the ranges of the reference.
fn edges(shots: &SampledFirings) -> Result<Vec<SilhouetteEdge>, StudyError> {
    let mut edges = Vec::new();
    for (number, (firing, _)) in shots.firings.iter().enumerate() {
        for laser in firing.alive() {
            let footprint = ReferenceFootprint::of(firing, laser);
            let footprint =
                footprint.ok_or_else(|| StudyError::workload("a shot without a footprint"))?;
            let samples = footprint.samples(FINE, &shots.surroundings);
            if !samples.are_plane() {
                edges.push(SilhouetteEdge {
                    firing: number,
                    laser,
                    truth_m: samples.returns_m(),
                });
            }
        }
    }
    Ok(edges)
}

fn errors(way: &SamplingMethod, shots: &SampledFirings, edges: &[SilhouetteEdge]) -> SamplingError {
    let mut left = edges.iter().peekable();
    let mut off = [0_u32; 2];
    let (mut two, mut wrong) = (0_u32, 0_u32);
    way.sample(shots, |firing, echoes| {
        while let Some(edge) = left.next_if(|edge| edge.firing == firing) {
            let at = |echoes: &[Echo]| echoes.get(edge.laser).map_or(f64::INFINITY, |e| e.range_m);
            let got_m = [at(&echoes.strongest), at(&echoes.other)];
            let [truth_m, other_m] = edge.truth_m;
            for (count, limit_m) in off.iter_mut().zip([5e-3, 50e-3]) {
                let both_none = got_m[0].is_infinite() && truth_m.is_infinite();
                // A missing return is infinitely far.
                *count += u32::from(!both_none && (got_m[0] - truth_m).abs() > limit_m);
            }
            if got_m[1].is_finite() || other_m.is_finite() {
                let is_same = |(got, truth): (&f64, &f64)| (got - truth).abs() <= ANOTHER_M;
                two += 1;
                // A missing return is infinitely far, and no number.
                wrong += u32::from(!got_m.iter().zip(&edge.truth_m).all(is_same));
            }
        }
    });
    // A share of nothing is no number.
    let [off_5mm, off_50mm] = off.map(|count| f64::from(count) / edges.len() as f64);
    SamplingError {
        off_5mm,
        off_50mm,
        wrong: f64::from(wrong) / f64::from(two),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The independent reference against the effect with the same sub-rays.
    #[test]
    fn the_reference_agrees_with_the_effect_for_equal_sub_rays() {
        let mut two = 0;
        for scene in SCENES {
            let shots = SampledFirings::of(scene, 48).unwrap();
            let choices = choices(&GRIDS).unwrap();
            let way = choices.iter().find(|choice| choice.label == "5x3 all");
            way.unwrap().way.sample(&shots, |number, echoes| {
                let (firing, _) = &shots.firings[number];
                for laser in firing.alive() {
                    let footprint = ReferenceFootprint::of(firing, laser).unwrap();
                    let expected = footprint.samples([5, 3], &shots.surroundings).returns_m();
                    let got = [&echoes.strongest, &echoes.other].map(|set| set[laser].range_m);
                    for (got, expected) in got.into_iter().zip(expected) {
                        let same = got == expected || (got - expected).abs() < 1e-9;
                        assert!(same, "{scene} {number} {laser}: {got} {expected}");
                    }
                    two += u32::from(got[1].is_finite());
                }
            });
        }
        assert!(two > 3, "{two}");
    }

    #[test]
    fn more_sub_rays_are_more_accurate() {
        let shots = SampledFirings::of("parking", 48).unwrap();
        let edges = edges(&shots).unwrap();
        assert!(edges.len() > 20 && edges.len() * 10 < shots.count());
        let choices = choices(&GRIDS).unwrap();
        let of = |label: &str| {
            let choice = choices.iter().find(|choice| choice.label == label).unwrap();
            errors(&choice.way, &shots, &edges)
        };
        let (middle, few, many) = (of("1"), of("3x3 all"), of("5x3 all"));
        assert_eq!(middle.wrong, 1.0);
        assert!(
            few.wrong < 0.7 && many.wrong < few.wrong,
            "{few:?} {many:?}"
        );
        assert!(few.off_5mm < middle.off_5mm && many.off_50mm <= few.off_50mm);
        assert!(many.off_50mm <= many.off_5mm && many.off_5mm > 0.0);
        // Sub-rays find most edges.
        let found = of("5x3");
        assert!(found.wrong < many.wrong + 0.15, "{found:?} {many:?}");
    }
}
