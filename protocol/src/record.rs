//! One piece of wire traffic with the host time at which it passed: what a log is made of.
//!
//! Everything after the log is a pure function of its records in their order.

use units::{Host, Stamp};

/// Which way drive traffic went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the host to the device.
    ToDevice,
    /// From the device to the host.
    FromDevice,
}

/// How the drive is attached; says how the bytes of a drive record are framed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveLink {
    /// EPOS2 USB frames (`90 02 ...`), one whole frame a record.
    Usb,
    /// EPOS2 RS232 frames and their handshake bytes.
    Rs232,
    /// CANopen: one SocketCAN `struct can_frame` (16 bytes, id big-endian as in LINKTYPE_CAN_SOCKETCAN) a record.
    Can,
}

/// What passed on one of the two interfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire<'a> {
    /// A UDP datagram from the lidar.
    Lidar {
        /// IPv4 address it came from, network order.
        source: [u8; 4],
        /// UDP port it was sent to (2368 data, 8308 position, unless configured otherwise).
        port: u16,
        /// The UDP payload.
        payload: &'a [u8],
    },
    /// A frame to or from the tilt drive.
    Drive {
        /// How the bytes are framed.
        link: DriveLink,
        /// Which way they went.
        direction: Direction,
        /// One frame as on the wire, stuffing included.
        frame: &'a [u8],
    },
}

/// One record of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record<'a> {
    /// For the lidar the kernel's receive time; for the drive when the frame was handed to, or wholly read from, the port.
    pub host: Stamp<Host>,
    /// What passed.
    pub wire: Wire<'a>,
}
