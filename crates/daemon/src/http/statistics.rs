//! Statistics of a scan, measured on request and never during a capture.

use std::os::fd::AsRawFd;
use std::path::Path as FilePath;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use analysis::plan::ErrorBudget;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use engine::capture::scan_planner::ScanPlanner;
use engine::failure::Failure;
use engine::reconstruct::source::Source;
use engine::reconstruct::statistics::{LogStatistics, statistics};
use engine::service::LeaseError;
use engine::service::scan_record::ScanRecord;
use engine::service::status::AxisTask;
use protocol::vlp16::models;
use serde::Serialize;
use utoipa::ToSchema;

use super::ClientGuard;
use super::api::Api;
use super::openapi::{Limit, NotFound, NotNow};
use super::refusal::Refusal;
use crate::scans::LOG;
use crate::state::DaemonState;

/// Distances of the error budgets, metres.
const DISTANCES_M: [f64; 6] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// Between two looks whether a capture has begun.
const POLL: Duration = Duration::from_millis(50);

/// Statistics of a scan.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(example = json!({
    "points": 262_749, "of": "view",
    "density": {
        "bins": 2_462, "mean": 105.6, "sd": 51.9, "min": 0, "max": 267, "mean_per_deg2": 13.1,
        "sd_per_deg2": 6.4, "empty": 1, "sd_over_mean": 0.49, "coverage": 0.9996,
    },
    "bins": [{"direction": [-0.5774, -0.5774, 0.5774], "points": 98}],
    "gap_deg": {"p50": 0.142, "p95": 0.649, "p99": 0.890, "worst": 2.102},
    "ranges": [{"from_m": 1.0, "to_m": 1.5, "points": 244}],
    "sd_mm": {"p50": 0.693, "p95": 0.881, "p99": 0.958},
    "residuals": [{
        "at_s": 0.011, "delay_us": 24.1, "most_delay_us": 102.6, "angle_rms_deg": 0.0083, "most_angle_deg": 0.021,
    }],
    "budget": [{"at_m": 2.0, "error_mm": {
        "range": 0.0, "range_step": 0.577, "azimuth": 0.082, "tilt": 0.030, "clock": 0.004,
        "delay": 0.489, "mount": null, "column_sd": 0.584, "total": 1.493,
    }}],
}))]
pub struct ScanStatistics {
    /// Of its cloud and its residuals.
    #[serde(flatten)]
    log: LogStatistics,
    /// Errors to expect, as a plan of its request states them; empty where the request is not known
    /// or the axis does not permit it any more.
    budget: Vec<BudgetAt>,
}

/// Error of a point at a distance.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
pub struct BudgetAt {
    /// The distance, metres.
    at_m: f64,
    /// Its terms.
    error_mm: ErrorBudget,
}

/// Density, gaps, ranges and errors of a scan.
///
/// They are measured now, from its log: seconds for millions of points. During a capture this is
/// refused, and a capture that begins ends it.
#[utoipa::path(get, path = "/api/v1/scans/{id}/statistics", tag = "scans", params(("id" = String, Path, description = "Id of a scan")), responses(
    (status = 200, body = ScanStatistics), (status = 404, response = NotFound), (status = 409, response = NotNow), (status = 429, response = Limit),
))]
pub async fn measure(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
) -> Result<Response, Refusal> {
    let record = api.state.scans.record(&id);
    let record = record.ok_or_else(|| Refusal::no_scan(&id))?;
    if !record.state.is_final() {
        return Err(super::download::being_made());
    }
    refuse_during_capture(&api.state)?;
    let making = Arc::clone(&api.making).try_acquire_owned();
    let making = making.map_err(|_| Refusal::too_many("clouds being made"))?;
    let client = ClientGuard::default();
    let (state, interrupt) = (Arc::clone(&api.state), client.interrupt());
    let mut measured = tokio::task::spawn_blocking(move || {
        let _making = making;
        of_log(&state, &record, &interrupt)
    });
    let measured = loop {
        tokio::select! {
            measured = &mut measured => break measured,
            () = tokio::time::sleep(POLL) => refuse_during_capture(&api.state)?,
        }
    };
    let statistics = measured.map_err(|_| crate::cloud_builder::defect())??;
    Ok(super::json(StatusCode::OK, &statistics))
}

/// A capture needs the machine.
fn refuse_during_capture(state: &DaemonState) -> Result<(), Refusal> {
    match state.service.activity().doing {
        AxisTask::Capturing => Err(LeaseError::Busy(AxisTask::Capturing).into()),
        _ => Ok(()),
    }
}

fn of_log(
    state: &DaemonState,
    record: &ScanRecord,
    interrupt: &AtomicBool,
) -> Result<ScanStatistics, Refusal> {
    let file =
        io::files::open_regular(&state.log(&record.id)).map_err(|_| Refusal::no_file(LOG))?;
    // The name may belong to another file by now; this one leads to the open file (proc(5)).
    let path = format!("/proc/self/fd/{}", file.as_raw_fd());
    let named = |failure: Failure| Failure {
        message: failure.message.replace(&path, LOG),
        ..failure
    };
    let source = Source::open(FilePath::new(&path), None).map_err(named)?;
    let log = statistics(&source, record.accuracy(), interrupt).map_err(named)?;
    Ok(ScanStatistics {
        log,
        budget: budget(state, record).unwrap_or_default(),
    })
}

/// Errors by distance that the scan's request lets expect.
fn budget(state: &DaemonState, record: &ScanRecord) -> Option<Vec<BudgetAt>> {
    let asked = record.request.as_ref()?;
    let service = &state.service;
    let plan = service.plan(asked, "cloud".into(), "log".into()).ok()?;
    let report = record.report.as_ref()?;
    let name = report.get("model").and_then(|name| name.as_str());
    let model = models::ALL
        .into_iter()
        .find(|known| Some(known.name) == name);
    let rpm = report.get("rpm").and_then(|rpm| rpm.as_f64());
    let rpm = rpm.map(|rpm| rpm.round() as u32);
    let at = |at_m: f64| {
        // Beyond the lidar's range there is none.
        let planner = ScanPlanner::of_capture_at(service.config(), &plan, model, rpm, at_m).ok()?;
        let error_mm = planner.budget(&plan.steps);
        Some(BudgetAt { at_m, error_mm })
    };
    Some(DISTANCES_M.into_iter().filter_map(at).collect())
}
