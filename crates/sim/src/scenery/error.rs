//! What can be wrong with a scene, and where it says so.

use std::fmt;

use thiserror::Error;
use toml::de::DeTable;

use super::meshes::MeshFileError;

/// A place in a scene file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct At {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
}

impl At {
    /// The place of a byte of the text.
    pub(super) fn of(text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.matches('\n').count() + 1,
            column: before.get(line_start..).unwrap_or_default().chars().count() + 1,
        }
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// What is no scene.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SceneryError {
    /// No TOML, a key that is not known, or a value of another kind.
    #[error("sim: scene, {at}: {message}")]
    Toml {
        /// Where.
        at: At,
        /// What, and what was expected instead.
        message: String,
    },
    /// A value that cannot be.
    #[error("sim: scene, {at}: {what}: expected {expected}, got {got}")]
    Value {
        /// Where it stands; where the table begins that has it, if it is of several.
        at: At,
        /// Which value.
        what: String,
        /// What it may be.
        expected: String,
        /// What it is.
        got: String,
    },
    /// A mesh that cannot be had.
    #[error("sim: scene, {at}: mesh {file}")]
    Mesh {
        /// Where the object stands.
        at: At,
        /// The file by its name in the scene.
        file: String,
        /// Why.
        source: MeshFileError,
    },
}

impl SceneryError {
    /// Where the scene file is wrong.
    #[must_use]
    pub const fn at(&self) -> At {
        match self {
            Self::Toml { at, .. } | Self::Value { at, .. } | Self::Mesh { at, .. } => *at,
        }
    }

    /// What is wrong there, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::Toml { message, .. } => message.clone(),
            Self::Value {
                what,
                expected,
                got,
                ..
            } => format!("{what}: expected {expected}, got {got}"),
            Self::Mesh { file, source, .. } => format!("mesh {file}: {source}"),
        }
    }

    /// The same, said of the value itself instead of the table that begins (or whose name does) at a byte of the text.
    pub(super) fn at_its_value(mut self, text: &str, begin: usize) -> Self {
        if let Self::Value { at, what, .. } = &mut self
            && let Ok(file) = DeTable::parse(text)
            && let Some(value) = find(file.get_ref(), begin, what)
        {
            *at = At::of(text, value);
        }
        self
    }

    pub(super) fn toml(text: &str, error: &toml::de::Error) -> Self {
        Self::Toml {
            at: At::of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().trim().replace('\n', ", "),
        }
    }
}

/// Where the value begins that a dotted name leads to, as far as it does, from the material or object at `begin`; `None` where not even its
/// first part is a key there.
fn find(file: &DeTable<'_>, begin: usize, name: &str) -> Option<usize> {
    let objects = file.get("objects").and_then(|all| all.get_ref().as_array());
    let object = objects.and_then(|all| all.iter().find(|object| object.span().start == begin));
    let materials = file
        .get("materials")
        .and_then(|all| all.get_ref().as_table());
    let material = || {
        let mut all = materials?.iter();
        all.find(|(name, _)| name.span().start == begin)
            .map(|(_, material)| material)
    };
    let mut value = object.or_else(material)?;
    let mut found = None;
    for part in name.split('.') {
        let Some(next) = value.get_ref().get(part) else {
            break;
        };
        value = next;
        found = Some(value.span().start);
    }
    found
}

/// A check that fails with these words.
pub(super) fn wrong(
    at: &At,
    what: impl Into<String>,
    expected: impl Into<String>,
    got: impl fmt::Debug,
) -> SceneryError {
    SceneryError::Value {
        at: *at,
        what: what.into(),
        expected: expected.into(),
        got: format!("{got:?}"),
    }
}

/// All finite.
pub(super) fn finite(at: &At, what: &str, values: &[f64]) -> Result<(), SceneryError> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(wrong(at, what, "finite numbers", values)),
    }
}

/// Finite and above zero.
pub(super) fn above_0(at: &At, what: &str, value: f64) -> Result<(), SceneryError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(wrong(at, what, "a number above 0", value)),
    }
}

/// Within, ends included.
pub(super) fn within(
    at: &At,
    what: &str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
) -> Result<(), SceneryError> {
    match range.contains(&value) {
        true => Ok(()),
        false => {
            let expected = format!("{} to {}", range.start(), range.end());
            Err(wrong(at, what, expected, value))
        }
    }
}
