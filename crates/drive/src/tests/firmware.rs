//! The client with the simulated EPOS2 of firmware-sim, in virtual time. The two share only the
//! frames.

mod load;

use std::collections::VecDeque;

use firmware_sim::epos2::{BrakeState, Node, NodeConfig, Servo};
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::Address;
use protocol::epos2::{Bounded, CommError, DeviceError};
use protocol::record::DriveLink;
use units::{Host, Rpm, Span, Stamp};

use super::bursts::{DAMAGES, distorting};
use super::rig::to;
use super::unit::{Distortion, Server};
use crate::{
    AngleSource, AxisConfig, CommandOutcome, CommandProgress, DriveClient, DriveCommand,
    DriveError, DriveEvent, MoveCommand, MovePlan, PositionValidity, ShaftSample, StopReport,
};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];

/// One-way delay through wire, adapter and unit.
fn delay(link: DriveLink, bytes: usize) -> Span {
    match link {
        DriveLink::Usb => Span::from_micros(300),
        // 115,200 baud, 8N1.
        DriveLink::Rs232 => Span::from_micros(200 + 87 * bytes as i64),
        DriveLink::Can => Span::from_micros(160),
    }
}

pub(super) struct World {
    pub(super) client: DriveClient,
    pub(super) node: Node,
    server: Server,
    now: Stamp<Host>,
    next_tick: Stamp<Host>,
    to_node: VecDeque<(Stamp<Host>, Vec<u8>)>,
    to_host: VecDeque<(Stamp<Host>, Vec<u8>)>,
    events: Vec<DriveEvent>,
    /// When the client sent a quick stop.
    quick_stops: Vec<Stamp<Host>>,
    /// The cable is cut.
    pub(super) cut: bool,
    /// Transforms the unit's bytes on their way.
    distort: Distortion,
    /// Start of each control cycle, and the shaft's motion through it, world qc.
    truth: Vec<(Stamp<Host>, f64, f64)>,
}

impl World {
    fn new(config: NodeConfig) -> Self {
        Self::on(DriveLink::Usb, config)
    }

    pub(super) fn on(link: DriveLink, config: NodeConfig) -> Self {
        let now = Stamp::from_nanos(1_795_000_000_000_000_000);
        Self {
            client: DriveClient::new(AxisConfig::default(), link),
            node: Node::new(config),
            server: Server::new(link),
            now,
            next_tick: now + Span::from_micros(370),
            to_node: VecDeque::new(),
            to_host: VecDeque::new(),
            events: Vec::new(),
            quick_stops: Vec::new(),
            cut: false,
            distort: Box::new(|_, bytes| bytes),
            truth: Vec::new(),
        }
    }

    fn run(&mut self, command: DriveCommand) -> Result<CommandOutcome, DriveError> {
        self.client.start(command)?;
        self.finish()
    }

    fn finish(&mut self) -> Result<CommandOutcome, DriveError> {
        let limit = self.now + Span::from_secs(120);
        while self.now < limit {
            if let Some(end) = self.step() {
                return end;
            }
        }
        panic!("the command does not end within 120 s: {:?}", self.client);
    }

    pub(super) fn step(&mut self) -> Option<Result<CommandOutcome, DriveError>> {
        while let Some(frame) = self.client.poll_transmit(self.now) {
            if is_quick_stop(&frame) {
                self.quick_stops.push(self.now);
            }
            let delay = delay(self.client.link(), frame.len());
            let free = self.to_node.back().map_or(self.now, |m| m.0);
            if !self.cut {
                self.to_node
                    .push_back(((self.now + delay).max(free), frame));
            }
        }
        while let Some(event) = self.client.poll_event() {
            self.events.push(event.clone());
            match event {
                DriveEvent::Done(outcome) => return Some(Ok(outcome)),
                DriveEvent::Failed(error) => return Some(Err(error)),
                DriveEvent::Sample(_) | DriveEvent::Progress(_) => {}
            }
        }
        self.wait();
        None
    }

    fn run_for(&mut self, span: Span) {
        let until = self.now + span;
        while self.now < until {
            assert_eq!(self.step(), None);
        }
    }

    fn deliver(&mut self, replies: Vec<Vec<u8>>) {
        for bytes in replies {
            let delay = delay(self.client.link(), bytes.len());
            let free = self.to_host.back().map_or(self.now, |m| m.0);
            if !self.cut {
                self.to_host
                    .push_back(((self.now + delay).max(free), bytes));
            }
        }
    }

