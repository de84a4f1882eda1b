//! The server of `velomotion view`: the page with files instead of a daemon's scans.
//!
//! It listens on the loopback interface. The token is the first part of every path, so that
//! neither other users nor pages of other servers can read the files.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use engine::config::daemon::equal;
use engine::failure::{Failure, Kind};
use engine::reconstruct::source::Source;
use engine::reconstruct::statistics::statistics;
use futures_util::stream::unfold;
use io::files::ReopenableFile;
use scanner::Accuracy;
use serde::Serialize;
use tokio::sync::{Semaphore, watch};
use tokio::time::sleep;

use super::ClientGuard;
use super::assets;
use super::connection_limits::{Connection, Trust};
use super::partial::tag_of;
use super::refusal::Refusal;
use super::request_limits;
use super::secret::secret;
use super::send_file;
use super::server::{self, Server};
use crate::limits::{CONNECTIONS, DOWNLOADS, Waits};

/// Between two signs of life to a page.
const ALIVE: Duration = Duration::from_secs(1);
/// A page that is reloaded is back within this time, also on a busy machine.
const RELOAD: Duration = Duration::from_secs(10);

/// State of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FileState {
    /// Its cloud is being made.
    Making,
    /// Its cloud can be shown.
    Ready,
    /// It has no cloud.
    Failed,
}

/// A file as the page shows it.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ViewedFile {
    /// Name.
    pub name: String,
    /// State.
    pub state: FileState,
    /// Part of the cloud that is made, if known.
    pub share: Option<f64>,
    /// Points, if known.
    pub points: Option<u64>,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// Whether the origin is on the tilt axis.
    pub scanner: bool,
    /// Whether it is a log or recording.
    pub log: bool,
    /// What its replay reports.
    pub report: Option<serde_json::Value>,
    /// Why there is no cloud, or what it lacks.
    pub error: Option<String>,
    /// What to do about it.
    pub help: Option<String>,
    /// The cloud as binary PLY.
    #[serde(skip)]
    pub cloud: Option<Arc<ReopenableFile>>,
    /// The log or recording.
    #[serde(skip)]
    source: Option<Arc<Source>>,
}

impl ViewedFile {
    /// A file whose cloud is to be made.
    #[must_use]
    pub const fn new(name: String, source: Option<Arc<Source>>) -> Self {
        let log = source.is_some();
        Self {
            name,
            state: FileState::Making,
            share: None,
            points: None,
            simulated: false,
            scanner: log,
            log,
            report: None,
            error: None,
            help: None,
            cloud: None,
            source,
        }
    }
}

/// The files, which pages and the command share.
pub struct ViewedFiles {
    token: String,
    files: watch::Sender<Vec<ViewedFile>>,
    pages: Mutex<Pages>,
    downloads: Arc<Semaphore>,
    /// Statistics are measured one after the other.
    measuring: Arc<Semaphore>,
    closing: watch::Receiver<bool>,
}

/// Open pages.
#[derive(Debug, Default)]
struct Pages {
    open: usize,
    /// Time at which the last one was closed.
    left: Option<Instant>,
}

impl ViewedFiles {
    /// Changes a file and tells the pages.
    pub fn update(&self, index: usize, change: impl FnOnce(&mut ViewedFile)) {
        self.files.send_modify(|files| {
            if let Some(file) = files.get_mut(index) {
                change(file);
            }
        });
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a cloud can be shown.
    #[must_use]
    pub fn has_cloud(&self) -> bool {
        let files = self.files.borrow();
        files.iter().any(|file| file.state == FileState::Ready)
    }

    /// Whether a page is open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.pages().open > 0
    }

    /// Whether every page has been closed.
    #[must_use]
    pub fn is_left(&self) -> bool {
        let pages = self.pages();
        pages.open == 0 && pages.left.is_some_and(|left| left.elapsed() > RELOAD)
    }
}

/// A page that listens to changes.
struct OpenPage(Arc<ViewedFiles>);

