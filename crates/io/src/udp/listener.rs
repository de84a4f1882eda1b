//! Both of the lidar's ports on one plain thread, until a flag says stop.

use std::future::poll_fn;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;
use std::time::Duration;

use protocol::record::{Record, Wire};
use tokio::runtime::{Builder, Runtime};

use super::{LidarSocket, UdpError};

/// How soon a stop is noticed.
const STOP_INTERVAL: Duration = Duration::from_millis(20);
/// Datagrams taken from one socket before the other gets its turn.
const BURST: usize = 64;
/// The longest UDP payload.
const BUFFER_LEN: usize = 65_535;

/// Where the lidar sends to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListenConfig {
    /// Local address; 0.0.0.0 for every interface, which broadcast needs.
    pub address: Ipv4Addr,
    /// Data packets; 0 for any free port.
    pub data_port: u16,
    /// Position packets, if wanted; 0 for any free port.
    pub position_port: Option<u16>,
    /// Bytes of receive buffer to ask for, a socket.
    pub receive_buffer: usize,
}

impl Default for ListenConfig {
    /// The VLP-16's factory ports (user manual, 63-9243), every interface, 8 MiB.
    fn default() -> Self {
        Self {
            address: Ipv4Addr::UNSPECIFIED,
            data_port: 2368,
            position_port: Some(8308),
            receive_buffer: 8 << 20,
        }
    }
}

/// What was heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ListenCounts {
    /// Datagrams on the data port.
    pub data: u64,
    /// Datagrams on the position port.
    pub position: u64,
    /// Datagrams the kernel dropped because this program was too slow, both ports.
    pub dropped: u64,
    /// Datagrams without a kernel time; their host time is that of the read.
    pub without_kernel_time: u64,
}

/// Sockets bound and a runtime of their own; owned by one thread.
#[derive(Debug)]
pub struct Listener {
    /// Data first.
    sockets: Vec<LidarSocket>,
    runtime: Runtime,
    counts: ListenCounts,
}

/// Binds, listens until `stop`, and gives each datagram to `sink` in a record.
///
/// # Errors
/// [`UdpError`].
pub fn listen(
    config: &ListenConfig,
    stop: &AtomicBool,
    sink: impl FnMut(&Record<'_>),
) -> Result<ListenCounts, UdpError> {
    Listener::bind(config)?.run(stop, sink)
}

impl Listener {
    /// Binds the sockets.
    ///
    /// # Errors
    /// [`UdpError`].
    pub fn bind(config: &ListenConfig) -> Result<Self, UdpError> {
        let at = |port| SocketAddrV4::new(config.address, port);
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()
            .map_err(|source| UdpError::Io {
                address: at(config.data_port),
                action: "wait",
                source,
            })?;
        let sockets = {
            let _inside = runtime.enter();
            let mut sockets = vec![LidarSocket::bind(
                at(config.data_port),
                config.receive_buffer,
            )?];
            // A lidar set to send both to one port needs one socket.
            if let Some(port) = config.position_port
                && (port != config.data_port || port == 0)
            {
                sockets.push(LidarSocket::bind(at(port), config.receive_buffer)?);
            }
            sockets
        };
        Ok(Self {
            sockets,
            runtime,
            counts: ListenCounts::default(),
        })
    }

    /// The sockets: data first, then position if it has its own.
    #[must_use]
    pub fn sockets(&self) -> &[LidarSocket] {
        &self.sockets
    }

    /// What was heard so far.
    #[must_use]
    pub fn counts(&self) -> ListenCounts {
        ListenCounts {
            dropped: self.sockets.iter().map(LidarSocket::dropped).sum(),
            ..self.counts
        }
    }

    /// Gives each datagram to `sink` until `stop` is set; looks at `stop` every 20 ms at least. What had arrived by then
    /// is still given. May be called again.
    ///
    /// # Errors
    /// [`UdpError::Io`].
    pub fn run(
        &mut self,
        stop: &AtomicBool,
        mut sink: impl FnMut(&Record<'_>),
    ) -> Result<ListenCounts, UdpError> {
        let mut buffer = vec![0; BUFFER_LEN];
        while !stop.load(Ordering::Acquire) {
            let sockets = &self.sockets;
            let ready = self
                .runtime
                .block_on(async { tokio::time::timeout(STOP_INTERVAL, readable(sockets)).await });
            match ready {
                Ok(ready) => ready?,
                Err(_elapsed) => continue,
            }
            self.drain(&mut buffer, &mut sink)?;
        }
        while self.drain(&mut buffer, &mut sink)? == BURST {}
        Ok(self.counts())
    }

    /// Takes up to [`BURST`] datagrams from each socket; the most that one of them gave.
    fn drain(
        &mut self,
        buffer: &mut [u8],
        sink: &mut impl FnMut(&Record<'_>),
    ) -> Result<usize, UdpError> {
        let mut most = 0;
        for (index, socket) in self.sockets.iter_mut().enumerate() {
            let mut taken = 0;
            while taken < BURST {
                let Some(received) = socket.try_recv(buffer)? else {
                    break;
                };
                taken += 1;
                self.counts.without_kernel_time += u64::from(!received.kernel_time);
                match index {
                    0 => self.counts.data += 1,
                    _ => self.counts.position += 1,
                }
                sink(&Record {
                    host: received.host,
                    wire: Wire::Lidar {
                        source: received.source.ip().octets(),
                        port: socket.address().port(),
                        payload: buffer.get(..received.len).unwrap_or_default(),
                    },
                });
            }
            most = most.max(taken);
        }
        Ok(most)
    }
}

/// Until one of the sockets may have something.
async fn readable(sockets: &[LidarSocket]) -> Result<(), UdpError> {
    poll_fn(|context| {
        let mut ready = Poll::Pending;
        // Each is asked, so that each will wake this.
        for socket in sockets {
            match socket.poll_ready(context) {
                Poll::Ready(Ok(())) => ready = Poll::Ready(Ok(())),
                Poll::Ready(Err(e)) => return Poll::Ready(Err(socket.io_error("wait", e))),
                Poll::Pending => {}
            }
        }
        ready
    })
    .await
}

#[cfg(test)]
mod tests;