    /// Advances to the next event.
    fn wait(&mut self) {
        let to_node = self.to_node.front().map(|m| m.0);
        let to_host = self.to_host.front().map(|m| m.0);
        let next = [to_node, to_host, self.client.poll_timeout()];
        let next = next.into_iter().flatten().min().unwrap_or(self.next_tick);
        self.now = next.min(self.next_tick).max(self.now);
        if self.now == self.next_tick {
            self.node.tick();
            self.next_tick += Span::from_millis(1);
            let way = self.node.segment();
            let [start, end] = [way.start, way.end].map(|q32| q32 as f64 / 2f64.powi(32));
            self.truth.push((self.now, start, end));
            let replies = self.server.poll(&mut self.node);
            self.deliver(replies);
        }
        if let Some((_, frame)) = self.to_node.pop_front_if(|m| m.0 <= self.now) {
            let into = 1000 - (self.next_tick - self.now).as_nanos() / 1000;
            self.node.set_phase_us(into as u32);
            let replies = self.server.input(&mut self.node, &frame);
            self.deliver(replies);
        }
        if let Some((_, bytes)) = self.to_host.pop_front_if(|m| m.0 <= self.now) {
            let bytes = (self.distort)(self.now, bytes);
            self.client.handle_input(&bytes, self.now);
        }
        if self.client.poll_timeout().is_some_and(|t| t <= self.now) {
            self.client.handle_timeout(self.now);
        }
    }

    /// A world in mid-sweep.
    fn moving_on(link: DriveLink) -> Self {
        let mut world = Self::homed_on(link);
        world.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
        world.run_for(Span::from_millis(1_000));
        world.quick_stops.clear();
        world
    }

    fn homed_on(link: DriveLink) -> Self {
        let mut world = Self::on(link, NodeConfig::default());
        world.run(DriveCommand::Connect).unwrap();
        world.run(DriveCommand::Home).unwrap();
        world.events.clear();
        world
    }

    /// The client's report of the stopped axis.
    fn made_safe(&self) -> Option<StopReport> {
        self.events.iter().find_map(|event| match event {
            DriveEvent::Progress(CommandProgress::MadeSafe(stopped)) => Some(*stopped),
            _ => None,
        })
    }

    fn homed() -> Self {
        Self::homed_on(DriveLink::Usb)
    }

    fn samples(&self) -> Vec<ShaftSample> {
        self.events
            .iter()
            .filter_map(|event| match event {
                DriveEvent::Sample(sample) => Some(*sample),
                _ => None,
            })
            .collect()
    }

    /// World position at an instant.
    fn world_qc(&self, at: Stamp<Host>) -> f64 {
        let after = self.truth.partition_point(|t| t.0 <= at);
        let (t0, p0, p1) = self.truth[after - 1];
        p0 + (p1 - p0) * (at - t0).as_secs_f64() / 1e-3
    }
}

/// Whether bytes contain a quick stop: controlword (6040) 000B in a frame of USB or CAN, or in a
/// body of RS232.
fn is_quick_stop(bytes: &[u8]) -> bool {
    let has = |wanted: &[u8]| bytes.windows(wanted.len()).any(|w| w == wanted);
    has(&[0x40, 0x60, 0, 1, 0x0B, 0]) || has(&[0x2B, 0x40, 0x60, 0, 0x0B, 0])
}

fn from_home(world: &World, angle_deg: f64) -> MovePlan {
    let axis = world.client.config();
    let home = axis.gearing.position(axis.homing.home_position).unwrap();
    axis.plan_move(home, axis.validate(to(angle_deg)).unwrap())
}

/// A complete capture, from power-on to the brake.
#[test]
fn connect_home_sweep_and_brake_succeed() {
    let mut world = World::new(NodeConfig::default());
    assert_eq!(world.node.state(), DeviceState::Fault);
    let Ok(CommandOutcome::Connected(connected)) = world.run(DriveCommand::Connect) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!(connected.history.first(), Some(&DeviceError::CAN_PASSIVE));
    assert_eq!(connected.identity.serial, 1);
    assert_eq!(world.node.brake(), BrakeState::Closed);
    let Ok(CommandOutcome::Homed { angle, .. }) = world.run(DriveCommand::Home) else {
        panic!("{:?}", world.events.last())
    };
    assert!((angle.0 + 60.0).abs() < 0.01, "{angle:?}");
    assert_eq!(world.node.brake(), BrakeState::Open);
    world.events.clear();
    let Ok(CommandOutcome::Arrived(arrived)) = world.run(DriveCommand::Sweep(to(-15.0))) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!(arrived.position.0, -10_000);
    assert_eq!(arrived.plan.duration, from_home(&world, -15.0).duration);
    let took = (arrived.arrived - arrived.started).as_secs_f64();
    let planned = arrived.plan.duration.as_secs_f64();
    assert!(
        (took - planned).abs() < 0.03,
        "{took} s, planned {planned} s"
    );
    let Ok(CommandOutcome::Stopped(stopped)) = world.run(DriveCommand::Brake) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!((stopped.position.0, stopped.fault), (-10_000, false));
    assert_eq!(world.node.brake(), BrakeState::Closed);
    assert_eq!(world.client.link_stats().lost, 0);
    assert_eq!(world.client.link_stats().unmatched, 0);
}

