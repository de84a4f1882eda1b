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

use super::partial::{FileRange, is_known, range_of};
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

/// Headers of a file that the client may keep, but asks for each time, as a token may protect it.
fn validators(tag: &str) -> HeaderMap {
    let mut headers = HeaderMap::new();
    if let Ok(tag) = HeaderValue::from_str(tag) {
        headers.insert(header::ETAG, tag);
    }
    headers.insert(
        header::CACHE_CONTROL,
        HeaderValue::from_static("private, no-cache"),
    );
    headers
}

/// The answer to a client that has the file.
pub fn not_modified(tag: &str) -> Response {
    (StatusCode::NOT_MODIFIED, validators(tag)).into_response()
}

/// Sends a file as it is now, a piece at a time: as fast as the client takes it. The client may ask
/// for a part by the headers of its request, if its bytes have the same validator.
pub fn send(
    (mut file, metadata): OpenFile,
    (stem, extension): (&str, &str),
    permit: OwnedSemaphorePermit,
    (request_headers, tag): (&HeaderMap, &str),
) -> Response {
    if is_known(request_headers, tag) {
        return not_modified(tag);
    }
    let length = metadata.len();
    let mut headers = validators(tag);
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
    set(header::ACCEPT_RANGES, "bytes".to_owned());
    let mut status = StatusCode::OK;
    let mut range = 0..length;
    match range_of(request_headers, tag, length) {
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
