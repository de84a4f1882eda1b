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

use super::captures::{KnownStops, STOPS, body, stop_signal};
use super::openapi::{NotNow, Usage};
use super::refusal::Refusal;

type Service = State<Arc<DeviceService>>;

fn ok(answer: &impl Serialize) -> Response {
    super::json(StatusCode::OK, answer)
}

/// Runs a request that moves nothing.
async fn run(service: &Arc<DeviceService>, request: JogRequest) -> Result<Response, Refusal> {
    Ok(ok(&service.run_jog(request, None).await?))
}

async fn jog(
    service: &Arc<DeviceService>,
    request: JogRequest,
    headers: &HeaderMap,
) -> Result<Response, Refusal> {
    let stop = stop_signal(service, headers)?;
    Ok(ok(&service.run_jog(request, Some(&stop)).await?))
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
        None => run(&service, JogRequest::Status).await,
    }
}

/// Home the axis.
#[utoipa::path(post, path = "/api/v1/tilt/home", tag = "tilt", params(KnownStops), responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow),
))]
pub async fn home(State(service): Service, headers: HeaderMap) -> Result<Response, Refusal> {
    jog(&service, JogRequest::Home, &headers).await
}

/// Move the axis.
#[utoipa::path(post, path = "/api/v1/tilt/goto", tag = "tilt", params(KnownStops), request_body = GotoRequest, responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow), (status = 415, response = Usage),
))]
pub async fn goto(
    State(service): Service,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let request = JogRequest::Goto(body(&headers, &bytes)?);
    jog(&service, request, &headers).await
}

/// Stop the axis: any motion, also of a capture. Sets the brake.
///
/// The header `Velomotion-Stops` of the answer is for requests that move the axis from now on.
#[utoipa::path(post, path = "/api/v1/tilt/stop", tag = "tilt", responses(
    (status = 200, description = "The axis is at rest", body = StopAnswer), (status = 409, response = NotNow),
))]
pub async fn stop(State(service): Service) -> Result<Response, Refusal> {
    let mut answer = ok(&service.stop_axis().await?);
    answer.headers_mut().insert(STOPS, service.stops().into());
    Ok(answer)
}

/// Take the drive out of its fault state.
#[utoipa::path(post, path = "/api/v1/tilt/clear", tag = "tilt", responses(
    (status = 200, body = AxisReport), (status = 409, response = NotNow),
))]
pub async fn clear(State(service): Service) -> Result<Response, Refusal> {
    run(&service, JogRequest::ClearFaults).await
}