#[test]
fn samples_are_shaft_positions_between_their_stamps() {
    for link in LINKS {
        let mut world = World::homed_on(link);
        world.run(DriveCommand::Sweep(to(45.0))).unwrap();
        let samples = world.samples();
        let least = match link {
            DriveLink::Usb => 1_800,
            DriveLink::Rs232 => 300,
            DriveLink::Can => 1_900,
        };
        assert!(samples.len() > least, "{link:?}: {}", samples.len());
        // Drive zero and world zero differ by a constant of whole counts.
        let origin = {
            let first = samples[0];
            world.world_qc(first.request).floor() - f64::from(first.position.0)
        };
        for s in &samples {
            let [before, after] = [s.request, s.answer].map(|at| world.world_qc(at) - origin);
            let got = f64::from(s.position.0);
            assert!(
                before.floor() <= got && got <= after + 0.01,
                "{link:?}: {before} {got} {after} at {:?}",
                s.request
            );
        }
    }
}

#[test]
fn slow_and_short_moves_arrive() {
    let mut world = World::homed();
    for (to_deg, rpm) in [(-59.9, 1), (-59.9, 1), (-59.8985, 1500), (-30.0, 1500)] {
        let command = DriveCommand::Goto(MoveCommand {
            speed: Rpm(rpm),
            ..to(to_deg)
        });
        let Ok(CommandOutcome::Arrived(arrived)) = world.run(command) else {
            panic!("{to_deg} at {rpm}: {:?}", world.events.last())
        };
        assert!((arrived.angle.0 - to_deg).abs() < 0.002, "{arrived:?}");
    }
}

#[test]
fn stop_in_mid_sweep_keeps_the_position() {
    let mut world = World::homed();
    world.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    let until = world.now + Span::from_millis(800);
    while world.now < until {
        assert_eq!(world.step(), None);
    }
    world.client.start(DriveCommand::Stop).unwrap();
    let start = world.now;
    let Ok(CommandOutcome::Stopped(stopped)) = world.finish() else {
        panic!("{:?}", world.events.last())
    };
    assert!(stopped.angle.is_some());
    assert_eq!(world.node.brake(), BrakeState::Closed);
    // 1125 rpm at 20,000 rpm/s take 56 ms to stop; then 50 ms of standstill, the brake, and some
    // round trips.
    assert!(world.now - start < Span::from_millis(200));
    // The axis can move on.
    assert!(world.run(DriveCommand::Goto(to(0.0))).is_ok());
}

#[test]
fn a_limit_switch_in_mid_sweep_is_named() {
    for link in LINKS {
        // The positive switch has slipped to 20 deg.
        let mut config = NodeConfig::default();
        if let Some(switch) = &mut config.switches[1] {
            switch.pressed = firmware_sim::epos2::Region::AtLeast(13_333);
        }
        let mut world = World::on(link, config);
        world.run(DriveCommand::Connect).unwrap();
        world.run(DriveCommand::Home).unwrap();
        let error = world.run(DriveCommand::Sweep(to(45.0))).unwrap_err();
        assert_eq!(
            error,
            DriveError::Fault {
                error: Some(DeviceError::POSITIVE_LIMIT)
            },
            "{link:?}"
        );
        assert!(error.to_string().contains("FF07"), "{error}");
        let stopped = world.made_safe().unwrap();
        assert_eq!(stopped.validity, PositionValidity::Valid, "{link:?}");
        let Ok(CommandOutcome::FaultsCleared(found)) = world.run(DriveCommand::ClearFaults) else {
            panic!("{:?}", world.events.last())
        };
        assert_eq!(found.first(), Some(&DeviceError::POSITIVE_LIMIT));
        assert!(
            world.run(DriveCommand::Goto(to(0.0))).is_ok(),
            "{link:?}: the axis can leave the switch"
        );
    }
}

