//! The daemon's HTTP: one list of routes, each answered by a function of a few lines. docs/src/daemon.md and `openapi.json` say what they mean.

pub mod captures;
pub mod download;
pub mod events;
pub mod guard;
pub mod guests;
pub mod metrics;
pub mod page;
pub mod refusal;
pub mod scans;
pub mod server;
pub mod tilt;

use std::sync::Arc;

use axum::Router;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, delete, get, post};
use tokio::sync::Semaphore;
use tokio::sync::watch;

use super::limits::{DOWNLOADS, MAKING, SUBSCRIBERS, Waits};
use super::shared::{Counters, Shared};
use guard::{Peer, Sessions};
use refusal::Refusal;

/// What requests are answered with.
pub struct Api {
    /// The daemon's state.
    pub shared: Arc<Shared>,
    /// What lasts too long.
    pub waits: Waits,
    /// Browsers that are signed in.
    pub sessions: Sessions,
    /// Permits for making clouds.
    pub making: Arc<Semaphore>,
    /// Permits for downloads.
    pub downloads: Arc<Semaphore>,
    /// Permits for WebSockets.
    pub sockets: Arc<Semaphore>,
    /// True once everybody is to leave.
    pub closing: watch::Receiver<bool>,
}

impl Api {
    /// Of a daemon.
    #[must_use]
    pub fn new(shared: &Arc<Shared>, waits: Waits, closing: watch::Receiver<bool>) -> Self {
        Self {
            shared: Arc::clone(shared),
            waits,
            sessions: Sessions::default(),
            making: Arc::new(Semaphore::new(MAKING)),
            downloads: Arc::new(Semaphore::new(DOWNLOADS)),
            sockets: Arc::new(Semaphore::new(SUBSCRIBERS)),
            closing,
        }
    }
}

type Route = (&'static str, MethodRouter<Arc<Api>>);

/// Every route of the API.
fn routes() -> Vec<Route> {
    vec![
        ("/api/v1/openapi.json", get(page::openapi)),
        ("/api/v1/status", get(status)),
        ("/api/v1/plan", get(captures::plan)),
        ("/api/v1/captures", post(captures::begin)),
        ("/api/v1/captures/stop", post(captures::stop)),
        ("/api/v1/tilt", get(tilt::status)),
        ("/api/v1/tilt/home", post(tilt::home)),
        ("/api/v1/tilt/goto", post(tilt::goto)),
        ("/api/v1/tilt/stop", post(tilt::stop)),
        ("/api/v1/tilt/clear", post(tilt::clear)),
        ("/api/v1/scans", get(scans::list)),
        (
            "/api/v1/scans/{id}",
            get(scans::one).merge(delete(scans::delete)),
        ),
        ("/api/v1/scans/{id}/cloud", get(download::cloud)),
        ("/api/v1/scans/{id}/log", get(download::log)),
        ("/api/v1/scans/{id}/thumbnail", get(download::thumbnail)),
        ("/api/v1/events", get(events::events)),
        ("/metrics", get(metrics::metrics)),
    ]
}

/// Everything that is answered, for requests that come by `peer`.
pub fn router(api: &Arc<Api>, peer: Peer) -> Router {
    let router = routes()
        .into_iter()
        .fold(Router::new(), |router, (path, methods)| {
            router.route(path, methods)
        });
    router
        .route("/login", post(page::login))
        .fallback(page::asset)
        .method_not_allowed_fallback(no_method)
        .layer(from_fn_with_state(api.waits, guard::limits))
        .layer(from_fn_with_state((Arc::clone(api), peer), guard::guard))
        .layer(from_fn_with_state(Arc::clone(api), count))
        .with_state(Arc::clone(api))
}

async fn no_method() -> Refusal {
    Refusal::new(
        StatusCode::METHOD_NOT_ALLOWED,
        "usage",
        "this path does not have that method",
        "GET /api/v1/openapi.json lists paths and methods",
    )
}

async fn count(State(api): State<Arc<Api>>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    let counters = &api.shared.counters;
    Counters::count(&counters.requests);
    if response.status().is_client_error() {
        Counters::count(&counters.refused);
    }
    response
}

async fn status(State(api): State<Arc<Api>>) -> Response {
    json(StatusCode::OK, &api.shared.status())
}

/// Does what may wait for a disk, beside the threads that answer: a stop must get through whatever the disk does.
///
/// # Errors
/// [`Refusal`] after a defect in it.
pub async fn with_disk<T: Send + 'static>(
    what: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Refusal> {
    tokio::task::spawn_blocking(what).await.map_err(|_| {
        Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "incomplete",
            "a defect of the program",
            "run the daemon with -vv and report what it says",
        )
    })
}

