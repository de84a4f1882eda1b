//! Files of scans. A cloud in another format is made from the log into an unnamed file and streamed
//! from there, never all of it in memory.

use std::fs::Metadata;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Seek, SeekFrom};
use std::os::fd::AsRawFd;
use std::path::{Path as FilePath, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};
use std::time::SystemTime;

use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use cloud::Fields;
use cloud::formats::Format;
use scanner::Accuracy;
use serde::Deserialize;
use tokio::sync::OwnedSemaphorePermit;
use utoipa::IntoParams;

use super::ClientGuard;
use super::api::Api;
use super::openapi::{NotNow, StoredFile, StoredPicture};
use super::partial::{is_known, tag_of};
use super::refusal::Refusal;
use super::send_file::{OpenFile, not_modified, send};
use crate::cloud_builder::defect;
use crate::disk_quota::{self, DiskQuota, QuotaFile};
use crate::plan;
use crate::scans::{LOG, THUMBNAIL};
use engine::failure::{Failure, Kind};
use engine::output::BufferedFile;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use engine::service::scan_record::ScanRecord;

/// Query of `GET /scans/ID/cloud`.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[serde(default, deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct CloudQuery {
    /// Format by its extension; PLY by default.
    #[param(schema_with = super::openapi::formats)]
    format: Option<String>,
    /// Whether to add the column sd.
    uncertainty: bool,
    /// Whether to add the column echo.
    echo: bool,
    /// Whether to add the column laser.
    laser: bool,
}

impl CloudQuery {
    fn fields(&self) -> Fields {
        let more = [
            (self.uncertainty, Fields::SD),
            (self.echo, Fields::ECHO),
            (self.laser, Fields::LASER),
        ];
        let wanted = more.into_iter().filter(|(is_wanted, _)| *is_wanted);
        wanted.fold(Fields::FILE, |fields, (_, field)| fields | field)
    }
}

/// The cloud of a scan.
///
/// In PLY it is a stored file. Other formats and more columns are made on request: always the same
/// bytes while the daemon runs, so that an interrupted download can go on, too.
#[utoipa::path(get, path = "/api/v1/scans/{id}/cloud", tag = "scans",
    params(("id" = String, Path, description = "Id of a scan"), CloudQuery, ("Range" = Option<String>, Header, description = "The requested part (RFC 9110)")), responses(StoredFile,
    (status = 409, response = NotNow), (status = 507, response = NotNow),
))]
pub async fn cloud(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
    query: Result<Query<CloudQuery>, QueryRejection>,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    let Query(wanted) = query?;
    let name = wanted.format.as_deref().unwrap_or("ply");
    let format = format_of(name)?;
    let record = api.state.scans.record(&id);
    let record = record.ok_or_else(|| Refusal::no_scan(&id))?;
    if !record.state.is_final() {
        return Err(being_made());
    }
    let permit = downloading(&api)?;
    let fields = wanted.fields();
    if format == Format::Ply
        && fields == Fields::FILE
        && let Ok(stored) = open(api.state.cloud(&id)).await?
    {
        let tag = tag_of(&stored.1);
        return Ok(send(
            stored,
            (&stem(&record), "ply"),
            permit,
            (&headers, &tag),
        ));
    }
    let log = api.state.log(&id);
    let log_metadata = open(log.clone()).await?.ok().map(|(_, metadata)| metadata);
    let accuracy = record.accuracy();
    let tag = tag_of_made(log_metadata.as_ref(), (format, fields, accuracy));
    if log_metadata.is_some() && is_known(&headers, &tag) {
        return Ok(not_modified(&tag));
    }
    let making = Arc::clone(&api.making).try_acquire_owned();
    let making = making.map_err(|_| Refusal::too_many("clouds being made"))?;
    let stem = stem(&record);
    let (points, state) = (record.points, Arc::clone(&api.state));
    let client = ClientGuard::default();
    let interrupt = client.interrupt();
    let made = tokio::task::spawn_blocking(move || {
        let _making = making;
        let log_bytes = || std::fs::metadata(&log).map_or(0, |there| there.len());
        let points = points.unwrap_or_else(|| plan::most_points(log_bytes()));
        let quota = DiskQuota::take(&state, disk_quota::most_bytes(format, points));
        make(
            &log,
            (state.scans.folder(), &quota.map_err(Refusal::no_room)?),
            format,
            fields,
            accuracy,
            &interrupt,
        )
    });
    let file = made.await.map_err(|_| defect())??;
    drop(client);
    let file_name = (stem.as_str(), format.extension());
    Ok(send(file, file_name, permit, (&headers, &tag)))
}

/// Validator of a cloud that is made of a log. The same log gives the same bytes, but perhaps not
/// with the program that runs after the next start.
fn tag_of_made(
    log: Option<&Metadata>,
    (format, fields, accuracy): (Format, Fields, Accuracy),
) -> String {
    static START: LazyLock<SystemTime> = LazyLock::new(SystemTime::now);
    let mut hasher = DefaultHasher::new();
    (*START, log.map(tag_of), format.extension(), fields).hash(&mut hasher);
    format!("{accuracy:?}").hash(&mut hasher);
    format!("\"made-{:x}\"", hasher.finish())
}

