//! The client against the software EPOS2 of firmware-sim, in virtual time: two machines that share nothing but the frames.

use firmware_sim::epos2::{Brake, Node, NodeConfig, UsbServer};
use protocol::epos2::DeviceError;
use protocol::epos2::cia402::State;
use units::{Host, Rpm, Span, Stamp};

use super::rig::to;
use crate::{AxisConfig, Client, Command, DriveError, Event, Move, Outcome, Plan, ShaftSample};

/// Wire and USB one way.
const DELAY: Span = Span::from_micros(300);

struct World {
    client: Client,
    node: Node,
    server: UsbServer,
    now: Stamp<Host>,
    next_tick: Stamp<Host>,
    to_node: Option<(Stamp<Host>, Vec<u8>)>,
    to_host: Option<(Stamp<Host>, Vec<u8>)>,
    events: Vec<Event>,
    /// Beginning of each control cycle, and the shaft's way through it, world qc.
    truth: Vec<(Stamp<Host>, f64, f64)>,
}

impl World {
    fn new(config: NodeConfig) -> Self {
        let now = Stamp::from_nanos(1_795_000_000_000_000_000);
        Self {
            client: Client::new(AxisConfig::default()),
            node: Node::new(config),
            server: UsbServer::new(7),
            now,
            next_tick: now + Span::from_micros(370),
            to_node: None,
            to_host: None,
            events: Vec::new(),
            truth: Vec::new(),
        }
    }

    fn run(&mut self, command: Command) -> Result<Outcome, DriveError> {
        self.client.start(command)?;
        self.finish()
    }

    fn finish(&mut self) -> Result<Outcome, DriveError> {
        let limit = self.now + Span::from_secs(120);
        while self.now < limit {
            if let Some(end) = self.step() {
                return end;
            }
        }
        panic!("no end after 120 s: {:?}", self.client);
    }

    fn step(&mut self) -> Option<Result<Outcome, DriveError>> {
        if let Some(frame) = self.client.poll_transmit(self.now) {
            assert!(self.to_node.is_none(), "one request at a time");
            self.to_node = Some((self.now + DELAY, frame));
        }
        while let Some(event) = self.client.poll_event() {
            self.events.push(event.clone());
            match event {
                Event::Done(outcome) => return Some(Ok(outcome)),
                Event::Failed(error) => return Some(Err(error)),
                Event::Sample(_) | Event::Progress(_) => {}
            }
        }
        self.wait();
        None
    }

    /// On to the next thing that happens.
    fn wait(&mut self) {
        let to_node = self.to_node.as_ref().map(|m| m.0);
        let to_host = self.to_host.as_ref().map(|m| m.0);
        let next = [to_node, to_host, self.client.poll_timeout()];
        let next = next.into_iter().flatten().min().unwrap_or(self.next_tick);
        self.now = next.min(self.next_tick).max(self.now);
        if self.now == self.next_tick {
            self.node.tick();
            self.next_tick += Span::from_millis(1);
            let way = self.node.segment();
            let [start, end] = [way.start, way.end].map(|q32| q32 as f64 / 2f64.powi(32));
            self.truth.push((self.now, start, end));
        }
        if let Some((_, frame)) = self.to_node.take_if(|m| m.0 <= self.now) {
            let into = 1000 - (self.next_tick - self.now).as_nanos() / 1000;
            self.node.set_phase_us(into as u32);
            let mut answer = Vec::new();
            let out = &mut |bytes: &[u8]| answer.extend_from_slice(bytes);
            self.server.input(&mut self.node, &frame, out);
            self.to_host = Some((self.now + DELAY, answer));
        }
        if let Some((_, bytes)) = self.to_host.take_if(|m| m.0 <= self.now) {
            self.client.handle_input(&bytes, self.now);
        }
        if self.client.poll_timeout().is_some_and(|t| t <= self.now) {
            self.client.handle_timeout(self.now);
        }
    }

    fn homed() -> Self {
        let mut world = Self::new(NodeConfig::default());
        world.run(Command::Connect).unwrap();
        world.run(Command::Home).unwrap();
        world.events.clear();
        world
    }

