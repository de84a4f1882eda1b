//! The lidar's datagrams with the kernel's receive time, and a count of those the kernel dropped.
//!
//! The kernel's time is taken when the packet comes out of the network stack; a time read by the
//! program can be late by many milliseconds when the machine is busy. IPv4 only, as the lidars of
//! this family are. A payload is looked into only to count whose it is; every datagram from a
//! wanted source is given on.

mod batch;
mod listener;
mod socket;

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4};

pub use listener::{GATHER, ListenConfig, ListenCounts, Listener, listen};
pub use socket::{LidarSocket, Received};

/// Why a socket could not be had or read.
#[derive(Debug, thiserror::Error)]
pub enum UdpError {
    /// Another program has the port.
    #[error("UDP port {}: in use by another program", address.port())]
    Busy {
        /// What was to be bound.
        address: SocketAddrV4,
    },
    /// No interface of this machine has that address.
    #[error("UDP address {address}: expected an address of this machine or 0.0.0.0")]
    NoInterface {
        /// What was to be bound.
        address: Ipv4Addr,
    },
    /// A socket was made outside a tokio runtime.
    #[error("UDP socket {address}: expected a tokio runtime around it, got none")]
    NoRuntime {
        /// What was to be bound.
        address: SocketAddrV4,
    },
    /// The system refused.
    #[error("UDP socket {address}: cannot {action}: {source}")]
    Io {
        /// What was to be bound, or is.
        address: SocketAddrV4,
        /// `bind`, `configure`, `join`, `wait` or `receive`.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
}
