//! Beginning and stopping captures, and what one would be.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::de::DeserializeOwned;

use super::Api;
use super::refusal::Refusal;
use crate::hub::Event;
use crate::keeper::Order;
use crate::shared::{Refused, Shared};
use crate::view::{DeviceState, Doing};
use crate::{plan as plans, scans};
use engine::capture::request::CaptureRequest;

/// The body of a request, which is to be JSON.
///
/// # Errors
/// [`Refusal`] where it is not JSON, or not what is asked for.
pub fn body<T: DeserializeOwned>(headers: &HeaderMap, body: &Bytes) -> Result<T, Refusal> {
    let content = headers
        .get(header::CONTENT_TYPE)
        .and_then(|c| c.to_str().ok());
    let kind = content.map(|content| content.split(';').next().unwrap_or_default().trim());
    if !kind.is_some_and(|kind| kind.eq_ignore_ascii_case("application/json")) {
        return Err(Refusal::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "usage",
            "expected a body in JSON",
            "send Content-Type: application/json",
        ));
    }
    // The derived readers take a list for an object, its fields in order: nobody has described that.
    let begin = body.iter().find(|byte| !byte.is_ascii_whitespace());
    if begin != Some(&b'{') {
        return Err(Refusal::usage("the body: expected a JSON object"));
    }
    serde_json::from_slice(body).map_err(|error| Refusal::usage(format!("the body: {error}")))
}

/// `POST /captures`.
pub async fn begin(
    State(api): State<Arc<Api>>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let asked: CaptureRequest = body(&headers, &bytes)?;
    let shared = Arc::clone(&api.shared);
    heard(&shared).await;
    answered(&shared).await;
    // Files are made, which may take a disk its time.
    let id = super::with_disk(move || start(&shared, &asked)).await??;
    let (shared, begun) = (Arc::clone(&api.shared), id.clone());
    let view = super::with_disk(move || shared.scans.view(&begun)).await?;
    let view = view.ok_or_else(|| Refusal::no_scan(&id))?;
    let mut response = super::json(StatusCode::CREATED, &view);
    if let Ok(location) = format!("/api/v1/scans/{id}").parse() {
        response.headers_mut().insert(header::LOCATION, location);
    }
    Ok(response)
}

/// Begins a capture; the scan's id.
///
/// # Errors
/// [`Refusal`] where it cannot be, or not now.
pub fn start(shared: &Shared, asked: &CaptureRequest) -> Result<String, Refusal> {
    // A scan that is being recorded is why there may be no room, and not what is to be said.
    let doing = shared.activity().doing;
    if doing != Doing::Idle {
        return Err(Refused::Busy(doing).into());
    }
    // Refused before anything is made.
    shared.drive_is_there()?;
    shared.lidar_is_heard()?;
    let dry = plans::setup(shared, asked, "cloud".into(), "log".into())?;
    plans::fits(shared, &plans::plan(shared, asked, &dry))?;
    shared.take(Doing::Capturing, None)?;
    let begun = ordered(shared, asked);
    if begun.is_err() {
        shared.set_idle();
    }
    begun
}

/// The same with the axis taken.
fn ordered(shared: &Shared, asked: &CaptureRequest) -> Result<String, Refusal> {
    let record = shared.scans.begin(asked, shared.simulated())?;
    let id = record.id.clone();
    shared.note(|activity| activity.scan = Some(id.clone()));
    let (cloud, log) = (shared.cloud(&id), shared.log(&id));
    let sent = plans::setup(shared, asked, cloud, log)
        .map_err(Refused::Failure)
        .and_then(|setup| {
            shared.order(Order::Capture {
                setup: Box::new(setup),
                id: id.clone(),
            })
        });
    if let Err(refused) = sent {
        // Who is refused has begun no scan.
        shared.scans.forget(&id);
        return Err(refused.into());
    }
    if let Some(scan) = shared.scans.view(&id) {
        shared.hub.tell(Event::Scan {
            scan: Box::new(scan),
            deleted: false,
        });
    }
    Ok(id)
}

/// `POST /captures/stop`.
pub async fn stop(State(api): State<Arc<Api>>) -> Response {
    let (stopped, scan) = end(&api.shared).await;
    let body = serde_json::json!({ "stopped": stopped, "scan": scan });
    super::json(StatusCode::OK, &body)
}

/// Stops a capture and waits until the axis stands: whether there was one, and the scan. What else moves the axis is let alone.
pub async fn end(shared: &Shared) -> (bool, Option<String>) {
    let mut activity = shared.follow();
    // It may have been begun this moment: then its scan has no name yet.
    if activity.borrow().doing != Doing::Capturing {
        return (false, None);
    }
    let stopped = shared.interrupt(None);
    let mut scan: Option<String> = None;
    loop {
        {
            let now = activity.borrow_and_update();
            let another = now.scan.is_some() && scan.is_some() && now.scan != scan;
            if now.doing == Doing::Idle || another {
                break;
            }
            scan = scan.or_else(|| now.scan.clone());
        }
        // The sender lives as long as `shared`.
        if activity.changed().await.is_err() {
            break;
        }
    }
    (stopped, scan)
}

/// How long a lidar is waited for that may have been switched on a moment ago: it is looked for every second.
const HEARD: Duration = Duration::from_secs(3);
/// Between two looks.
const LOOK: Duration = Duration::from_millis(50);

/// Waits for a lidar that nobody has heard yet; not for one that is known to be silent.
async fn heard(shared: &Shared) {
    let unknown = || {
        let lidar = shared.lidar();
        lidar.state == DeviceState::Absent && lidar.problem.is_none()
    };
    let mut left = HEARD;
    while unknown() && !left.is_zero() {
        tokio::time::sleep(LOOK).await;
        left = left.saturating_sub(LOOK);
    }
}

/// How long a question to the drive is waited for.
const ANSWERED: Duration = Duration::from_secs(5);

/// Waits until nobody asks the drive something: a question must not have a move refused.
pub async fn answered(shared: &Shared) {
    let mut activity = shared.follow();
    let asks = activity.wait_for(|activity| !activity.only_asks);
    let _ = tokio::time::timeout(ANSWERED, asks).await;
}

/// Waits until the axis stands. What moves it has its own limits of time.
pub async fn idle(shared: &Shared) {
    let mut activity = shared.follow();
    // The sender lives as long as `shared`.
    let _ = activity
        .wait_for(|activity| activity.doing == Doing::Idle)
        .await;
}

/// `GET /plan`.
pub async fn plan(
    State(api): State<Arc<Api>>,
    query: Result<Query<CaptureRequest>, QueryRejection>,
) -> Result<Response, Refusal> {
    let Query(asked) = query?;
    let shared = &api.shared;
    if let Some(name) = &asked.name {
        scans::check_name(name)?;
    }
    let setup = plans::setup(shared, &asked, "cloud".into(), "log".into())?;
    Ok(super::json(StatusCode::OK, &plans::plan(shared, &asked, &setup)).into_response())
}
