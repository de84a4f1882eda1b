//! The sockets: TCP and Unix, each connection with its limits, and a runtime of their own.

use std::convert::Infallible;
use std::net::{IpAddr, SocketAddr, TcpListener as StdTcpListener};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener as StdUnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::http::Request;
use axum::serve::Listener;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, UnixListener};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Semaphore, mpsc, watch};

use super::guard::Peer;
use super::guests::{Guests, Paced, Place};
use super::{Api, router};
use crate::limits::{CONNECTIONS, HEAD_BYTES, HEADERS, LOCAL_CONNECTIONS, SUBSCRIBERS, Waits};
use crate::shared::Shared;
use engine::failure::{Failure, Kind};

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
    /// Ends once no connection is left.
    staying: mpsc::Receiver<Infallible>,
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
        let (stay, staying) = mpsc::channel(1);
        let inside = runtime.enter();
        let tcp = TcpListener::from_std(self.tcp).map_err(cannot)?;
        let unix = UnixListener::from_std(self.unix).map_err(cannot)?;
        drop(inside);
        let door = |most| Door {
            guests: Guests::new(most),
            stay: stay.clone(),
            closing: close.clone(),
            waits,
        };
        let (open, open_door) = (
            router(&api, Peer::Tcp(self.address.ip())),
            door(CONNECTIONS),
        );
        let (local, local_door) = (router(&api, Peer::Local), door(LOCAL_CONNECTIONS));
        runtime.spawn(async move {
            open_door.keep(open, tcp, remote).await;
        });
        runtime.spawn(async move {
            local_door.keep(local, unix, |_| None).await;
        });
        Ok(Server {
            runtime,
            address: self.address,
            closing,
            staying,
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
    pub fn stop(mut self) {
        self.closing.send_replace(true);
        let all = u32::try_from(SUBSCRIBERS).unwrap_or(u32::MAX);
        self.runtime.block_on(async {
            // Every connection has a sender, and every WebSocket a permit.
            let ended = async {
                let _ = self.staying.recv().await;
                drop(self.sockets.acquire_many(all).await);
            };
            let _ = tokio::time::timeout(LAST, ended).await;
        });
        self.runtime.shutdown_timeout(LAST);
    }
}

/// The host that a connection comes from, if it is another.
fn remote(address: &SocketAddr) -> Option<IpAddr> {
    let ip = address.ip().to_canonical();
    (!ip.is_loopback()).then_some(ip)
}

/// Lets connections in.
struct Door {
    guests: Arc<Guests>,
    stay: mpsc::Sender<Infallible>,
    closing: watch::Receiver<bool>,
    waits: Waits,
}

impl Door {
    async fn keep<L: Listener>(
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
            let Some(place) = self.guests.enter(host(&address)) else {
                // Dropped, which closes it.
                continue;
            };
            let (waits, router, closing) = (self.waits, router.clone(), self.closing.clone());
            let stay = self.stay.clone();
            tokio::spawn(async move {
                tokio::select! {
                    () = talk(stream, &place, router, waits, closing) => {}
                    () = place.needed() => {}
                }
                drop(stay);
            });
        }
    }
}

async fn talk<S: AsyncRead + AsyncWrite + Unpin + Send + 'static>(
    stream: S,
    place: &Place,
    router: Router,
    waits: Waits,
    mut closing: watch::Receiver<bool>,
) {
    let guest = Arc::clone(&place.guest);
    let stream = Paced::new(stream, Arc::clone(&guest), waits);
    let router = TowerToHyperService::new(router);
    // Whoever checks a request tells what it shows.
    let answer = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(Arc::clone(&guest));
        router.call(request)
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(waits.headers)
        .max_buf_size(HEAD_BYTES)
        .max_headers(HEADERS)
        .serve_connection(TokioIo::new(stream), answer)
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
