//! Numbers of points of the shipped scenes against Table 4 of the paper: `cargo run --release -p
//! velomotion-sim --example scan_counts`.
//!
//! All effects of the scene files are on. Light (`reflectance`), the scanner's frame and tripod
//! (`own_shadow`) and the sensor's range of 1 to 100 m decide whether a beam returns.

use std::error::Error;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

use sim::motion::{AxisMotion, Sweeps};
use sim::scene_file::SceneFile;
use sim::scenery::shipped;
use sim::sensor::LidarSensor;
use sim::simulate::{SimulationEvent, SimulationSink};

/// A scene, the paper's place, and its points of each of [`SCANS`].
const PLACES: [(&str, &str, [u64; 4]); 3] = [
    (
        "hall",
        "building hall",
        [27_998, 68_080, 201_851, 11_348_103],
    ),
    (
        "parking",
        "parking area",
        [20_141, 58_875, 158_351, 6_833_873],
    ),
    ("quarry", "quarry", [16_954, 51_362, 125_237, 6_269_304]),
];

/// A scan of the paper.
struct Scan {
    name: &'static str,
    sensor: fn() -> LidarSensor,
    /// Speed from 0 to -45 degrees; `None` for a level sensor.
    speed_deg_s: Option<f64>,
    /// Shots a second that the paper's shares are of.
    shots_per_s: f64,
}

/// The paper has 28,800 shots a revolution of the VLP-16. The HDL-32E fires 32 lasers every 46.08
/// us.
const SCANS: [Scan; 4] = [
    Scan {
        name: "VLP-16, 0.1 s",
        sensor: LidarSensor::vlp16,
        speed_deg_s: None,
        shots_per_s: 288_000.0,
    },
    Scan {
        name: "HDL-32E, 0.1 s",
        sensor: LidarSensor::hdl32e,
        speed_deg_s: None,
        shots_per_s: 32.0 / 46.08e-6,
    },
    Scan {
        name: "fast, 0.8 s",
        sensor: LidarSensor::vlp16,
        speed_deg_s: Some(56.25),
        shots_per_s: 288_000.0,
    },
    Scan {
        name: "slow, 42.05 s",
        sensor: LidarSensor::vlp16,
        speed_deg_s: Some(1.07),
        shots_per_s: 288_000.0,
    },
];
/// Duration with a level sensor: a revolution at 10 Hz, seconds.
const TURN_S: f64 = 0.1;

/// Counts of shots.
#[derive(Clone, Copy)]
struct Count {
    shots: f64,
    returned: f64,
}

impl Count {
    fn percent(self) -> f64 {
        100.0 * self.returned / self.shots
    }
}

/// Takes everything and keeps nothing.
struct Nowhere;

impl SimulationSink for Nowhere {
    fn event(&mut self, _: &SimulationEvent) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let columns = SCANS.map(|scan| format!("{} | share", scan.name));
    let ratios = "HDL / VLP | fast / VLP | slow / VLP";
    println!(
        "| scene | place of the paper | | {} | {ratios} |",
        columns.join(" | ")
    );
    println!("|{}", "---|".repeat(14));
    for (name, place, papers) in PLACES {
        let ours = SCANS.iter().map(|scan| scan.counts(name));
        row(name, "", "simulated", &ours.collect::<Result<Vec<_>, _>>()?);
        let counts = SCANS
            .iter()
            .zip(papers)
            .map(|(scan, count)| scan.papers(count));
        row("", place, "paper", &counts.collect::<Vec<_>>());
    }
    Ok(())
}

fn row(scene: &str, place: &str, whose: &str, counts: &[Count]) {
    let first = counts.first().map_or(f64::NAN, |count| count.returned);
    let counted = counts
        .iter()
        .map(|count| format!("{:.0} | {:.1} %", count.returned, count.percent()));
    let ratios = counts
        .iter()
        .skip(1)
        .map(|count| format!("{:.2}", count.returned / first));
    let cells: Vec<String> = counted.chain(ratios).collect();
    println!("| {scene} | {place} | {whose} | {} |", cells.join(" | "));
}

impl Scan {
    fn motion(&self) -> Result<AxisMotion, Box<dyn Error>> {
        match self.speed_deg_s {
            Some(speed_deg_s) => scan_down(speed_deg_s),
            None => Ok(AxisMotion::fixed(0.0, TURN_S)?),
        }
    }

    /// The paper's count, with the shots that its share is of.
    fn papers(&self, returned: u64) -> Count {
        let seconds = self.speed_deg_s.map_or(TURN_S, |speed| 45.0 / speed);
        Count {
            shots: seconds * self.shots_per_s,
            returned: returned as f64,
        }
    }

    /// A shipped scene, all of it but for its sensor and motion.
    fn counts(&self, name: &str) -> Result<Count, Box<dyn Error>> {
        let mut scene = SceneFile::parse(shipped(name).ok_or(name)?, None, None)?;
        scene.simulation.sensor = (self.sensor)();
        scene.simulation.motion = self.motion()?;
        scene.simulation.polls = None;
        let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let effects = &mut scene.effects.effects;
        let summary = scene.simulation.run(effects, threads, &mut Nowhere)?;
        Ok(Count {
            shots: summary.shots as f64,
            returned: summary.returned as f64,
        })
    }
}

/// Down from level to -45 degrees, at one speed from beginning to end.
fn scan_down(speed_deg_s: f64) -> Result<AxisMotion, Box<dyn Error>> {
    Ok(AxisMotion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s,
        accel_deg_s2: None,
        count: 1,
        both_ways: false,
        rest_s: 0.0,
    })?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within 5 points of the paper's shares, level and fast; and the VLP-16's ratios within a
    /// twentieth. The slow scan takes the test too long.
    #[test]
    fn return_ratios_are_close_to_the_paper() {
        let [level, hdl, fast, _] = &SCANS;
        for (name, _, papers) in PLACES {
            let [of_level, of_hdl, of_fast, _] = papers;
            let papers = [
                level.papers(of_level),
                hdl.papers(of_hdl),
                fast.papers(of_fast),
            ];
            let ours = [level, hdl, fast].map(|scan| scan.counts(name).unwrap());
            for (ours, paper) in ours.iter().zip(&papers) {
                let off = ours.percent() - paper.percent();
                assert!(off.abs() < 5.0, "{name}: {off} points");
            }
            let ratio = |[level, _, fast]: [Count; 3]| fast.returned / level.returned;
            let off = ratio(ours) / ratio(papers) - 1.0;
            assert!(off.abs() < 0.05, "{name}: {}", ratio(ours));
        }
    }

    /// The paper's scan times: 45 degrees at 1.07 and 56.25 deg/s, cut to hundredths of a second as
    /// in the paper, and a revolution of the VLP-16.
    #[test]
    fn scan_durations_match_the_paper() {
        for (speed_deg_s, hundredths) in [(1.07, 4_205.0), (56.25, 80.0)] {
            let end_s = scan_down(speed_deg_s).unwrap().end_s;
            assert!((end_s - 45.0 / speed_deg_s).abs() < 1e-12);
            assert_eq!((end_s * 100.0 + 1e-9).floor(), hundredths);
        }
        let hall = SceneFile::parse(shipped("hall").unwrap(), None, None).unwrap();
        assert_eq!(60.0 / f64::from(hall.simulation.rotation.rpm), TURN_S);
        let [level, ..] = &SCANS;
        let shots = level.counts("hall").unwrap().shots;
        assert_eq!(shots, TURN_S * level.shots_per_s);
    }
}
