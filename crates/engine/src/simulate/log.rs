//! Conversion of a simulation to log records and points.

use std::fs::File;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use cloud::{Fields, Point, Points};
use drive::AbortCode;
use drive::cia402::control;
use io::log::LogWriter;
use protocol::epos2::message::{ReadObject, WriteObject};
use protocol::epos2::objects::{self, Address};
use protocol::epos2::{SerialFrame, usb};
use protocol::record::{Direction, DriveLink, Record, Wire};
use scanner::config::{MountConfig, SimulatedScene, TiltAxisConfig};
use scanner::{RangeAccuracy, ScanConfig, SweepPlan};
use sim::TruePoint;
use sim::effects::SurfaceEffect;
use sim::scene_file::SceneFile;
use sim::sensor::LidarMount;
use sim::simulate::{DriveRequest, Simulation, SimulationEvent, SimulationSink};
use units::{Degrees, Gearing, Host, Lidar, Span, Stamp};

use crate::failure::{Failure, Kind};
use crate::output::{Target, sink_failure};

/// Factory address of a sensor (63-9243).
pub(super) const SOURCE: [u8; 4] = [192, 168, 1, 201];
/// The drive's node id.
const NODE: u8 = 1;
/// Points per batch.
const BATCH: usize = 16_384;

/// Cause and scene time of an early end.
pub(super) type Cut = (Failure, Span);

/// A cloud of returns.
pub(super) struct ReturnCloud {
    target: Target,
    batch: Points,
    kind: ReturnPlace,
    failed: bool,
}

/// The places of a cloud's points.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ReturnPlace {
    /// Those that beams hit.
    True,
    /// Those that a lidar without packets measures.
    Measured,
}

impl ReturnCloud {
    pub fn new(target: Target, kind: ReturnPlace) -> Self {
        Self {
            target,
            batch: Points::with_capacity(Fields::FILE, BATCH),
            kind,
            failed: false,
        }
    }

    const fn help(&self) -> &'static str {
        match self.kind {
            ReturnPlace::True => {
                "free some space or choose another folder with --truth, and run the command again: the simulation ended here"
            }
            ReturnPlace::Measured => {
                "free some space or choose another folder with -o, and run the command again: the simulation ended here"
            }
        }
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let written = self.target.sink().points(&self.batch);
        self.batch.clear();
        written.map_err(|error| {
            self.failed = true;
            sink_failure(self.target.path(), &error).help(self.help())
        })
    }

    /// Takes a return of a lidar whose clock was at `clock_ns` at the start.
    fn push(&mut self, point: &TruePoint, ring: u8, clock_ns: i64) -> Result<(), Failure> {
        let position_m = match self.kind {
            ReturnPlace::True if !point.range_m.is_finite() => return Ok(()),
            ReturnPlace::True => point.position_m,
            ReturnPlace::Measured => point.measured_m,
        };
        self.batch.push(Point {
            position_m: position_m.to_array(),
            intensity: point.reflectivity,
            ring,
            laser: point.laser,
            time: point.host,
            device_time: Stamp::<Lidar>::from_nanos(point.device_ns)
                .saturating_add(Span::from_nanos(clock_ns)),
            tilt: Degrees(point.tilt_deg),
            sd_m: 0.0,
            echo: 0,
        });
        match self.batch.len() >= BATCH {
            true => self.flush(),
            false => Ok(()),
        }
    }

    /// Completes the file and returns its path; `None` for a cloud that failed before, of which no
    /// part is kept under its name.
    fn finish(mut self) -> Result<Option<PathBuf>, Failure> {
        if self.failed {
            return Ok(None);
        }
        self.flush()?;
        let path = self.target.path().to_owned();
        let help = self.help();
        self.target.commit().map_err(|failure| failure.help(help))?;
        Ok(Some(path))
    }
}

/// Destinations of a simulation's output.
#[derive(Default)]
pub(super) struct Outputs {
    /// The log of a lidar with packets.
    pub log: Option<(LogWriter<File>, PathBuf)>,
    /// The cloud that a lidar without packets measures.
    pub measured: Option<ReturnCloud>,
    /// The cloud of the places that beams hit.
    pub truth: Option<ReturnCloud>,
}

/// The clouds that were written, and what ended the simulation early.
pub(super) struct WrittenClouds {
    pub measured: Option<PathBuf>,
    pub truth: Option<PathBuf>,
    pub cut: Option<Cut>,
}

/// Writes the log and the clouds.
pub(super) struct Log<'a> {
    outputs: Outputs,
    gearing: Option<Gearing>,
    rings: Vec<u8>,
    clock_ns: i64,
    interrupt: &'a AtomicBool,
    progressed: &'a mut dyn FnMut(f64),
    began: Stamp<Host>,
    last: Stamp<Host>,
    failure: Option<Failure>,
}

