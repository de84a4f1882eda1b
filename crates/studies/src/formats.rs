//! Study of the point formats: size, time and rounding.

use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

use crate::placing::worst_m;
use ::cloud::formats::Format;
use ::cloud::{Fields, Metadata, Points, read};
use analysis::plan::TiltSweep;
use analysis::tradeoff::{
    Bench, Row, SeededNoise, Study, StudyError, StudyFindings, StudyRows, TimedChoice, Trade,
};
use protocol::vlp16::models::VLP_16;
use sim::Scene;
use sim::sensor::{LidarMount, LidarSensor};

use crate::granularity::place_packets;
use crate::workload::{SimulatedShot, Workload};
use engine::output::BufferedFile;

/// The study.
pub(super) const FORMATS: Study = Study {
    name: "formats",
    title: "Point formats",
    choice: "format",
    columns: &[
        ("time_s_per_million_points", "s per million points"),
        ("bytes_per_point", "bytes per point"),
        ("worst_error_um", "worst error of a place, um"),
    ],
    trades: &[Trade::new(0, 2), Trade::new(1, 2)],
    finding,
    measure,
};

/// The smallest file and the fastest.
fn finding(findings: &StudyFindings) -> String {
    let of = |row, column| findings.text(row, column);
    format!(
        ".laz takes {} bytes per point, .ply {}; they are written in {} and {} s per million points",
        of(".laz", 1),
        of(".ply", 1),
        of(".laz", 0),
        of(".ply", 0),
    )
}

/// A million points.
const SWEEP: TiltSweep = TiltSweep {
    from_deg: 0.0,
    to_deg: -45.0,
    speed_deg_s: 13.0,
    accel_deg_s2: 500.0,
};
/// Size of the scanner's batches.
const BATCH_POINTS: usize = 1 << 12;
/// Standard deviation of a range, metres: a third of the VLP-16's +-3 cm (Table 2 of the paper).
const NOISE_M: f64 = 0.01;

fn measure(bench: &mut Bench<'_>) -> Result<StudyRows, StudyError> {
    let cloud = hall(bench.pick(0.15, SWEEP.duration_s()))?;
    let batches = batches(&cloud);
    let points = cloud.len();
    let plan = bench.plan(&format!("{points} points"), 3, 9);
    let mut choices = Vec::new();
    for format in Format::ALL {
        let (memory, empty) = (Memory::default(), Memory::default());
        write(format, &memory, &batches)?;
        write(format, &empty, &[])?;
        let bytes = memory.content();
        let of_points = bytes.len().saturating_sub(empty.content().len());
        let error_m = error_m(format, &bytes, &cloud)?;
        let name = format!(".{format}");
        let batches = &batches;
        choices.push(TimedChoice {
            row: Row::new(
                name.clone(),
                name,
                "velomotion's writers",
                [of_points as f64 / points as f64, error_m * 1e6],
            ),
            scale: 1e6 / points as f64,
            work: Box::new(move || write(format, &memory, batches)),
        });
    }
    Ok((about(points), bench.rows(plan, choices)?))
}

fn about(points: usize) -> Vec<String> {
    vec![
        format!(
            "{points} points of a sweep through the simulator's hall (nothing farther than 20 m), with {} mm of range noise. \
             They are written to memory with intensity, ring, time and tilt (.bin with intensity alone). LAZ is compressed on \
             both cores, the others use one.",
            NOISE_M * 1e3
        ),
        "Bytes exclude those of an empty file. The error is the largest distance between a point written and read back. In f32 \
         (.ply, .pcd, .e57, .mcap, .bin, .npz) it grows with distance, 4 um at 100 m; with steps of 0.1 mm (.las, .laz) it does not."
            .to_owned(),
    ]
}

