//! Both devices of the scanner in one virtual world.
//!
//! The host's time is true time. At the beginning of every millisecond the drive's control cycle settles how the shaft moves
//! until the next; a lidar packet is made when its last firing has ended, each laser with the shaft's angle at its own
//! instant. What comes out depends on the configuration and on which bytes came in when, never on the steps of
//! [`Rig::advance`]. Left out: the transports' delays ([`crate::link`] has them for whoever pumps the bytes).

use std::collections::VecDeque;
use std::sync::Arc;

use firmware_sim::epos2::{Node, NodeConfig};
use firmware_sim::vlp16::{DATA_PORT, POSITION_PORT};
use units::{Degrees, Gearing, Host, Metres, Span, Stamp};

use crate::attached::{Attached, Server};
use crate::clock::LidarClock;
use crate::effects::GearRipple;
use crate::scene::Scene;
use crate::scenes;
use crate::shaft::{CYCLE, Shaft};
use crate::spinning::Spinning;
use crate::truth::Truth;
use crate::world::{Spin, World};

/// What the virtual world is made of.
#[derive(Clone, Debug)]
pub struct RigConfig {
    /// What the beams meet.
    pub scene: Arc<Scene>,
    /// Height of the lidar's origin above the tilt axis (d of Eq. 4-6).
    pub mount: Metres,
    /// The drive.
    pub drive: NodeConfig,
    /// How the host reaches it.
    pub attached: Attached,
    /// From the motor's shaft to the platform; tilt 0 (level) is the shaft's position 0.
    pub gearing: Gearing,
    /// What the gear adds to that; `None`: nothing.
    pub ripple: Option<GearRipple>,
    /// The lidar.
    pub lidar: LidarConfig,
    /// Host time at which both devices are switched on.
    pub start: Stamp<Host>,
    /// Decides whatever the devices leave to chance.
    pub seed: u64,
}

/// How the lidar runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarConfig {
    /// Turns of the head a minute, in the lidar's own time (300..=1200 on the real one).
    pub rpm: u32,
    /// Azimuth of the very first firing.
    pub azimuth_at_start: Degrees,
    /// The lidar's clock at the start, microseconds past the hour.
    pub clock_at_start_us: u32,
    /// How much faster than the host's the lidar's clock runs, parts per million.
    pub drift_ppm: f64,
}

impl Default for LidarConfig {
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
    /// The paper's scanner in the hall: lidar 0.06 m above the axis, 500-line encoder, gear of 120:1, 10 Hz.
    #[must_use]
    pub fn new(start: Stamp<Host>) -> Self {
        Self {
            scene: Arc::new(scenes::hall()),
            mount: Metres(0.06),
            drive: NodeConfig::default(),
            attached: Attached::Usb,
            gearing: GEARING,
            ripple: None,
            lidar: LidarConfig::default(),
            start,
            seed: 0,
        }
    }
}

/// 500 lines, 120:1: 0.0015 deg a quadcount.
const GEARING: Gearing = match Gearing::new(500, 120, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

/// A UDP datagram that a device sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Datagram {
    /// When it left the lidar.
    pub at: Stamp<Host>,
    /// The port it is sent to: [`DATA_PORT`] or [`POSITION_PORT`].
    pub port: u16,
    /// The UDP payload.
    pub payload: Vec<u8>,
}

/// Bytes that the drive sent: a frame, a handshake, a line of its adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    /// When they left the drive.
    pub at: Stamp<Host>,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// The two devices and the world around them.
///
/// Whoever pumps it calls [`Rig::advance`] with the time, hands over what the host sent, and takes what the devices sent.
/// Datagrams and answers wait until they are taken; nothing is dropped.
#[derive(Debug)]
pub struct Rig {
    world: World,
    shaft: Shaft,
    node: Node,
    server: Server,
    lidar: Spinning,
    now: Stamp<Host>,
    datagrams: VecDeque<Datagram>,
    sent: VecDeque<Sent>,
}