/// An answer in JSON.
pub fn json(status: StatusCode, body: &impl serde::Serialize) -> Response {
    match serde_json::to_vec(body) {
        Ok(body) => {
            let headers = [
                ("content-type", "application/json"),
                ("cache-control", "no-store"),
            ];
            (status, headers, body).into_response()
        }
        Err(error) => Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "incomplete",
            format!("cannot be said in JSON: {error}"),
            "this is a defect of the program",
        )
        .into_response(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Methods that a route answers, by what the router itself says of it.
    fn methods(of: &str) -> BTreeSet<String> {
        let (_, router) = routes().into_iter().find(|(path, _)| *path == of).unwrap();
        let shown = format!("{router:?}");
        ["get", "post", "put", "delete", "patch"]
            .into_iter()
            .filter(|method| !shown.contains(&format!(" {method}: None")))
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn the_description_has_every_route_and_no_other() {
        let described: serde_json::Value = serde_json::from_str(page::OPENAPI).unwrap();
        let paths = described["paths"].as_object().unwrap();
        let ours: BTreeSet<&str> = routes().iter().map(|(path, _)| *path).collect();
        let theirs: BTreeSet<&str> = paths.keys().map(String::as_str).collect();
        let extra: BTreeSet<&str> = ["/", "/login"].into();
        assert_eq!(ours.union(&extra).copied().collect::<BTreeSet<_>>(), theirs);
        for path in ours {
            let described = paths[path].as_object().unwrap().keys();
            let described: BTreeSet<String> = described
                .filter(|key| *key != "parameters")
                .cloned()
                .collect();
            assert_eq!(methods(path), described, "{path}");
        }
    }

    #[test]
    fn the_description_has_every_format() {
        let described: serde_json::Value = serde_json::from_str(page::OPENAPI).unwrap();
        let parameters = &described["paths"]["/api/v1/scans/{id}/cloud"]["get"]["parameters"];
        let format = parameters
            .as_array()
            .unwrap()
            .iter()
            .find(|p| p["name"] == "format");
        let listed = format.unwrap()["schema"]["enum"].as_array().unwrap();
        let ours: Vec<&str> = cloud::formats::Format::ALL
            .iter()
            .map(|f| f.extension())
            .collect();
        assert_eq!(
            listed
                .iter()
                .map(|name| name.as_str().unwrap())
                .collect::<Vec<_>>(),
            ours
        );
    }

    #[test]
    fn every_reference_of_the_description_is_there() {
        let described: serde_json::Value = serde_json::from_str(page::OPENAPI).unwrap();
        let mut references = Vec::new();
        collect(&described, &mut references);
        assert!(references.len() > 20);
        for reference in references {
            let pointer = reference.trim_start_matches('#');
            assert!(described.pointer(pointer).is_some(), "{reference}");
        }
    }

    fn collect(value: &serde_json::Value, into: &mut Vec<String>) {
        match value {
            serde_json::Value::Object(object) => {
                for (key, value) in object {
                    match value.as_str() {
                        Some(text) if key == "$ref" => into.push(text.to_owned()),
                        _ => collect(value, into),
                    }
                }
            }
            serde_json::Value::Array(array) => array.iter().for_each(|v| collect(v, into)),
            _ => {}
        }
    }
}
