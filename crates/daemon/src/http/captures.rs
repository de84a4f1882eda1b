//! Captures: plan, begin, stop.

use std::sync::{Arc, mpsc};

use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::Response;
use engine::capture_request::CaptureRequest;
use engine::failure::{Failure, Kind};
use engine::service::scan_record::{ScanView, check_name};
use engine::service::status::AxisTask;
use engine::service::{AxisLease, DeviceService, LeaseError, StopSignal};
use serde::Serialize;
use serde::de::DeserializeOwned;
use utoipa::{IntoParams, ToSchema};

use super::api::Api;
use super::openapi::{NotNow, Usage};
use super::refusal::Refusal;
use crate::plan as plans;
use crate::state::{Counters, DaemonState};

/// Header with the number of stops that the client knew when its user asked for a motion.
pub const STOPS: &str = "velomotion-stops";

/// A header of requests that move the axis.
#[derive(IntoParams)]
#[into_params(parameter_in = Header)]
#[expect(dead_code, reason = "described only: the header is optional")]
pub struct KnownStops {
    /// `stops` of the last status that the client has seen. The request is refused if the axis was
    /// stopped since then: one that arrives late moves nothing.
    #[param(rename = "Velomotion-Stops")]
    stops: Option<u64>,
}

/// Reads the JSON body of a request.
///
/// # Errors
/// [`Refusal`] where it is not JSON, or not the expected object.
pub fn body<T: DeserializeOwned>(headers: &HeaderMap, body: &Bytes) -> Result<T, Refusal> {
    let content = headers
        .get(header::CONTENT_TYPE)
        .and_then(|c| c.to_str().ok());
    let kind = content.map(|content| content.split(';').next().unwrap_or_default().trim());
    if !kind.is_some_and(|kind| kind.eq_ignore_ascii_case("application/json")) {
        return Err(Refusal::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Kind::Usage,
            "expected a body in JSON",
            "send Content-Type: application/json",
        ));
    }
    // Derived deserializers also accept a list of the fields, which is not documented.
    let begin = body.iter().find(|byte| !byte.is_ascii_whitespace());
    if begin != Some(&b'{') {
        return Err(Refusal::usage("the body: expected a JSON object"));
    }
    serde_json::from_slice(body).map_err(|error| Refusal::usage(format!("the body: {error}")))
}

/// The signal of a motion that a client asks for.
///
/// # Errors
/// [`Refusal`] where the header [`STOPS`] is no number.
pub fn stop_signal(service: &DeviceService, headers: &HeaderMap) -> Result<StopSignal, Refusal> {
    let known = headers.get(STOPS).map(|value| {
        let number = value.to_str().ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| {
            let text = format!("{STOPS}: expected the stops of a status, got {value:?}");
            Refusal::usage(text)
        })
    });
    Ok(service.stop_signal(known.transpose()?))
}

/// Start a capture.
///
/// Takes the options of `velomotion capture`.
#[utoipa::path(post, path = "/api/v1/captures", tag = "captures", params(KnownStops), request_body = CaptureRequest, responses(
    (status = 201, description = "The started scan", body = ScanView, headers(("Location" = String))),
    (status = 409, response = NotNow),
    (status = 415, response = Usage),
))]
pub async fn begin(
    State(api): State<Arc<Api>>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let request: CaptureRequest = body(&headers, &bytes)?;
    let state = Arc::clone(&api.state);
    let stop = stop_signal(&state.service, &headers)?;
    state.service.wait_for_lidar().await;
    state.service.wait_for_reads().await;
    let id = super::with_disk(move || start(&state, &request, &stop)).await??;
    let (state, begun) = (Arc::clone(&api.state), id.clone());
    let scan = super::with_disk(move || state.scans.view(&begun)).await?;
    let scan = scan.ok_or_else(|| Refusal::no_scan(&id))?;
    let mut response = super::json(StatusCode::CREATED, &scan);
    if let Ok(location) = format!("/api/v1/scans/{id}").parse() {
        response.headers_mut().insert(header::LOCATION, location);
    }
    Ok(response)
}

