//! One UDP socket: kernel receive times (SO_TIMESTAMPNS), drop counter (SO_RXQ_OVFL), a large
//! receive buffer.

use std::io::{self, IoSliceMut};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket as StdSocket};
use std::os::fd::AsRawFd;
use std::task::{Context, Poll};

use nix::sys::socket::{
    ControlMessageOwned, MsgFlags, RecvMsg, SockaddrIn, recvmsg, setsockopt, sockopt,
};
use nix::sys::time::TimeSpec;
use socket2::{Domain, Protocol, Socket, Type};
use tokio::io::Interest;
use tokio::net::UdpSocket;
use units::{Host, Stamp};

use super::UdpError;
use super::batch::Batch;
use crate::clock;

/// A datagram received into a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// Bytes of the payload, at the front of the buffer.
    pub len: usize,
    /// Where it came from.
    pub source: SocketAddrV4,
    /// When the kernel got it.
    pub host: Stamp<Host>,
    /// `host` is the kernel's time; otherwise the kernel gave none, and it is the time of the read,
    /// which may be late.
    pub kernel_time: bool,
    /// The payload was longer than the buffer; its end is lost.
    pub cut: bool,
}

/// A bound socket.
#[derive(Debug)]
pub struct LidarSocket {
    socket: UdpSocket,
    address: SocketAddrV4,
    receive_buffer: usize,
    control: Vec<u8>,
    /// The kernel's counter as last seen (32 bits, wraps), and what it adds up to.
    overflow_counter: u32,
    dropped: u64,
}

impl LidarSocket {
    /// Binds `address` (port 0: any free one) and asks for a receive buffer of `receive_buffer`
    /// bytes; what the kernel granted is [`LidarSocket::receive_buffer`]. Must be called within a
    /// tokio runtime that has I/O enabled.
    ///
    /// # Errors
    /// [`UdpError`].
    pub fn bind(address: SocketAddrV4, receive_buffer: usize) -> Result<Self, UdpError> {
        Self::open(address, receive_buffer, None)
    }

    /// Binds `port` on every interface and joins a multicast group on the interface that has the
    /// address `interface` (0.0.0.0: the one that the routes say). Other programs on this machine
    /// may listen to the same port and group. What is sent to this machine alone, or to all, is
    /// heard as well. Otherwise as [`LidarSocket::bind`].
    ///
    /// # Errors
    /// [`UdpError`]; [`UdpError::Io`] with `join` where the group is none, or no interface has that
    /// address.
    pub fn bind_group(
        group: Ipv4Addr,
        interface: Ipv4Addr,
        port: u16,
        receive_buffer: usize,
    ) -> Result<Self, UdpError> {
        let address = SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, port);
        Self::open(address, receive_buffer, Some((group, interface)))
    }

    fn open(
        address: SocketAddrV4,
        receive_buffer: usize,
        group: Option<(Ipv4Addr, Ipv4Addr)>,
    ) -> Result<Self, UdpError> {
        if tokio::runtime::Handle::try_current().is_err() {
            return Err(UdpError::NoRuntime { address });
        }
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
        setsockopt(&socket, sockopt::ReceiveTimestampns, &true)
            .and_then(|()| setsockopt(&socket, sockopt::RxqOvfl, &1))
            .map_err(|e| failed("configure")(e.into()))?;
        socket.set_nonblocking(true).map_err(failed("configure"))?;
        if let Some((group, interface)) = group {
            socket
                .set_reuse_address(true)
                // Not what other programs have joined.
                .and_then(|()| socket.set_multicast_all_v4(false))
                .map_err(failed("configure"))?;
            socket
                .join_multicast_v4(&group, &interface)
                .map_err(failed("join"))?;
        }
        socket
            .bind(&SocketAddr::V4(address).into())
            .map_err(|source| match source.kind() {
                io::ErrorKind::AddrInUse => UdpError::Busy { address },
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
            control: control_space(),
            overflow_counter: 0,
            dropped: 0,
        })
    }

    /// The address it is bound to.
    #[must_use]
    pub fn address(&self) -> SocketAddrV4 {
        self.address
    }

    /// Bytes of receive buffer that the kernel granted. It counts its own overhead in: some 2300
    /// bytes a packet of 1206, so that a second of a VLP-16 (754 packets) wants 1.7 MB.
    #[must_use]
    pub fn receive_buffer(&self) -> usize {
        self.receive_buffer
    }

    /// Datagrams that the kernel dropped because this program did not read fast enough, as far as
    /// those read tell.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Waits for a datagram.
    ///
    /// # Errors
    /// [`UdpError::Io`].
    pub async fn recv(&mut self, buffer: &mut [u8]) -> Result<Received, UdpError> {
        loop {
            self.socket
                .readable()
                .await
                .map_err(|e| self.io_error("wait", e))?;
            if let Some(received) = self.try_recv(buffer)? {
                return Ok(received);
            }
        }
    }

    /// A datagram, if one is there.
    ///
    /// # Errors
    /// [`UdpError::Io`].
    pub fn try_recv(&mut self, buffer: &mut [u8]) -> Result<Option<Received>, UdpError> {
        let control = &mut self.control;
        control.resize(control.capacity(), 0);
        let read = attempt(&self.socket, |fd| receive(fd, buffer, control));
        match self.unless_nothing(read)? {
            Some((received, counter)) => {
                counter
                    .into_iter()
                    .for_each(|counter| self.overflow(counter));
                Ok(Some(received))
            }
            None => Ok(None),
        }
    }

    /// What is there, as much as the batch takes; what was still in it is gone.
    ///
    /// # Errors
    /// [`UdpError::Io`].
    pub(super) fn try_recv_batch(&mut self, batch: &mut Batch) -> Result<(), UdpError> {
        let mut counters = (self.overflow_counter, self.dropped);
        let read = attempt(&self.socket, |fd| {
            batch.receive(fd, |counter| counters = counted(counters, counter))?;
            match batch.was_full() {
                true => Ok(()),
                // The socket is empty, and tokio would have to try once more to know.
                false => Err(io::ErrorKind::WouldBlock.into()),
            }
        });
        (self.overflow_counter, self.dropped) = counters;
        self.unless_nothing(read).map(drop)
    }

    /// Takes the drop counter that came with a datagram.
    fn overflow(&mut self, counter: u32) {
        (self.overflow_counter, self.dropped) =
            counted((self.overflow_counter, self.dropped), counter);
    }

    /// `None` where nothing was there.
    fn unless_nothing<T>(&self, read: io::Result<T>) -> Result<Option<T>, UdpError> {
        match read {
            Ok(read) => Ok(Some(read)),
            Err(e)
                if matches!(
                    e.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
                ) =>
            {
                Ok(None)
            }
            Err(e) => Err(self.io_error("receive", e)),
        }
    }

    /// Whether there may be something to read.
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

