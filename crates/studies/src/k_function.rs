//! Study of the methods of the K function: time, error and bound on the error. The benchmark `k`
//! measures larger scans.

use std::f64::consts::PI;
use std::hint::black_box;
use std::num::NonZeroUsize;

use analysis::k::{
    Edges, Estimate, FrameRotation, KError, Registers, Sampling, exact_by, sampled, turned,
};
use analysis::tradeoff::{
    Bench, Row, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};
use glam::DVec3;

/// The study.
pub(crate) const K_FUNCTION: Study = Study {
    name: "k-function",
    title: "Ways to the K function",
    choice: "way",
    columns: &[
        ("time_ms", "ms"),
        ("error", "error of D"),
        ("bound", "its bound"),
    ],
    trades: &[Trade::new(0, 1).joined(), Trade::new(0, 2).joined()],
    finding,
    measure,
};

/// The exact ways, and the most precise sample.
fn finding(findings: &StudyFindings) -> String {
    let of = |row, column| findings.text(row, column);
    format!(
        "All pairs are counted in {} ms, by turning frames in {} ms; samples of {} ms err by {}",
        of("every pair", 0),
        of("by the turning of frames", 0),
        of("sampled, 1e-4", 0),
        of("sampled, 1e-4", 1),
    )
}

/// Number of bins, as in the paper.
const BINS: usize = 151;
const ONE: NonZeroUsize = NonZeroUsize::MIN;

/// A scan of rotated frames.
struct StudyScan {
    points: Vec<DVec3>,
    rotation: FrameRotation,
    edges: Edges,
}

type Way = (
    &'static str,
    &'static str,
    &'static str,
    fn(&StudyScan) -> Result<Estimate, KError>,
);

/// Name, label, group and function.
const WAYS: [Way; 7] = [
    ("every pair", "every pair", "exact", |s| {
        every(s, Registers::Best)
    }),
    ("every pair, AVX2", "AVX2", "exact", |s| {
        every(s, Registers::Avx2)
    }),
    ("every pair, SSE 4.2", "SSE 4.2", "exact", |s| {
        every(s, Registers::Sse4)
    }),
    ("by the turning of frames", "turned", "exact", |s| {
        turned(&s.points, &s.rotation, &s.edges, ONE).map(Estimate::from)
    }),
    ("sampled, 1e-2", "1e-2", "sampled", |s| sample(s, 1e-2)),
    ("sampled, 1e-3", "1e-3", "sampled", |s| sample(s, 1e-3)),
    ("sampled, 1e-4", "1e-4", "sampled", |s| sample(s, 1e-4)),
];

fn every(scan: &StudyScan, registers: Registers) -> Result<Estimate, KError> {
    exact_by(registers, &scan.points, &scan.edges, ONE).map(Estimate::from)
}

fn sample(scan: &StudyScan, tolerance: f64) -> Result<Estimate, KError> {
    let sampling = Sampling {
        tolerance,
        ..Sampling::default()
    };
    sampled(&scan.points, &scan.edges, &sampling)
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let wrong = |error: KError| StudyError::Workload(Box::new(error));
    let scan = scan(bench.pick(2, 8)).map_err(wrong)?;
    let truth = every(&scan, Registers::Best).map_err(wrong)?;
    let mut choices = Vec::new();
    for (name, label, group, way) in WAYS {
        let of = way(&scan).map_err(wrong)?;
        let off = of
            .shares
            .iter()
            .zip(&truth.shares)
            .map(|(a, b)| (a - b).abs());
        let error = off.fold(0.0, f64::max);
        let scan = &scan;
        choices.push(TimedChoice {
            row: Row::new(name, label, group, [error, of.largest_bound()]),
            scale: 1e3,
            work: Box::new(move || way(scan).map(|of| drop(black_box(of))).map_err(wrong)),
        });
    }
    let points = scan.points.len();
    let plan = bench.plan(&format!("{points} points"), 2, 7);
    let about = vec![
        format!(
            "A VLP-16 at 901 azimuths, rotated in steps from 0 to 180 degrees ({points} points); {BINS} bins of equal angle; \
             one thread."
        ),
        "The error is the largest of D, a share of all pairs. The bound of samples is a confidence interval with a risk of 1 \
         in 1000."
            .to_owned(),
    ];
    Ok((about, bench.rows(plan, choices)?))
}

/// An RMBL of `frames` frames (Eq. 1-6 of the paper with d = 0) that stands still within a frame.
fn scan(frames: usize) -> Result<StudyScan, KError> {
    let step_rad = PI / frames as f64;
    let mut points = Vec::with_capacity(frames * 901 * 16);
    for frame in 0..frames {
        let (sin_g, cos_g) = (frame as f64 * step_rad).sin_cos();
        for firing in 0..901 * 16_u32 {
            let (azimuth, laser) = (f64::from(firing / 16) * 0.4, f64::from(firing % 16));
            let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
            let (sin_w, cos_w) = (laser * 2.0 - 15.0).to_radians().sin_cos();
            let (x, z) = (cos_w * sin_a, sin_w);
            let (x, z) = (x * cos_g + z * sin_g, z * cos_g - x * sin_g);
            points.push(DVec3::new(x, cos_w * cos_a, z));
        }
    }
    Ok(StudyScan {
        points,
        rotation: FrameRotation {
            axis: DVec3::Y,
            step_rad,
            frames,
        },
        edges: Edges::equal(BINS)?,
    })
}

#[cfg(test)]
mod tests {
    use analysis::tradeoff::Effort;
    use units::{Host, Stamp};

    use super::*;

    #[test]
    fn bounds_hold_and_more_time_buys_less_error() {
        let mut ns = 0;
        let mut clock = || {
            ns += 1_000_000_000;
            Stamp::<Host>::from_nanos(ns)
        };
        let mut bench = Bench {
            clock: &mut clock,
            effort: Effort::Quick,
            say: &mut |_| (),
        };
        let (_, rows) = measure(&mut bench).unwrap();
        assert_eq!(rows.len(), WAYS.len());
        for row in &rows {
            let [error, bound] = [1, 2].map(|column| row.values[column].middle());
            assert!(error <= bound, "{}: {error} {bound}", row.name);
            assert_eq!(bound == 0.0, row.group == "exact", "{}", row.name);
        }
        let bound = |name: &str| {
            let row = rows.iter().find(|row| row.name == name);
            row.unwrap().values[2].middle()
        };
        assert!(bound("sampled, 1e-4") <= 1e-4);
    }
}
