//! HTTP: the daemon's (`api`), and that of `velomotion view`, which needs no devices.

mod accept;
#[cfg(devices)]
pub mod api;
mod assets;
#[cfg(devices)]
pub mod captures;
pub mod connection_limits;
#[cfg(devices)]
pub mod download;
#[cfg(devices)]
pub mod events;
#[cfg(devices)]
pub mod guard;
#[cfg(devices)]
pub mod metrics;
#[cfg(devices)]
mod openapi;
#[cfg(devices)]
pub mod page;
mod partial;
pub mod refusal;
mod request_limits;
#[cfg(devices)]
pub mod scans;
mod secret;
mod send_file;
pub mod server;
#[cfg(devices)]
pub mod statistics;
#[cfg(devices)]
pub mod tilt;
#[cfg(devices)]
pub mod tls;
#[cfg(devices)]
pub(crate) mod unix_socket;
pub mod view;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use engine::failure::Kind;
use serde::Serialize;

use refusal::Refusal;

fn no_method() -> Refusal {
    Refusal::new(
        StatusCode::METHOD_NOT_ALLOWED,
        Kind::Usage,
        "this path does not have that method",
        "GET /api/v1/openapi.json lists paths and methods",
    )
}

/// Runs what may wait for a disk, or computes for long, on a thread that answers no requests: a
/// stop is answered whatever the disk does.
///
/// # Errors
/// [`Refusal`] after a panic in it.
pub async fn with_disk<T: Send + 'static>(
    what: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Refusal> {
    tokio::task::spawn_blocking(what).await.map_err(|_| {
        let help = "run the daemon with -vv and report the messages";
        Refusal::defect("a defect of the program", help)
    })
}

/// Interrupts the reading of a log when its client disconnects.
#[derive(Default)]
pub struct ClientGuard(Arc<AtomicBool>);

impl ClientGuard {
    /// True once the client has disconnected.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

impl Drop for ClientGuard {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A response in JSON.
pub fn json(status: StatusCode, body: &impl Serialize) -> Response {
    match serde_json::to_vec(body) {
        Ok(body) => {
            let headers = [
                ("content-type", "application/json"),
                ("cache-control", "no-store"),
            ];
            (status, headers, body).into_response()
        }
        Err(error) => {
            let error = format!("the answer has no JSON form: {error}");
            Refusal::defect(error, "this is a defect of the program").into_response()
        }
    }
}
