//! Jogs of the axis.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use engine::capture::jog::{GotoRequest, JogRequest};
use engine::service::DeviceService;
use engine::service::axis_report::{AxisReport, StopAnswer};
use serde::Serialize;

use super::captures::body;
use super::openapi::{NotNow, Usage};
use super::refusal::Refusal;

type Service = State<Arc<DeviceService>>;

fn ok(answer: &impl Serialize) -> Response {
    super::json(StatusCode::OK, answer)
}

async fn jog(service: &Arc<DeviceService>, request: JogRequest) -> Result<Response, Refusal> {
    Ok(ok(&service.run_jog(request).await?))
}

/// State of the axis.
///
/// The last report while the axis is busy and shortly after: clients that look do not keep motions
/// waiting.
#[utoipa::path(get, path = "/api/v1/tilt", tag = "tilt", responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow),
))]
pub async fn status(State(service): Service) -> Result<Response, Refusal> {
    match service.wait_for_report().await {
        Some(report) => Ok(ok(&report)),
        None => jog(&service, JogRequest::Status).await,
    }
}

/// Home the axis.
#[utoipa::path(post, path = "/api/v1/tilt/home", tag = "tilt", responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow),
))]
pub async fn home(State(service): Service) -> Result<Response, Refusal> {
    jog(&service, JogRequest::Home).await
}

/// Move the axis.
#[utoipa::path(post, path = "/api/v1/tilt/goto", tag = "tilt", request_body = GotoRequest, responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow), (status = 415, response = Usage),
))]
pub async fn goto(
    State(service): Service,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    jog(&service, JogRequest::Goto(body(&headers, &bytes)?)).await
}

/// Stop the axis: any motion, also of a capture. Sets the brake.
#[utoipa::path(post, path = "/api/v1/tilt/stop", tag = "tilt", responses(
    (status = 200, description = "The axis is at rest", body = StopAnswer), (status = 409, response = NotNow),
))]
pub async fn stop(State(service): Service) -> Result<Response, Refusal> {
    Ok(ok(&service.stop_axis().await?))
}

/// Take the drive out of its fault state.
#[utoipa::path(post, path = "/api/v1/tilt/clear", tag = "tilt", responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow),
))]
pub async fn clear(State(service): Service) -> Result<Response, Refusal> {
    jog(&service, JogRequest::ClearFaults).await
}
