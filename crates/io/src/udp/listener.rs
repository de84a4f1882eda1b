//! All of the lidars' ports on one plain thread, until a flag says stop. Several sensors may share a port: their addresses tell them
//! apart. Not here: storing, and IPv6.

use std::future::poll_fn;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;
use std::time::Duration;

use protocol::record::{Record, Wire};
use tokio::runtime::{Builder, Runtime};

use super::{LidarSocket, UdpError};
use crate::recording::{Sensor, Sensors};

/// How soon a stop is noticed.
const STOP_INTERVAL: Duration = Duration::from_millis(20);
/// Datagrams taken from one socket before the other gets its turn.
const BURST: usize = 64;
/// The longest UDP payload.
const BUFFER_LEN: usize = 65_535;

/// Where the lidars send to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListenConfig {
    /// Local address; 0.0.0.0 for every interface, which broadcast needs. With a `group`, the address of the interface to join it on.
    pub address: Ipv4Addr,
    /// Data packets; 0 for any free port.
    pub data_port: u16,
    /// Position packets, if wanted; 0 for any free port.
    pub position_port: Option<u16>,
    /// Further data ports, for sensors that do not share one.
    pub more_ports: Vec<u16>,
    /// Bytes of receive buffer to ask for, a socket.
    pub receive_buffer: usize,
    /// A multicast group to join on all of these ports.
    pub group: Option<Ipv4Addr>,
    /// Addresses of the sensors that are wanted; empty: whoever sends.
    pub sources: Vec<Ipv4Addr>,
}

impl Default for ListenConfig {
    /// The VLP-16's factory ports (user manual, 63-9243), every interface, 8 MiB.
    fn default() -> Self {
        Self {
            address: Ipv4Addr::UNSPECIFIED,
            data_port: 2368,
            position_port: Some(8308),
            more_ports: Vec::new(),
            receive_buffer: 8 << 20,
            group: None,
            sources: Vec::new(),
        }
    }
}

/// What was heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ListenCounts {
    /// Datagrams on the data ports.
    pub data: u64,
    /// Datagrams on the position port.
    pub position: u64,
    /// Datagrams the kernel dropped because this program was too slow, all ports.
    pub dropped: u64,
    /// Datagrams without a kernel time; their host time is that of the read.
    pub without_kernel_time: u64,
    /// Of `data` and `position`: what is no lidar's by its content.
    pub foreign: u64,
    /// Datagrams from other sources than the wanted ones: in none of the above, and not given on.
    pub unwanted: u64,
}

/// Sockets bound and a runtime of their own; owned by one thread.
#[derive(Debug)]
pub struct Listener {
    /// Data first, then position, then further data.
    sockets: Vec<LidarSocket>,
    /// Which of them is for position packets only.
    position: Option<usize>,
    sources: Vec<Ipv4Addr>,
    runtime: Runtime,
    counts: ListenCounts,
    sensors: Sensors,
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
        let bind = |port| match config.group {
            Some(group) => {
                LidarSocket::bind_group(group, config.address, port, config.receive_buffer)
            }
            None => LidarSocket::bind(at(port), config.receive_buffer),
        };
        let mut position = None;
        let sockets = {
            let _inside = runtime.enter();
            let mut sockets = vec![bind(config.data_port)?];
            // A lidar set to send both to one port needs one socket.
            if let Some(port) = config.position_port
                && (port != config.data_port || port == 0)
            {
                position = Some(sockets.len());
                sockets.push(bind(port)?);
            }
            for &port in &config.more_ports {
                if port == 0 || sockets.iter().all(|s| s.address().port() != port) {
                    sockets.push(bind(port)?);
                }
            }
            sockets
        };
        Ok(Self {
            sockets,
            position,
            sources: config.sources.clone(),
            runtime,
            counts: ListenCounts::default(),
            sensors: Sensors::default(),
        })
    }

    /// The sensors heard so far.
    #[must_use]
    pub fn sensors(&self) -> Vec<Sensor> {
        self.sensors.list()
    }

    /// The sockets: data first, then position if it has its own, then further data.
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
                let source = received.source.ip();
                if !self.sources.is_empty() && !self.sources.contains(source) {
                    self.counts.unwanted += 1;
                    continue;
                }
                let record = Record {
                    host: received.host,
                    wire: Wire::Lidar {
                        source: source.octets(),
                        port: socket.address().port(),
                        payload: buffer.get(..received.len).unwrap_or_default(),
                    },
                };
                self.counts.without_kernel_time += u64::from(!received.kernel_time);
                if self.position == Some(index) {
                    self.counts.position += 1;
                } else {
                    self.counts.data += 1;
                }
                if !self.sensors.observe(&record) {
                    self.counts.foreign += 1;
                }
                sink(&record);
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
