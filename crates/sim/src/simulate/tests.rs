use super::*;
use super::{
    DriveRequest, Polls, SimulateError, Simulation, SimulationEvent, SimulationSink,
    SimulationSummary,
};
use crate::effect_models::range_noise::RangeNoise;
use crate::effects::{
    AxisAngles, ClockEffect, ConfiguredEffects, Effect, Effects, FiringEffectSet, FiringEffects,
    LinkEffect, LinkMessage, MechanismEffect, MeteredEffect, Needs, SurfaceEffect, ViewEffect,
};
use crate::firing::{Echoes, SimulatedFiring};
use crate::motion::Sweeps;
use crate::packet_maker::{HeadRotation, TruePoint};
use crate::scene::Scene;
use crate::sensor::{LidarMount, LidarSensor, ReturnMode};
use firmware_sim::vlp16::DATA_PORT;

/// The output of a run.
#[derive(Default)]
struct Taken {
    times: Vec<i64>,
    datagrams: Vec<(u16, Vec<u8>)>,
    answers: Vec<(Stamp<Host>, i32)>,
    commands: Vec<DriveRequest>,
    points: Vec<TruePoint>,
    stop_after: Option<usize>,
    probes: usize,
}

impl SimulationSink for Taken {
    fn event(&mut self, event: &SimulationEvent) -> ControlFlow<()> {
        let at = match event {
            SimulationEvent::Datagram { at, port, payload } => {
                self.datagrams.push((*port, payload.to_vec()));
                at
            }
            SimulationEvent::Request { at, .. } => at,
            SimulationEvent::Answer {
                at,
                request,
                position_qc,
            } => {
                match request {
                    DriveRequest::Position => self.answers.push((*at, *position_qc)),
                    DriveRequest::Probe(_) => self.probes += 1,
                    other => self.commands.push(*other),
                }
                at
            }
        };
        self.times.push(at.as_nanos());
        match self.stop_after == Some(self.times.len()) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn truth(&mut self, points: &[TruePoint]) -> ControlFlow<()> {
        self.points.extend_from_slice(points);
        ControlFlow::Continue(())
    }
}

const START: Stamp<Host> = Stamp::from_nanos(1_795_226_733_000_000_000);

fn hall(sensor: LidarSensor) -> Simulation {
    let motion = AxisMotion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 300.0,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.03,
    });
    Simulation {
        scene: Arc::new(Scene::hall()),
        sensor,
        returns: ReturnMode::Strongest,
        rotation: HeadRotation {
            rpm: 600,
            start_deg: 200.0,
        },
        mount: LidarMount::above(0.06),
        motion: motion.unwrap(),
        polls: Some(Polls {
            period_ns: 2_500_000,
            answer_ns: 1_000_000,
            gearing: Gearing::new(500, 120, 1).unwrap(),
        }),
        start: START,
        clock_at_start_us: 3_599_900_000,
    }
}

fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap()
}

fn run(simulation: &Simulation, count: usize) -> (Taken, SimulationSummary) {
    let mut taken = Taken::default();
    let summary = simulation.run(
        &mut Effects::<FiringEffectSet>::default(),
        threads(count),
        &mut taken,
    );
    (taken, summary.unwrap())
}

/// Without packets there are only points: of all lasers, all round or in an aperture.
#[test]
fn lidars_without_packets_measure_points() {
    for (sensor, rpm, lasers, per_s, share, step_m) in [
        (LidarSensor::hdl64e(), 600, 64, 20_828.0, 1.0, 2e-3),
        (LidarSensor::utm30lx(), 2_400, 1, 57_600.0, 0.75, 1e-3),
        (LidarSensor::lms151(), 3_000, 1, 36_000.0, 0.75, 1e-3),
    ] {
        let mut simulation = hall(sensor);
        simulation.rotation.rpm = rpm;
        let (taken, summary) = run(&simulation, 2);
        assert!(taken.datagrams.is_empty() && !taken.answers.is_empty());
        assert_eq!(summary.packets, 0);
        assert_eq!(taken.points.len() as u64, summary.returned);
        let seconds = summary.duration.as_secs_f64();
        let shots = seconds * per_s * f64::from(lasers) * share;
        // The last revolution is not whole.
        assert!((summary.shots as f64 / shots - 1.0).abs() < 0.03, "{shots}");
        let seen: std::collections::BTreeSet<u8> =
            taken.points.iter().map(|point| point.laser).collect();
        assert_eq!(seen.len(), lasers as usize);
        for point in &taken.points {
            let from_front = (point.azimuth_deg + 180.0) % 360.0 - 180.0;
            assert!(share == 1.0 || from_front.abs() <= 135.0, "{point:?}");
            let laser = usize::from(point.laser);
            let (azimuth_deg, tilt_deg) = (point.azimuth_deg, point.tilt_deg);
            let ray = (simulation.sensor).ray(laser, azimuth_deg, tilt_deg, &simulation.mount);
            let (origin, direction) = ray.unwrap();
            let at = origin + point.range_m * direction;
            assert!(at.distance(point.position_m) < 1e-9, "{point:?}");
            assert!(
                at.distance(point.measured_m) < 0.5 * step_m + 1e-9,
                "{point:?}"
            );
        }
    }
}

