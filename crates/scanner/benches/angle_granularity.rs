//! What accuracy costs: how often the angles are worked out, in which numbers and by which sine, beside the worst error that
//! comes of it at 100 m.
//!
//! `cargo bench -p scanner --bench angle_granularity [-- --runs N]`
//!
//! A real VLP-16 at 20 Hz on a platform that swings at 56.25 deg/s. Angles are those at the start of their packet, block, firing or
//! return; the azimuth is the block's own where the tilt is the packet's, as every packet has twelve. Errors are against
//! angles a return, f64, libm's sine, with every return put at 100 m; times are with the distances as recorded. The loops are
//! `analysis`'s, which `velomotion tradeoff` compares on packets of its own; the last line is the product's own path with everything
//! that it does besides, and the error that its tests hold it to.
#![expect(clippy::unwrap_used, reason = "a bench of recordings")]

mod common;

use std::hint::black_box;

use analysis::tradeoff::placing::{
    BLOCK, Beam, Exact, FIRING, Head, LASERS, Number, PACKET, Places, RETURN, Shot, Sine, Table,
    place, returns,
};
use cloud::{Fields, Points, Sink, SinkError};
use common::{Recording, Timing};
use drive::record::Wire;
use lidar::{Decoder, Options};
use protocol::vlp16::models::VLP_16;
use scanner::clock::Moment;
use scanner::{Alignment, Placer};
use units::Span;

const RECORDING: &str = "vlp16-2014-no-factory-bytes.pcap";
const FAR_M: f64 = 100.0;

fn main() {
    let runs = std::env::args()
        .skip_while(|word| word != "--runs")
        .nth(1)
        .and_then(|n| n.parse().ok())
        .unwrap_or(40);
    let Some(recording) = Recording::read(RECORDING) else {
        return;
    };
    let alignment = recording.tilting();
    let shots = shots(&recording, &alignment);
    let far = at_100_m(&shots);
    let setting = Setting {
        shots: &shots,
        far: &far,
        head: head(),
        truth: truth(&far),
    };
    let (wide, narrow) = (Table::<f64>::new(), Table::<f32>::new());
    let mut rows: Vec<Row<'_>> = Vec::new();
    setting.add::<f64, _>(&mut rows, "f64  libm", &Exact);
    setting.add(&mut rows, "f64  table", &wide);
    setting.add::<f32, _>(&mut rows, "f32  libm", &Exact);
    setting.add(&mut rows, "f32  table", &narrow);
    let product = || {
        let mut sink = Ignore;
        let mut placer = Placer::new(&alignment, Options::default(), &mut sink);
        for record in recording.records() {
            placer.observe(&record).unwrap();
        }
        black_box(placer.finish().unwrap());
    };
    rows.push((
        "return  f64, from the packets' bytes".to_owned(),
        Box::new(product),
        [1e-6; 2],
    ));
    let points = returns(&shots);
    println!("{points} points; time: least of {runs} runs, and the median above it");
    println!("{:<38}{:>10}{:>9}{:>26}", "", "", "", "worst, mm at 100 m");
    println!(
        "{:<38}{:>10}{:>9}{:>13}{:>13}",
        "angles per", "ns/point", "spread", "tilt alone", "in all"
    );
    let mut work: Vec<&mut dyn FnMut()> = rows.iter_mut().map(|row| &mut *row.1 as _).collect();
    let timings = Timing::in_turns(runs, &mut work);
    for ((name, _, [tilt_mm, worst_mm]), timing) in rows.iter().zip(timings) {
        let ns = timing.least() * 1e9 / points as f64;
        let spread = (timing.quantile(0.5) / timing.least() - 1.0) * 100.0;
        println!("{name:<38}{ns:>10.2}{spread:>8.0}%{tilt_mm:>13.6}{worst_mm:>13.6}");
    }
}

/// Takes what comes.
struct Ignore;

impl Sink for Ignore {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        black_box(batch);
        Ok(())
    }

    fn fields(&self) -> Fields {
        Fields::NONE
    }
}

/// Name, work, and worst errors in millimetres: by the tilt alone and in all.
type Row<'a> = (String, Box<dyn FnMut() + 'a>, [f64; 2]);