#[test]
fn a_restart_in_mid_sweep_is_detected() {
    for link in LINKS {
        let mut world = World::moving_on(link);
        world.node.power_cycle();
        world.server = Server::new(link);
        let error = world.finish().unwrap_err();
        assert!(
            matches!(error, DriveError::Restarted { .. }),
            "{link:?}: {error}"
        );
        let stopped = world.made_safe().unwrap();
        assert_eq!(stopped.validity, PositionValidity::Lost { error: None });
        // The drive has lost its limits: it must be connected before it moves.
        assert!(matches!(
            world.run(DriveCommand::Goto(to(0.0))),
            Err(DriveError::Restarted { .. })
        ));
    }
}

#[test]
fn connect_home_sweep_and_brake_succeed_on_each_link() {
    for link in LINKS {
        let mut world = World::on(link, NodeConfig::default());
        let Ok(CommandOutcome::Connected(connected)) = world.run(DriveCommand::Connect) else {
            panic!("{link:?}: {:?}", world.events.last())
        };
        assert_eq!(connected.identity.name.as_str(), "EPOS2", "{link:?}");
        assert_eq!(connected.monitors_host, link == DriveLink::Can);
        let streams = connected.angle == AngleSource::Stream;
        assert_eq!(streams, link == DriveLink::Can);
        world.run(DriveCommand::Home).unwrap();
        let Ok(CommandOutcome::Arrived(arrived)) = world.run(DriveCommand::Sweep(to(-15.0))) else {
            panic!("{link:?}: {:?}", world.events.last())
        };
        assert_eq!(arrived.position.0, -10_000);
        let Ok(CommandOutcome::Stopped(stopped)) = world.run(DriveCommand::Brake) else {
            panic!("{link:?}: {:?}", world.events.last())
        };
        assert_eq!(
            (stopped.validity, stopped.fault),
            (PositionValidity::Valid, false)
        );
        let stats = world.client.link_stats();
        assert_eq!((stats.lost, stats.unmatched), (0, 0), "{link:?}");
    }
}

/// Time from the fault to the client's quick stop, although the drive reacts on its own.
#[test]
fn faults_in_mid_sweep_are_named_and_handled_within_100_ms() {
    for link in LINKS {
        for error in [
            DeviceError::FOLLOWING,
            DeviceError::OVERCURRENT,
            DeviceError::POSITIVE_LIMIT,
            DeviceError::POSITION_SENSOR,
        ] {
            let mut world = World::moving_on(link);
            let at = world.now;
            world.node.inject(error);
            assert_eq!(
                world.finish(),
                Err(DriveError::Fault { error: Some(error) }),
                "{link:?}"
            );
            let reaction = world.quick_stops[0] - at;
            assert!(reaction < Span::from_millis(100), "{link:?}: {reaction:?}");
            if link == DriveLink::Can {
                assert!(reaction < Span::from_millis(5), "{reaction:?}");
            }
            let lost = error == DeviceError::POSITION_SENSOR;
            let stopped = world.made_safe().unwrap();
            assert!(stopped.fault);
            assert_eq!(
                matches!(stopped.validity, PositionValidity::Lost { .. }),
                lost
            );
        }
    }
}

#[test]
fn a_blocked_motor_is_a_following_error() {
    for link in LINKS {
        let mut world = World::moving_on(link);
        world.node.block();
        let error = Some(DeviceError::FOLLOWING);
        assert_eq!(world.finish(), Err(DriveError::Fault { error }), "{link:?}");
        assert_eq!(world.made_safe().unwrap().validity, PositionValidity::Valid);
        // The axis can move on once it is free.
        world.node.unblock();
        world.run(DriveCommand::ClearFaults).unwrap();
        assert!(world.run(DriveCommand::Goto(to(0.0))).is_ok(), "{link:?}");
    }
}

#[test]
fn a_cut_cable_in_mid_sweep_is_reported_and_stops_the_axis_on_can() {
    for link in LINKS {
        let mut world = World::moving_on(link);
        let at = world.now;
        world.cut = true;
        world.to_host.clear();
        let error = world.finish().unwrap_err();
        assert!(matches!(error, DriveError::NotStopped { .. }), "{error}");
        let replies = world.now - world.quick_stops.first().copied().unwrap_or(world.now);
        // Quick stop, its ramp, and power off, each without a reply.
        assert!(replies < Span::from_millis(240), "{link:?}: {replies:?}");
        assert!(world.now - at < Span::from_millis(1_900), "{link:?}");
        if link == DriveLink::Can {
            while world.now - at < Span::from_millis(600) {
                world.now = world.next_tick;
                world.wait();
            }
            assert_eq!(world.node.state(), DeviceState::Fault);
            let way = world.node.segment();
            assert_eq!(way.start, way.end, "the axis is at rest");
        }
    }
}

