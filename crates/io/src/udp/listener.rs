//! Receives the lidars' datagrams on all their ports, on one plain thread, until a flag says stop.
//! Several sensors may share a port; their addresses tell them apart. IPv4 only.

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

/// Longest time until a stop is noticed.
const STOP_INTERVAL: Duration = Duration::from_millis(20);
/// Default time for which datagrams gather after the first before they are read: one wake-up and
/// one system call then serve several. Receive times are the kernel's and do not change. Three
/// VLP-16 in dual return fill 60 KB of receive buffer in this time.
pub const GATHER: Duration = Duration::from_millis(5);
/// Most datagrams that should gather: three quarters of a batch, 110 KB of receive buffer, a
/// quarter of the Linux default.
const GATHERED: u64 = 48;

/// Addresses that the lidars send to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListenConfig {
    /// Local address; 0.0.0.0 for every interface, which broadcast needs. With a `group`, the
    /// address of the interface that joins it.
    pub address: Ipv4Addr,
    /// Port of data packets; 0 for any free port.
    pub data_port: u16,
    /// Port of position packets, if wanted; 0 for any free port.
    pub position_port: Option<u16>,
    /// Bytes of receive buffer to request for each socket.
    pub receive_buffer: usize,
    /// Multicast group to join on all ports.
    pub group: Option<Ipv4Addr>,
    /// Addresses of the wanted sensors; empty accepts all.
    pub sources: Vec<Ipv4Addr>,
}

impl Default for ListenConfig {
    /// The VLP-16's factory ports (user manual 63-9243), every interface, 8 MiB.
    fn default() -> Self {
        Self {
            address: Ipv4Addr::UNSPECIFIED,
            data_port: 2368,
            position_port: Some(8308),
            receive_buffer: 8 << 20,
            group: None,
            sources: Vec::new(),
        }
    }
}

/// Numbers of datagrams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ListenCounts {
    /// Datagrams on the data ports.
    pub data: u64,
    /// Datagrams on the position port.
    pub position: u64,
    /// Datagrams dropped by the kernel because the program read too slowly, on all ports.
    pub dropped: u64,
    /// Datagrams without a kernel time; their host time is that of the read.
    pub without_kernel_time: u64,
    /// Datagrams from unwanted sources: in no other count, and not delivered.
    pub unwanted: u64,
}

/// Bound sockets with a runtime of their own, owned by one thread.
#[derive(Debug)]
pub struct LidarListener {
    /// Data first, then position.
    sockets: Vec<LidarSocket>,
    /// Undelivered datagrams of each socket.
    batches: Vec<Batch>,
    /// Index of the socket for position packets only.
    position: Option<usize>,
    sources: Vec<Ipv4Addr>,
    runtime: Runtime,
    counts: ListenCounts,
    longest_gather: Duration,
    gather: Duration,
}

impl LidarListener {
    /// Binds the sockets.
    ///
    /// # Errors
    /// [`UdpError`].
    pub fn bind(config: &ListenConfig) -> Result<Self, UdpError> {
        let address_of = |port| SocketAddrV4::new(config.address, port);
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()
            .map_err(|source| UdpError::Io {
                address: address_of(config.data_port),
                action: "wait",
                source,
            })?;
        let bind = |port| {
            let (address, group) = match config.group {
                Some(group) => (Ipv4Addr::UNSPECIFIED, Some((group, config.address))),
                None => (config.address, None),
            };
            let address = SocketAddrV4::new(address, port);
            LidarSocket::open(address, config.receive_buffer, group)
        };
        let mut position = None;
        let sockets = {
            let _inside = runtime.enter();
            let mut sockets = vec![bind(config.data_port)?];
            // A lidar that sends both kinds to one port needs one socket.
            if let Some(port) = config.position_port
                && (port != config.data_port || port == 0)
            {
                position = Some(sockets.len());
                sockets.push(bind(port)?);
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
            longest_gather: GATHER,
            gather: GATHER,
        })
    }

