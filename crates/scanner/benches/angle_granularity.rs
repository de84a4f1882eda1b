//! What accuracy costs: how often the angles are worked out, in which numbers and by which sine, beside the worst error that
//! comes of it at 100 m.
//!
//! `cargo bench -p scanner --bench angle_granularity [-- --runs N]`
//!
//! A real VLP-16 at 20 Hz on a platform that swings at 56.25 deg/s. Angles are those at the start of their packet, block, firing or
//! return; the azimuth is the block's own where the tilt is the packet's, as every packet has twelve. Errors are against
//! angles a return, f64, libm's sine, with every return put at 100 m; times are with the distances as recorded. These kernels are
//! plain loops that write x, y and z; the last line is the product's own path with everything that it does besides, and the
//! error that its tests hold it to.
#![expect(clippy::unwrap_used, reason = "a bench of recordings")]

mod common;

use std::hint::black_box;

use cloud::{Fields, Points, Sink, SinkError};
use common::{Recording, Timing};
use drive::record::Wire;
use lidar::{Decoder, Options};
use protocol::vlp16::models::VLP_16;
use scanner::clock::Moment;
use scanner::{Alignment, Placer};
use units::Span;

const RECORDING: &str = "vlp16-2014-no-factory-bytes.pcap";
const LASERS: usize = 16;
const BLOCK_FIRINGS: usize = 2;
const PACKET_FIRINGS: usize = 24;
const MOUNT_D_M: f64 = 0.06;
const FAR_M: f64 = 100.0;
/// The table has a sine for every hundredth of a degree.
const TABLE_STEPS: usize = 36_000;

/// One firing: its angles at its start, how fast they grow, and what came back.
struct Shot {
    azimuth_deg: f64,
    azimuth_deg_ns: f64,
    tilt_deg: f64,
    tilt_deg_ns: f64,
    counts: [u16; LASERS],
}

/// How often angles are worked out.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Per {
    Packet,
    Block,
    Firing,
    Return,
}

const PACKET: u8 = Per::Packet as u8;
const BLOCK: u8 = Per::Block as u8;
const FIRING: u8 = Per::Firing as u8;
const RETURN: u8 = Per::Return as u8;
const UNITS: [(Per, &str); 4] = [
    (Per::Packet, "packet"),
    (Per::Block, "block"),
    (Per::Firing, "firing"),
    (Per::Return, "return"),
];

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
    let returns = |shots: &[Shot]| {
        shots
            .iter()
            .flat_map(|s| s.counts)
            .filter(|c| *c != 0)
            .count()
    };
    let points = returns(&shots);
    let truth = {
        let mut out = Out::<f64>::new(returns(&far));
        place::<f64, Exact, RETURN, RETURN>(&far, &Exact, &mut out);
        out
    };
    let (wide, narrow) = (Table::<f64>::new(), Table::<f32>::new());
    let mut rows: Vec<Row<'_>> = Vec::new();
    for (per, name) in UNITS {
        add::<f64, _>(
            &mut rows,
            format!("{name:<8}f64  libm"),
            per,
            &Exact,
            &shots,
            &far,
            &truth,
        );
        add(
            &mut rows,
            format!("{name:<8}f64  table"),
            per,
            &wide,
            &shots,
            &far,
            &truth,
        );
        add::<f32, _>(
            &mut rows,
            format!("{name:<8}f32  libm"),
            per,
            &Exact,
            &shots,
            &far,
            &truth,
        );
        add(
            &mut rows,
            format!("{name:<8}f32  table"),
            per,
            &narrow,
            &shots,
            &far,
            &truth,
        );
    }
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

type Kernel<T, S> = fn(&[Shot], &S, &mut Out<T>);

/// Adds a line of the table.
fn add<'a, T: Number, S: Sine<T>>(
    rows: &mut Vec<Row<'a>>,
    name: String,
    per: Per,
    sine: &'a S,
    shots: &'a [Shot],
    far: &[Shot],
    truth: &Out<f64>,
) {
    let (run, with_own_azimuth): (Kernel<T, S>, Kernel<T, S>) = match per {
        Per::Packet => (place::<T, S, BLOCK, PACKET>, place::<T, S, RETURN, PACKET>),
        Per::Block => (place::<T, S, BLOCK, BLOCK>, place::<T, S, RETURN, BLOCK>),
        Per::Firing => (place::<T, S, FIRING, FIRING>, place::<T, S, RETURN, FIRING>),
        Per::Return => (place::<T, S, RETURN, RETURN>, place::<T, S, RETURN, RETURN>),
    };
    let mut out = Out::<T>::new(truth.len());
    with_own_azimuth(far, sine, &mut out);
    let by_tilt_mm = out.worst_m(truth) * 1e3;
    run(far, sine, &mut out);
    let worst_mm = [by_tilt_mm, out.worst_m(truth) * 1e3];
    let work = move || {
        run(shots, sine, &mut out);
        black_box(&out);
    };
    rows.push((name, Box::new(work), worst_mm));
}

/// f32 or f64.
trait Number: Copy + 'static {
    fn of(x: f64) -> Self;
    fn f64(self) -> f64;
    fn sin_cos_deg(self) -> (Self, Self);
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
}