/// The format of an extension. A download is one file, without a companion.
fn format_of(extension: &str) -> Result<Format, Refusal> {
    let is_named = |format: &Format| extension.eq_ignore_ascii_case(format.extension());
    Format::single_files().find(is_named).ok_or_else(|| {
        let names: Vec<_> = Format::single_files().map(Format::extension).collect();
        let error = format!("format={extension}: expected one of {}", names.join(" "));
        let help = "velomotion replay makes .xyz and .bin, which are two files each, of the log";
        Refusal::new(StatusCode::BAD_REQUEST, Kind::Usage, error, help)
    })
}

/// The refusal of what needs a finished scan.
pub(super) fn being_made() -> Refusal {
    Failure::new(Kind::Incomplete, "the scan is being made")
        .help("wait until its state is whole, partial or failed")
        .into()
}

/// Makes a cloud as `velomotion replay` does, into an unnamed file.
fn make(
    log: &FilePath,
    (folder, quota): (&FilePath, &Arc<DiskQuota>),
    format: Format,
    fields: Fields,
    accuracy: Accuracy,
    interrupt: &AtomicBool,
) -> Result<OpenFile, Refusal> {
    let cannot = |error: std::io::Error| {
        Failure::new(
            Kind::Incomplete,
            format!("no room to make the cloud in {}: {error}", folder.display()),
        )
        .help("free some space on that disk")
    };
    let log = io::files::open_regular(log).map_err(|_| Refusal::no_file(LOG))?;
    // The name may belong to another file by now; this one leads to the open file (proc(5)).
    let log_path = format!("/proc/self/fd/{}", log.as_raw_fd());
    let named = |failure: Failure| Failure {
        message: failure.message.replace(&log_path, LOG),
        ..failure
    };
    let source = Source::open(FilePath::new(&log_path), None).map_err(named)?;
    let request = Reconstruction::of_log(&source, accuracy, interrupt)?;
    let mut file = io::files::scratch_in(folder).map_err(cannot)?;
    let out = QuotaFile::new(file.try_clone().map_err(cannot)?, Arc::clone(quota));
    let out = BufferedFile::new(out);
    let mut sink = format.writer(out, fields);
    let output = PathBuf::from(format!("cloud.{}", format.extension()));
    let made = replay::scan(&request, &mut *sink, &output).and_then(|_| {
        sink.finish()
            .map_err(|error| engine::output::sink_failure(&output, &error))
    });
    made.map_err(|failure| match quota.refused() {
        Some(full) => Refusal::no_room(full.clone()),
        None => named(failure).into(),
    })?;
    drop(sink);
    file.seek(SeekFrom::Start(0)).map_err(cannot)?;
    let metadata = file.metadata().map_err(cannot)?;
    Ok((file, metadata))
}

/// The log of a scan.
#[utoipa::path(get, path = "/api/v1/scans/{id}/log", tag = "scans", params(("id" = String, Path, description = "Id of a scan"), ("Range" = Option<String>, Header, description = "The requested part (RFC 9110)")), responses(StoredFile))]
pub async fn log(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    stored(&api, &id, (LOG, "pcapng"), &headers).await
}

/// A picture of the cloud.
#[utoipa::path(get, path = "/api/v1/scans/{id}/thumbnail", tag = "scans", params(("id" = String, Path, description = "Id of a scan"), ("Range" = Option<String>, Header, description = "The requested part (RFC 9110)")), responses(StoredPicture))]
pub async fn thumbnail(
    State(api): State<Arc<Api>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    stored(&api, &id, (THUMBNAIL, "png"), &headers).await
}

/// A file of a scan's folder.
async fn stored(
    api: &Api,
    id: &str,
    (name, extension): (&str, &str),
    headers: &HeaderMap,
) -> Result<Response, Refusal> {
    let record = api.state.scans.record(id);
    let stem = stem(&record.ok_or_else(|| Refusal::no_scan(id))?);
    let permit = downloading(api)?;
    let file = open(api.state.scans.place(id).join(name)).await?;
    let file = file.map_err(|_| Refusal::no_file(name))?;
    let tag = tag_of(&file.1);
    Ok(send(file, (&stem, extension), permit, (headers, &tag)))
}

fn downloading(api: &Api) -> Result<OwnedSemaphorePermit, Refusal> {
    Arc::clone(&api.downloads)
        .try_acquire_owned()
        .map_err(|_| Refusal::too_many("downloads"))
}

/// Opens a regular file.
///
/// # Errors
/// As [`super::with_disk`]; within, the disk's own.
async fn open(path: PathBuf) -> Result<std::io::Result<OpenFile>, Refusal> {
    super::with_disk(move || {
        let file = io::files::open_regular(&path)?;
        let metadata = file.metadata()?;
        Ok((file, metadata))
    })
    .await
}

/// Name of a scan's files without extension: the user's name and the id, which no two share.
fn stem(record: &ScanRecord) -> String {
    let name = record.name.as_deref().unwrap_or("velomotion");
    format!("{name}-{}", record.id)
}