impl OpenPage {
    fn new(files: &Arc<ViewedFiles>) -> Self {
        files.pages().open += 1;
        Self(Arc::clone(files))
    }
}

impl Drop for OpenPage {
    fn drop(&mut self) {
        let mut pages = self.0.pages();
        pages.open = pages.open.saturating_sub(1);
        pages.left = Some(Instant::now());
    }
}

/// A running server.
pub struct ViewServer {
    /// The files.
    pub files: Arc<ViewedFiles>,
    address: SocketAddr,
    server: Server,
}

impl ViewServer {
    /// Serves files on a free port of the loopback interface.
    ///
    /// # Errors
    /// Where the system has no port, thread or random number.
    pub fn start(files: Vec<ViewedFile>) -> Result<Self, Failure> {
        let token = secret().map_err(|error| {
            let what = format!("cannot get random bytes from the system: {error}");
            Failure::new(Kind::Incomplete, what)
                .help("start it again: the system's random numbers may not be ready")
        })?;
        let waits = Waits::default();
        let (tcp, address) = server::bind_tcp((Ipv4Addr::LOCALHOST, 0).into())?;
        let mut server = Server::start(waits)?;
        let files = Arc::new(ViewedFiles {
            token,
            files: watch::Sender::new(files),
            pages: Mutex::default(),
            downloads: Arc::new(Semaphore::new(DOWNLOADS)),
            measuring: Arc::new(Semaphore::new(1)),
            closing: server.closing(),
        });
        let router = Router::new()
            .fallback(answer)
            .layer(from_fn_with_state(waits, request_limits::limits))
            .with_state(Arc::clone(&files));
        server.accept_tcp(tcp, None, router, CONNECTIONS)?;
        Ok(Self {
            files,
            address,
            server,
        })
    }

    /// Address of the page, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.files.token)
    }

    /// Ends the server.
    pub fn stop(self) {
        self.server.stop(std::future::ready(()));
    }
}

async fn answer(State(files): State<Arc<ViewedFiles>>, request: Request) -> Response {
    let path = request.uri().path().trim_start_matches('/');
    let (token, rest) = path.split_once('/').unwrap_or((path, ""));
    if !equal(files.token.as_bytes(), token.as_bytes()) {
        return Refusal::new(
            StatusCode::NOT_FOUND,
            Kind::NotFound,
            "there is nothing at this address",
            "use the whole address that velomotion view prints",
        )
        .into_response();
    }
    if let Some(connection) = request.extensions().get::<Arc<Connection>>() {
        connection.raise(Trust::Token);
    }
    if !path.contains('/') {
        // The page's own addresses are relative.
        let page = [(header::LOCATION, format!("/{token}/"))];
        return (StatusCode::PERMANENT_REDIRECT, page).into_response();
    }
    let cloud = rest.strip_prefix("clouds/");
    let cloud = cloud.and_then(|name| name.strip_suffix(".ply"));
    if let Some(index) = cloud {
        let (index, headers) = (index.to_owned(), request.headers().clone());
        let cloud = cloud_of(&files, &index, &headers).await;
        return cloud.unwrap_or_else(IntoResponse::into_response);
    }
    if let Some(index) = rest.strip_prefix("statistics/") {
        let index = index.to_owned();
        let measured = statistics_of(&files, &index).await;
        return measured.unwrap_or_else(IntoResponse::into_response);
    }
    match rest {
        "" => assets::page_of_files(),
        "events" => events(&files),
        _ => assets::file(&format!("/{rest}"), &request),
    }
}

