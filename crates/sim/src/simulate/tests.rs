use super::*;
use crate::effects::{OnFirings, RangeNoise};
use crate::head::Head;
use crate::motion::Sweeps;
use crate::scenes;
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
