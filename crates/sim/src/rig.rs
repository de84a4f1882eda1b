//! Both devices of the scanner in one virtual world, the drive with its firmware.
//!
//! Host time is true time. Each control cycle of the drive (1 ms) fixes the motion of the shaft
//! until the next. A lidar packet is made when its last firing ends, by the same
//! [`packet_maker`](crate::packet_maker) as in [`crate::simulate`]. The output depends on the
//! configuration and on the input bytes and their times, not on the steps of [`Rig::advance`].
//! Delays of the transports are not included.

mod attachment;
mod shaft;
mod truth;

use std::collections::VecDeque;
use std::sync::Arc;

use firmware_sim::epos2::{SimulatedDrive, SimulatedDriveConfig};
use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT, firing_blocks};
use units::{Degrees, Gearing, Host, Span, Stamp};

use crate::effects::{ClockEffect, FiringEffectSet};
use crate::firing::Surroundings;
use crate::gear_ripple::GearRipple;
use crate::lidar_clock::LidarClock;
use crate::packet_maker::{HeadRotation, PacketMaker, SimulatedLidar};
use crate::scene::Scene;
use crate::sensor::{LidarMount, LidarSensor, ReturnMode};
use shaft::{CYCLE, ShaftCourse};

pub use attachment::{Attachment, DriveServer};
pub use truth::Truth;

/// Configuration of the virtual world.
#[derive(Clone, Debug)]
pub struct RigConfig {
    /// The scene of the lidar's beams.
    pub scene: Arc<Scene>,
    /// Mounting of the lidar on the platform.
    pub mount: LidarMount,
    /// The drive.
    pub drive: SimulatedDriveConfig,
    /// The interface between host and drive.
    pub attached: Attachment,
    /// From motor shaft to platform; tilt 0 (level) is position 0 of the shaft.
    pub gearing: Gearing,
    /// Ripple of the gear.
    pub ripple: Option<GearRipple>,
    /// The lidar.
    pub lidar: RigLidar,
    /// Host time at which both devices are switched on.
    pub start: Stamp<Host>,
    /// Seed of everything that the devices leave undefined.
    pub seed: u64,
}

/// Configuration of the rig's lidar.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RigLidar {
    /// Revolutions per minute in the lidar's own time (300..=1200 on the real one).
    pub rpm: u32,
    /// Azimuth of the first firing.
    pub azimuth_at_start: Degrees,
    /// The lidar's clock at the start, microseconds past the hour.
    pub clock_at_start_us: u32,
    /// Drift of the lidar's clock against the host's, parts per million; positive is fast.
    pub drift_ppm: f64,
}

impl Default for RigLidar {
    /// 600 rpm (10 Hz), 20 minutes past the hour, 12 ppm fast.
    fn default() -> Self {
        Self {
            rpm: 600,
            azimuth_at_start: Degrees(0.0),
            clock_at_start_us: 1_234_567_890,
            drift_ppm: 12.0,
        }
    }
}

impl RigConfig {
    /// The paper's scanner in the hall: lidar 0.06 m above the axis, 500-line encoder, gear of
    /// 120:1, 10 Hz.
    #[must_use]
    pub fn new(start: Stamp<Host>) -> Self {
        Self {
            scene: Arc::new(Scene::hall()),
            mount: LidarMount::above(0.06),
            drive: SimulatedDriveConfig::default(),
            attached: Attachment::Usb,
            gearing: GEARING,
            ripple: None,
            lidar: RigLidar::default(),
            start,
            seed: 0,
        }
    }
}

/// 500 lines, 120:1: 0.0015 deg per quadcount.
const GEARING: Gearing = match Gearing::new(500, 120, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

/// A UDP datagram of the lidar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Datagram {
    /// Time at which it left the lidar.
    pub at: Stamp<Host>,
    /// The destination port: [`DATA_PORT`] or [`POSITION_PORT`].
    pub port: u16,
    /// The UDP payload.
    pub payload: Vec<u8>,
}

/// Bytes from the drive: a frame, a handshake or a line of its adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DriveOutput {
    /// Time at which they left the drive.
    pub at: Stamp<Host>,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// The effects of the rig: the lidar's clock alone.
type RigEffects = FiringEffectSet<(), (), (), (), LidarClock>;

/// The two devices and the world around them.
///
/// The caller calls [`Rig::advance`] with the time, passes on the host's bytes and takes the
/// devices' bytes. Datagrams and answers are kept until they are taken.
#[derive(Debug)]
pub struct Rig {
    lidar: SimulatedLidar,
    surroundings: Surroundings,
    maker: PacketMaker<RigEffects>,
    /// Data packets so far.
    packets: u64,
    shaft: ShaftCourse,
    node: SimulatedDrive,
    server: DriveServer,
    now: Stamp<Host>,
    datagrams: VecDeque<Datagram>,
    sent: VecDeque<DriveOutput>,
}