macro_rules! number {
    ($float:ty) => {
        impl Number for $float {
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $float
            }
            #[inline(always)]
            fn f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sin_cos_deg(self) -> (Self, Self) {
                self.to_radians().sin_cos()
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self - other
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                self * other
            }
        }
    };
}
number!(f32);
number!(f64);

trait Sine<T> {
    fn sin_cos(&self, degrees: T) -> (T, T);
}

struct Exact;

impl<T: Number> Sine<T> for Exact {
    #[inline(always)]
    fn sin_cos(&self, degrees: T) -> (T, T) {
        degrees.sin_cos_deg()
    }
}

/// Sine and cosine of the nearest hundredth of a degree.
struct Table<T>(Vec<(T, T)>);

impl<T: Number> Table<T> {
    fn new() -> Self {
        let of = |i: usize| {
            let (sin, cos) = (i as f64 * 0.01).to_radians().sin_cos();
            (T::of(sin), T::of(cos))
        };
        Self((0..TABLE_STEPS).map(of).collect())
    }
}

impl<T: Number> Sine<T> for Table<T> {
    #[inline(always)]
    fn sin_cos(&self, degrees: T) -> (T, T) {
        // Azimuths and tilts here are between -360 and 720 degrees.
        let hundredths = degrees.mul(T::of(100.0)).f64() + (TABLE_STEPS as f64 + 0.5);
        self.0[hundredths as usize % TABLE_STEPS]
    }
}

struct Out<T> {
    x_m: Vec<T>,
    y_m: Vec<T>,
    z_m: Vec<T>,
}

impl<T: Number> Out<T> {
    fn new(len: usize) -> Self {
        let column = || vec![T::of(0.0); len];
        Self {
            x_m: column(),
            y_m: column(),
            z_m: column(),
        }
    }

    fn len(&self) -> usize {
        self.x_m.len()
    }

    fn worst_m(&self, truth: &Out<f64>) -> f64 {
        let square = |a: &[T], b: &[f64], i: usize| (a[i].f64() - b[i]).powi(2);
        (0..self.len())
            .map(|i| {
                square(&self.x_m, &truth.x_m, i)
                    + square(&self.y_m, &truth.y_m, i)
                    + square(&self.z_m, &truth.z_m, i)
            })
            .fold(0.0, f64::max)
            .sqrt()
    }
}

/// Places every return, its angles those at the start of its packet, block or firing, or its own.
fn place<T: Number, S: Sine<T>, const AZIMUTH: u8, const TILT: u8>(
    shots: &[Shot],
    sine: &S,
    out: &mut Out<T>,
) {
    let unit = T::of(VLP_16.distance_unit_m);
    let rays: [(T, T, T); LASERS] = std::array::from_fn(|i| {
        let laser = &VLP_16.lasers[i];
        let (sin, cos) = laser.elevation_deg.to_radians().sin_cos();
        (
            T::of(sin),
            T::of(cos),
            T::of(laser.vertical_offset_m + MOUNT_D_M),
        )
    });
    let delays: [T; LASERS] = std::array::from_fn(|i| T::of(f64::from(VLP_16.lasers[i].delay_ns)));
    let (mut azimuth, mut tilt) = ((unit, unit), (unit, unit));
    let mut row = 0;
    for (i, shot) in shots.iter().enumerate() {
        let starts = |per: Per| match per {
            Per::Packet => i % PACKET_FIRINGS == 0,
            Per::Block => i % BLOCK_FIRINGS == 0,
            Per::Firing | Per::Return => true,
        };
        if starts(of(AZIMUTH)) {
            azimuth = sine.sin_cos(T::of(shot.azimuth_deg));
        }
        if starts(of(TILT)) {
            tilt = sine.sin_cos(T::of(shot.tilt_deg));
        }
        for (laser, &count) in shot.counts.iter().enumerate() {
            if count == 0 {
                continue;
            }
            let at = |deg: f64, rate: f64| T::of(deg).add(T::of(rate).mul(delays[laser]));
            if AZIMUTH == RETURN {
                azimuth = sine.sin_cos(at(shot.azimuth_deg, shot.azimuth_deg_ns));
            }
            if TILT == RETURN {
                tilt = sine.sin_cos(at(shot.tilt_deg, shot.tilt_deg_ns));
            }
            let (sin_w, cos_w, up) = rays[laser];
            let range = T::of(f64::from(count)).mul(unit);
            let across = range.mul(cos_w);
            let (x, height) = (across.mul(azimuth.0), range.mul(sin_w).add(up));
            let (sin, cos) = tilt;
            if let (Some(to_x), Some(to_y), Some(to_z)) = (
                out.x_m.get_mut(row),
                out.y_m.get_mut(row),
                out.z_m.get_mut(row),
            ) {
                *to_x = x.mul(cos).add(height.mul(sin));
                *to_y = across.mul(azimuth.1);
                *to_z = height.mul(cos).sub(x.mul(sin));
            }
            row += 1;
        }
    }
}

const fn of(per: u8) -> Per {
    match per {
        0 => Per::Packet,
        1 => Per::Block,
        2 => Per::Firing,
        _ => Per::Return,
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
