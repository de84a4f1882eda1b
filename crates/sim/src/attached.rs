//! How the drive of a rig is reached: which of the unit's interfaces the host's bytes go to.
//!
//! Left out: wire time and delays, which are the link's ([`crate::link`]).

use firmware_sim::epos2::{
    CanFrame, CanServer, Node, Rs232Server, SOCKETCAN_LEN, SlcanServer, UsbServer,
};

/// What connects host and drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Attached {
    /// The unit's USB port: bytes of its frames.
    #[default]
    Usb,
    /// The unit's RS232 port: bytes of its frames and handshakes.
    Rs232,
    /// A serial CAN adapter: bytes of SLCAN lines.
    Slcan,
    /// A CAN bus: one `struct can_frame` of 16 bytes at a time.
    Can,
}

/// The unit's side of it.
#[derive(Clone, Debug)]
pub(crate) enum Server {
    Usb(UsbServer),
    Rs232(Rs232Server),
    Slcan(SlcanServer),
    Can(CanServer),
}

impl Server {
    pub fn new(attached: Attached, seed: u64) -> Self {
        match attached {
            Attached::Usb => Self::Usb(UsbServer::new(seed)),
            Attached::Rs232 => Self::Rs232(Rs232Server::new(seed)),
            Attached::Slcan => Self::Slcan(SlcanServer::new()),
            Attached::Can => Self::Can(CanServer::new()),
        }
    }

    /// Takes what the host sent, at the node's present instant. What is no frame of a bus is not heard there.
    pub fn input(&mut self, node: &mut Node, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
        match self {
            Self::Usb(server) => server.input(node, bytes, out),
            Self::Rs232(server) => server.input(node, bytes, out),
            Self::Slcan(server) => server.input(node, bytes, out),
            Self::Can(server) => {
                for frame in bytes.chunks(SOCKETCAN_LEN) {
                    if let Ok(frame) = CanFrame::from_socketcan(frame) {
                        server.input(node, &frame, &mut |answer| out(&answer.to_socketcan()));
                    }
                }
            }
        }
    }

    /// What the unit sends by itself after a control cycle.
    pub fn poll(&mut self, node: &mut Node, out: &mut impl FnMut(&[u8])) {
        match self {
            Self::Usb(_) | Self::Rs232(_) => {}
            Self::Slcan(server) => server.poll(node, out),
            Self::Can(server) => server.poll(node, &mut |frame| out(&frame.to_socketcan())),
        }
    }
}