/// The plain definition of a ray against the rays of a firing.
#[test]
fn points_agree_with_single_rays() {
    let simulation = hall(LidarSensor::vlp16());
    let (taken, summary) = run(&simulation, 1);
    assert_eq!(taken.points.len() as u64, summary.returned);
    assert_eq!(summary.returned, summary.shots, "every beam hits the hall");
    let mut different = 0;
    for point in &taken.points {
        let since_s = (point.host - START).as_secs_f64();
        let commanded = simulation.motion.at(since_s);
        // The platform moves at constant speed during a firing: 35 us at 5000 deg/s2.
        assert!((point.tilt_deg - commanded.angle_deg).abs() < 3.1e-6);
        let azimuth = simulation.rotation.start_deg + 3_600.0 * 1e-9 * point.device_ns as f64;
        let off = (point.azimuth_deg - azimuth).rem_euclid(360.0);
        assert!(!(1e-9..=360.0 - 1e-9).contains(&off), "{off}");
        let laser = usize::from(point.laser);
        let ray = (simulation.sensor).ray(laser, azimuth, point.tilt_deg, &simulation.mount);
        let (origin, direction) = ray.unwrap();
        let seen = origin + point.range_m * direction;
        assert!(seen.distance(point.position_m) < 1e-11, "{point:?}");
        // Half a step of 2 mm.
        assert!(seen.distance(point.measured_m) < 1e-3 + 1e-9, "{point:?}");
        let hit = simulation.scene.cast(origin, direction, 1.0, 100.0);
        let same = hit.is_some_and(|hit| (hit.range_m - point.range_m).abs() < 1e-9);
        different += u32::from(!same);
    }
    // At an edge the last bit of a direction decides between two surfaces.
    assert!(different < 3, "{different}");
}

#[test]
fn bytes_do_not_depend_on_threads() {
    for sensor in [LidarSensor::vlp16(), LidarSensor::hdl32e()] {
        let simulation = hall(sensor);
        let mut runs = Vec::new();
        for count in [1, 2, 5] {
            let noise = RangeNoise::new(0.02, 7);
            let mut effects = Effects::<_> {
                firings: FiringEffectSet::<(), (), (), _, ()> {
                    objects: (),
                    view: (),
                    beam: (),
                    surface: noise,
                    clock: (),
                },
                mechanism: (),
                encoder: (),
                link: (),
            };
            let mut taken = Taken::default();
            let summary = simulation.run(&mut effects, threads(count), &mut taken);
            runs.push((
                taken.datagrams,
                taken.answers,
                taken.times,
                taken.points,
                summary,
            ));
        }
        assert!(runs.windows(2).all(|two| two[0] == two[1]));
    }
}

#[test]
fn events_are_ordered_and_end_at_a_break() {
    let simulation = hall(LidarSensor::vlp16());
    let (taken, summary) = run(&simulation, 2);
    assert!(taken.times.is_sorted());
    assert!(!summary.stopped);
    // 0.17 s: 0.15 s of cruise, one ramp of 0.06 s less what it saves.
    let lasted = summary.duration.as_secs_f64();
    assert_eq!(summary.packets, (lasted / 1_327.104e-6) as u64);
    assert_eq!((taken.answers.len() + 6) as u64, summary.polls);
    let commanded = [
        DriveRequest::Target(-30_000),
        DriveRequest::Speed(300.0),
        DriveRequest::Acceleration(5_000.0),
        DriveRequest::Deceleration(5_000.0),
        DriveRequest::Ready,
        DriveRequest::Go,
    ];
    assert_eq!(taken.commands, commanded);
    assert_eq!(summary.polls, (lasted / 2.5e-3) as u64 + 1);
    for count in [1, 2] {
        let mut taken = Taken {
            stop_after: Some(50),
            ..Taken::default()
        };
        let summary = simulation
            .run(
                &mut Effects::<FiringEffectSet>::default(),
                threads(count),
                &mut taken,
            )
            .unwrap();
        assert!(summary.stopped);
        assert_eq!(taken.times.len(), 50);
    }
}

