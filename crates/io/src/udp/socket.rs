//! A UDP socket with kernel receive times, a drop counter and a large receive buffer.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket as StdSocket};
use std::os::fd::AsRawFd;
use std::task::{Context, Poll};

use nix::sys::socket::{setsockopt, sockopt};
use socket2::{Domain, Protocol, Socket, Type};
use tokio::io::Interest;
use tokio::net::UdpSocket;

use super::UdpError;
use super::batch::Batch;
use crate::ancillary::{self, DropCounter};
use crate::processes;

/// A bound socket.
#[derive(Debug)]
pub struct LidarSocket {
    socket: UdpSocket,
    /// The bound address.
    pub address: SocketAddrV4,
    /// Size of the receive buffer that the kernel granted, bytes.
    pub receive_buffer: usize,
    dropped: DropCounter,
}

impl LidarSocket {
    /// Binds `address` (port 0: any free port) and requests a receive buffer of `receive_buffer`
    /// bytes. Must run inside a tokio runtime with I/O enabled. A `group` is a multicast group and
    /// the address of the interface that joins it (0.0.0.0: the interface of the route). Other
    /// programs may share its port; unicast and broadcast datagrams to the port arrive as well.
    pub(super) fn open(
        address: SocketAddrV4,
        receive_buffer: usize,
        group: Option<(Ipv4Addr, Ipv4Addr)>,
    ) -> Result<Self, UdpError> {
        let failed = |action| {
            move |source| UdpError::Io {
                address,
                action,
                source,
            }
        };
        let socket =
            Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP)).map_err(failed("bind"))?;
        let granted = enlarge_buffer(&socket, receive_buffer).map_err(failed("configure"))?;
        ancillary::enable(&socket).map_err(|e| failed("configure")(e.into()))?;
        socket.set_nonblocking(true).map_err(failed("configure"))?;
        if let Some((group, interface)) = group {
            socket
                .set_reuse_address(true)
                // Excludes the groups that other programs joined.
                .and_then(|()| socket.set_multicast_all_v4(false))
                .map_err(failed("configure"))?;
            socket
                .join_multicast_v4(&group, &interface)
                .map_err(failed("join"))?;
        }
        socket
            .bind(&SocketAddr::V4(address).into())
            .map_err(|source| match source.kind() {
                io::ErrorKind::AddrInUse => UdpError::Busy {
                    address,
                    by: processes::udp_descriptions(address.port()),
                },
                io::ErrorKind::AddrNotAvailable => UdpError::NoInterface {
                    address: *address.ip(),
                },
                _ => failed("bind")(source),
            })?;
        let socket = UdpSocket::from_std(StdSocket::from(socket)).map_err(failed("bind"))?;
        let bound = match socket.local_addr().map_err(failed("bind"))? {
            SocketAddr::V4(bound) => bound,
            SocketAddr::V6(_) => address,
        };
        Ok(Self {
            socket,
            address: bound,
            receive_buffer: granted,
            dropped: DropCounter::default(),
        })
    }

    /// Datagrams that the kernel dropped because the receive buffer was full. The count arrives
    /// with the next datagram.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped.total()
    }

    /// Fills the batch with the waiting datagrams and discards its previous content.
    pub(super) fn try_recv_batch(&mut self, batch: &mut Batch) -> Result<(), UdpError> {
        let dropped = &mut self.dropped;
        let received = read_now(&self.socket, |fd| {
            batch.receive(fd, |overflow| dropped.update(overflow))?;
            match batch.was_full() {
                true => Ok(()),
                // Tells tokio that the socket is empty, which saves one more system call.
                false => Err(io::ErrorKind::WouldBlock.into()),
            }
        });
        use io::ErrorKind::{Interrupted, WouldBlock};
        match received {
            Err(e) if !matches!(e.kind(), WouldBlock | Interrupted) => {
                Err(self.io_error("receive", e))
            }
            _ => Ok(()),
        }
    }

    /// Polls for readability.
    pub(super) fn poll_ready(&self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.socket.poll_recv_ready(context)
    }

    pub(super) fn io_error(&self, action: &'static str, source: io::Error) -> UdpError {
        UdpError::Io {
            address: self.address,
            action,
            source,
        }
    }
}

/// Requests a receive buffer, above the user limit (`net.core.rmem_max`) if permitted; returns the
/// bytes granted.
fn enlarge_buffer(socket: &Socket, wanted: usize) -> io::Result<usize> {
    // The kernel takes a C int, and doubles it.
    let wanted = wanted.min(i32::MAX as usize / 2);
    if setsockopt(socket, sockopt::RcvBufForce, &wanted).is_err() {
        socket.set_recv_buffer_size(wanted)?;
    }
    socket.recv_buffer_size()
}

/// Reads from a socket even if tokio's reactor has not yet seen the datagram arrive.
fn read_now<T>(socket: &UdpSocket, mut read: impl FnMut(i32) -> io::Result<T>) -> io::Result<T> {
    let fd = socket.as_raw_fd();
    let mut was_read = false;
    let result = socket.try_io(Interest::READABLE, || {
        was_read = true;
        read(fd)
    });
    if was_read { result } else { read(fd) }
}
