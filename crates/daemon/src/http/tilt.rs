//! Jogs of the axis. A command's own service answers these requests, too.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use engine::capture::jog::JogRequest;
use engine::service::DeviceService;
use serde::Serialize;

use super::captures::body;
use super::refusal::Refusal;

type Service = State<Arc<DeviceService>>;

fn ok(answer: &impl Serialize) -> Response {
    super::json(StatusCode::OK, answer)
}

async fn jog(service: &Arc<DeviceService>, request: JogRequest) -> Result<Response, Refusal> {
    Ok(ok(&service.run_jog(request).await?))
}

/// `GET /tilt`. Answered from the last report while the axis is busy and shortly after, so that
/// clients that look do not keep motions waiting.
pub async fn status(State(service): Service) -> Result<Response, Refusal> {
    match service.known_report() {
        Some(report) => Ok(ok(&report)),
        None => jog(&service, JogRequest::Status).await,
    }
}

/// `POST /tilt/home`.
pub async fn home(State(service): Service) -> Result<Response, Refusal> {
    jog(&service, JogRequest::Home).await
}

/// `POST /tilt/goto`.
pub async fn goto(
    State(service): Service,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    jog(&service, JogRequest::Goto(body(&headers, &bytes)?)).await
}

/// `POST /tilt/stop`: stops any motion and sets the brake.
pub async fn stop(State(service): Service) -> Result<Response, Refusal> {
    Ok(ok(&service.stop_axis().await?))
}

/// `POST /tilt/clear`.
pub async fn clear(State(service): Service) -> Result<Response, Refusal> {
    jog(&service, JogRequest::ClearFaults).await
}
