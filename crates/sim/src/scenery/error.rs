//! Errors of scene files and their positions.

use std::fmt;
use std::ops::{Range, RangeInclusive};

use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::meshes::MeshFileError;

/// A position in a scene file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilePosition {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
}

impl FilePosition {
    /// The position of a byte of the text.
    pub(super) fn of(text: &str, offset: usize) -> Self {
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
#[non_exhaustive]
pub enum SceneryError {
    /// No TOML, an unknown key or a value of another type.
    #[error("sim: scene, {at}: {message}")]
    Toml {
        /// The position.
        at: FilePosition,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// An invalid value.
    #[error("sim: scene, {at}: {what}")]
    Value {
        /// The position of the value, or of its table where several values are involved.
        at: FilePosition,
        /// Which value, what was expected, and the value.
        what: String,
    },
    /// A mesh that cannot be read.
    #[error("sim: scene, {at}: mesh {file}")]
    Mesh {
        /// The position of the object.
        at: FilePosition,
        /// Name of the file in the scene.
        file: String,
        /// The reason.
        source: MeshFileError,
    },
}

impl SceneryError {
    /// The position of the error.
    #[must_use]
    pub const fn at(&self) -> FilePosition {
        match self {
            Self::Toml { at, .. } | Self::Value { at, .. } | Self::Mesh { at, .. } => *at,
        }
    }

    /// What is wrong, without the position.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::Toml { message, .. } => message.clone(),
            Self::Value { what, .. } => what.clone(),
            Self::Mesh { file, source, .. } => format!("mesh {file}: {source}"),
        }
    }

    pub(super) fn toml(text: &str, error: &toml::de::Error) -> Self {
        Self::Toml {
            at: FilePosition::of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().trim().replace('\n', ", "),
        }
    }
}

/// An invalid value of an object or material, before its position is known.
#[derive(Debug)]
pub(super) struct InvalidField {
    /// Its keys within the table, joined by dots.
    field: String,
    expected: String,
    got: String,
}

impl InvalidField {
    /// The error at a position.
    pub fn at(self, at: FilePosition) -> SceneryError {
        SceneryError::Value {
            at,
            what: format!(
                "{}: expected {}, got {}",
                self.field, self.expected, self.got
            ),
        }
    }

    /// The error at the value in the material or object that begins at a byte of the text, else at
    /// that byte.
    pub fn in_text(self, text: &str, begin: usize) -> SceneryError {
        let offset = offset_of_field(text, begin, &self.field).unwrap_or(begin);
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

pub(super) fn invalid(
    field: impl Into<String>,
    expected: impl Into<String>,
    got: impl fmt::Debug,
) -> InvalidField {
    InvalidField {
        field: field.into(),
        expected: expected.into(),
        got: format!("{got:?}"),
    }
}

/// Checks that all values are finite.
pub(super) fn finite(field: &str, values: &[f64]) -> Result<(), InvalidField> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(invalid(field, "finite numbers", values)),
    }
}

/// Checks that a value is finite and above zero.
pub(super) fn above_0(field: &str, value: f64) -> Result<(), InvalidField> {
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
) -> Result<(), InvalidField> {
    match range.contains(&value) {
        true => Ok(()),
        false => {
            let expected = format!("{} to {}", range.start(), range.end());
            Err(invalid(field, expected, value))
        }
    }
}
