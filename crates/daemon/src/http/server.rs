//! Accepts connections, with their limits, and the runtime that serves them.

use std::convert::Infallible;
use std::future::Future;
use std::net::{IpAddr, SocketAddr, TcpListener as StdTcpListener};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::http::Request;
use axum::serve::Listener;
use engine::failure::{Failure, Kind};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;
#[cfg(devices)]
use tokio_rustls::TlsAcceptor;

use super::connection_limits::{ConnectionLimits, ConnectionSlot, TimedStream};
use crate::limits::{HEAD_BYTES, HEADERS, Waits};

/// A build without the daemon has no TLS.
#[cfg(not(devices))]
#[derive(Clone)]
pub enum TlsAcceptor {}

/// Wait for answers under way at the end.
const CLOSE_WAIT: Duration = Duration::from_secs(2);

pub(super) fn cannot_listen(place: &str, error: &std::io::Error) -> Failure {
    let help = match error.kind() {
        std::io::ErrorKind::PermissionDenied => {
            "allow this user to write the folder, set XDG_RUNTIME_DIR to another, or choose a port above 1023"
        }
        _ => {
            "end the program that has it, or choose another address with --listen (port 0 takes any that is free)"
        }
    };
    Failure::new(Kind::Usage, format!("cannot listen on {place}: {error}")).help(help)
}

/// Binds a TCP address.
///
/// # Errors
/// [`Kind::Usage`] where it is not available.
pub(crate) fn bind_tcp(listen: SocketAddr) -> Result<(StdTcpListener, SocketAddr), Failure> {
    let bind = || {
        let tcp = StdTcpListener::bind(listen)?;
        tcp.set_nonblocking(true)?;
        let address = tcp.local_addr()?;
        Ok((tcp, address))
    };
    bind().map_err(|error| cannot_listen(&listen.to_string(), &error))
}

/// A running server.
pub struct Server {
    pub(super) runtime: Runtime,
    waits: Waits,
    closing: watch::Sender<bool>,
    /// Cloned by every connection.
    open: mpsc::Sender<Infallible>,
    /// Closed once no connection is left.
    all_closed: mpsc::Receiver<Infallible>,
}

pub(super) fn no_runtime(error: std::io::Error) -> Failure {
    engine::no_resource("runtime", "the server", &error)
}

impl Server {
    /// Starts the runtime.
    ///
    /// # Errors
    /// Where the system cannot create threads.
    pub(crate) fn start(waits: Waits) -> Result<Self, Failure> {
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("http")
            .enable_all()
            .build()
            .map_err(no_runtime)?;
        let (open, all_closed) = mpsc::channel(1);
        Ok(Self {
            runtime,
            waits,
            closing: watch::Sender::new(false),
            open,
            all_closed,
        })
    }

    /// Becomes true when the server ends.
    pub(crate) fn closing(&self) -> watch::Receiver<bool> {
        self.closing.subscribe()
    }

    /// Serves a TCP socket, with TLS if that is given, with at most this many connections.
    pub(crate) fn accept_tcp(
        &mut self,
        listener: StdTcpListener,
        tls: Option<TlsAcceptor>,
        router: Router,
        connections: usize,
    ) -> Result<(), Failure> {
        let inside = self.runtime.enter();
        let listener = TcpListener::from_std(listener).map_err(no_runtime)?;
        drop(inside);
        let acceptor = Acceptor {
            tls,
            ..self.acceptor(connections)
        };
        self.runtime
            .spawn(acceptor.run(router, listener, remote_host));
        Ok(())
    }

    pub(super) fn acceptor(&self, connections: usize) -> Acceptor {
        Acceptor {
            limits: ConnectionLimits::new(connections),
            tls: None,
            open: self.open.clone(),
            closing: self.closing.subscribe(),
            waits: self.waits,
        }
    }

    /// Takes no more requests, waits a moment for answers under way and for `upgraded`
    /// connections, and ends.
    pub fn stop(self, upgraded: impl Future<Output = ()>) {
        let Self {
            runtime,
            closing,
            open,
            mut all_closed,
            ..
        } = self;
        closing.send_replace(true);
        drop(open);
        runtime.block_on(async {
            let ended = async {
                let _ = all_closed.recv().await;
                upgraded.await;
            };
            let _ = timeout(CLOSE_WAIT, ended).await;
        });
        runtime.shutdown_timeout(CLOSE_WAIT);
    }
}

/// The host of a connection, if it is not this machine.
fn remote_host(address: &SocketAddr) -> Option<IpAddr> {
    let ip = address.ip().to_canonical();
    (!ip.is_loopback()).then_some(ip)
}

/// Accepts the connections of a socket.
pub(super) struct Acceptor {
    limits: Arc<ConnectionLimits>,
    tls: Option<TlsAcceptor>,
    open: mpsc::Sender<Infallible>,
    closing: watch::Receiver<bool>,
    waits: Waits,
}

impl Acceptor {
    pub(super) async fn run<L: Listener>(
        mut self,
        router: Router,
        mut listener: L,
        host: fn(&L::Addr) -> Option<IpAddr>,
    ) {
        loop {
            let (stream, address) = tokio::select! {
                accepted = listener.accept() => accepted,
                _ = self.closing.wait_for(|closing| *closing) => return,
            };
            let Some(slot) = self.limits.enter(host(&address)) else {
                // Dropping the stream closes the connection.
                continue;
            };
            let (waits, router, closing) = (self.waits, router.clone(), self.closing.clone());
            let (open, tls) = (self.open.clone(), self.tls.clone());
            tokio::spawn(async move {
                let stream = TimedStream::new(stream, Arc::clone(&slot.connection), waits);
                let served = async {
                    match tls {
                        None => serve(stream, &slot, router, waits, closing).await,
                        // A client without TLS, or with another's certificate, is disconnected.
                        #[cfg(devices)]
                        Some(tls) => {
                            if let Ok(Ok(stream)) = timeout(waits.headers, tls.accept(stream)).await
                            {
                                serve(stream, &slot, router, waits, closing).await;
                            }
                        }
                        #[cfg(not(devices))]
                        Some(tls) => match tls {},
                    }
                };
                tokio::select! {
                    () = served => {}
                    () = slot.revoked() => {}
                }
                drop(open);
            });
        }
    }
}

async fn serve<S: AsyncRead + AsyncWrite + Unpin + Send + 'static>(
    stream: S,
    slot: &ConnectionSlot,
    router: Router,
    waits: Waits,
    mut closing: watch::Receiver<bool>,
) {
    let connection = Arc::clone(&slot.connection);
    let router = TowerToHyperService::new(router);
    // The guard records in it what a request proves.
    let answer = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(Arc::clone(&connection));
        router.call(request)
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(waits.headers)
        // Twice the limits: `request_limits::limits` refuses more with an error object.
        .max_buf_size(2 * HEAD_BYTES)
        .max_headers(2 * HEADERS)
        .serve_connection(TokioIo::new(stream), answer)
        .with_upgrades();
    let mut connection = std::pin::pin!(connection);
    let close = async {
        // The guard that it returns is not held across an await.
        drop(closing.wait_for(|closing| *closing).await);
    };
    // Errors of a connection have been answered where that was possible.
    tokio::select! {
        _ = connection.as_mut() => return,
        () = close => {}
    }
    connection.as_mut().graceful_shutdown();
    let _ = connection.await;
}