/// The first seconds of a sweep in the simulator's hall, as velomotion places them.
fn hall(seconds: f64) -> Result<Points, StudyError> {
    let scene = Scene::hall();
    let (sensor, mount) = (LidarSensor::vlp16(), LidarMount::above(0.06));
    let range = sensor.range();
    let mut noise = SeededNoise(1);
    let answer = |ray: &SimulatedShot| {
        let beam = sensor.ray(ray.laser, ray.azimuth_deg, ray.tilt_deg, &mount);
        let hit = beam.and_then(|(origin, way)| scene.cast(origin, way, range.min_m, range.max_m));
        hit.map_or((0, 0), |hit| {
            let range_m = hit.range_m + NOISE_M * noise.normal();
            let count = (range_m / VLP_16.distance_unit_m).round();
            (count as u16, hit.reflectivity)
        })
    };
    let packets = Workload::new(|t_s| SWEEP.angle_deg(t_s), seconds, answer);
    let mut cloud = Points::new(Fields::FILE);
    place_packets(&packets, &packets.alignment()?, &mut cloud)?;
    Ok(cloud)
}

fn batches(cloud: &Points) -> Vec<Points> {
    let mut batches = Vec::new();
    for (i, point) in cloud.iter().enumerate() {
        if i % BATCH_POINTS == 0 {
            batches.push(Points::with_capacity(cloud.fields(), BATCH_POINTS));
        }
        if let Some(batch) = batches.last_mut() {
            batch.push(point);
        }
    }
    batches
}

fn write(format: Format, memory: &Memory, batches: &[Points]) -> Result<(), StudyError> {
    memory.clear();
    let mut sink = format.writer(BufferedFile::new(memory.clone()), cloud::Fields::FILE);
    sink.begin(&Metadata::default())?;
    for batch in batches {
        sink.points(batch)?;
    }
    sink.finish()?;
    Ok(())
}

/// The largest distance of a point from its original place.
fn error_m(format: Format, bytes: &[u8], cloud: &Points) -> Result<f64, StudyError> {
    let positions = read::positions(format, bytes.to_vec())
        .map_err(StudyError::workload)?
        .positions;
    if positions.len() != cloud.len() {
        return Err(StudyError::workload(format!(
            ".{format} read back: expected {} points, got {}",
            cloud.len(),
            positions.len()
        )));
    }
    let [x, y, z] = [0, 1, 2].map(|axis| positions.iter().map(|p| p[axis]).collect::<Vec<f64>>());
    Ok(worst_m(
        [&x, &y, &z],
        [cloud.x_m(), cloud.y_m(), cloud.z_m()],
    ))
}

/// A file in memory that outlives the sink and keeps its allocation between rounds.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Cursor<Vec<u8>>>>);

impl Memory {
    fn with<T>(&self, act: impl FnOnce(&mut Cursor<Vec<u8>>) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn clear(&self) {
        self.with(|file| {
            file.get_mut().clear();
            file.set_position(0);
        });
    }

    fn content(&self) -> Vec<u8> {
        self.with(|file| file.get_ref().clone())
    }
}

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.with(|file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Memory {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.with(|file| file.read(bytes))
    }
}

impl Seek for Memory {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.with(|file| file.seek(to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures of `cloud::formats`: 4 um at 100 m for f32, half of 0.1 mm per coordinate for
    /// LAS, exact for CSV.
    #[test]
    fn round_trip_errors_match_the_formats_documentation() {
        let cloud = hall(0.02).unwrap();
        assert!(cloud.len() > 5_000);
        let batches = batches(&cloud);
        assert_eq!(batches.iter().map(Points::len).sum::<usize>(), cloud.len());
        let error_um = |format| {
            let memory = Memory::default();
            write(format, &memory, &batches).unwrap();
            // Twice, as in the rounds.
            write(format, &memory, &batches).unwrap();
            error_m(format, &memory.content(), &cloud).unwrap() * 1e6
        };
        assert_eq!(error_um(Format::Csv), 0.0);
        let ply = error_um(Format::Ply);
        // Half a step of f32 between 16 and 32 m is 0.95 um per coordinate.
        assert!((0.1..1.7).contains(&ply), "{ply}");
        assert_eq!(error_um(Format::Xyz), 0.0);
        for like in [
            Format::Pcd,
            Format::E57,
            Format::Mcap,
            Format::Kitti,
            Format::Npz,
        ] {
            assert_eq!(error_um(like), ply, "{like}");
        }
        let las = error_um(Format::Las);
        assert!((50.0..=50.0 * 3_f64.sqrt() + 0.01).contains(&las), "{las}");
        assert_eq!(error_um(Format::Laz), las);
    }
}
