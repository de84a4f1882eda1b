use super::*;
use crate::effects::{
    Absorb, Asked, Axis, Clock, Effect, Listed, Needs, OnFirings, Parcel, RangeNoise, Surface, View,
};
use crate::head::Head;
use crate::motion::Sweeps;
use crate::scenes;
use firmware_sim::vlp16::DATA_PORT;
use units::{Degrees, Metres};

/// What a run gave.
#[derive(Default)]
struct Taken {
    times: Vec<i64>,
    datagrams: Vec<(u16, Vec<u8>)>,
    answers: Vec<(Stamp<Host>, i32)>,
    commands: Vec<Ask>,
    points: Vec<TruePoint>,
    stop_after: Option<usize>,
    markers: usize,
}

impl Out for Taken {
    fn event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        let at = match event {
            Event::Datagram { at, port, payload } => {
                self.datagrams.push((*port, payload.to_vec()));
                at
            }
            Event::Request { at, .. } => at,
            Event::Answer {
                at,
                ask,
                position_qc,
            } => {
                match ask {
                    Ask::Position => self.answers.push((*at, *position_qc)),
                    Ask::Marker(_) => self.markers += 1,
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

fn hall(sensor: Sensor) -> Simulation {
    let motion = Motion::sweeps(&Sweeps {
        from_deg: 0.0,
        to_deg: -45.0,
        speed_deg_s: 300.0,
        accel_deg_s2: Some(5_000.0),
        count: 1,
        both_ways: false,
        rest_s: 0.03,
    });
    Simulation {
        scene: Arc::new(scenes::hall()),
        sensor,
        returns: ReturnMode::Strongest,
        spin: Spin {
            rpm: 600,
            start_deg: 200.0,
        },
        mount: Mount::above(0.06),
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

fn run(simulation: &Simulation, count: usize) -> (Taken, Summary) {
    let mut taken = Taken::default();
    let summary = simulation.run(
        &mut Effects::<OnFirings>::default(),
        threads(count),
        &mut taken,
    );
    (taken, summary.unwrap())
}

/// The rig's way, laser by laser with one matrix each, against the firing's.
#[test]
fn points_are_where_the_rigs_head_sees_them() {
    let simulation = hall(Sensor::vlp16());
    let head = Head::new(Metres(0.06));
    let (taken, summary) = run(&simulation, 1);
    assert_eq!(taken.points.len() as u64, summary.returned);
    assert_eq!(summary.returned, summary.shots, "every beam meets the hall");
    let mut elsewhere = 0;
    for point in &taken.points {
        let since_s = (point.host - START).as_secs_f64();
        let commanded = simulation.motion.at(since_s);
        // The platform turns evenly while a firing lasts: 35 us at 5000 deg/s2.
        assert!((point.tilt_deg - commanded.angle_deg).abs() < 3.1e-6);
        let azimuth = simulation.spin.start_deg + 3_600.0 * 1e-9 * point.device_ns as f64;
        let turned = (point.azimuth_deg - azimuth).rem_euclid(360.0);
        assert!(!(1e-9..=360.0 - 1e-9).contains(&turned), "{turned}");
        let laser = usize::from(point.laser);
        let beam = head.beam(laser, Degrees(azimuth), Degrees(point.tilt_deg));
        let (origin, direction) = beam.unwrap();
        let seen = origin + point.range_m * direction;
        assert!(seen.distance(point.position_m) < 1e-11, "{point:?}");
        let hit = simulation.scene.cast(origin, direction, 1.0, 100.0);
        let same = hit.is_some_and(|hit| (hit.range_m - point.range_m).abs() < 1e-9);
        elsewhere += u32::from(!same);
    }
    // Beside an edge the last bit of a direction decides between two surfaces.
    assert!(elsewhere < 3, "{elsewhere}");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    for sensor in [Sensor::vlp16(), Sensor::hdl32e()] {
        let simulation = hall(sensor);
        let mut runs = Vec::new();
        for count in [1, 2, 5] {
            let noise = RangeNoise::new(0.02, 7);
            let mut effects = Effects::<_> {
                firings: OnFirings::<(), (), (), _, ()> {
                    objects: (),
                    view: (),
                    beam: (),
                    surface: noise,
                    clock: (),
                },
                mechanism: (),
                encoder: (),
                wire: (),
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
fn events_come_in_order_and_a_break_ends_them() {
    let simulation = hall(Sensor::vlp16());
    let (taken, summary) = run(&simulation, 2);
    assert!(taken.times.is_sorted());
    assert!(!summary.broken_off);
    // 0.17 s: 0.15 s of cruise, one ramp of 0.06 s less what it saves.
    let lasted = summary.lasted.as_secs_f64();
    assert_eq!(summary.packets, (lasted / 1_327.104e-6) as u64);
    assert_eq!((taken.answers.len() + 6) as u64, summary.polls);
    let commanded = [
        Ask::Target(-30_000),
        Ask::Speed(300.0),
        Ask::Acceleration(5_000.0),
        Ask::Deceleration(5_000.0),
        Ask::Ready,
        Ask::Go,
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
                &mut Effects::<OnFirings>::default(),
                threads(count),
                &mut taken,
            )
            .unwrap();
        assert!(summary.broken_off);
        assert_eq!(taken.times.len(), 50);
    }
}

#[test]
fn the_drive_says_where_its_shaft_was_in_the_middle() {
    let simulation = hall(Sensor::vlp16());
    let (taken, _) = run(&simulation, 1);
    for (at, position_qc) in taken.answers {
        let read_s = (at - START).as_secs_f64() - 0.0005;
        let angle = simulation.motion.at(read_s).angle_deg;
        assert!((f64::from(position_qc) * 0.0015 - angle).abs() <= 0.000_750_1);
    }
}

/// A sensor that fires to the right alone, from 90 to 180 degrees.
#[derive(Clone, Debug)]
struct Window;

impl Effect for Window {
    fn name(&self) -> &'static str {
        "window"
    }

    fn needs(&self) -> Needs {
        Needs {
            azimuths: true,
            ..Needs::NOTHING
        }
    }
}

impl Absorb for Window {}

impl View for Window {
    fn fires(&self, azimuth_deg: f64) -> bool {
        (90.0..180.0).contains(&azimuth_deg)
    }
}

fn with<V, S, C>(view: V, surface: S, clock: C) -> Effects<OnFirings<(), V, (), S, C>> {
    Effects {
        firings: OnFirings {
            objects: (),
            view,
            beam: (),
            surface,
            clock,
        },
        mechanism: (),
        encoder: (),
        wire: (),
    }
}

fn run_with<F: FiringEffects, M: Mechanism, E: Encoder, W: Wire>(
    simulation: &Simulation,
    effects: &mut Effects<F, M, E, W>,
) -> (Taken, Summary) {
    let mut taken = Taken::default();
    let summary = simulation.run(effects, threads(2), &mut taken);
    (taken, summary.unwrap())
}

#[test]
fn a_window_leaves_blocks_out_and_packets_straddle_the_gap() {
    let mut simulation = hall(Sensor::vlp16());
    simulation.motion = Motion::fixed(0.0, 0.5).unwrap();
    simulation.polls = None;
    let (taken, summary) = run_with(&simulation, &mut with(Window, (), ()));
    // A quarter of five turns.
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
    // Every point is where it was seen, at its own time.
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

impl Absorb for Dim {}

impl Surface for Dim {
    fn reflect(&self, _: &Firing, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        for echo in echoes.all_mut().flatten().filter(|echo| echo.is_there()) {
            echo.reflectivity *= 0.5;
            acted += 1;
        }
        acted
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
fn one_more_effect_leaves_the_draws_of_the_others_as_they_were() {
    let simulation = hall(Sensor::vlp16());
    let noise = RangeNoise::new(0.05, 3);
    let (alone, _) = run_with(&simulation, &mut with((), noise, ()));
    let (both, _) = run_with(&simulation, &mut with((), (Dim, noise), ()));
    assert_eq!(distances(&alone), distances(&both));
    assert_ne!(alone.datagrams, both.datagrams);
    let (none, _) = run(&simulation, 1);
    assert_ne!(distances(&alone), distances(&none));
}

#[test]
fn lists_do_what_pairs_do_and_count_it() {
    let simulation = hall(Sensor::hdl32e());
    let noise = RangeNoise::new(0.05, 3);
    let (pair, summary) = run_with(&simulation, &mut with((), (noise, Dim), ()));
    let mut asked = Asked::default();
    let surface = &mut asked.firings.surface;
    surface.push(Listed::new(Arc::new(noise), None));
    surface.push(Listed::new(Arc::new(Dim), Some(|| 5)));
    for times in 1..=2 {
        let (list, _) = run_with(&simulation, &mut asked);
        assert_eq!(list.datagrams, pair.datagrams);
        for listed in &asked.firings.surface {
            let usage = listed.usage();
            assert_eq!(usage.asked, times * summary.shots / 32);
            assert_eq!(usage.acted, usage.asked);
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

impl Mechanism for Ahead {
    fn step(&mut self, _: f64, axis: &mut Axis) -> bool {
        axis.platform_deg += 1.0;
        true
    }
}

#[test]
fn a_mechanism_stands_between_encoder_and_platform() {
    let simulation = hall(Sensor::vlp16());
    let (ideal, _) = run(&simulation, 1);
    let mut effects = Effects {
        firings: OnFirings::default(),
        mechanism: Ahead,
        encoder: (),
        wire: (),
    };
    let (ahead, _) = run_with::<OnFirings, _, _, _>(&simulation, &mut effects);
    let apart = ideal.answers.iter().zip(&ahead.answers);
    assert!(apart.clone().count() > 50);
    for ((_, ideal), (_, ahead)) in apart {
        assert!((ideal - ahead).abs() <= 1);
    }
    for (ideal, ahead) in ideal.points.iter().zip(&ahead.points) {
        // Straight between steps of 250 us: 5000 deg/s2 x (250 us)^2 / 8.
        let off = ahead.tilt_deg - ideal.tilt_deg - 1.0;
        assert!(off.abs() < 5e-5, "{off}");
    }
}

/// Every third parcel is lost, every fifth comes twice, and all are late by up to 4 ms, so that they overtake each other.
#[derive(Debug)]
struct Bad(crate::random::Source);

impl Effect for Bad {
    fn name(&self) -> &'static str {
        "bad"
    }
}

impl Wire for Bad {
    fn deliver(&mut self, parcel: Parcel, arrive: &mut dyn FnMut(Parcel)) -> u32 {
        let times = match (parcel.number % 3, parcel.number % 5) {
            (0, _) => 0,
            (_, 0) => 2,
            _ => 1,
        };
        let mut draws = self.0.at(parcel.number, parcel.kind as u32);
        for _ in 0..times {
            let late_ns = (4e6 * draws.unit()) as i64;
            arrive(Parcel {
                leaves_ns: parcel.leaves_ns + late_ns,
                ..parcel
            });
        }
        1
    }
}

#[test]
fn whatever_a_link_does_events_come_in_order_and_moves_are_commanded() {
    let simulation = hall(Sensor::vlp16());
    let mut effects = Effects {
        firings: OnFirings::default(),
        mechanism: (),
        encoder: (),
        wire: (Bad(crate::random::Source::new(1, "bad")), ()),
    };
    let (taken, summary) = run_with::<OnFirings, _, _, _>(&simulation, &mut effects);
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
        "nothing overtook anything: the test is blind"
    );
    // A command is repeated until it is acknowledged, and an acknowledgement may come twice.
    let mut commands = taken.commands.clone();
    commands.dedup();
    assert_eq!(commands.len(), 6, "{commands:?}");
    assert!(taken.markers > 0, "nothing was given up: the test is blind");
    // The truth does not care.
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

impl Absorb for Fast {}

impl Clock for Fast {
    fn host_ns(&self, device_ns: i64) -> i64 {
        device_ns - device_ns / 1_001
    }
}

#[test]
fn the_lidars_clock_decides_when_it_fires() {
    let simulation = hall(Sensor::vlp16());
    let (taken, _) = run_with(&simulation, &mut with((), (), Fast));
    let last = taken.points.last().unwrap();
    let host_ns = (last.host - START).as_nanos();
    assert!((last.device_ns - host_ns - last.device_ns / 1_001).abs() <= 1);
    let commanded = simulation.motion.at(host_ns as f64 * 1e-9);
    assert!((last.tilt_deg - commanded.angle_deg).abs() < 1e-5);
}

#[test]
fn a_laser_that_is_covered_never_fires() {
    let mut simulation = hall(Sensor::single_beam());
    simulation.motion = Motion::fixed(0.0, 0.1).unwrap();
    let (taken, summary) = run(&simulation, 1);
    assert_eq!(summary.shots, 24 * summary.packets);
    assert_eq!(summary.returned, summary.shots);
    assert!(taken.points.iter().all(|point| point.laser == 14));
}

#[test]
fn what_cannot_be_run_is_refused() {
    let mut simulation = hall(Sensor::vlp16());
    simulation.motion = Motion::fixed(0.0, 86_401.0).unwrap();
    let mut none = Effects::<OnFirings>::default();
    let refused = simulation.run(&mut none, threads(1), &mut Taken::default());
    assert!(matches!(refused, Err(SimulateError::TooLong { .. })));
    simulation.motion = Motion::fixed(0.0, 1e-4).unwrap();
    simulation.polls = simulation.polls.map(|polls| Polls {
        period_ns: 0,
        ..polls
    });
    let refused = simulation.run(&mut none, threads(1), &mut Taken::default());
    assert!(matches!(refused, Err(SimulateError::Polls { .. })));
    // Shorter than a packet: nothing, and no complaint.
    simulation.polls = None;
    let (taken, summary) = run(&simulation, 5);
    assert_eq!((summary.packets, taken.times.len()), (0, 0));
}
