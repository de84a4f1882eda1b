//! The scans kept.

use std::sync::Arc;
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::api::Api;
use super::captures;
use super::openapi::{NotFound, NotNow, Usage};
use super::refusal::Refusal;
use crate::limits::UNDO;
use engine::failure::{Failure, Kind};
use engine::service::scan_record::{ScanDetails, ScanEdit, ScanView};

/// Query of `GET /scans`.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[serde(default, deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ScansQuery {
    /// Most scans of the answer; all by default.
    limit: Option<usize>,
    /// Id of a scan: only older ones.
    before: Option<String>,
}

/// Body of `GET /scans`.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(example = json!({"scans": [{
    "id": "hall-2026-11-26T09-17-55Z", "name": "hall", "notes": null, "state": "recording",
    "why": null, "waits_for_room": false, "started_s": 1_795_684_675.219, "simulated": false,
    "asked": {"speed_deg_s": 56.25, "both_ways": false, "name": "hall"}, "points": null,
    "duration_s": null, "bytes": 443, "log_bytes": null, "cloud_bytes": null, "thumbnail": false,
    "summary": null,
}]}))]
pub struct ScanList {
    /// The newest first.
    scans: Vec<ScanView>,
}

/// All scans, the newest first.
#[utoipa::path(get, path = "/api/v1/scans", tag = "scans", params(ScansQuery), responses(
    (status = 200, body = ScanList), (status = 404, response = NotFound),
))]
pub async fn list(
    State(api): State<Arc<Api>>,
    query: Result<Query<ScansQuery>, QueryRejection>,
) -> Result<Response, Refusal> {
    let Query(ScansQuery { limit, before }) = query?;
    let state = Arc::clone(&api.state);
    let limit = limit.unwrap_or(usize::MAX);
    if let Some(id) = before
        .as_ref()
        .filter(|id| state.scans.record(id).is_none())
    {
        return Err(Refusal::no_scan(id));
    }
    let scans = super::with_disk(move || state.scans.part(before.as_deref(), limit)).await?;
    Ok(super::json(StatusCode::OK, &ScanList { scans }))
}

/// One scan.
#[utoipa::path(get, path = "/api/v1/scans/{id}", tag = "scans", params(("id" = String, Path, description = "Id of a scan")), responses(
    (status = 200, body = ScanDetails), (status = 404, response = NotFound),
))]
pub async fn one(State(api): State<Arc<Api>>, Path(id): Path<String>) -> Result<Response, Refusal> {
    let (state, scan_id) = (Arc::clone(&api.state), id.clone());
    let scan = super::with_disk(move || state.scans.whole(&scan_id)).await?;
    let scan = scan.ok_or_else(|| Refusal::no_scan(&id))?;
    Ok(super::json(StatusCode::OK, &scan))
}

/// Change name and notes of a scan.
#[utoipa::path(patch, path = "/api/v1/scans/{id}", tag = "scans", params(("id" = String, Path, description = "Id of a scan")), request_body = ScanEdit, responses(
    (status = 200, body = ScanView), (status = 404, response = NotFound), (status = 409, response = NotNow), (status = 415, response = Usage),
))]
pub async fn edit(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let edit: ScanEdit = captures::body(&headers, &bytes)?;
    edit.check()?;
    let (state, scan_id) = (Arc::clone(&api.state), id.clone());
    let scan = super::with_disk(move || state.scans.edit(&scan_id, &edit)).await??;
    let scan = scan.ok_or_else(|| Refusal::no_scan(&id))?;
    api.state.send_scan(scan.clone(), false);
    Ok(super::json(StatusCode::OK, &scan))
}

/// Query of `DELETE /scans/ID`.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[serde(default, deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct DeleteQuery {
    /// Whether the scan can be restored for 10 s; its files take room until then.
    undo: bool,
}

/// Delete a scan.
#[utoipa::path(delete, path = "/api/v1/scans/{id}", tag = "scans", params(("id" = String, Path, description = "Id of a scan"), DeleteQuery), responses(
    (status = 204, description = "Deleted"), (status = 404, response = NotFound), (status = 409, response = NotNow),
))]
pub async fn delete(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
    query: Result<Query<DeleteQuery>, QueryRejection>,
) -> Result<StatusCode, Refusal> {
    let Query(DeleteQuery { undo }) = query?;
    let (state, scan_id) = (Arc::clone(&api.state), id.clone());
    let deleted = super::with_disk(move || {
        let deleted = match undo {
            true => state.scans.delete_with_undo(&scan_id, Instant::now()),
            false => state.scans.delete(&scan_id),
        };
        state.refresh_disk();
        deleted
    });
    let deleted = deleted.await?.map_err(|failure| {
        // The request is valid, only too early.
        let kind = match failure.kind {
            Kind::Usage => Kind::Incomplete,
            kind => kind,
        };
        Failure { kind, ..failure }
    })?;
    let scan = deleted.ok_or_else(|| Refusal::no_scan(&id))?;
    api.state.send_scan(scan, true);
    Ok(StatusCode::NO_CONTENT)
}

/// Restore a scan that was deleted with `undo` at most 10 s ago.
#[utoipa::path(post, path = "/api/v1/scans/{id}/restore", tag = "scans", params(("id" = String, Path, description = "Id of a deleted scan")), responses(
    (status = 200, body = ScanView), (status = 404, response = NotFound), (status = 409, response = NotNow),
))]
pub async fn restore(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
) -> Result<Response, Refusal> {
    let (state, scan_id) = (Arc::clone(&api.state), id.clone());
    let restored = super::with_disk(move || {
        let restored = state.scans.restore(&scan_id);
        state.refresh_disk();
        restored
    });
    let scan = restored.await??.ok_or_else(|| {
        Refusal::new(
            StatusCode::NOT_FOUND,
            Kind::NotFound,
            format!("there is no deleted scan {id:?}"),
            format!("a scan can be restored for {} s", UNDO.as_secs()),
        )
    })?;
    api.state.send_scan(scan.clone(), false);
    Ok(super::json(StatusCode::OK, &scan))
}