    fn samples(&self) -> Vec<ShaftSample> {
        self.events
            .iter()
            .filter_map(|event| match event {
                Event::Sample(sample) => Some(*sample),
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

fn from_home(world: &World, angle_deg: f64) -> Plan {
    let axis = world.client.config();
    let home = axis.gearing.position(axis.homing.home_position).unwrap();
    let aim = to(angle_deg);
    let target = axis.gearing.position(aim.to).unwrap();
    axis.plan_move(home, target, aim.speed, aim.acceleration)
        .unwrap()
}

/// The whole story of a capture, from power-on to the brake.
#[test]
fn connect_home_sweep_brake() {
    let mut world = World::new(NodeConfig::default());
    assert_eq!(world.node.state(), State::Fault);
    let Ok(Outcome::Connected(connected)) = world.run(Command::Connect) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!(connected.history.first(), Some(&DeviceError::CAN_PASSIVE));
    assert_eq!(connected.identity.serial, 1);
    assert_eq!(world.node.brake(), Brake::Closed);
    let Ok(Outcome::Homed { angle, .. }) = world.run(Command::Home) else {
        panic!("{:?}", world.events.last())
    };
    assert!((angle.0 + 60.0).abs() < 0.01, "{angle:?}");
    assert_eq!(world.node.brake(), Brake::Open);
    world.events.clear();
    let Ok(Outcome::Arrived(arrived)) = world.run(Command::Sweep(to(-15.0))) else {
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
    let Ok(Outcome::Stopped(stopped)) = world.run(Command::Brake) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!((stopped.position.0, stopped.fault), (-10_000, false));
    assert_eq!(world.node.brake(), Brake::Closed);
    assert_eq!(world.client.link_stats().lost, 0);
    assert_eq!(world.client.link_stats().strays, 0);
}

#[test]
fn samples_are_the_shaft_at_a_time_between_their_stamps() {
    let mut world = World::homed();
    world.run(Command::Sweep(to(45.0))).unwrap();
    let samples = world.samples();
    assert!(samples.len() > 1_800, "{}", samples.len());
    // Drive zero and world zero differ by a constant of whole counts.
    let origin = {
        let first = samples[0];
        world.world_qc(first.request + DELAY).floor() - f64::from(first.position.0)
    };
    for s in &samples {
        let truth = world.world_qc(s.request + DELAY) - origin;
        let off = truth - f64::from(s.position.0);
        assert!((-0.01..1.01).contains(&off), "{off} qc at {:?}", s.request);
    }
}

#[test]
fn slow_and_short_moves_arrive() {
    let mut world = World::homed();
    for (to_deg, rpm) in [(-59.9, 1), (-59.9, 1), (-59.8985, 1500), (-30.0, 1500)] {
        let command = Command::Goto(Move {
            speed: Rpm(rpm),
            ..to(to_deg)
        });
        let Ok(Outcome::Arrived(arrived)) = world.run(command) else {
            panic!("{to_deg} at {rpm}: {:?}", world.events.last())
        };
        assert!((arrived.angle.0 - to_deg).abs() < 0.002, "{arrived:?}");
    }
}

#[test]
fn stop_in_mid_sweep_keeps_the_position() {
    let mut world = World::homed();
    world.client.start(Command::Sweep(to(45.0))).unwrap();
    let until = world.now + Span::from_millis(800);
    while world.now < until {
        assert_eq!(world.step(), None);
    }
    world.client.start(Command::Stop).unwrap();
    let asked = world.now;
    let Ok(Outcome::Stopped(stopped)) = world.finish() else {
        panic!("{:?}", world.events.last())
    };
    assert!(stopped.angle.is_some());
    assert_eq!(world.node.brake(), Brake::Closed);
    // 1125 rpm at 20,000 rpm/s take 56 ms to stop; then 50 ms of standstill, the brake, and some round trips.
    assert!(world.now - asked < Span::from_millis(200));
    // And it goes on from there.
    assert!(world.run(Command::Goto(to(0.0))).is_ok());
}

#[test]
fn a_limit_switch_in_mid_sweep_is_named() {
    // The positive switch has slipped to 20 deg.
    let mut config = NodeConfig::default();
    if let Some(switch) = &mut config.switches[1] {
        switch.pressed = firmware_sim::epos2::Region::AtLeast(13_333);
    }
    let mut world = World::new(config);
    world.run(Command::Connect).unwrap();
    world.run(Command::Home).unwrap();
    let error = world.run(Command::Sweep(to(45.0))).unwrap_err();
    assert_eq!(
        error,
        DriveError::Fault {
            error: Some(DeviceError::POSITIVE_LIMIT)
        }
    );
    assert!(error.to_string().contains("FF07"), "{error}");
    let Ok(Outcome::FaultsCleared(found)) = world.run(Command::ClearFaults) else {
        panic!("{:?}", world.events.last())
    };
    assert_eq!(found.first(), Some(&DeviceError::POSITIVE_LIMIT));
    assert!(
        world.run(Command::Goto(to(0.0))).is_ok(),
        "it can leave the switch"
    );
}

#[test]
fn a_reset_in_mid_sweep_is_noticed() {
    let mut world = World::homed();
    world.client.start(Command::Sweep(to(45.0))).unwrap();
    let until = world.now + Span::from_millis(800);
    while world.now < until {
        assert_eq!(world.step(), None);
    }
    world.node.power_cycle();
    let error = world.finish().unwrap_err();
    assert!(
        matches!(error, DriveError::Fault { .. } | DriveError::State { .. }),
        "{error}"
    );
    // It has forgotten its limits: no move before it is connected again.
    assert!(matches!(
        world.run(Command::Goto(to(0.0))),
        Err(DriveError::NotTaken { .. })
    ));
}
