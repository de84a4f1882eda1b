//! Who is connected, and who has to leave for others: nobody keeps the rest out by opening connections, nor by never reading.
//!
//! What a connection is answered is not known here.

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

/// What a connection has shown by its requests so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Standing {
    /// Nothing: it may ask for the page that signs in.
    Stranger,
    /// That it comes from this machine, where no more is asked for.
    Admitted,
    /// The token.
    Trusted,
}

/// A connection.
#[derive(Debug)]
pub struct Guest {
    /// Of another host's; absent for this machine's own.
    host: Option<IpAddr>,
    standing: AtomicU8,
    leave: Notify,
}

impl Guest {
    fn new(host: Option<IpAddr>) -> Arc<Self> {
        Arc::new(Self {
            host,
            standing: AtomicU8::new(Standing::Stranger as u8),
            leave: Notify::new(),
        })
    }

    /// It has shown so much, or more before.
    pub fn rise(&self, standing: Standing) {
        self.standing.fetch_max(standing as u8, Ordering::Relaxed);
    }

    fn is(&self, standing: Standing) -> bool {
        self.standing.load(Ordering::Relaxed) == standing as u8
    }
}

/// The connections of a socket.
#[derive(Debug)]
pub struct Guests {
    most: usize,
    /// Oldest first.
    inside: Mutex<Vec<Arc<Guest>>>,
}

/// A connection's place, until it is dropped.
#[derive(Debug)]
pub struct Place {
    guests: Arc<Guests>,
    /// Who has it.
    pub guest: Arc<Guest>,
}

impl Guests {
    /// At most so many.
    #[must_use]
    pub fn new(most: usize) -> Arc<Self> {
        Arc::new(Self {
            most,
            inside: Mutex::default(),
        })
    }

    fn inside(&self) -> MutexGuard<'_, Vec<Arc<Guest>>> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for one more, which another may have to leave: of a host that has its share its own oldest, and where all places are
    /// taken the oldest of those that have shown least. None where everybody inside has shown the token.
    #[must_use]
    pub fn enter(self: &Arc<Self>, host: Option<IpAddr>) -> Option<Place> {
        let mut inside = self.inside();
        let untrusted = || {
            let all = inside.iter().enumerate();
            all.filter(|(_, guest)| !guest.is(Standing::Trusted))
        };
        let same = || untrusted().filter(|(_, guest)| guest.host == host);
        let leaves = if host.is_some() && same().count() >= SHARE {
            same().next()
        } else if inside.len() >= self.most {
            // Of equals the first: the oldest.
            Some(untrusted().min_by_key(|(_, guest)| guest.standing.load(Ordering::Relaxed))?)
        } else {
            None
        };
        if let Some(at) = leaves.map(|(at, _)| at) {
            inside.remove(at).leave.notify_one();
        }
        let guest = Guest::new(host);
        inside.push(Arc::clone(&guest));
        Some(Place {
            guests: Arc::clone(self),
            guest,
        })
    }
}

impl Place {
    /// Waits until another needs it.
    pub async fn needed(&self) {
        self.guest.leave.notified().await;
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut inside = self.guests.inside();
        inside.retain(|guest| !Arc::ptr_eq(guest, &self.guest));
    }
}

/// A connection that fails where its client takes nothing of what it is sent for too long.
pub struct Paced<S> {
    stream: S,
    guest: Arc<Guest>,
    waits: Waits,
    late: Option<Pin<Box<Sleep>>>,
}

impl<S> Paced<S> {
    /// Of this guest.
    pub const fn new(stream: S, guest: Arc<Guest>, waits: Waits) -> Self {
        Self {
            stream,
            guest,
            waits,
            late: None,
        }
    }

    /// What came of a write, or that it has been waited for long enough.
    fn in_time(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<Result<usize>>,
    ) -> Poll<Result<usize>> {
        if written.is_ready() {
            self.late = None;
            return written;
        }
        let wait = match self.guest.is(Standing::Stranger) {
            true => self.waits.write,
            false => self.waits.download,
        };
        let late = self.late.get_or_insert_with(|| Box::pin(sleep(wait)));
        ready!(late.as_mut().poll(context));
        Poll::Ready(Err(Error::new(ErrorKind::TimedOut, "nobody reads")))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Paced<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Paced<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.in_time(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[IoSlice<'_>],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
        self.in_time(context, written)
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

    fn gone(place: &Place) -> bool {
        let inside = place.guests.inside();
        !inside.iter().any(|guest| Arc::ptr_eq(guest, &place.guest))
    }

    #[test]
    fn a_host_has_its_share_and_its_own_oldest_leaves() {
        let guests = Guests::new(CONNECTIONS);
        let other = guests.enter(host(1)).unwrap();
        let all: Vec<Place> = (0..3 * SHARE)
            .map(|_| guests.enter(host(2)).unwrap())
            .collect();
        assert!(!gone(&other));
        assert_eq!(guests.inside().len(), 1 + SHARE);
        let (left, stay) = all.split_at(2 * SHARE);
        assert!(left.iter().all(gone) && !stay.iter().any(gone));
        // Who shows the token is no part of the share.
        stay[0].guest.rise(Standing::Trusted);
        let one_more = guests.enter(host(2)).unwrap();
        assert!(!stay.iter().any(gone));
        drop((one_more, all));
        assert_eq!(guests.inside().len(), 1);
    }

    #[test]
    fn where_all_places_are_taken_who_has_shown_least_leaves() {
        let guests = Guests::new(4);
        let all: Vec<Place> = (0..4).map(|_| guests.enter(None).unwrap()).collect();
        all[0].guest.rise(Standing::Trusted);
        all[1].guest.rise(Standing::Admitted);
        let mut later = Vec::new();
        for leaves in [2, 3] {
            let place = guests.enter(host(1)).unwrap();
            place.guest.rise(Standing::Trusted);
            later.push(place);
            assert!(gone(&all[leaves]) && !gone(&all[1]));
        }
        later.push(guests.enter(None).unwrap());
        assert!(gone(&all[1]));
        later[2].guest.rise(Standing::Trusted);
        // A lower standing takes nothing away.
        later[2].guest.rise(Standing::Stranger);
        assert!(guests.enter(None).is_none());
        assert!(!gone(&all[0]));
        drop(later);
        assert!(guests.enter(None).is_some());
    }
}
