//! Parts of stored files (RFC 9110, section 14), so that an interrupted download of a large log
//! goes on where it ended, and validators (section 8.8).

use std::fs::Metadata;
use std::ops::Range;
use std::time::UNIX_EPOCH;

use axum::http::{HeaderMap, header};

/// The part of a file to send.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileRange {
    /// All of it.
    Whole,
    /// These bytes.
    Bytes(Range<u64>),
    /// None: the file is shorter.
    Unsatisfiable,
}

/// Validator of a stored file as it is now: its length and the time of its last change.
pub fn tag_of(file: &Metadata) -> String {
    let time = file.modified().ok();
    let age = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    let ns = age.map_or(0, |age| age.as_nanos());
    format!("\"{:x}-{ns:x}\"", file.len())
}

/// Whether the client has the content of this validator.
pub fn is_known(headers: &HeaderMap, tag: &str) -> bool {
    let known = headers.get_all(header::IF_NONE_MATCH).iter();
    let mut tags = known
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','));
    tags.any(|known| matches!(known.trim(), "*") || known.trim().trim_start_matches("W/") == tag)
}

/// The part that a request asks for of `length` bytes. Several parts, other units and parts of
/// another version give the whole.
pub fn range_of(headers: &HeaderMap, tag: &str, length: u64) -> FileRange {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    if text(header::IF_RANGE).is_some_and(|version| version != tag) {
        return FileRange::Whole;
    }
    let Some((first, last)) = text(header::RANGE)
        .and_then(|range| range.strip_prefix("bytes="))
        .and_then(|range| range.split_once('-'))
    else {
        return FileRange::Whole;
    };
    let range = match (first.trim().parse(), last.trim().parse::<u64>()) {
        (Ok(first), Ok(last)) if first <= last => first..last.saturating_add(1).min(length),
        (Ok(first), Err(_)) if last.trim().is_empty() => first..length,
        (Err(_), Ok(last)) if first.trim().is_empty() => length.saturating_sub(last)..length,
        _ => return FileRange::Whole,
    };
    match range.start < range.end {
        true => FileRange::Bytes(range),
        false => FileRange::Unsatisfiable,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(range: &str, version: Option<&str>) -> FileRange {
        let mut headers = HeaderMap::new();
        headers.insert(header::RANGE, range.parse().unwrap());
        if let Some(version) = version {
            headers.insert(header::IF_RANGE, version.parse().unwrap());
        }
        range_of(&headers, "\"1\"", 1_000)
    }

    #[test]
    fn ranges_are_those_of_rfc_9110() {
        for (range, expected) in [
            ("bytes=0-499", FileRange::Bytes(0..500)),
            ("bytes=500-999", FileRange::Bytes(500..1_000)),
            ("bytes=500-5000", FileRange::Bytes(500..1_000)),
            ("bytes=-500", FileRange::Bytes(500..1_000)),
            ("bytes=-5000", FileRange::Bytes(0..1_000)),
            ("bytes=999-", FileRange::Bytes(999..1_000)),
            ("bytes=1000-", FileRange::Unsatisfiable),
            ("bytes=1000-1001", FileRange::Unsatisfiable),
            ("bytes=-0", FileRange::Unsatisfiable),
            ("bytes=5-4", FileRange::Whole),
            ("bytes=0-1,5-6", FileRange::Whole),
            ("bytes=-", FileRange::Whole),
            ("lines=0-1", FileRange::Whole),
            ("bytes=0-18446744073709551615", FileRange::Bytes(0..1_000)),
        ] {
            assert_eq!(of(range, None), expected, "{range}");
        }
    }

    #[test]
    fn a_part_of_another_version_is_not_sent() {
        assert_eq!(of("bytes=5-", Some("\"1\"")), FileRange::Bytes(5..1_000));
        assert_eq!(of("bytes=5-", Some("\"2\"")), FileRange::Whole);
        assert_eq!(of("bytes=5-", Some("W/\"1\"")), FileRange::Whole);
    }

    #[test]
    fn a_client_may_know_several_versions() {
        let mut headers = HeaderMap::new();
        headers.insert(header::IF_NONE_MATCH, "\"0\", W/\"1\"".parse().unwrap());
        assert!(is_known(&headers, "\"1\"") && !is_known(&headers, "\"2\""));
    }
}