/// Asks for a receive buffer, past the limit for users (`net.core.rmem_max`) where this program
/// may; bytes granted.
fn enlarge_buffer(socket: &Socket, wanted: usize) -> io::Result<usize> {
    // The kernel takes a C int, and doubles it.
    let wanted = wanted.min(i32::MAX as usize / 2);
    if setsockopt(socket, sockopt::RcvBufForce, &wanted).is_err() {
        socket.set_recv_buffer_size(wanted)?;
    }
    socket.recv_buffer_size()
}

/// Reads from a socket, whatever tokio thinks of it: it says no unless its reactor has run since
/// the datagram came; the kernel knows.
fn attempt<T>(socket: &UdpSocket, mut read: impl FnMut(i32) -> io::Result<T>) -> io::Result<T> {
    let fd = socket.as_raw_fd();
    let mut asked = false;
    let tried = socket.try_io(Interest::READABLE, || {
        asked = true;
        read(fd)
    });
    if asked { tried } else { read(fd) }
}

/// The kernel's counter (32 bits, wraps) as last seen and what it adds up to, after it was seen
/// anew.
fn counted((last, dropped): (u32, u64), counter: u32) -> (u32, u64) {
    (counter, dropped + u64::from(counter.wrapping_sub(last)))
}

/// Room for the control messages of one datagram: its time and the drop counter.
pub(super) fn control_space() -> Vec<u8> {
    nix::cmsg_space!(TimeSpec, u32)
}

/// One `recvmsg`: the datagram, and the drop counter if the kernel sent it along.
fn receive(fd: i32, buffer: &mut [u8], control: &mut [u8]) -> io::Result<(Received, Option<u32>)> {
    let mut parts = [IoSliceMut::new(buffer)];
    let message = recvmsg::<SockaddrIn>(fd, &mut parts, Some(control), MsgFlags::empty())?;
    described(&message)
}

/// A datagram without its payload, and the drop counter if the kernel sent it along.
pub(super) fn described(
    message: &RecvMsg<'_, '_, SockaddrIn>,
) -> io::Result<(Received, Option<u32>)> {
    let mut kernel_time = None;
    let mut overflow = None;
    for part in message.cmsgs()? {
        match part {
            ControlMessageOwned::ScmTimestampns(time) => {
                kernel_time = Some(Stamp::from_nanos(
                    time.tv_sec()
                        .saturating_mul(1_000_000_000)
                        .saturating_add(time.tv_nsec()),
                ));
            }
            ControlMessageOwned::RxqOvfl(counter) => overflow = Some(counter),
            _ => {}
        }
    }
    let source = message
        .address
        .map_or(SocketAddrV4::new([0; 4].into(), 0), |from| {
            SocketAddrV4::new(from.ip(), from.port())
        });
    let received = Received {
        len: message.bytes,
        source,
        host: kernel_time.unwrap_or_else(clock::now),
        kernel_time: kernel_time.is_some(),
        cut: message.flags.contains(MsgFlags::MSG_TRUNC),
    };
    Ok((received, overflow))
}