/// Begins a capture that `stop` stops, and returns the scan's id.
///
/// # Errors
/// [`Refusal`] where it is not possible, or not now.
pub fn start(
    state: &Arc<DaemonState>,
    request: &CaptureRequest,
    stop: &StopSignal,
) -> Result<String, Refusal> {
    let service = &state.service;
    // A busy axis is reported rather than the disk space that its scan may need.
    let task = service.activity().doing;
    if task != AxisTask::Idle {
        return Err(LeaseError::Busy(task).into());
    }
    service.require_drive()?;
    service.require_lidar()?;
    let plan = service.plan(request, "cloud".into(), "log".into())?;
    let bytes = plans::bytes(state, &plan);
    let need = format!("this scan may need {} MB", bytes / 1_000_000);
    plans::check_room(state, bytes, &need)?;
    let lease = service.lease_until(AxisTask::Capturing, stop)?;
    let record = state.scans.begin(request, service.simulated())?;
    let id = record.id.clone();
    lease.set_scan(&id);
    if let Err(error) = run(state, request, &id, lease) {
        state.scans.forget(&id);
        return Err(error.into());
    }
    Counters::count(&state.counters.captures);
    if let Some(scan) = state.scans.view(&id) {
        state.send_scan(scan, false);
    }
    Ok(id)
}

/// Hands a capture to the device thread, and its end to a thread that may wait for the disk.
fn run(
    state: &Arc<DaemonState>,
    request: &CaptureRequest,
    id: &str,
    lease: AxisLease,
) -> Result<(), LeaseError> {
    let plan = state
        .service
        .plan(request, state.cloud(id), state.log(id))?;
    let ending = || Failure::new(Kind::Interrupted, "the daemon is ending").help("start it again");
    let jobs = state.cloud_jobs().ok_or_else(ending)?;
    let (begun, capture) = mpsc::channel::<tokio::sync::oneshot::Receiver<_>>();
    let (own_state, own_id, accuracy) = (Arc::clone(state), id.to_owned(), plan.accuracy);
    engine::spawn("scan", "the scan", move || {
        if let Ok(end) = capture.recv()
            && let Ok(result) = end.blocking_recv()
        {
            own_state.capture_ended(&own_id, accuracy, result, &jobs);
        }
    })?;
    // The thread waits for it.
    let _ = begun.send(state.service.capture(lease, plan)?);
    Ok(())
}

/// Body of `POST /captures/stop`.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(example = json!({"stopped": true, "scan": "hall-2026-11-26T09-17-55Z"}))]
pub struct StoppedCapture {
    /// Whether a capture was stopped.
    stopped: bool,
    /// Id of its scan.
    scan: Option<String>,
}

/// Stop the capture. Other moves go on.
#[utoipa::path(post, path = "/api/v1/captures/stop", tag = "captures", responses(
    (status = 200, description = "The axis is at rest", body = StoppedCapture),
))]
pub async fn stop(State(service): State<Arc<DeviceService>>) -> Response {
    let (stopped, scan) = service.stop_capture().await;
    super::json(StatusCode::OK, &StoppedCapture { stopped, scan })
}

/// Plan of a capture: duration, resolution, bytes. Nothing moves.
#[utoipa::path(get, path = "/api/v1/plan", tag = "captures", params(CaptureRequest), responses(
    (status = 200, body = plans::CaptureEstimate),
    (status = 409, response = NotNow),
))]
pub async fn plan(
    State(api): State<Arc<Api>>,
    query: Result<Query<CaptureRequest>, QueryRejection>,
) -> Result<Response, Refusal> {
    let Query(request) = query?;
    if let Some(name) = &request.name {
        check_name(name)?;
    }
    let plan = api
        .state
        .service
        .plan(&request, "cloud".into(), "log".into())?;
    let state = Arc::clone(&api.state);
    // Tens of milliseconds of computing.
    let estimate = super::with_disk(move || plans::estimate(&state, &request, &plan)).await?;
    Ok(super::json(StatusCode::OK, &estimate))
}