#[test]
fn the_drive_reports_its_shaft_at_the_middle_of_the_exchange() {
    let simulation = hall(LidarSensor::vlp16());
    let (taken, _) = run(&simulation, 1);
    for (at, position_qc) in taken.answers {
        let read_s = (at - START).as_secs_f64() - 0.0005;
        let angle = simulation.motion.at(read_s).angle_deg;
        assert!((f64::from(position_qc) * 0.0015 - angle).abs() <= 0.000_750_1);
    }
}

/// A sensor that fires only to the right, from 90 to 180 degrees.
#[derive(Clone, Debug)]
struct Window;

impl Effect for Window {
    fn name(&self) -> &'static str {
        "window"
    }

    fn needs(&self) -> Needs {
        Needs {
            azimuths: true,
            ..Needs::default()
        }
    }
}

impl ViewEffect for Window {
    fn fires(&self, azimuth_deg: f64) -> bool {
        (90.0..180.0).contains(&azimuth_deg)
    }
}

fn with<V, S, C>(view: V, surface: S, clock: C) -> Effects<FiringEffectSet<(), V, (), S, C>> {
    Effects {
        firings: FiringEffectSet {
            objects: (),
            view,
            beam: (),
            surface,
            clock,
        },
        mechanism: (),
        encoder: (),
        link: (),
    }
}

fn run_with<F: FiringEffects, M: MechanismEffect, E: EncoderEffect, L: LinkEffect>(
    simulation: &Simulation,
    effects: &mut Effects<F, M, E, L>,
) -> (Taken, SimulationSummary) {
    let mut taken = Taken::default();
    let summary = simulation.run(effects, threads(2), &mut taken);
    (taken, summary.unwrap())
}

#[test]
fn packets_span_the_gap_of_a_limited_field_of_view() {
    let mut simulation = hall(LidarSensor::vlp16());
    simulation.motion = AxisMotion::fixed(0.0, 0.5).unwrap();
    simulation.polls = None;
    let (taken, summary) = run_with(&simulation, &mut with(Window, (), ()));
    // A quarter of five revolutions.
    assert!((92..=94).contains(&summary.packets), "{summary:?}");
    let mut straddling = 0;
    for (_, packet) in taken
        .datagrams
        .iter()
        .filter(|(port, _)| *port == DATA_PORT)
    {
        let azimuth =
            |block: usize| u16::from_le_bytes([packet[100 * block + 2], packet[100 * block + 3]]);
        let azimuths: Vec<u16> = (0..12).map(azimuth).collect();
        assert!(
            azimuths.iter().all(|cdeg| (9_000..=18_000).contains(cdeg)),
            "{azimuths:?}"
        );
        straddling += u32::from(!azimuths.is_sorted());
    }
    assert!((3..=5).contains(&straddling), "{straddling}");
    // Every point is at the position of its own time.
    for point in &taken.points {
        let azimuth = 200.0 + 3.6e-6 * point.device_ns as f64;
        let turned = (point.azimuth_deg - azimuth).rem_euclid(360.0);
        assert!(!(1e-9..=360.0 - 1e-9).contains(&turned));
    }
}

/// Half as bright.
#[derive(Clone, Debug)]
struct Dim;

impl Effect for Dim {
    fn name(&self) -> &'static str {
        "dim"
    }
}

impl SurfaceEffect for Dim {
    fn reflect(&self, _: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        for echo in echoes.all_mut().flatten().filter(|echo| echo.is_present()) {
            echo.reflectivity *= 0.5;
            acted += 1;
        }
        acted
    }
}

/// One effect, then another.
#[derive(Clone, Debug)]
struct Both<A, B>(A, B);

