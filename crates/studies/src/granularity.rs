//! Study of how often the angles are computed: per packet, block, firing or return.

use std::hint::black_box;

use crate::placing::{
    BLOCK, Exact, FIRING, LEAST_MM, PACKET, PlacedPoints, PlainFiring, RETURN, SensorGeometry,
    place, worst_m,
};
use analysis::tradeoff::{
    Bench, Row, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};
use cloud::{Fields, Points, Sink, SinkError};
use lidar::Options;
use scanner::{Alignment, Placer};

use crate::workload::{Workload, all_at, cruise_deg, cruise_s, head};

/// The study.
pub(crate) const GRANULARITY: Study = Study {
    name: "granularity",
    title: "How often angles are computed",
    choice: "angles per",
    columns: &[
        ("time_ns_per_point", "ns per point"),
        ("worst_error_mm", "worst error, mm at 100 m"),
    ],
    trades: &[Trade::new(0, 1).joined().down_to(LEAST_MM)],
    finding,
    measure,
};

/// velomotion's path beside angles of each return.
fn finding(findings: &StudyFindings) -> String {
    let of = |row, column| findings.text(row, column);
    let ours = "velomotion, from the packets' bytes";
    format!(
        "velomotion places a point in {} ns, within {} mm of angles for each return, which take {} ns",
        of(ours, 0),
        of(ours, 1),
        of("both a return", 0),
    )
}

const RANGE_M: f64 = 100.0;

type Kernel = fn(&[PlainFiring], &SensorGeometry, (&Exact, &Exact), &mut PlacedPoints<f64>);

/// Name, label, group and loop.
type GranularityChoice = (&'static str, &'static str, &'static str, Kernel);

const fn choice<const AZIMUTH: u8, const TILT: u8>(
    name: &'static str,
    label: &'static str,
    group: &'static str,
) -> GranularityChoice {
    (
        name,
        label,
        group,
        place::<f64, Exact, Exact, AZIMUTH, TILT>,
    )
}

const WAYS: [GranularityChoice; 7] = [
    choice::<RETURN, PACKET>("tilt a packet, azimuth a return", "packet", "tilt alone"),
    choice::<RETURN, BLOCK>("tilt a block, azimuth a return", "block", "tilt alone"),
    choice::<RETURN, FIRING>("tilt a firing, azimuth a return", "firing", "tilt alone"),
    choice::<BLOCK, PACKET>(
        "tilt a packet, azimuth a block",
        "packet",
        "tilt and azimuth",
    ),
    choice::<BLOCK, BLOCK>("both a block", "block", "tilt and azimuth"),
    choice::<FIRING, FIRING>("both a firing", "firing", "tilt and azimuth"),
    choice::<RETURN, RETURN>("both a return", "return", "tilt and azimuth"),
];

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let packets = Workload::new(cruise_deg, cruise_s(bench), all_at(RANGE_M));
    let alignment = packets.alignment()?;
    let (shots, truth) = (
        packets.firings_with_angles(&alignment),
        definition(&packets, &alignment),
    );
    let (head, points) = (head(), truth.len());
    let scale = 1e9 / points as f64;
    let mut choices = Vec::new();
    for (name, label, group, kernel) in WAYS {
        let mut out = PlacedPoints::new(points);
        kernel(&shots, &head, (&Exact, &Exact), &mut out);
        let row = Row::new(name, label, group, [out.worst_m(&truth) * 1e3]);
        let (shots, head) = (&shots, &head);
        choices.push(TimedChoice {
            row,
            scale,
            work: Box::new(move || {
                kernel(black_box(shots), head, (&Exact, &Exact), &mut out);
                black_box(&out);
                Ok(())
            }),
        });
    }
    let error_mm = own_error_m(&packets, &alignment, &truth)? * 1e3;
    choices.push(TimedChoice {
        row: Row::new(
            "velomotion, from the packets' bytes",
            "velomotion",
            "velomotion",
            [error_mm],
        ),
        scale,
        work: Box::new(|| place_packets(&packets, &alignment, &mut Ignore)),
    });
    let plan = bench.plan(&format!("{points} points"), 5, 25);
    Ok((about(points), bench.rows(plan, choices)?))
}

fn about(points: usize) -> Vec<String> {
    vec![
        format!(
            "A VLP-16 at 10 revolutions per second tilts at 56.25 deg/s; all surfaces are {RANGE_M} m away ({points} points). \
             Angles are those at the start of packet, block or firing, or of each return. The error is the distance to the \
             point with time and angles looked up for each return; at 10 m it is a tenth."
        ),
        "From the packets' bytes, velomotion looks up clock and angle, and extrapolates both angles from a block's start to \
         each return. The other rows are plain f64 loops over decoded distances, with the library's sine."
            .to_owned(),
    ]
}

/// A sink that drops its points.
struct Ignore;

impl Sink for Ignore {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        black_box(batch);
        Ok(())
    }
}

/// The second pass of velomotion.
pub(crate) fn place_packets(
    packets: &Workload,
    alignment: &Alignment,
    sink: &mut dyn Sink,
) -> Result<(), StudyError> {
    let mut placer = Placer::new(alignment, Options::default(), sink);
    for record in packets.records() {
        placer.observe(&record)?;
    }
    black_box(placer.finish()?);
    Ok(())
}

/// Every return on its own, as `scanner` defines its place.
fn definition(packets: &Workload, alignment: &Alignment) -> PlacedPoints<f64> {
    let mut places = PlacedPoints::new(0);
    let mut each = |firing: &lidar::Firing<'_>| {
        for point in firing.points().filter_map(|point| alignment.place(&point)) {
            let [x, y, z] = point.position_m;
            places.x_m.push(x);
            places.y_m.push(y);
            places.z_m.push(z);
        }
    };
    packets.firings(&mut each);
    places
}

/// Distance of velomotion's points from those of the definition.
fn own_error_m(
    packets: &Workload,
    alignment: &Alignment,
    truth: &PlacedPoints<f64>,
) -> Result<f64, StudyError> {
    let mut cloud = Points::new(Fields::NONE);
    place_packets(packets, alignment, &mut cloud)?;
    if cloud.len() != truth.len() {
        let (got, expected) = (cloud.len(), truth.len());
        return Err(StudyError::workload(format!(
            "expected {expected} points, got {got}"
        )));
    }
    Ok(worst_m(
        [cloud.x_m(), cloud.y_m(), cloud.z_m()],
        [&truth.x_m, &truth.y_m, &truth.z_m],
    ))
}