impl<'a> Log<'a> {
    pub fn new(
        simulation: &Simulation,
        outputs: Outputs,
        gearing: Option<Gearing>,
        interrupt: &'a AtomicBool,
        progressed: &'a mut dyn FnMut(f64),
    ) -> Self {
        Self {
            outputs,
            gearing,
            rings: rings(simulation),
            clock_ns: i64::from(simulation.clock_at_start_us).saturating_mul(1_000),
            interrupt,
            progressed,
            began: simulation.start,
            last: simulation.start,
            failure: None,
        }
    }

    fn record(&mut self, record: &Record<'_>) -> ControlFlow<()> {
        let written = match &mut self.outputs.log {
            Some((writer, _)) => writer.write(record),
            None => Ok(()),
        };
        match written {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => self.fail(
                Failure::new(Kind::Incomplete, error.to_string())
                    .help("free some space or choose another folder with -o"),
            ),
        }
    }

    fn fail(&mut self, failure: Failure) -> ControlFlow<()> {
        self.failure = Some(failure);
        ControlFlow::Break(())
    }

    fn frame(
        &mut self,
        host: Stamp<Host>,
        direction: Direction,
        frame: &SerialFrame,
    ) -> ControlFlow<()> {
        let bytes = usb::to_bytes(frame);
        self.record(&Record {
            host,
            wire: Wire::Drive {
                link: DriveLink::Usb,
                direction,
                frame: &bytes,
            },
        })
    }

    /// Reports the time reached, and fails if the user stopped the simulation.
    fn reach(&mut self, at: Stamp<Host>) -> ControlFlow<()> {
        (self.progressed)((at - self.began).as_secs_f64());
        self.last = at;
        if !self.interrupt.load(Ordering::Relaxed) {
            return ControlFlow::Continue(());
        }
        let what = "stopped by the user during the simulation";
        self.fail(
            Failure::new(Kind::Interrupted, what)
                .help("the files are complete up to that time; run the command again for the rest"),
        )
    }

    /// Completes the files.
    pub fn finish(self) -> Result<WrittenClouds, Failure> {
        let Outputs {
            log,
            measured,
            truth,
        } = self.outputs;
        if let Some((writer, path)) = log {
            writer
                .finish()
                .map_err(|error| cannot_write(&path, &error))?;
        }
        let mut failure = self.failure;
        let mut finish = |cloud: Option<ReturnCloud>| {
            cloud?.finish().unwrap_or_else(|error| {
                // A cloud that is lost matters more than a run that the user stopped.
                failure = Some(error);
                None
            })
        };
        let (measured, truth) = (finish(measured), finish(truth));
        let after = self.last - self.began;
        Ok(WrittenClouds {
            measured,
            truth,
            cut: failure.map(|failure| (failure, after)),
        })
    }
}

