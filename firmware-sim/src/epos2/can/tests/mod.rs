//! The drive as seen by a master on its bus.

extern crate std;
use std::vec::Vec;

mod errors;
mod guard;
mod lss;
mod pdo;
mod sdo;

use protocol::canopen::nmt::{Nmt, NmtCommand};
use protocol::canopen::{CanFrame, CobId, NodeId};
use protocol::epos2::DeviceError;
use protocol::epos2::objects::Address;

use super::CanServer;
use crate::epos2::{SimulatedDrive, SimulatedDriveConfig};

/// Identifier and data.
type Frames = Vec<(u16, Vec<u8>)>;

/// A drive and its bus.
struct Bus {
    node: SimulatedDrive,
    server: CanServer,
    received: Frames,
}

fn note(received: &mut Frames, frame: &CanFrame) {
    assert!(!frame.is_remote());
    received.push((frame.cob_id().unwrap().get(), frame.data().to_vec()));
}

impl Bus {
    /// A drive after power-on whose boot-up message has been received.
    fn new() -> Self {
        Self::of(SimulatedDriveConfig {
            fault_at_power_on: DeviceError::NONE,
            initial_position: 0,
            ..SimulatedDriveConfig::default()
        })
    }

    fn of(config: SimulatedDriveConfig) -> Self {
        let mut bus = Self {
            node: SimulatedDrive::new(config),
            server: CanServer::new(),
            received: Vec::new(),
        };
        bus.poll();
        assert_eq!(bus.take().first(), Some(&(0x701, Vec::from([0]))));
        bus
    }

    fn poll(&mut self) {
        let received = &mut self.received;
        self.server
            .poll(&mut self.node, &mut |frame| note(received, frame));
    }

    fn frame(&mut self, frame: &CanFrame) {
        let received = &mut self.received;
        self.server
            .input(&mut self.node, frame, &mut |frame| note(received, frame));
    }

    fn send(&mut self, id: u16, data: &[u8]) {
        self.frame(&CanFrame::new(CobId::new(id).unwrap(), data).unwrap());
    }

    fn send_remote(&mut self, id: u16) {
        self.frame(&CanFrame::remote(CobId::new(id).unwrap(), 8).unwrap());
    }

    fn nmt(&mut self, command: NmtCommand) {
        let node = NodeId::new(1);
        self.frame(&Nmt { node, command }.to_frame());
    }

    fn ticks(&mut self, n: usize) {
        for _ in 0..n {
            self.node.tick();
            self.poll();
        }
    }

    fn take(&mut self) -> Frames {
        core::mem::take(&mut self.received)
    }

    /// Frames received with an identifier.
    fn with(&mut self, id: u16) -> Vec<Vec<u8>> {
        let received = self.take().into_iter();
        received
            .filter(|(from, _)| *from == id)
            .map(|(_, data)| data)
            .collect()
    }

    fn write(&mut self, index: u16, sub: u8, raw: u32) {
        self.node.write(Address::new(index, sub), raw).unwrap();
    }

    fn read(&self, index: u16, sub: u8) -> u32 {
        self.node
            .read(Address::new(index, sub))
            .unwrap()
            .raw()
            .unwrap()
    }

    /// Maps position and time stamp to TPDO 1 with transmission type `kind`.
    fn stream_angle(&mut self, kind: u32, inhibit_100us: u32) {
        for (index, sub, raw) in [
            (0x1800, 1, 0xC000_0181),
            (0x1800, 2, kind),
            (0x1800, 3, inhibit_100us),
            (0x1A00, 0, 0),
            (0x1A00, 1, 0x6064_0020),
            (0x1A00, 2, 0x1013_0020),
            (0x1A00, 0, 2),
            (0x1800, 1, 0x4000_0181),
        ] {
            self.write(index, sub, raw);
        }
    }

    /// Enables the drive and starts a move to a target.
    fn go(&mut self, target: i32) {
        self.write(0x607A, 0, target as u32);
        for word in [0x06, 0x0F] {
            self.write(0x6040, 0, word);
        }
        self.ticks(5);
        self.write(0x6040, 0, 0x1F);
    }
}