impl<A: Effect, B: Effect> Effect for Both<A, B> {
    fn name(&self) -> &'static str {
        "both"
    }
}

impl<A: SurfaceEffect, B: SurfaceEffect> SurfaceEffect for Both<A, B> {
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        self.0.reflect(firing, echoes) + self.1.reflect(firing, echoes)
    }
}

fn distances(taken: &Taken) -> Vec<u16> {
    let data = taken
        .datagrams
        .iter()
        .filter(|(port, _)| *port == DATA_PORT);
    data.flat_map(|(_, packet)| {
        let places =
            (0..12).flat_map(|block| (0..32).map(move |channel| 100 * block + 4 + 3 * channel));
        places
            .map(|at| u16::from_le_bytes([packet[at], packet[at + 1]]))
            .collect::<Vec<_>>()
    })
    .collect()
}

#[test]
fn another_effect_does_not_change_random_draws() {
    let simulation = hall(LidarSensor::vlp16());
    let noise = RangeNoise::new(0.05, 3);
    let (alone, _) = run_with(&simulation, &mut with((), noise, ()));
    let (both, _) = run_with(&simulation, &mut with((), Both(Dim, noise), ()));
    assert_eq!(distances(&alone), distances(&both));
    assert_ne!(alone.datagrams, both.datagrams);
    let (none, _) = run(&simulation, 1);
    assert_ne!(distances(&alone), distances(&none));
}

#[test]
fn effects_in_a_list_act_in_order_and_are_counted() {
    let simulation = hall(LidarSensor::hdl32e());
    let noise = RangeNoise::new(0.05, 3);
    let (pair, summary) = run_with(&simulation, &mut with((), Both(noise, Dim), ()));
    let mut configured = ConfiguredEffects::default();
    let surface = &mut configured.firings.surface;
    surface.push(MeteredEffect::new(Arc::new(noise), None));
    surface.push(MeteredEffect::new(Arc::new(Dim), Some(|| 5)));
    for times in 1..=2 {
        let (list, _) = run_with(&simulation, &mut configured);
        assert_eq!(list.datagrams, pair.datagrams);
        for listed in &configured.firings.surface {
            let usage = listed.counts();
            assert_eq!(usage.calls, times * summary.shots / 32);
            assert_eq!(usage.acted, usage.calls);
            assert_eq!(usage.changed, times * summary.returns);
            assert_eq!(usage.spent_ns, 0);
        }
    }
}

/// A platform a degree ahead of its motor.
#[derive(Debug)]
struct Ahead;

impl Effect for Ahead {
    fn name(&self) -> &'static str {
        "ahead"
    }
}

impl MechanismEffect for Ahead {
    fn step(&mut self, _: f64, axis: &mut AxisAngles) -> bool {
        axis.platform_deg += 1.0;
        true
    }
}

#[test]
fn the_mechanism_acts_between_encoder_and_platform() {
    let simulation = hall(LidarSensor::vlp16());
    let (ideal, _) = run(&simulation, 1);
    let mut effects = Effects {
        firings: FiringEffectSet::default(),
        mechanism: Ahead,
        encoder: (),
        link: (),
    };
    let (ahead, _) = run_with::<FiringEffectSet, _, _, _>(&simulation, &mut effects);
    let apart = ideal.answers.iter().zip(&ahead.answers);
    assert!(apart.clone().count() > 50);
    for ((_, ideal), (_, ahead)) in apart {
        assert!((ideal - ahead).abs() <= 1);
    }
    for (ideal, ahead) in ideal.points.iter().zip(&ahead.points) {
        // Linear between steps of 250 us: 5000 deg/s2 x (250 us)^2 / 8.
        let off = ahead.tilt_deg - ideal.tilt_deg - 1.0;
        assert!(off.abs() < 5e-5, "{off}");
    }
}

/// Every third message is lost, every fifth is duplicated, and all are delayed by up to 4 ms, so
/// that they overtake each other.
#[derive(Debug)]
struct Bad(crate::random::RandomSource);

impl Effect for Bad {
    fn name(&self) -> &'static str {
        "bad"
    }
}