/// The cloud of a file.
async fn cloud_of(
    files: &Arc<ViewedFiles>,
    index: &str,
    headers: &HeaderMap,
) -> Result<Response, Refusal> {
    let no_cloud = || Refusal::no_file("cloud");
    let index: usize = index.parse().map_err(|_| no_cloud())?;
    let cloud = files
        .files
        .borrow()
        .get(index)
        .and_then(|f| f.cloud.clone());
    let cloud = cloud.ok_or_else(no_cloud)?;
    let permit = Arc::clone(&files.downloads)
        .try_acquire_owned()
        .map_err(|_| Refusal::too_many("downloads"))?;
    let opened = super::with_disk(move || {
        let file = cloud.reopen()?;
        let metadata = file.metadata()?;
        Ok::<_, std::io::Error>((file, metadata))
    });
    let opened = opened.await?.map_err(|_| no_cloud())?;
    let name = format!("velomotion-{index}");
    let tag = tag_of(&opened.1);
    let name = (name.as_str(), "ply");
    Ok(send_file::send(opened, name, permit, (headers, &tag)))
}

/// Density, gaps, ranges, residuals and stated standard deviations of a log.
async fn statistics_of(files: &Arc<ViewedFiles>, index: &str) -> Result<Response, Refusal> {
    let no_log = || Refusal::no_file("log");
    let index: usize = index.parse().map_err(|_| no_log())?;
    let source = files
        .files
        .borrow()
        .get(index)
        .and_then(|file| file.source.clone());
    let source = source.ok_or_else(no_log)?;
    let ended = || {
        Refusal::new(
            StatusCode::SERVICE_UNAVAILABLE,
            Kind::Interrupted,
            "velomotion view has ended",
            "start it again",
        )
    };
    let mut closing = files.closing.clone();
    let permit = tokio::select! {
        permit = Arc::clone(&files.measuring).acquire_owned() => permit.map_err(|_| ended())?,
        _ = closing.wait_for(|closing| *closing) => return Err(ended()),
    };
    let client = ClientGuard::default();
    let interrupt = client.interrupt();
    let measured = super::with_disk(move || {
        let _permit = permit;
        statistics(&source, Accuracy::Best, &interrupt)
    });
    let measured = tokio::select! {
        measured = measured => measured??,
        // The guard ends the measurement.
        _ = closing.wait_for(|closing| *closing) => return Err(ended()),
    };
    Ok(super::json(StatusCode::OK, &measured))
}

/// The files now and after each change, as server-sent events (HTML, section 9.2).
fn events(files: &Arc<ViewedFiles>) -> Response {
    let state = EventState {
        _page: OpenPage::new(files),
        changes: files.files.subscribe(),
        closing: files.closing.clone(),
        is_first: true,
    };
    let body = Body::from_stream(unfold(state, |mut state| async move {
        let event = state.next().await?;
        Some((Ok::<_, std::convert::Infallible>(event), state))
    }));
    let headers = [
        (header::CONTENT_TYPE, "text/event-stream"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    (headers, body).into_response()
}

struct EventState {
    _page: OpenPage,
    changes: watch::Receiver<Vec<ViewedFile>>,
    closing: watch::Receiver<bool>,
    is_first: bool,
}

impl EventState {
    /// The next event; `None` at the end of the server.
    async fn next(&mut self) -> Option<String> {
        if !std::mem::take(&mut self.is_first) {
            tokio::select! {
                changed = self.changes.changed() => changed.ok()?,
                () = sleep(ALIVE) => return Some(":\n\n".to_owned()),
                _ = self.closing.wait_for(|closing| *closing) => return None,
            }
        }
        let files = self.changes.borrow_and_update().clone();
        let json = serde_json::to_string(&files).ok()?;
        Some(format!("data: {json}\n\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_left_once_the_last_page_has_been_closed_for_longer_than_a_reload() {
        let server = ViewServer::start(Vec::new()).unwrap();
        let files = Arc::clone(&server.files);
        assert!(!files.is_left(), "no page was open yet");
        let (one, other) = (OpenPage::new(&files), OpenPage::new(&files));
        drop(one);
        assert!(files.is_open() && !files.is_left());
        drop(other);
        assert!(!files.is_open() && !files.is_left());
        files.pages().left = Instant::now().checked_sub(2 * RELOAD);
        assert!(files.is_left());
        let _back = OpenPage::new(&files);
        assert!(!files.is_left());
        server.stop();
    }
}