impl SimulationSink for Log<'_> {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        match event {
            SimulationEvent::Datagram { at, port, payload } => {
                self.reach(*at)?;
                self.record(&Record {
                    host: *at,
                    wire: Wire::Lidar {
                        source: SOURCE,
                        port: *port,
                        payload,
                    },
                })
            }
            _ => match frame_of(event, self.gearing) {
                Some((at, direction, frame)) => self.frame(at, direction, &frame),
                None => ControlFlow::Continue(()),
            },
        }
    }

    fn reached(&mut self, at: Stamp<Host>) -> ControlFlow<()> {
        self.reach(at)
    }

    fn wants_truth(&self) -> bool {
        self.outputs.measured.is_some() || self.outputs.truth.is_some()
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        for point in points {
            let ring = self.rings.get(usize::from(point.laser)).copied();
            let outputs = &mut self.outputs;
            for cloud in outputs.measured.iter_mut().chain(&mut outputs.truth) {
                if let Err(failure) = cloud.push(point, ring.unwrap_or(0), self.clock_ns) {
                    return self.fail(failure);
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The failure of a log that cannot be written.
pub(super) fn cannot_write(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(
        Kind::Incomplete,
        format!("the log {} cannot be written: {error}", path.display()),
    )
    .help("free some space or choose another folder with -o")
}

/// Ring of each laser by elevation; 0 is the lowest.
fn rings(simulation: &Simulation) -> Vec<u8> {
    let beams = &simulation.sensor.beams;
    let below = |elevation_deg: f64| {
        beams
            .iter()
            .filter(move |b| b.elevation_deg < elevation_deg)
    };
    beams
        .iter()
        .map(|beam| u8::try_from(below(beam.elevation_deg).count()).unwrap_or(u8::MAX))
        .collect()
}

/// The frame of the drive in an event, with its time and direction.
pub(super) fn frame_of(
    event: &SimulationEvent,
    gearing: Option<Gearing>,
) -> Option<(Stamp<Host>, Direction, SerialFrame)> {
    match event {
        SimulationEvent::Datagram { .. } => None,
        SimulationEvent::Request { at, request } => {
            Some((*at, Direction::ToDrive, frame(*request, gearing?)))
        }
        SimulationEvent::Answer {
            at,
            request,
            position_qc,
        } => {
            let answer = match request {
                DriveRequest::Position => ReadObject::answer(Ok(*position_qc as u32)),
                DriveRequest::Probe(which) => ReadObject::answer(Err(probe_request(*which).1)),
                _ => WriteObject::answer(Ok(())),
            };
            Some((*at, Direction::FromDrive, answer))
        }
    }
}

/// Frame of a request to the drive.
fn frame(request: DriveRequest, gearing: Gearing) -> SerialFrame {
    let rpm = |deg: f64| (deg / gearing.deg_s_per_rpm()).round() as u32;
    let read = |address: Address| {
        let node = NODE;
        ReadObject { node, address }.to_frame()
    };
    let (address, value) = match request {
        DriveRequest::Position => return read(objects::POSITION_ACTUAL.address),
        DriveRequest::Probe(which) => return read(probe_request(which).0),
        DriveRequest::Target(qc) => (objects::TARGET_POSITION.address, qc as u32),
        DriveRequest::Speed(deg_s) => (objects::PROFILE_VELOCITY.address, rpm(deg_s)),
        DriveRequest::Acceleration(deg_s2) => (objects::PROFILE_ACCELERATION.address, rpm(deg_s2)),
        DriveRequest::Deceleration(deg_s2) => (objects::PROFILE_DECELERATION.address, rpm(deg_s2)),
        DriveRequest::Ready => (
            objects::CONTROLWORD.address,
            control::ENABLE_OPERATION.into(),
        ),
        DriveRequest::Go => (
            objects::CONTROLWORD.address,
            control::START_ABSOLUTE_AT_ONCE.into(),
        ),
    };
    let write = WriteObject {
        node: NODE,
        address,
        value,
    };
    write.to_frame()
}

/// Address and error answer of the two probe requests.
const fn probe_request(second: bool) -> (Address, AbortCode) {
    let [one, other] = drive::PROBES;
    if second { other } else { one }
}

/// Configuration stored in the log.
pub(super) fn scan_config(name: &str, scene: &SceneFile, gearing: Option<Gearing>) -> ScanConfig {
    let simulation = &scene.simulation;
    let step_m = f64::from(simulation.sensor.distance_unit_mm) * 1e-3;
    let noise_m2 = scene.effects.effects.firings.surface.range_variance_m2();
    let axis = gearing.map_or_else(TiltAxisConfig::default, |gearing| TiltAxisConfig {
        node: NODE,
        encoder_lines: gearing.qc_per_motor_turn() / 4,
        gear: gearing.turns(),
    });
    ScanConfig {
        device: "simulate".to_owned(),
        simulated: true,
        mount: mount_config(&simulation.mount),
        lidar: RangeAccuracy {
            range_sd_m: (step_m * step_m / 12.0 + noise_m2).sqrt(),
        },
        axis,
        sweep: plan(simulation),
        simulation: Some(SimulatedScene {
            scene: name.to_owned(),
            seed: scene.seed.to_string(),
            effects: (scene.effects.lines.iter())
                .map(|line| line.name.to_owned())
                .collect(),
            fingerprint: Some(SimulatedScene::fingerprint_of(&scene.text)),
        }),
        ..ScanConfig::default()
    }
}

fn mount_config(mount: &LidarMount) -> MountConfig {
    let [x, y, z] = mount.position_m.to_array();
    MountConfig {
        position_m: [x, y, 0.0],
        rotation_deg: mount.rotation_deg(),
        ..MountConfig::upright(z)
    }
}

/// The planned sweeps of the motion.
fn plan(simulation: &Simulation) -> Option<SweepPlan> {
    let sweeps = || simulation.motion.moves.iter().filter(|next| next.sweep);
    let first = sweeps().next()?;
    let speed = first.cruise_deg_s.abs();
    Some(SweepPlan {
        from_deg: first.from_deg,
        to_deg: first.to_deg,
        cruise_deg_s: speed,
        accel_deg_s2: if first.ramp_s > 0.0 {
            speed / first.ramp_s
        } else {
            f64::INFINITY
        },
        sweeps: u32::try_from(sweeps().count()).unwrap_or(u32::MAX),
        both_ways: sweeps()
            .nth(1)
            .is_some_and(|second| second.from_deg == first.to_deg),
    })
}
