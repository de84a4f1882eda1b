//! Sends files, a piece at a time.

use std::fs::{File, Metadata};
use std::io::{Seek, SeekFrom};

use axum::body::Body;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use engine::failure::Kind;
use futures_util::stream::try_unfold;
use tokio::io::AsyncReadExt;
use tokio::sync::OwnedSemaphorePermit;

use super::partial::{FileRange, is_known, range_of, tag_of};
use super::refusal::Refusal;

/// Bytes that are read at once.
const PIECE: usize = 256 << 10;

/// A file and what the system says of it.
pub type OpenFile = (File, Metadata);

/// The header for a file of this name (RFC 6266): folders renamed by hand may have any.
fn attachment(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let plain = name.replace(|c| !is_plain(c), "_");
    if plain == name {
        return format!("attachment; filename=\"{plain}\"");
    }
    let mut escaped = String::new();
    for byte in name.bytes() {
        match is_plain(byte.into()) {
            true => escaped.push(byte.into()),
            false => escaped.push_str(&format!("%{byte:02X}")),
        }
    }
    format!("attachment; filename=\"{plain}\"; filename*=UTF-8''{escaped}")
}

/// Sends a file as it is now, a piece at a time: as fast as the client takes it. Of a stored file
/// the client may ask, by the headers of its request, for a part.
pub fn send(
    (mut file, metadata): OpenFile,
    stem: &str,
    extension: &str,
    permit: OwnedSemaphorePermit,
    request_headers: Option<&HeaderMap>,
) -> Response {
    let length = metadata.len();
    let tag = tag_of(&metadata);
    let mut headers = HeaderMap::new();
    let mut set = |name, value: String| {
        if let Ok(value) = HeaderValue::from_str(&value) {
            headers.insert(name, value);
        }
    };
    let content = match extension {
        "png" => "image/png",
        "csv" => "text/csv; charset=utf-8",
        _ => "application/octet-stream",
    };
    set(header::CONTENT_TYPE, content.to_owned());
    set(
        header::CONTENT_DISPOSITION,
        attachment(&format!("{stem}.{extension}")),
    );
    // A token may protect it: only the client itself may keep it, and asks each time.
    let cache = request_headers.map_or("no-store", |_| "private, no-cache");
    set(header::CACHE_CONTROL, cache.to_owned());
    let mut status = StatusCode::OK;
    let mut range = 0..length;
    if let Some(request_headers) = request_headers {
        set(header::ETAG, tag.clone());
        set(header::ACCEPT_RANGES, "bytes".to_owned());
        if is_known(request_headers, &tag) {
            return (StatusCode::NOT_MODIFIED, headers).into_response();
        }
        match range_of(request_headers, &tag, length) {
            FileRange::Whole => {}
            FileRange::Bytes(bytes) if file.seek(SeekFrom::Start(bytes.start)).is_ok() => {
                status = StatusCode::PARTIAL_CONTENT;
                let last = bytes.end.saturating_sub(1);
                let place = format!("bytes {}-{last}/{length}", bytes.start);
                set(header::CONTENT_RANGE, place);
                range = bytes;
            }
            FileRange::Bytes(_) | FileRange::Unsatisfiable => {
                let (code, reason) = (StatusCode::RANGE_NOT_SATISFIABLE, Kind::Usage);
                let error = format!("the range of bytes: expected a part of {length} bytes");
                let refusal = Refusal::new(code, reason, error, "ask for the whole file");
                let place = [(header::CONTENT_RANGE, format!("bytes */{length}"))];
                return (place, refusal).into_response();
            }
        }
    }
    let length = range.end.saturating_sub(range.start);
    set(header::CONTENT_LENGTH, length.to_string());
    // A log may grow while it is read: the announced length is sent.
    let file = tokio::fs::File::from_std(file).take(length);
    let body = Body::from_stream(try_unfold(
        (file, permit),
        |(mut file, permit)| async move {
            let mut piece = vec![0; PIECE];
            let read = file.read(&mut piece).await?;
            piece.truncate(read);
            Ok::<_, std::io::Error>((read > 0).then_some((piece, (file, permit))))
        },
    ));
    (status, headers, body).into_response()
}