type Kernel<T, S> = fn(&[Shot], &Head, (&S, &S), &mut Places<T>);

/// How often, the loop, and the same with each return's own azimuth.
type Way<T, S> = (&'static str, Kernel<T, S>, Kernel<T, S>);

/// What every line works on.
struct Setting<'a> {
    shots: &'a [Shot],
    far: &'a [Shot],
    head: Head,
    truth: Places<f64>,
}

impl<'a> Setting<'a> {
    /// Adds four lines: how often the angles are worked out, and the same with each return's own azimuth.
    fn add<T: Number, S: Sine<T>>(&'a self, rows: &mut Vec<Row<'a>>, name: &str, sine: &'a S) {
        let ways: [Way<T, S>; 4] = [
            (
                "packet",
                place::<T, S, S, BLOCK, PACKET>,
                place::<T, S, S, RETURN, PACKET>,
            ),
            (
                "block",
                place::<T, S, S, BLOCK, BLOCK>,
                place::<T, S, S, RETURN, BLOCK>,
            ),
            (
                "firing",
                place::<T, S, S, FIRING, FIRING>,
                place::<T, S, S, RETURN, FIRING>,
            ),
            (
                "return",
                place::<T, S, S, RETURN, RETURN>,
                place::<T, S, S, RETURN, RETURN>,
            ),
        ];
        for (per, run, with_own_azimuth) in ways {
            let mut out = Places::<T>::new(self.truth.len());
            let mut worst_mm = |kernel: Kernel<T, S>| {
                kernel(self.far, &self.head, (sine, sine), &mut out);
                out.worst_m(&self.truth) * 1e3
            };
            let errors_mm = [worst_mm(with_own_azimuth), worst_mm(run)];
            let work = move || {
                run(self.shots, &self.head, (sine, sine), &mut out);
                black_box(&out);
            };
            rows.push((format!("{per:<8}{name}"), Box::new(work), errors_mm));
        }
    }
}

fn truth(far: &[Shot]) -> Places<f64> {
    let mut truth = Places::new(returns(far));
    place::<f64, _, _, RETURN, RETURN>(far, &head(), (&Exact, &Exact), &mut truth);
    truth
}

fn head() -> Head {
    Head {
        beams: std::array::from_fn(|i| {
            let laser = &VLP_16.lasers[i];
            Beam {
                elevation_deg: laser.elevation_deg,
                rise_m: laser.vertical_offset_m,
                delay_ns: f64::from(laser.delay_ns),
            }
        }),
        unit_m: VLP_16.distance_unit_m,
        d_m: 0.06,
    }
}

/// The recording's firings with their angles.
fn shots(recording: &Recording, alignment: &Alignment) -> Vec<Shot> {
    let mut decoder = Decoder::new(Options::default());
    let mut shots = Vec::new();
    let mut each = |firing: &lidar::Firing<'_>| {
        let length = Span::from_nanos(i64::from(VLP_16.firing_period_ns));
        let tilt = |at| {
            let moment: Moment = alignment.clock.moment(at);
            alignment.trajectory.angle(moment).unwrap().0
        };
        let tilt_deg = tilt(firing.start);
        let mut counts = [0; LASERS];
        for seen in firing.returns() {
            counts[usize::from(seen.laser)] = seen.distance_raw;
        }
        shots.push(Shot {
            azimuth_deg: firing.azimuth_deg,
            azimuth_deg_ns: firing.azimuth_rate_deg_s * 1e-9,
            tilt_deg,
            tilt_deg_ns: (tilt(firing.start + length) - tilt_deg) / length.as_nanos() as f64,
            counts,
        });
    };
    for record in recording.records() {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.packet(record.host, payload, &mut each);
        }
    }
    decoder.finish(&mut each);
    shots
}

/// The same with something 100 m away in every direction.
fn at_100_m(shots: &[Shot]) -> Vec<Shot> {
    let count = (FAR_M / VLP_16.distance_unit_m) as u16;
    shots
        .iter()
        .map(|shot| Shot {
            counts: [count; LASERS],
            ..*shot
        })
        .collect()
}
