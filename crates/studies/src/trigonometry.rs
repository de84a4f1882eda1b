//! Study of the number type and the sine with which points are placed (Eq. 4-6).

use std::hint::black_box;

use crate::placing::{
    Addition, Exact, Float, LASERS, LEAST_MM, PlacedPoints, PlainFiring, RETURN, SensorGeometry,
    Sine, SineTable, place,
};
use analysis::tradeoff::{
    Bench, Row, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};

use crate::workload::{Workload, all_at, cruise_deg, cruise_s, head};

/// The study.
pub(crate) const TRIGONOMETRY: Study = Study {
    name: "trigonometry",
    title: "Numbers and sines",
    choice: "numbers, sine and cosine",
    columns: &[
        ("time_ns_per_point", "ns per point"),
        ("worst_error_mm", "worst error, mm at 100 m"),
    ],
    trades: &[Trade::new(0, 1).down_to(LEAST_MM)],
    finding,
    measure,
};

/// The way that velomotion takes, and what f32 would add.
fn finding(findings: &StudyFindings) -> String {
    let of = |row, column| findings.text(row, column);
    format!(
        "Sines by addition take {} instead of {} ns and err by {} mm at 100 m; in f32 {} ns and {} mm",
        of("f64, addition", 0),
        of("f64, library", 0),
        of("f64, addition", 1),
        of("f32, addition", 0),
        of("f32, addition", 1),
    )
}

const RANGE_M: f64 = 100.0;

/// The workload of all methods.
struct TrigonometrySetup {
    shots: Vec<PlainFiring>,
    head: SensorGeometry,
    truth: PlacedPoints<f64>,
}

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let packets = Workload::new(cruise_deg, cruise_s(bench), all_at(RANGE_M));
    let shots = packets.firings_with_angles(&packets.alignment()?);
    let (head, points) = (head(), shots.len() * LASERS);
    let mut truth = PlacedPoints::new(points);
    place::<f64, _, _, RETURN, RETURN>(&shots, &head, (&Exact, &Exact), &mut truth);
    let setting = TrigonometrySetup { shots, head, truth };
    let (wide, narrow) = (SineTable::<f64>::new(), SineTable::<f32>::new());
    let mut choices = ways("f64", &setting, &wide);
    choices.extend(ways("f32", &setting, &narrow));
    let plan = bench.plan(&format!("{points} points"), 5, 25);
    Ok((about(points), bench.rows(plan, choices)?))
}

fn about(points: usize) -> Vec<String> {
    vec![
        format!(
            "The same tilt, {points} points at {RANGE_M} m, each return with its own azimuth and tilt. The paper's Eq. 1-6 are \
             computed in f64, or entirely in f32 with angles and distances. The error is the distance to the point of \"f64, \
             library\"."
        ),
        "Library: sine and cosine of both angles for every return. Table: those of the nearest hundredth of a degree (36,000 \
         entries); azimuth table: for the azimuth only. Addition: the library's for a firing's first laser; the others follow \
         by angle addition formulas, with a third-order series of the small difference. In f64, velomotion does this per \
         block."
            .to_owned(),
    ]
}

fn ways<'a, T: Float>(
    group: &'static str,
    setting: &'a TrigonometrySetup,
    table: &'a SineTable<T>,
) -> Vec<TimedChoice<'a>> {
    vec![
        way::<T, _, _>((group, "library"), setting, (&Exact, &Exact)),
        way::<T, _, _>((group, "azimuth table"), setting, (table, &Exact)),
        way::<T, _, _>((group, "table"), setting, (table, table)),
        way::<T, _, _>((group, "addition"), setting, (&Addition, &Addition)),
    ]
}

fn way<'a, T: Float, A: Sine<T>, G: Sine<T>>(
    (group, label): (&'static str, &'static str),
    setting: &'a TrigonometrySetup,
    sines: (&'a A, &'a G),
) -> TimedChoice<'a> {
    let TrigonometrySetup { shots, head, truth } = setting;
    let mut out = PlacedPoints::<T>::new(truth.len());
    place::<T, A, G, RETURN, RETURN>(shots, head, sines, &mut out);
    let name = format!("{group}, {label}");
    TimedChoice {
        row: Row::new(name, label, group, [out.worst_m(truth) * 1e3]),
        scale: 1e9 / truth.len() as f64,
        work: Box::new(move || {
            place::<T, A, G, RETURN, RETURN>(black_box(shots), head, sines, &mut out);
            black_box(&out);
            Ok(())
        }),
    }
}