/// The unit receives, but all its replies are damaged.
#[test]
fn an_axis_whose_answers_are_all_damaged_is_stopped() {
    for link in [DriveLink::Usb, DriveLink::Rs232] {
        for damage in DAMAGES {
            let mut world = World::moving_on(link);
            let from = world.now;
            world.distort = distorting(damage, from, from + Span::from_secs(100));
            let error = world.finish().unwrap_err();
            assert!(matches!(error, DriveError::NotStopped { .. }), "{error}");
            let way = world.node.segment();
            assert_eq!(way.start, way.end, "{link:?} {damage:?}: {error}");
        }
    }
}

/// The simulated EPOS2 has no writable object of that length, but it takes the whole transfer
/// before it aborts.
#[test]
fn long_objects_of_the_software_drive_are_readable_and_refuse_writes() {
    for link in LINKS {
        let mut world = World::on(link, NodeConfig::default());
        world.run(DriveCommand::Connect).unwrap();
        let mut read = |index, sub| match world.run(DriveCommand::Read(Address::new(index, sub))) {
            Ok(CommandOutcome::Read { bytes, .. }) => bytes,
            other => panic!("{link:?}: {other:?}"),
        };
        assert_eq!(read(0x1008, 0), b"EPOS2");
        assert_eq!(
            read(0x2004, 0).len(),
            8,
            "{link:?}: a serial number of 64 bits"
        );
        assert_eq!(read(0x6041, 0).len(), 2);
        assert_eq!(read(0x6065, 0), 2_000_u32.to_le_bytes());
        for (index, len, expected) in [
            (0x20C1, 8, CommError::STATE),
            (0x20C1, 9, CommError::TOO_LONG),
            (0x20C1, 7, CommError::TOO_SHORT),
            (0x2004, 8, CommError::READ_ONLY),
            (0x5000, 8, CommError::NO_OBJECT),
        ] {
            let bytes = Bounded::from_slice(&vec![0x90; len]).unwrap();
            let address = Address::new(index, 0);
            let error = world
                .run(DriveCommand::Write { address, bytes })
                .unwrap_err();
            assert!(
                matches!(error, DriveError::Refused { error, .. } if error == expected),
                "{link:?}: {error}"
            );
        }
        let bytes = Bounded::from_slice(&1_500_u32.to_le_bytes()).unwrap();
        let address = Address::new(0x6065, 0);
        world.run(DriveCommand::Write { address, bytes }).unwrap();
        let Ok(CommandOutcome::Read { bytes, .. }) = world.run(DriveCommand::Read(address)) else {
            panic!("{link:?}")
        };
        assert_eq!(bytes, 1_500_u32.to_le_bytes());
        let stats = world.client.link_stats();
        assert_eq!((stats.lost, stats.unmatched), (0, 0), "{link:?}");
    }
}

/// A lagging servo arrives some hundredths of a second after its demand, at the end of the axis:
/// too late for an immediate check.
#[test]
fn a_lagging_servo_homes_and_arrives() {
    for (natural_millihertz, damping_permille) in [(15_000, 700), (15_000, 1_000), (8_000, 1_000)] {
        for link in LINKS {
            let servo = Servo::SecondOrder {
                natural_millihertz,
                damping_permille,
            };
            let config = NodeConfig {
                servo: Some(servo),
                ..NodeConfig::default()
            };
            let mut world = World::on(link, config);
            world.run(DriveCommand::Connect).unwrap();
            let homed = world.run(DriveCommand::Home);
            let Ok(CommandOutcome::Homed { angle, .. }) = homed else {
                panic!("{servo:?} {link:?}: {homed:?}")
            };
            // Within the limits and the arrival tolerance.
            assert!(angle.0 > -60.031, "{servo:?} {link:?}: {angle:?}");
            let swept = world.run(DriveCommand::Sweep(to(-15.0)));
            let Ok(CommandOutcome::Arrived(arrived)) = swept else {
                panic!("{servo:?} {link:?}: {swept:?}")
            };
            assert!(arrived.position.0.abs_diff(-10_000) <= 20);
            let slept = world.run(DriveCommand::Brake).unwrap();
            let CommandOutcome::Stopped(stopped) = slept else {
                panic!("{slept:?}")
            };
            assert!(!stopped.fault && stopped.position.0.abs_diff(-10_000) <= 1);
            assert_eq!(world.node.brake(), BrakeState::Closed);
        }
    }
}
