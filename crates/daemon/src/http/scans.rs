//! The scans that are kept.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Serialize;

use super::Api;
use super::refusal::Refusal;
use crate::hub::Event;
use crate::scans::ScanView;
use engine::failure::{Failure, Kind};

/// `GET /scans`.
pub async fn list(State(api): State<Arc<Api>>) -> Result<Response, Refusal> {
    #[derive(Serialize)]
    struct List {
        scans: Vec<ScanView>,
    }
    let shared = Arc::clone(&api.shared);
    let scans = super::with_disk(move || shared.scans.list()).await?;
    Ok(super::json(StatusCode::OK, &List { scans }))
}

/// `GET /scans/ID`.
pub async fn one(State(api): State<Arc<Api>>, Path(id): Path<String>) -> Result<Response, Refusal> {
    let (shared, asked) = (Arc::clone(&api.shared), id.clone());
    let scan = super::with_disk(move || shared.scans.whole(&asked)).await?;
    let scan = scan.ok_or_else(|| Refusal::no_scan(&id))?;
    Ok(super::json(StatusCode::OK, &scan))
}

/// `DELETE /scans/ID`.
pub async fn delete(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
) -> Result<StatusCode, Refusal> {
    let (shared, asked) = (Arc::clone(&api.shared), id.clone());
    let deleted = super::with_disk(move || {
        let deleted = shared.scans.delete(&asked);
        shared.look_at_disk();
        deleted
    });
    let deleted = deleted.await?.map_err(|failure| {
        // Not the request is wrong, but its time.
        let kind = match failure.kind {
            Kind::Usage => Kind::Incomplete,
            kind => kind,
        };
        Failure { kind, ..failure }
    })?;
    let scan = deleted.ok_or_else(|| Refusal::no_scan(&id))?;
    api.shared.hub.tell(Event::Scan {
        scan: Box::new(scan),
        deleted: true,
    });
    Ok(StatusCode::NO_CONTENT)
}
