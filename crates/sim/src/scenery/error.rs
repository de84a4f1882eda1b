//! Errors of scene files and their positions.

use std::fmt;
use std::ops::{Range, RangeInclusive};

use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::meshes::MeshFileError;

/// A position in a scene file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FilePosition {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
}

impl FilePosition {
    /// The position of a byte of the text.
    pub(crate) fn of(text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.matches('\n').count() + 1,
            column: before.get(line_start..).unwrap_or_default().chars().count() + 1,
        }
    }
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// An invalid scene.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{at}: {what}")]
#[non_exhaustive]
pub struct SceneryError {
    /// The position of the value or object, or of its table where several values are involved.
    pub at: FilePosition,
    /// Name of the value, the expectation, and the value found.
    pub what: String,
    /// Reason why a mesh cannot be read.
    pub source: Option<MeshFileError>,
}

impl SceneryError {
    /// An error at a position.
    pub(super) const fn new(at: FilePosition, what: String) -> Self {
        let source = None;
        Self { at, what, source }
    }

    pub(super) fn toml(text: &str, error: &toml::de::Error) -> Self {
        let offset = error.span().map_or(0, |span| span.start);
        Self::new(FilePosition::of(text, offset), toml_message(error))
    }
}

/// The message of a TOML error in one line, with ranges in place of types.
pub(crate) fn toml_message(error: &toml::de::Error) -> String {
    let line = error.message().trim().replace('\n', ", ");
    line.replace("expected u8", "expected a whole number from 0 to 255")
        .replace(
            "expected u32",
            "expected a whole number from 0 to 4294967295",
        )
        .replace("expected u64", "expected a whole number from 0")
}

/// An invalid value, before its position is known.
#[derive(Debug)]
pub(crate) struct InvalidValue {
    /// Its keys, joined by dots: in the file, or in the table of an object or material.
    pub path: String,
    /// The error.
    pub what: String,
}

impl InvalidValue {
    /// The error at a position.
    pub(super) fn at(self, at: FilePosition) -> SceneryError {
        SceneryError::new(at, self.what)
    }

    /// The error at the value in the material or object that begins at a byte of the text, else at
    /// that byte.
    pub(super) fn in_text(self, text: &str, begin: usize) -> SceneryError {
        let offset = offset_of_field(text, begin, &self.path).unwrap_or(begin);
        self.at(FilePosition::of(text, offset))
    }
}

fn offset_of_field(text: &str, begin: usize, field: &str) -> Option<usize> {
    let file = DeTable::parse(text).ok()?;
    let objects = file.get_ref().get("objects");
    let mut objects = objects
        .and_then(|all| all.get_ref().as_array())
        .into_iter()
        .flatten();
    let table = match objects.find(|object| object.span().start == begin) {
        Some(object) => object,
        None => {
            let materials = file.get_ref().get("materials")?.get_ref().as_table()?;
            let mut materials = materials.iter();
            materials.find(|(name, _)| name.span().start == begin)?.1
        }
    };
    Some(deepest_span(table, field)?.start)
}

/// The span of the value that dotted keys lead to, as far as they exist.
fn deepest_span(table: &Spanned<DeValue<'_>>, path: &str) -> Option<Range<usize>> {
    let (mut value, mut span) = (table, None);
    for key in path.split('.') {
        let Some(next) = value.get_ref().get(key) else {
            break;
        };
        (value, span) = (next, Some(next.span()));
    }
    span
}

/// The line (from 1) of the value that dotted keys lead to, as far as they exist.
pub(crate) fn line_of_value(text: &str, path: &str) -> usize {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let offset = DeTable::parse(text).ok().and_then(|file| {
        let value = file.get_ref().get(first)?;
        Some(deepest_span(value, rest).unwrap_or(value.span()).start)
    });
    FilePosition::of(text, offset.unwrap_or(0)).line
}

/// An invalid value of an object or material.
pub(super) fn invalid(field: &str, expected: &str, got: impl fmt::Debug) -> InvalidValue {
    InvalidValue {
        path: field.to_owned(),
        what: format!("{field}: expected {expected}, got {got:?}"),
    }
}

/// Checks that all values are finite.
pub(super) fn finite(field: &str, values: &[f64]) -> Result<(), InvalidValue> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(invalid(field, "finite numbers", values)),
    }
}

/// Checks that a value is finite and above zero.
pub(super) fn above_0(field: &str, value: f64) -> Result<(), InvalidValue> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(invalid(field, "a number above 0", value)),
    }
}

/// Checks that a value is within a range, ends included.
pub(super) fn within(
    field: &str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<(), InvalidValue> {
    match range.contains(&value) {
        true => Ok(()),
        false => {
            let expected = format!("{} to {}", range.start(), range.end());
            Err(invalid(field, &expected, value))
        }
    }
}
