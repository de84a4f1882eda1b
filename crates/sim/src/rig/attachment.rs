//! The interface of the drive that the host uses.
//!
//! Transmission times and delays are not included.

use firmware_sim::epos2::{
    CanFrame, CanServer, Rs232Server, SOCKETCAN_LEN, SimulatedDrive, SlcanServer, UsbServer,
};

/// Interface between host and drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Attachment {
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

/// The unit's side of the interface.
#[derive(Clone, Debug)]
pub enum DriveServer {
    /// The server of the USB port.
    Usb(UsbServer),
    /// The server of the RS232 port.
    Rs232(Rs232Server),
    /// The server behind a serial CAN adapter.
    Slcan(SlcanServer),
    /// The server on a CAN bus.
    Can(CanServer),
}

impl DriveServer {
    /// The server of an interface, whose numbers follow from `seed`.
    #[must_use]
    pub fn new(attachment: Attachment, seed: u64) -> Self {
        match attachment {
            Attachment::Usb => Self::Usb(UsbServer::new(seed)),
            Attachment::Rs232 => Self::Rs232(Rs232Server::new(seed)),
            Attachment::Slcan => Self::Slcan(SlcanServer::new()),
            Attachment::Can => Self::Can(CanServer::new()),
        }
    }

    /// Takes bytes from the host at the node's current time. On a CAN bus, anything that is not a
    /// frame is ignored.
    pub fn input(&mut self, node: &mut SimulatedDrive, bytes: &[u8], out: &mut impl FnMut(&[u8])) {
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

    /// Sends unsolicited frames after a control cycle.
    pub fn poll(&mut self, node: &mut SimulatedDrive, out: &mut impl FnMut(&[u8])) {
        match self {
            Self::Usb(_) | Self::Rs232(_) => {}
            Self::Slcan(server) => server.poll(node, out),
            Self::Can(server) => server.poll(node, &mut |frame| out(&frame.to_socketcan())),
        }
    }
}