impl Rig {
    /// Both devices at the moment of being switched on.
    #[must_use]
    pub fn new(config: RigConfig) -> Self {
        let RigConfig { start, lidar, .. } = config;
        let clock = LidarClock::new(start, lidar.clock_at_start_us, lidar.drift_ppm);
        let lidar = SimulatedLidar::new(
            LidarSensor::vlp16(),
            ReturnMode::Strongest,
            HeadRotation {
                rpm: lidar.rpm,
                start_deg: lidar.azimuth_at_start.0,
            },
            config.mount,
            start,
            clock.clone(),
        );
        let surroundings = Surroundings::new(config.scene, lidar.sensor.range(), true);
        let effects = FiringEffectSet {
            objects: (),
            view: (),
            beam: (),
            surface: (),
            clock,
        };
        let node = SimulatedDrive::new(config.drive);
        let mut rig = Self {
            maker: PacketMaker::new(&lidar, effects, surroundings.clone()),
            lidar,
            surroundings,
            packets: 0,
            shaft: ShaftCourse::new(config.gearing, node.segment().start, config.ripple),
            node,
            server: DriveServer::new(config.attached, config.seed),
            now: start,
            datagrams: VecDeque::new(),
            sent: VecDeque::new(),
        };
        // The first control cycle begins at the start.
        rig.cycle();
        rig
    }

    /// Advances the time to `to`. A time in the past changes nothing.
    pub fn advance(&mut self, to: Stamp<Host>) {
        loop {
            let (cycle, packet) = (self.cycle_end(), self.next_packet());
            // The drive first: a packet needs the shaft's motion up to its end.
            if cycle.min(packet) > to {
                break;
            } else if cycle <= packet {
                self.now = cycle;
                self.cycle();
            } else {
                self.now = packet;
                self.send_packets();
            }
        }
        self.now = self.now.max(to);
    }

    /// Passes bytes from the host to the drive, whole frames or not; they arrive now.
    ///
    /// The drive reads its encoder now and acts from its next control cycle on.
    pub fn drive_input(&mut self, bytes: &[u8]) {
        let cycle_began = self.cycle_end() - CYCLE;
        let phase_us = self.now.saturating_since(cycle_began).as_nanos() / 1_000;
        // Between two cycles, so below 1000.
        self.node
            .set_phase_us(u32::try_from(phase_us).unwrap_or_default());
        let (at, sent) = (self.now, &mut self.sent);
        let mut send = |bytes: &[u8]| {
            sent.push_back(DriveOutput {
                at,
                bytes: bytes.to_vec(),
            })
        };
        self.server.input(&mut self.node, bytes, &mut send);
    }

    /// The next bytes from the drive, if any: answers, and on a CAN bus unsolicited frames.
    pub fn drive_output(&mut self) -> Option<DriveOutput> {
        self.sent.pop_front()
    }

    /// The next datagram from the lidar, if any.
    pub fn poll_datagram(&mut self) -> Option<Datagram> {
        self.datagrams.pop_front()
    }

    /// The time before which the devices send nothing unsolicited; now if output is waiting.
    #[must_use]
    pub fn next_event(&self) -> Stamp<Host> {
        if self.datagrams.is_empty() && self.sent.is_empty() {
            self.next_packet()
        } else {
            self.now
        }
    }

    /// The drive, for faults that no client can cause: a blocked motor, a power cut, an error.
    pub const fn drive_mut(&mut self) -> &mut SimulatedDrive {
        &mut self.node
    }

    /// The current time.
    #[must_use]
    pub const fn now(&self) -> Stamp<Host> {
        self.now
    }

    /// Drops the shaft's motion before `host`, so that a run of days needs bounded memory; the
    /// truth begins there. The last second is kept, because packets need it.
    pub fn forget_before(&mut self, host: Stamp<Host>) {
        let last_second = self.now.saturating_add(-Span::from_secs(1));
        let since = host.min(last_second).saturating_since(self.lidar.start);
        self.shaft.forget_before(since.as_nanos());
    }

    /// The ground truth so far.
    #[must_use]
    pub fn truth(&self) -> Truth {
        Truth::new(
            self.lidar.clone(),
            self.surroundings.clone(),
            self.shaft.clone(),
        )
    }

    /// End of the current control cycle.
    fn cycle_end(&self) -> Stamp<Host> {
        let since = Span::from_nanos(self.shaft.end_ns());
        self.lidar.start.saturating_add(since)
    }

    /// Time at which the next data packet leaves.
    fn next_packet(&self) -> Stamp<Host> {
        let firings = (self.packets + 1).saturating_mul(self.maker.firings() as u64);
        let since_ns = self.lidar.clock.host_ns(self.lidar.device_ns(firings));
        (self.lidar.start).saturating_add(Span::from_nanos(since_ns))
    }

    /// Runs a control cycle of the drive, which fixes the motion of the coming millisecond.
    fn cycle(&mut self) {
        self.node.tick();
        self.shaft.push(self.node.segment().end);
        let (at, sent) = (self.now, &mut self.sent);
        let mut send = |bytes: &[u8]| {
            sent.push_back(DriveOutput {
                at,
                bytes: bytes.to_vec(),
            })
        };
        self.server.poll(&mut self.node, &mut send);
    }

    fn send_packets(&mut self) {
        let per_packet = firing_blocks(self.lidar.returns) as u64;
        let first = self.packets.saturating_mul(per_packet);
        let blocks = first..first.saturating_add(per_packet);
        let packet = self.maker.packet(&self.lidar, &self.shaft, blocks, None);
        self.packets += 1;
        let at = self.now;
        let mut send = |port, payload: &[u8]| {
            let payload = payload.to_vec();
            (self.datagrams).push_back(Datagram { at, port, payload });
        };
        send(DATA_PORT, &packet.payload);
        if let Some(payload) = packet.position_packet(self.packets) {
            send(POSITION_PORT, &payload);
        }
    }
}

#[cfg(test)]
mod packet_tests;
#[cfg(test)]
mod tests;