impl LinkEffect for Bad {
    fn deliver(&mut self, message: LinkMessage, arrive: &mut dyn FnMut(LinkMessage)) -> u32 {
        let times = match (message.number % 3, message.number % 5) {
            (0, _) => 0,
            (_, 0) => 2,
            _ => 1,
        };
        let mut draws = self.0.at(message.number, message.kind as u32);
        for _ in 0..times {
            let late_ns = (4e6 * draws.unit()) as i64;
            arrive(LinkMessage {
                time_ns: message.time_ns + late_ns,
                ..message
            });
        }
        1
    }
}

#[test]
fn events_are_ordered_and_moves_commanded_over_bad_links() {
    let simulation = hall(LidarSensor::vlp16());
    let mut effects = Effects {
        firings: FiringEffectSet::default(),
        mechanism: (),
        encoder: (),
        link: Bad(crate::random::RandomSource::new(1, "bad")),
    };
    let (taken, summary) = run_with::<FiringEffectSet, _, _, _>(&simulation, &mut effects);
    assert!(taken.times.is_sorted());
    let numbers = 0..summary.packets;
    let expected: u64 = numbers
        .map(|n| match (n % 3, n % 5) {
            (0, _) => 0,
            (_, 0) => 2,
            _ => 1,
        })
        .sum();
    let data = taken
        .datagrams
        .iter()
        .filter(|(port, _)| *port == DATA_PORT);
    assert_eq!(data.clone().count() as u64, expected);
    let stamps: Vec<u32> = data
        .map(|(_, packet)| u32::from_le_bytes(packet[1200..1204].try_into().unwrap()))
        .collect();
    assert!(
        !stamps.is_sorted(),
        "no message overtook another: the test checks nothing"
    );
    // A command is repeated until it is acknowledged, and an acknowledgement may be duplicated.
    let mut commands = taken.commands.clone();
    commands.dedup();
    assert_eq!(commands.len(), 6, "{commands:?}");
    assert!(
        taken.probes > 0,
        "no probe was sent: the test checks nothing"
    );
    // The truth is unaffected.
    assert_eq!(taken.points.len() as u64, summary.returns);
}

/// A lidar whose clock is 1000 ppm fast: it is ahead of the host's.
#[derive(Clone, Debug)]
struct Fast;

impl Effect for Fast {
    fn name(&self) -> &'static str {
        "fast"
    }
}

impl ClockEffect for Fast {
    fn host_ns(&self, device_ns: i64) -> i64 {
        device_ns - device_ns / 1_001
    }
}

#[test]
fn firing_times_follow_the_lidar_clock() {
    let simulation = hall(LidarSensor::vlp16());
    let (taken, _) = run_with(&simulation, &mut with((), (), Fast));
    let last = taken.points.last().unwrap();
    let host_ns = (last.host - START).as_nanos();
    assert!((last.device_ns - host_ns - last.device_ns / 1_001).abs() <= 1);
    let commanded = simulation.motion.at(host_ns as f64 * 1e-9);
    assert!((last.tilt_deg - commanded.angle_deg).abs() < 1e-5);
}

#[test]
fn covered_lasers_never_fire() {
    let mut simulation = hall(LidarSensor::single_beam());
    simulation.motion = AxisMotion::fixed(0.0, 0.1).unwrap();
    let (taken, summary) = run(&simulation, 1);
    assert_eq!(summary.shots, 24 * summary.packets);
    assert_eq!(summary.returned, summary.shots);
    assert!(taken.points.iter().all(|point| point.laser == 14));
}

#[test]
fn invalid_simulations_are_rejected() {
    let mut simulation = hall(LidarSensor::vlp16());
    simulation.motion = AxisMotion::fixed(0.0, 86_401.0).unwrap();
    let mut none = Effects::<FiringEffectSet>::default();
    let refused = simulation.run(&mut none, threads(1), &mut Taken::default());
    assert!(matches!(refused, Err(SimulateError::TooLong { .. })));
    simulation.motion = AxisMotion::fixed(0.0, 1e-4).unwrap();
    simulation.polls = simulation.polls.map(|polls| Polls {
        period_ns: 0,
        ..polls
    });
    let refused = simulation.run(&mut none, threads(1), &mut Taken::default());
    assert!(matches!(refused, Err(SimulateError::Polls { .. })));
    // Shorter than a packet: no output and no error.
    simulation.polls = None;
    let (taken, summary) = run(&simulation, 5);
    assert_eq!((summary.packets, taken.times.len()), (0, 0));
}