    /// Sets the longest time for which datagrams gather; it shortens while more than 48 datagrams
    /// arrive in it. To stop sooner, set the flag of [`LidarListener::run`] and unpark its thread.
    pub fn gather(&mut self, longest: Duration) {
        self.longest_gather = longest;
        self.gather = longest.min(self.gather.max(GATHER));
    }

    /// Halves or doubles the gathering time by the number of datagrams that arrived in it.
    fn adapt(&mut self, arrived: u64) {
        self.gather = match arrived {
            0..=20 => (self.gather * 2).min(self.longest_gather),
            21..=GATHERED => self.gather,
            _ => (self.gather / 2).max(GATHER.min(self.longest_gather)),
        };
    }

    /// The sockets: data first, then position if it has its own.
    #[must_use]
    pub fn sockets(&self) -> &[LidarSocket] {
        &self.sockets
    }

    /// Numbers of datagrams so far.
    #[must_use]
    pub fn counts(&self) -> ListenCounts {
        ListenCounts {
            dropped: self.sockets.iter().map(LidarSocket::dropped).sum(),
            ..self.counts
        }
    }

    /// Passes each datagram to `sink` until `stop` is set, then those that had arrived by then.
    /// `stop` is read every 25 ms, or as rarely as datagrams gather. Datagrams of several sockets
    /// that are read together are passed in order of their times. May be called again.
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
                // Without kernel times the time of the read counts, and must not be delayed.
                if self.counts.without_kernel_time == 0 {
                    thread::park_timeout(self.gather);
                }
            }
            let before = self.arrived();
            more = self.drain(&mut sink)?;
            self.adapt(self.arrived() - before);
        }
        while self.drain(&mut sink)? {}
        Ok(self.counts())
    }

    /// Datagrams so far, unwanted ones included.
    const fn arrived(&self) -> u64 {
        self.counts.data + self.counts.position + self.counts.unwanted
    }

    /// Delivers the datagrams that arrived in order of their times, up to one batch per socket;
    /// returns whether more may be waiting.
    fn drain(&mut self, sink: &mut impl FnMut(&Record<'_>)) -> Result<bool, UdpError> {
        for (socket, batch) in self.sockets.iter_mut().zip(&mut self.batches) {
            if batch.peek().is_none() {
                socket.try_recv_batch(batch)?;
            }
        }
        while let Some(index) = earliest(&self.batches) {
            self.deliver(index, sink);
            let batch = self.batches.get(index);
            // Datagrams behind a full batch may be earlier than those of other sockets.
            if batch.is_some_and(|batch| batch.peek().is_none() && batch.was_full()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Delivers the next datagram of a socket, if it is wanted.
    fn deliver(&mut self, index: usize, sink: &mut impl FnMut(&Record<'_>)) {
        let (Some(socket), Some((received, payload))) = (
            self.sockets.get(index),
            self.batches.get_mut(index).and_then(Batch::take),
        ) else {
            return;
        };
        if !self.sources.is_empty() && !self.sources.contains(&received.source) {
            self.counts.unwanted += 1;
            return;
        }
        let record = Record {
            host: received.host,
            wire: Wire::Lidar {
                source: received.source.octets(),
                port: socket.address.port(),
                payload,
            },
        };
        self.counts.without_kernel_time += u64::from(!received.has_kernel_time);
        if self.position == Some(index) {
            self.counts.position += 1;
        } else {
            self.counts.data += 1;
        }
        sink(&record);
    }
}

/// Index of the batch whose next datagram arrived first.
fn earliest(batches: &[Batch]) -> Option<usize> {
    let next = batches
        .iter()
        .enumerate()
        .filter_map(|(index, batch)| Some((batch.peek()?.host, index)));
    next.min().map(|(_, index)| index)
}

/// Resolves when one of the sockets may be readable.
async fn readable(sockets: &[LidarSocket]) -> Result<(), UdpError> {
    poll_fn(|context| {
        let mut ready = Poll::Pending;
        // All are polled, so that each of them wakes this task.
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
