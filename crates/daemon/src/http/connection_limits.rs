//! Limits of connections: a client that opens many, or never reads, cannot keep others out.

use std::io::{Error, ErrorKind, IoSlice, Result};
use std::net::IpAddr;
use std::pin::Pin;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::Notify;
use tokio::time::{Sleep, sleep};

use crate::limits::{SHARE, Waits};

/// Credentials proved by the requests of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Trust {
    /// Nothing: only the page that signs in is answered.
    None,
    /// Origin on this machine, where no token is needed.
    Local,
    /// The token.
    Token,
}

/// A connection.
#[derive(Debug)]
pub struct Connection {
    /// The remote host; absent for this machine.
    host: Option<IpAddr>,
    trust: AtomicU8,
    revoked: Notify,
}

impl Connection {
    fn new(host: Option<IpAddr>) -> Arc<Self> {
        Arc::new(Self {
            host,
            trust: AtomicU8::new(Trust::None as u8),
            revoked: Notify::new(),
        })
    }

    /// The remote host; absent for this machine.
    #[must_use]
    pub fn host(&self) -> Option<IpAddr> {
        self.host
    }

    /// Raises the trust; it never falls.
    pub fn raise(&self, trust: Trust) {
        self.trust.fetch_max(trust as u8, Ordering::Relaxed);
    }

    fn is(&self, trust: Trust) -> bool {
        self.trust.load(Ordering::Relaxed) == trust as u8
    }
}

/// The connections of a socket.
#[derive(Debug)]
pub struct ConnectionLimits {
    max: usize,
    /// Oldest first.
    open: Mutex<Vec<Arc<Connection>>>,
}

/// The slot of an open connection. Dropping it frees the slot.
#[derive(Debug)]
pub struct ConnectionSlot {
    limits: Arc<ConnectionLimits>,
    /// The connection.
    pub connection: Arc<Connection>,
}

impl ConnectionLimits {
    /// Limits for at most this many connections.
    #[must_use]
    pub fn new(max: usize) -> Arc<Self> {
        Arc::new(Self {
            max,
            open: Mutex::default(),
        })
    }

    fn open(&self) -> MutexGuard<'_, Vec<Arc<Connection>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a slot. A host that has its share loses its oldest connection; if all slots are taken,
    /// the oldest of the least trusted is revoked. `None` if all connections have the token.
    #[must_use]
    pub fn enter(self: &Arc<Self>, host: Option<IpAddr>) -> Option<ConnectionSlot> {
        let mut open = self.open();
        let untrusted = || {
            let all = open.iter().enumerate();
            all.filter(|(_, connection)| !connection.is(Trust::Token))
        };
        let same = || untrusted().filter(|(_, connection)| connection.host == host);
        let revoked = if host.is_some() && same().count() >= SHARE {
            same().next()
        } else if open.len() >= self.max {
            // Of equals the first: the oldest.
            Some(
                untrusted()
                    .min_by_key(|(_, connection)| connection.trust.load(Ordering::Relaxed))?,
            )
        } else {
            None
        };
        if let Some(at) = revoked.map(|(at, _)| at) {
            open.remove(at).revoked.notify_one();
        }
        let connection = Connection::new(host);
        open.push(Arc::clone(&connection));
        Some(ConnectionSlot {
            limits: Arc::clone(self),
            connection,
        })
    }
}

impl ConnectionSlot {
    /// Waits until another connection needs the slot.
    pub async fn revoked(&self) {
        self.connection.revoked.notified().await;
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut open = self.limits.open();
        open.retain(|connection| !Arc::ptr_eq(connection, &self.connection));
    }
}

/// A stream whose writes time out if the client does not read.
pub struct TimedStream<S> {
    stream: S,
    connection: Arc<Connection>,
    waits: Waits,
    timeout: Option<Pin<Box<Sleep>>>,
}

impl<S> TimedStream<S> {
    /// The stream of a connection.
    pub const fn new(stream: S, connection: Arc<Connection>, waits: Waits) -> Self {
        Self {
            stream,
            connection,
            waits,
            timeout: None,
        }
    }

    /// The result of a write, or a timeout.
    fn within_limit(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<Result<usize>>,
    ) -> Poll<Result<usize>> {
        if written.is_ready() {
            self.timeout = None;
            return written;
        }
        let wait = match self.connection.is(Trust::None) {
            true => self.waits.write,
            false => self.waits.download,
        };
        let timeout = self.timeout.get_or_insert_with(|| Box::pin(sleep(wait)));
        ready!(timeout.as_mut().poll(context));
        Poll::Ready(Err(Error::new(
            ErrorKind::TimedOut,
            "the client does not read",
        )))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for TimedStream<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for TimedStream<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.within_limit(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[IoSlice<'_>],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
        self.within_limit(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::CONNECTIONS;

    fn host(last: u8) -> Option<IpAddr> {
        Some(IpAddr::from([10, 0, 0, last]))
    }

    fn is_revoked(slot: &ConnectionSlot) -> bool {
        let open = slot.limits.open();
        !open
            .iter()
            .any(|connection| Arc::ptr_eq(connection, &slot.connection))
    }

    #[test]
    fn a_host_over_its_share_loses_its_oldest_connection() {
        let limits = ConnectionLimits::new(CONNECTIONS);
        let other = limits.enter(host(1)).unwrap();
        let all: Vec<ConnectionSlot> = (0..3 * SHARE)
            .map(|_| limits.enter(host(2)).unwrap())
            .collect();
        assert!(!is_revoked(&other));
        assert_eq!(limits.open().len(), 1 + SHARE);
        let (left, stay) = all.split_at(2 * SHARE);
        assert!(left.iter().all(is_revoked) && !stay.iter().any(is_revoked));
        // Connections with the token do not count.
        stay[0].connection.raise(Trust::Token);
        let one_more = limits.enter(host(2)).unwrap();
        assert!(!stay.iter().any(is_revoked));
        drop((one_more, all));
        assert_eq!(limits.open().len(), 1);
    }

    #[test]
    fn the_least_trusted_connection_is_revoked_when_all_slots_are_taken() {
        let limits = ConnectionLimits::new(4);
        let all: Vec<ConnectionSlot> = (0..4).map(|_| limits.enter(None).unwrap()).collect();
        all[0].connection.raise(Trust::Token);
        all[1].connection.raise(Trust::Local);
        let mut later = Vec::new();
        for revoked in [2, 3] {
            let slot = limits.enter(host(1)).unwrap();
            slot.connection.raise(Trust::Token);
            later.push(slot);
            assert!(is_revoked(&all[revoked]) && !is_revoked(&all[1]));
        }
        later.push(limits.enter(None).unwrap());
        assert!(is_revoked(&all[1]));
        later[2].connection.raise(Trust::Token);
        // Trust never falls.
        later[2].connection.raise(Trust::None);
        assert!(limits.enter(None).is_none());
        assert!(!is_revoked(&all[0]));
        drop(later);
        assert!(limits.enter(None).is_some());
    }
}
