//! The client with the simulated EPOS2 in virtual time; records everything on the wire.

use firmware_sim::epos2::SimulatedDriveConfig;
use protocol::epos2::message::SerialRequest;
use protocol::record::{Direction, DriveLink};
use units::{Degrees, Host, Rpm, RpmPerS, Span, Stamp};

use super::test_drive::{TestDrive, near_its_switch};
use crate::{
    AxisConfig, CommandOutcome, CommandProgress, DriveClient, DriveCommand, DriveError, DriveEvent,
    DriveListener, MoveCommand, Observation, ShaftSample, StopReport,
};

pub struct Rig {
    pub client: DriveClient,
    pub drive: TestDrive,
    pub now: Stamp<Host>,
    pub events: Vec<DriveEvent>,
    pub log: Vec<(Direction, Vec<u8>, Stamp<Host>)>,
}

impl Rig {
    pub fn new(config: AxisConfig) -> Self {
        Self::on(DriveLink::Usb, config)
    }

    pub fn on(link: DriveLink, config: AxisConfig) -> Self {
        Self::with(link, config, near_its_switch())
    }

    pub fn with(link: DriveLink, config: AxisConfig, drive: SimulatedDriveConfig) -> Self {
        let now = Stamp::from_nanos(1_795_000_000_000_000_000);
        Self {
            client: DriveClient::new(config, link),
            drive: TestDrive::new(link, drive, now),
            now,
            events: Vec::new(),
            log: Vec::new(),
        }
    }

    /// A connected and homed rig, without the record of that.
    pub fn homed() -> Self {
        Self::homed_on(DriveLink::Usb)
    }

    pub fn homed_on(link: DriveLink) -> Self {
        let mut rig = Self::on(link, AxisConfig::default());
        rig.run(DriveCommand::Connect).unwrap();
        rig.run(DriveCommand::Home).unwrap();
        rig.forget();
        rig
    }

    /// In mid-sweep to 45 degrees, after `span`.
    pub fn sweeping_on(link: DriveLink, span: Span) -> Self {
        let mut rig = Self::homed_on(link);
        rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
        assert_eq!(rig.run_for(span), None, "{link:?}");
        let moved = rig.drive.position(rig.now) + 40_000;
        assert!(moved > 5_000, "{link:?}: {moved}");
        rig.forget();
        rig
    }

    pub fn forget(&mut self) {
        self.drive.requests.clear();
        self.events.clear();
        self.log.clear();
    }

    /// Runs a command until it ends.
    pub fn run(&mut self, command: DriveCommand) -> Result<CommandOutcome, DriveError> {
        self.client.start(command)?;
        self.finish()
    }

    pub fn finish(&mut self) -> Result<CommandOutcome, DriveError> {
        let limit = self.now + Span::from_secs(120);
        while self.now < limit {
            if let Some(end) = self.step() {
                return end;
            }
        }
        panic!("the command does not end within 120 s: {:?}", self.client);
    }

    /// Runs for a span; `None` if the command has not ended.
    pub fn run_for(&mut self, span: Span) -> Option<Result<CommandOutcome, DriveError>> {
        let until = self.now + span;
        while self.now < until {
            if let Some(end) = self.step() {
                return Some(end);
            }
        }
        None
    }

    fn transmit(&mut self) {
        while let Some(frame) = self.client.poll_transmit(self.now) {
            self.drive.input(&frame, self.now);
            self.log.push((Direction::ToDrive, frame, self.now));
        }
    }

    /// Delays the host after it has sent everything pending.
    pub fn sleep(&mut self, span: Span) {
        self.transmit();
        self.now += span;
    }

    /// One iteration of the port owner's loop.
    pub fn step(&mut self) -> Option<Result<CommandOutcome, DriveError>> {
        self.transmit();
        while let Some(event) = self.client.poll_event() {
            self.events.push(event.clone());
            match event {
                DriveEvent::Done(outcome) => return Some(Ok(outcome)),
                DriveEvent::Failed(error) => return Some(Err(error)),
                DriveEvent::Sample(_) | DriveEvent::Progress(_) => {}
            }
        }
        let answer = self.drive.next_answer();
        let next = self
            .client
            .poll_timeout()
            .map_or(answer, |at| at.min(answer));
        // Virtual time always advances.
        self.now = next.max(self.now + Span::from_nanos(1));
        while let Some(bytes) = self.drive.take_answer(self.now) {
            self.client.handle_input(&bytes, self.now);
            self.log.push((Direction::FromDrive, bytes, self.now));
        }
        if self.client.poll_timeout().is_some_and(|t| t <= self.now) {
            self.client.handle_timeout(self.now);
        }
        None
    }

    /// When the drive received the first quick stop.
    pub fn quick_stop(&self) -> Option<Stamp<Host>> {
        let is_stop = |request: &SerialRequest| matches!(request, SerialRequest::WriteObject(w) if w.address.index == 0x6040 && w.value == 0x0B);
        let stop = self.drive.requests.iter().find(|(_, r)| is_stop(r));
        stop.map(|(at, _)| *at)
    }

    /// The client's report of the stopped axis.
    pub fn made_safe(&self) -> Option<StopReport> {
        self.progress().iter().find_map(|progress| match progress {
            CommandProgress::StoppedAfterFailure(stopped) => Some(*stopped),
            _ => None,
        })
    }

    pub fn samples(&self) -> Vec<ShaftSample> {
        self.events
            .iter()
            .filter_map(|event| match event {
                DriveEvent::Sample(sample) => Some(*sample),
                _ => None,
            })
            .collect()
    }

    pub fn progress(&self) -> Vec<CommandProgress> {
        self.events
            .iter()
            .filter_map(|event| match event {
                DriveEvent::Progress(progress) => Some(progress.clone()),
                _ => None,
            })
            .collect()
    }

    /// Writes that reached the drive: index, sub, value.
    pub fn writes(&self) -> Vec<(u16, u8, u32)> {
        self.drive
            .requests
            .iter()
            .filter_map(|(_, request)| match request {
                SerialRequest::WriteObject(w) => Some((w.address.index, w.address.sub, w.value)),
                _ => None,
            })
            .collect()
    }

    /// The listener's observations of the log.
    pub fn observations(&self) -> Vec<Observation> {
        let mut listener = DriveListener::new(1);
        let mut observed = Vec::new();
        for (direction, frame, host) in &self.log {
            let link = self.client.link();
            listener.observe(link, *direction, frame, *host, &mut |seen| {
                observed.push(seen);
            });
        }
        observed
    }
}

pub fn to(angle_deg: f64) -> MoveCommand {
    MoveCommand {
        to: Degrees(angle_deg),
        speed: Rpm(1125),
        acceleration: RpmPerS(10_000),
    }
}
