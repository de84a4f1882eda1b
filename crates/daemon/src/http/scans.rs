//! The scans kept.

use std::sync::Arc;

use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::Api;
use super::openapi::{NotFound, NotNow};
use super::refusal::Refusal;
use engine::failure::{Failure, Kind};
use engine::service::scan_record::{ScanDetails, ScanView};

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

/// Delete a scan.
#[utoipa::path(delete, path = "/api/v1/scans/{id}", tag = "scans", params(("id" = String, Path, description = "Id of a scan")), responses(
    (status = 204, description = "Deleted"), (status = 404, response = NotFound), (status = 409, response = NotNow),
))]
pub async fn delete(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
) -> Result<StatusCode, Refusal> {
    let (state, scan_id) = (Arc::clone(&api.state), id.clone());
    let deleted = super::with_disk(move || {
        let deleted = state.scans.delete(&scan_id);
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
