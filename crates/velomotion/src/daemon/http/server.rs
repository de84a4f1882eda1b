//! The sockets: TCP and Unix, each connection with its limits, and a runtime of their own.

use std::net::{SocketAddr, TcpListener as StdTcpListener};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener as StdUnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::serve::Listener;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, UnixListener};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Semaphore, watch};

use super::guard::Peer;
use super::{Api, router};
use crate::daemon::limits::{CONNECTIONS, HEAD_BYTES, HEADERS, SUBSCRIBERS, Waits};
use crate::daemon::shared::Shared;
use crate::failure::{Failure, Kind};

/// How long answers that are on their way are waited for at the end.
const LAST: Duration = Duration::from_secs(2);

/// Sockets that are bound.
pub struct Bound {
    tcp: StdTcpListener,
    address: SocketAddr,
    unix: StdUnixListener,
    socket: Socket,
}

/// The Unix socket's file, removed at the end.
struct Socket(PathBuf);

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Sockets that are answered.
pub struct Server {
    runtime: Runtime,
    address: SocketAddr,
    closing: watch::Sender<bool>,
    connections: Arc<Semaphore>,
    sockets: Arc<Semaphore>,
    _socket: Socket,
}

impl Bound {
    /// Binds both.
    ///
    /// # Errors
    /// [`Kind::NoDevice`] where another daemon has the device, [`Kind::Usage`] where the address cannot be had.
    pub fn bind(listen: SocketAddr, socket: &Path) -> Result<Self, Failure> {
        if UnixStream::connect(socket).is_ok() {
            return Err(Failure::new(
                Kind::NoDevice,
                format!("another daemon has this device ({})", socket.display()),
            )
            .help("use that one, or end it first"));
        }
        let cannot = |what: String, error: &std::io::Error| {
            Failure::new(Kind::Usage, format!("cannot listen on {what}: {error}")).help(
                "end the program that has it, or choose another address with --listen (port 0 takes any that is free)",
            )
        };
        let tcp = StdTcpListener::bind(listen).map_err(|e| cannot(listen.to_string(), &e))?;
        let address = tcp
            .local_addr()
            .map_err(|e| cannot(listen.to_string(), &e))?;
        // Nobody answers there: it was left by one that was killed.
        let _ = std::fs::remove_file(socket);
        let name = socket.display().to_string();
        let unix = StdUnixListener::bind(socket).map_err(|e| cannot(name.clone(), &e))?;
        let socket = Socket(socket.to_owned());
        let permissions = std::fs::Permissions::from_mode(0o660);
        std::fs::set_permissions(&socket.0, permissions).map_err(|e| cannot(name.clone(), &e))?;
        for blocking in [tcp.set_nonblocking(true), unix.set_nonblocking(true)] {
            blocking.map_err(|e| cannot(name.clone(), &e))?;
        }
        Ok(Self {
            tcp,
            address,
            unix,
            socket,
        })
    }

    /// Answers from now on.
    ///
    /// # Errors
    /// Where the system gives no threads.
    pub fn serve(self, shared: &Arc<Shared>, waits: Waits) -> Result<Server, Failure> {
        let cannot = |error: std::io::Error| {
            Failure::new(
                Kind::NoDevice,
                format!("no runtime for the server: {error}"),
            )
            .help("end other programs; see ulimit -u")
        };
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("http")
            .enable_all()
            .build()
            .map_err(cannot)?;
        let (closing, close) = watch::channel(false);
        let api = Arc::new(Api::new(shared, waits, close.clone()));
        let connections = Arc::new(Semaphore::new(CONNECTIONS));
        let inside = runtime.enter();
        let tcp = TcpListener::from_std(self.tcp).map_err(cannot)?;
        let unix = UnixListener::from_std(self.unix).map_err(cannot)?;
        drop(inside);
        let door = Door {
            connections: Arc::clone(&connections),
            closing: close,
            waits,
        };
        let open = router(&api, Peer::Tcp(self.address.ip()));
        let local = router(&api, Peer::Local);
        let theirs = door.clone();
        runtime.spawn(async move {
            theirs.keep(open, tcp).await;
        });
        runtime.spawn(async move {
            door.keep(local, unix).await;
        });
        Ok(Server {
            runtime,
            address: self.address,
            closing,
            connections,
            sockets: Arc::clone(&api.sockets),
            _socket: self.socket,
        })
    }
}

impl Server {
    /// Where TCP is listened to.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Takes no more requests, sends what is on its way for a moment, and ends.
    pub fn stop(self) {
        self.closing.send_replace(true);
        let all = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        self.runtime.block_on(async {
            // Every connection has a permit, and every WebSocket another.
            let ended = async {
                let connections = self.connections.acquire_many(all(CONNECTIONS)).await;
                let sockets = self.sockets.acquire_many(all(SUBSCRIBERS)).await;
                drop((connections, sockets));
            };
            let _ = tokio::time::timeout(LAST, ended).await;
        });
        self.runtime.shutdown_timeout(LAST);
    }
}

/// Lets connections in.
#[derive(Clone)]
struct Door {
    connections: Arc<Semaphore>,
    closing: watch::Receiver<bool>,
    waits: Waits,
}

impl Door {
    async fn keep<L: Listener>(mut self, router: Router, mut listener: L) {
        loop {
            let entered = async {
                let (stream, _) = listener.accept().await;
                // One too many waits here, and those behind it in the kernel.
                let permit = Arc::clone(&self.connections).acquire_owned().await;
                Some((stream, permit.ok()?))
            };
            let entered = tokio::select! {
                entered = entered => entered,
                _ = self.closing.wait_for(|closing| *closing) => None,
            };
            let Some((stream, permit)) = entered else {
                return;
            };
            let (waits, router, closing) = (self.waits, router.clone(), self.closing.clone());
            tokio::spawn(async move {
                talk(stream, router, waits, closing).await;
                drop(permit);
            });
        }
    }
}

async fn talk<S: AsyncRead + AsyncWrite + Unpin + Send + 'static>(
    stream: S,
    router: Router,
    waits: Waits,
    mut closing: watch::Receiver<bool>,
) {
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(waits.headers)
        .max_buf_size(HEAD_BYTES)
        .max_headers(HEADERS)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    let mut connection = std::pin::pin!(connection);
    let close = async {
        // What it gives back is no thing to hold while waiting.
        drop(closing.wait_for(|closing| *closing).await);
    };
    // What is wrong with a connection is the client's affair, who has been told where that could be.
    tokio::select! {
        _ = connection.as_mut() => return,
        () = close => {}
    }
    connection.as_mut().graceful_shutdown();
    let _ = connection.await;
}
