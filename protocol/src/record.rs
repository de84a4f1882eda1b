//! Records of a log: wire traffic with its host time.
//!
//! All processing after the log is a pure function of its records in their order.

use units::{Host, Stamp};

/// Direction of drive traffic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the host to the drive.
    ToDrive,
    /// From the drive to the host.
    FromDrive,
}

/// Connection of the drive; it determines the framing of drive records. SLCAN counts as CAN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveLink {
    /// EPOS2 USB frames (`90 02 ...`), one per record.
    Usb,
    /// EPOS2 RS232 frames and their handshake bytes.
    Rs232,
    /// CANopen: one SocketCAN `struct can_frame` per record (16 bytes, id big-endian as in
    /// LINKTYPE_CAN_SOCKETCAN).
    Can,
}

/// Traffic of one of the two interfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire<'a> {
    /// A UDP datagram from the lidar.
    Lidar {
        /// Source IPv4 address, network order.
        source: [u8; 4],
        /// Destination UDP port (by default 2368 data, 8308 position).
        port: u16,
        /// The UDP payload.
        payload: &'a [u8],
    },
    /// A frame to or from the tilt drive.
    Drive {
        /// Link, whose framing the bytes have.
        link: DriveLink,
        /// To or from the drive.
        direction: Direction,
        /// One frame as on the wire, stuffing included.
        frame: &'a [u8],
    },
}

/// One record of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record<'a> {
    /// For the lidar the kernel's receive time; for the drive the time at which the frame was
    /// passed to the port, or read completely.
    pub host: Stamp<Host>,
    /// The traffic.
    pub wire: Wire<'a>,
}
