//! The daemon's HTTP: lists of routes, each answered by a function of a few lines.
//! docs/src/daemon.md and `openapi` document them.

use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;

use axum::Router;
use axum::extract::{Request, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::Response;
use axum::routing::{MethodRouter, get, post};
use engine::failure::{Failure, Kind};
use engine::service::DeviceService;
use engine::service::status::{AxisTask, DeviceHealth, ServiceStatus};
use serde::Serialize;
use tokio::sync::{Semaphore, watch};
use tokio_rustls::TlsAcceptor;
use utoipa::ToSchema;

use super::guard::{self, Peer, Sessions};
use super::refusal::{self, Refusal};
use super::server::Server;
use super::unix_socket::UnixSocket;
use super::{
    captures, download, events, json, metrics, no_method, openapi, page, request_limits, scans,
    statistics, tilt,
};
use crate::limits::{CONNECTIONS, DOWNLOADS, LOCAL_CONNECTIONS, MAKING, Waits};
use crate::state::{Counters, DaemonState};

/// Shared state of the request handlers.
pub struct Api {
    /// The daemon's state.
    pub state: Arc<DaemonState>,
    /// Time limits.
    pub waits: Waits,
    /// Whether TCP has TLS.
    pub secure: bool,
    /// Browsers that are signed in.
    pub sessions: Sessions,
    /// Permits for making clouds.
    pub making: Arc<Semaphore>,
    /// Permits for downloads.
    pub downloads: Arc<Semaphore>,
    /// True once the server is ending.
    pub closing: watch::Receiver<bool>,
}

pub(super) type Routes<S> = Vec<(&'static str, MethodRouter<S>)>;

/// Routes that read the state of the devices and stop the axis.
fn stop_routes() -> Routes<Arc<DeviceService>> {
    vec![
        ("/api/v1/status", get(status)),
        ("/api/v1/captures/stop", post(captures::stop)),
        ("/api/v1/tilt", get(tilt::status)),
        ("/api/v1/tilt/stop", post(tilt::stop)),
    ]
}

/// Routes that need nothing but the devices.
pub(super) fn device_routes() -> Routes<Arc<DeviceService>> {
    let mut routes = stop_routes();
    routes.extend([
        ("/api/v1/tilt/home", post(tilt::home)),
        ("/api/v1/tilt/goto", post(tilt::goto)),
        ("/api/v1/tilt/clear", post(tilt::clear)),
    ]);
    routes
}

/// Routes of a daemon.
pub(super) fn daemon_routes() -> Routes<Arc<Api>> {
    vec![
        ("/api/v1/openapi.json", get(openapi::description)),
        ("/api/v1/plan", get(captures::plan)),
        ("/api/v1/captures", post(captures::begin)),
        ("/api/v1/scans", get(scans::list)),
        (
            "/api/v1/scans/{id}",
            get(scans::one).patch(scans::edit).delete(scans::delete),
        ),
        ("/api/v1/scans/{id}/restore", post(scans::restore)),
        ("/api/v1/scans/{id}/statistics", get(statistics::measure)),
        ("/api/v1/scans/{id}/cloud", get(download::cloud)),
        ("/api/v1/scans/{id}/log", get(download::log)),
        ("/api/v1/scans/{id}/thumbnail", get(download::thumbnail)),
        ("/api/v1/events", get(events::events)),
        ("/health", get(health)),
        ("/metrics", get(metrics::metrics)),
    ]
}

fn router<S: Clone + Send + Sync + 'static>(routes: Routes<S>) -> Router<S> {
    let routes = routes.into_iter();
    routes.fold(Router::new(), |router, (path, methods)| {
        router.route(path, methods)
    })
}

/// The router of a daemon for requests that come over `peer`.
fn daemon_router(api: &Arc<Api>, peer: Peer) -> Router {
    let devices = router(device_routes()).with_state(Arc::clone(&api.state.service));
    router(daemon_routes())
        .route("/", get(page::page))
        .route("/login", get(page::signed_in).post(page::login))
        .route("/logout", post(page::logout))
        .merge(devices)
        .fallback(page::asset)
        .method_not_allowed_fallback(method_refused)
        .layer(from_fn_with_state(api.waits, request_limits::limits))
        .layer(from_fn_with_state((Arc::clone(api), peer), guard::guard))
        .layer(from_fn_with_state(Arc::clone(api), count))
        .with_state(Arc::clone(api))
}

/// The router of a command's own service. It makes no moves for others: the command ends with its
/// own.
pub(crate) fn command_router(service: &Arc<DeviceService>, waits: Waits) -> Router {
    router(stop_routes())
        .fallback(in_use)
        .method_not_allowed_fallback(method_refused)
        .layer(from_fn_with_state(waits, request_limits::limits))
        .with_state(Arc::clone(service))
}

/// Serves a daemon over TCP and its Unix socket.
///
/// # Errors
/// Where the system cannot create threads.
pub(crate) fn serve(
    state: &Arc<DaemonState>,
    (tcp, address): (TcpListener, SocketAddr),
    tls: Option<TlsAcceptor>,
    unix: UnixSocket,
    waits: Waits,
) -> Result<Server, Failure> {
    let mut server = Server::start(waits)?;
    let api = Arc::new(Api {
        state: Arc::clone(state),
        waits,
        secure: tls.is_some(),
        sessions: Sessions::default(),
        making: Arc::new(Semaphore::new(MAKING)),
        downloads: Arc::new(Semaphore::new(DOWNLOADS)),
        closing: server.closing(),
    });
    let router = daemon_router(&api, Peer::Tcp(address.ip()));
    server.accept_tcp(tcp, tls, router, CONNECTIONS)?;
    server.accept_unix(unix, daemon_router(&api, Peer::Local), LOCAL_CONNECTIONS)?;
    Ok(server)
}

async fn in_use() -> Refusal {
    Refusal::new(
        StatusCode::CONFLICT,
        Kind::Busy,
        "another velomotion command uses the device",
        "wait for its end, or stop it (tilt stop)",
    )
    .retry_after(refusal::RETRY_S)
}

async fn method_refused() -> Refusal {
    no_method()
}

async fn count(State(api): State<Arc<Api>>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    let counters = &api.state.counters;
    Counters::count(&counters.requests);
    if response.status().is_client_error() {
        Counters::count(&counters.refused);
    }
    response
}

/// State of the daemon, both devices and the current activity.
#[utoipa::path(get, path = "/api/v1/status", tag = "daemon", responses((status = 200, body = ServiceStatus)))]
async fn status(State(service): State<Arc<DeviceService>>) -> Response {
    json(StatusCode::OK, &service.status())
}

/// Body of `GET /health`.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[schema(example = json!({"live": true, "ready": true, "drive": "connected", "lidar": "connected"}))]
pub struct HealthReport {
    /// Whether the daemon answers: always true.
    live: bool,
    /// Whether it could capture now: both devices are connected, no motion is under way, and more
    /// of the disk is free than its reserve.
    ready: bool,
    /// The drive.
    drive: DeviceHealth,
    /// The lidar.
    lidar: DeviceHealth,
}

/// For monitors: an answer means live, 200 ready for a capture.
#[utoipa::path(get, path = "/health", tag = "daemon", responses(
    (status = 200, body = HealthReport),
    (status = 503, description = "Not ready for a capture", body = HealthReport),
))]
async fn health(State(api): State<Arc<Api>>) -> Response {
    let status = api.state.service.status();
    let (drive, lidar) = (status.drive.state, status.lidar.state);
    let disk = &status.disk;
    let ready = [drive, lidar] == [DeviceHealth::Connected; 2]
        && (status.activity.doing == AxisTask::Idle || status.activity.reads_only)
        && disk
            .free_bytes
            .is_none_or(|free| free >= disk.reserve_bytes);
    let body = HealthReport {
        live: true,
        ready,
        drive,
        lidar,
    };
    if ready {
        return json(StatusCode::OK, &body);
    }
    let mut response = json(StatusCode::SERVICE_UNAVAILABLE, &body);
    let headers = response.headers_mut();
    headers.insert(header::RETRY_AFTER, refusal::RETRY_S.into());
    response
}