impl Rig {
    /// Both devices at the moment of being switched on.
    #[must_use]
    pub fn new(config: RigConfig) -> Self {
        let RigConfig {
            scene,
            mount,
            drive,
            attached,
            gearing,
            ripple,
            lidar,
            start,
            seed,
        } = config;
        let clock = LidarClock::new(start, lidar.clock_at_start_us, lidar.drift_ppm);
        let spin = Spin {
            rpm: lidar.rpm,
            at_start: lidar.azimuth_at_start,
        };
        let node = Node::new(drive);
        let mut rig = Self {
            world: World::new(scene, mount, clock, spin),
            shaft: Shaft::new(start, gearing, node.segment().start).with_ripple(ripple),
            node,
            server: Server::new(attached, seed),
            lidar: Spinning::default(),
            now: start,
            datagrams: VecDeque::new(),
            sent: VecDeque::new(),
        };
        // The first control cycle begins at the start, whether or not anyone advances to it.
        rig.cycle();
        rig
    }

    /// Lets time pass until `to`. An instant that is past already changes nothing.
    pub fn advance(&mut self, to: Stamp<Host>) {
        loop {
            let (cycle, packet) = (self.shaft.end(), self.lidar.release(&self.world));
            // The drive first: a packet needs the shaft's motion up to its release.
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

    /// The bytes that the host sends to the drive, whole frames or not, arrive now.
    ///
    /// The drive reads its encoder now and acts from its next control cycle on.
    pub fn drive_input(&mut self, bytes: &[u8]) {
        let cycle_began = self.shaft.end() - CYCLE;
        let phase_us = self.now.saturating_since(cycle_began).as_nanos() / 1_000;
        // Between two cycles, so below 1000.
        self.node
            .set_phase_us(u32::try_from(phase_us).unwrap_or_default());
        let (at, sent) = (self.now, &mut self.sent);
        self.server
            .input(&mut self.node, bytes, &mut |bytes: &[u8]| {
                let bytes = bytes.to_vec();
                sent.push_back(Sent { at, bytes });
            });
    }

    /// The next bytes that the drive sent, if any: answers, and on a CAN bus what it sends by itself.
    pub fn drive_output(&mut self) -> Option<Sent> {
        self.sent.pop_front()
    }

    /// The next datagram that the lidar has sent, if any.
    pub fn poll_datagram(&mut self) -> Option<Datagram> {
        self.datagrams.pop_front()
    }

    /// Until when nothing comes out of the devices by itself; now, if something is waiting to be taken.
    #[must_use]
    pub fn next_event(&self) -> Stamp<Host> {
        if self.datagrams.is_empty() && self.sent.is_empty() {
            self.lidar.release(&self.world)
        } else {
            self.now
        }
    }

    /// The drive, to do things to it that no client can: block its motor, cut its power, give it an error.
    pub const fn drive_mut(&mut self) -> &mut Node {
        &mut self.node
    }

    /// The time that the world has reached.
    #[must_use]
    pub const fn now(&self) -> Stamp<Host> {
        self.now
    }

    /// Forgets the shaft's motion before `host`, for a world that is to go on for days: its truth begins there. The last second is kept,
    /// of which packets are made.
    pub fn forget_before(&mut self, host: Stamp<Host>) {
        let last_second = self.now.saturating_add(-Span::from_secs(1));
        self.shaft.forget_before(host.min(last_second));
    }

    /// What truly happened so far.
    #[must_use]
    pub fn truth(&self) -> Truth {
        Truth::new(self.world.clone(), self.shaft.clone())
    }

    /// One control cycle of the drive: settles the motion of the coming millisecond.
    fn cycle(&mut self) {
        self.node.tick();
        self.shaft.push(self.node.segment().end);
        let (at, sent) = (self.now, &mut self.sent);
        self.server.poll(&mut self.node, &mut |bytes: &[u8]| {
            let bytes = bytes.to_vec();
            sent.push_back(Sent { at, bytes });
        });
    }

    fn send_packets(&mut self) {
        let at = self.now;
        let data = self.lidar.data_packet(&self.world, &self.shaft);
        let position = self.lidar.position_packet(&self.world);
        self.datagrams.push_back(Datagram {
            at,
            port: DATA_PORT,
            payload: data.to_vec(),
        });
        self.datagrams.extend(position.map(|payload| Datagram {
            at,
            port: POSITION_PORT,
            payload: payload.to_vec(),
        }));
    }
}

#[cfg(test)]
mod tests;
