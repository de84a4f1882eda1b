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
use sim::simulate::{SimulationEvent, SimulationSink};

/// A scene, the paper's place, and its points: VLP-16 level for 0.1 s, velomotion's fast scan in
/// 0.8 s.
const PLACES: [(&str, &str, u64, u64); 3] = [
    ("hall", "building hall", 27_998, 201_851),
    ("parking", "parking area", 20_141, 158_351),
    ("quarry", "quarry", 16_954, 125_237),
];
/// Shots a second that the paper's shares are of: 28,800 a turn.
const PAPERS_SHOTS_PER_S: f64 = 288_000.0;
/// Speed of the fast scan, degrees per second.
const FAST_DEG_S: f64 = 56.25;
/// Duration with a level sensor: a revolution of the VLP-16 at 10 Hz, seconds.
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
    println!(
        "| scene | place of the paper | | VLP-16, 0.1 s | share | fast scan, 0.8 s | share | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, place, level, fast) in PLACES {
        row(name, "", "simulated", counts(name)?);
        row("", place, "paper", papers(level, fast));
    }
    Ok(())
}

fn row(scene: &str, place: &str, whose: &str, [level, fast]: [Count; 2]) {
    println!(
        "| {scene} | {place} | {whose} | {:.0} | {:.1} % | {:.0} | {:.1} % | {:.2} |",
        level.returned,
        level.percent(),
        fast.returned,
        fast.percent(),
        fast.returned / level.returned
    );
}

/// The paper's counts, with the shots that its shares are of.
fn papers(level: u64, fast: u64) -> [Count; 2] {
    [(level, TURN_S), (fast, 45.0 / FAST_DEG_S)].map(|(returned, seconds)| Count {
        shots: seconds * PAPERS_SHOTS_PER_S,
        returned: returned as f64,
    })
}

/// A scene as the level sensor sees it, and as the fast scan does.
fn counts(name: &str) -> Result<[Count; 2], Box<dyn Error>> {
    let fast = scan_down(FAST_DEG_S)?;
    Ok([
        scan(name, AxisMotion::fixed(0.0, TURN_S)?)?,
        scan(name, fast)?,
    ])
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

/// A shipped scene, all of it but for its motion.
fn scan(name: &str, motion: AxisMotion) -> Result<Count, Box<dyn Error>> {
    let mut scene = SceneFile::parse(shipped(name).ok_or(name)?, None, None)?;
    scene.simulation.motion = motion;
    scene.simulation.polls = None;
    let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let effects = &mut scene.effects.effects;
    let summary = scene.simulation.run(effects, threads, &mut Nowhere)?;
    Ok(Count {
        shots: summary.shots as f64,
        returned: summary.returned as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within 5 points of the paper's shares, level and fast; and its ratios within a twentieth.
    #[test]
    fn return_ratios_are_close_to_the_paper() {
        for (name, _, level, fast) in PLACES {
            let (ours, papers) = (counts(name).unwrap(), papers(level, fast));
            for (ours, paper) in ours.iter().zip(papers) {
                let off = ours.percent() - paper.percent();
                assert!(off.abs() < 5.0, "{name}: {off} points");
            }
            let ratio = |[level, fast]: [Count; 2]| fast.returned / level.returned;
            let off = ratio(ours) / ratio(papers) - 1.0;
            assert!(off.abs() < 0.05, "{name}: {}", ratio(ours));
        }
    }

    /// The paper's scan times: 45 degrees at 1.07 and 56.25 deg/s, cut to hundredths of a second as
    /// in the paper, and a revolution of the VLP-16.
    #[test]
    fn scan_durations_match_the_paper() {
        for (speed_deg_s, hundredths) in [(1.07, 4_205.0), (FAST_DEG_S, 80.0)] {
            let end_s = scan_down(speed_deg_s).unwrap().end_s;
            assert!((end_s - 45.0 / speed_deg_s).abs() < 1e-12);
            assert_eq!((end_s * 100.0 + 1e-9).floor(), hundredths);
        }
        let hall = SceneFile::parse(shipped("hall").unwrap(), None, None).unwrap();
        assert_eq!(60.0 / f64::from(hall.simulation.rotation.rpm), TURN_S);
        let level = scan("hall", AxisMotion::fixed(0.0, TURN_S).unwrap()).unwrap();
        assert_eq!(level.shots, TURN_S * PAPERS_SHOTS_PER_S);
    }
}
