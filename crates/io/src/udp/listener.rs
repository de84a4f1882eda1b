//! All of the lidars' ports on one plain thread, until a flag says stop. Several sensors may share
//! a port: their addresses tell them apart. Not here: storing, and IPv6.

use std::future::poll_fn;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;
use std::thread;
use std::time::Duration;

use protocol::record::{Record, Wire};
use tokio::runtime::{Builder, Runtime};

use super::batch::Batch;
use super::{LidarSocket, UdpError};
use crate::recording::{Sensor, Sensors};

/// How soon a stop is noticed.
const STOP_INTERVAL: Duration = Duration::from_millis(20);
/// How long datagrams gather behind the first before they are read, unless [`Listener::gather`]
/// says otherwise: a wake-up and a system call then serve several. Their times are the kernel's,
/// whenever they are read, and three VLP-16 in dual return fill no more than 60 KB of receive
/// buffer meanwhile.
pub const GATHER: Duration = Duration::from_millis(5);
/// Datagrams that are to gather at most, three quarters of what is read at once: 110 KB of receive
/// buffer, a quarter of what a Linux gives that was not told otherwise.
const GATHERED: u64 = 48;

/// Where the lidars send to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListenConfig {
    /// Local address; 0.0.0.0 for every interface, which broadcast needs. With a `group`, the
    /// address of the interface to join it on.
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
    /// What each of them gave and is not given on yet.
    batches: Vec<Batch>,
    /// Which of them is for position packets only.
    position: Option<usize>,
    sources: Vec<Ipv4Addr>,
    runtime: Runtime,
    counts: ListenCounts,
    sensors: Sensors,
    /// How long datagrams gather, at most and now.
    gather: (Duration, Duration),
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
            batches: sockets.iter().map(|_| Batch::new()).collect(),
            sockets,
            position,
            sources: config.sources.clone(),
            runtime,
            counts: ListenCounts::default(),
            sensors: Sensors::default(),
            gather: (GATHER, GATHER),
        })
    }

    /// Lets datagrams gather for so long at most, and for less where they come so fast that more
    /// than 48 would. Who is in a hurry sets the flag of [`Listener::run`] and unparks its thread.
    pub fn gather(&mut self, longest: Duration) {
        self.gather = (longest, longest.min(self.gather.1.max(GATHER)));
    }

    /// Halves or doubles the time by how many datagrams came in it.
    fn adapt(&mut self, came: u64) {
        let (longest, now) = self.gather;
        self.gather.1 = match came {
            0..=20 => (now * 2).min(longest),
            21..=GATHERED => now,
            _ => (now / 2).max(GATHER.min(longest)),
        };
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

    /// Gives each datagram to `sink` until `stop` is set; looks at `stop` every 25 ms at least, or
    /// as late as datagrams gather. What had arrived by then is still given. Datagrams of several
    /// sockets come in the order of their times as far as they are read together, which is as they
    /// gather. May be called again.
    ///
    /// # Errors
    /// [`UdpError::Io`].
    pub fn run(
        &mut self,
        stop: &AtomicBool,
        mut sink: impl FnMut(&Record<'_>),
    ) -> Result<ListenCounts, UdpError> {
        let mut more = false;
        while !stop.load(Ordering::Acquire) {
            if !more {
                let sockets = &self.sockets;
                let ready = self.runtime.block_on(async {
                    tokio::time::timeout(STOP_INTERVAL, readable(sockets)).await
                });
                match ready {
                    Ok(ready) => ready?,
                    Err(_elapsed) => continue,
                }
                // The time of the read is no time to be late.
                if self.counts.without_kernel_time == 0 {
                    thread::park_timeout(self.gather.1);
                }
            }
            let before = self.came();
            more = self.drain(&mut sink)?;
            self.adapt(self.came() - before);
        }
        while self.drain(&mut sink)? {}
        Ok(self.counts())
    }

    /// Datagrams so far, wanted or not.
    const fn came(&self) -> u64 {
        self.counts.data + self.counts.position + self.counts.unwanted
    }

    /// Gives on what has come, in the order of its times, up to a batch of each socket; whether
    /// there may be more.
    fn drain(&mut self, sink: &mut impl FnMut(&Record<'_>)) -> Result<bool, UdpError> {
        for (socket, batch) in self.sockets.iter_mut().zip(&mut self.batches) {
            if batch.next().is_none() {
                socket.try_recv_batch(batch)?;
            }
        }
        while let Some(index) = earliest(&self.batches) {
            self.give(index, sink);
            let emptied = self.batches.get(index).is_some_and(|b| b.next().is_none());
            // What waits behind a full batch may be earlier than what other sockets gave.
            if emptied && self.batches.get(index).is_some_and(Batch::was_full) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Gives the next datagram of a socket on, if it is wanted.
    fn give(&mut self, index: usize, sink: &mut impl FnMut(&Record<'_>)) {
        let (Some(socket), Some((received, payload))) = (
            self.sockets.get(index),
            self.batches.get_mut(index).and_then(Batch::take),
        ) else {
            return;
        };
        let source = received.source.ip();
        if !self.sources.is_empty() && !self.sources.contains(source) {
            self.counts.unwanted += 1;
            return;
        }
        let record = Record {
            host: received.host,
            wire: Wire::Lidar {
                source: source.octets(),
                port: socket.address().port(),
                payload,
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
}

/// The batch whose next datagram came first.
fn earliest(batches: &[Batch]) -> Option<usize> {
    let next = batches
        .iter()
        .enumerate()
        .filter_map(|(index, batch)| Some((batch.next()?.host, index)));
    next.min().map(|(_, index)| index)
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
