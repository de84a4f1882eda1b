//! The axis by hand.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use serde::{Deserialize, Serialize};
use tokio::sync::oneshot;

use super::Api;
use super::captures::{answered, body, idle};
use super::refusal::Refusal;
use crate::keeper::{Order, tilt_order};
use crate::shared::Shared;
use crate::view::Doing;
use engine::capture::jog::JogRequest;
use engine::capture::jog::Report;
use engine::failure::{Failure, Kind};

/// A move by hand, as the command's `tilt goto`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goto {
    /// Where to.
    pub to_deg: f64,
    /// How fast.
    #[serde(default = "slow")]
    pub speed_deg_s: f64,
    /// Acceleration; the device's own where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accel_deg_s2: Option<f64>,
}

/// As the command does.
fn slow() -> f64 {
    10.0
}

/// Has the keeper do it, and waits for it. It goes on where the client does not wait.
async fn does(shared: &Shared, request: JogRequest) -> Result<Report, Refusal> {
    let (doing, commands) = tilt_order(request, shared)?;
    let only_asks = matches!(request, JogRequest::Status);
    if !only_asks {
        answered(shared).await;
    }
    shared.take(doing, None)?;
    shared.note(|activity| activity.only_asks = only_asks);
    let (answer, done) = oneshot::channel();
    if let Err(refused) = shared.order(Order::Tilt { commands, answer }) {
        shared.set_idle();
        return Err(refused.into());
    }
    match done.await {
        Ok(answer) => Ok(answer?),
        Err(_) => Err(Failure::new(Kind::Interrupted, "the daemon is ending")
            .help("the axis is stopped; start the daemon again")
            .into()),
    }
}

/// How often a stop is tried while others begin moves.
const STOPS: usize = 16;

fn said(report: &Report) -> Response {
    super::json(StatusCode::OK, report)
}

/// `GET /tilt`. While the axis is busy, and for a moment after it was asked, what is known of it: however many look, moves are not refused
/// for it.
pub async fn status(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    let shared = &api.shared;
    let busy = shared.activity().doing != Doing::Idle;
    let known = if busy {
        shared.report()
    } else {
        shared.fresh_report()
    };
    if let Some(mut report) = known {
        report.angle_deg = shared.drive().angle_deg;
        return Ok(said(&report));
    }
    Ok(said(&does(shared, JogRequest::Status).await?))
}

/// `POST /tilt/home`.
pub async fn home(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    Ok(said(&does(&api.shared, JogRequest::Home).await?))
}

/// `POST /tilt/goto`.
pub async fn goto(
    State(api): State<Arc<Api>>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let wanted: Goto = body(&headers, &bytes)?;
    let request = JogRequest::Goto {
        to_deg: wanted.to_deg,
        speed_deg_s: wanted.speed_deg_s,
        accel_deg_s2: wanted.accel_deg_s2,
    };
    Ok(said(&does(&api.shared, request).await?))
}

/// `POST /tilt/stop`: whatever moves is stopped, and the brake set.
pub async fn stop(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    let shared = &api.shared;
    for _ in 0..STOPS {
        shared.interrupt(None);
        idle(shared).await;
        // Somebody else may have been quicker: he is stopped, too.
        match does(shared, JogRequest::Stop).await {
            Err(refused) if refused.is_busy() => {}
            done => return Ok(said(&done?)),
        }
    }
    Ok(said(&does(shared, JogRequest::Stop).await?))
}

/// `POST /tilt/clear`.
pub async fn clear(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    Ok(said(&does(&api.shared, JogRequest::ClearFaults).await?))
}
