//! The lidar's datagrams with kernel receive times, and a count of the datagrams the kernel
//! dropped.
//!
//! The kernel takes the time when a packet leaves the network stack. A time read by the program can
//! be many milliseconds late on a busy machine. IPv4 only, like the lidars of this family.

mod batch;
mod listener;
mod socket;

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4};

pub use listener::{GATHER, LidarListener, ListenConfig, ListenCounts};
pub use socket::LidarSocket;

/// Failure to open or read a socket.
#[derive(Debug, thiserror::Error)]
pub enum UdpError {
    /// Another program uses the port.
    #[error("UDP port {}: in use by {by}", address.port())]
    Busy {
        /// Address to bind.
        address: SocketAddrV4,
        /// The programs that listen there.
        by: String,
    },
    /// No interface of this machine has that address.
    #[error("UDP address {address}: expected an address of this machine or 0.0.0.0")]
    NoInterface {
        /// Address to bind.
        address: Ipv4Addr,
    },
    /// A system call failed.
    #[error("UDP socket {address}: cannot {action}: {source}")]
    Io {
        /// Address of the socket.
        address: SocketAddrV4,
        /// `bind`, `configure`, `join`, `wait` or `receive`.
        action: &'static str,
        /// The system's error.
        source: io::Error,
    },
}
