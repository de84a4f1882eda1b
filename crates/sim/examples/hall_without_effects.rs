//! One sweep through the hall without effects; prints a checksum of the output.
//!
//! Built with and without the feature `effects` to count instructions: absent effects must not cost
//! any (`tests/absent_effects.rs`).

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::Arc;

use sim::HeadRotation;
use sim::Scene;
use sim::effects::{Effects, FiringEffectSet};
use sim::motion::{AxisMotion, Sweeps};
use sim::sensor::{LidarMount, LidarSensor, ReturnMode};
use sim::simulate::{Polls, Simulation, SimulationEvent, SimulationSink};
use units::{Gearing, Stamp};

/// FNV-1a over everything that reaches the host.
struct Checksum(u64);

impl Checksum {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }
}

impl SimulationSink for Checksum {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        match event {
            SimulationEvent::Datagram { at, payload, .. } => {
                self.add(&at.as_nanos().to_le_bytes());
                self.add(payload);
            }
            SimulationEvent::Request { at, .. } => self.add(&at.as_nanos().to_le_bytes()),
            SimulationEvent::Answer {
                at, position_qc, ..
            } => {
                self.add(&at.as_nanos().to_le_bytes());
                self.add(&position_qc.to_le_bytes());
            }
        }
        ControlFlow::Continue(())
    }
}

fn main() -> ExitCode {
    let sweeps = Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 112.5,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.05,
    };
    let (Ok(motion), Ok(gearing)) = (AxisMotion::sweeps(&sweeps), Gearing::new(500, 120, 1)) else {
        return ExitCode::FAILURE;
    };
    let simulation = Simulation {
        scene: Arc::new(Scene::hall()),
        sensor: LidarSensor::vlp16(),
        returns: ReturnMode::Strongest,
        rotation: HeadRotation {
            rpm: 600,
            start_deg: 0.0,
        },
        mount: LidarMount::above(0.06),
        motion,
        polls: Some(Polls {
            period_ns: 2_500_000,
            answer_ns: 1_000_000,
            gearing,
        }),
        start: Stamp::from_nanos(1_795_226_733_000_000_000),
        clock_at_start_us: 0,
    };
    let mut out = Checksum(0xCBF2_9CE4_8422_2325);
    let mut effects = Effects::<FiringEffectSet>::default();
    match simulation.run(&mut effects, NonZeroUsize::MIN, &mut out) {
        Ok(summary) => println!("{} shots {:016x}", summary.shots, out.0),
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
