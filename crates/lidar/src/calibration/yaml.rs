//! YAML documents as trees with line numbers, for the subset that calibration files use.
//!
//! Anchors, aliases, tags and several documents are errors.

use saphyr_parser::{Event, Parser, Span};

use super::CalibrationError;

/// Deeper nesting than any calibration file has.
const MOST_DEPTH: usize = 16;

/// A value and the line where it starts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct YamlNode {
    pub line: usize,
    pub value: YamlValue,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum YamlValue {
    Scalar(String),
    List(Vec<YamlNode>),
    /// Unique keys in the order of the file.
    Map(Vec<(YamlNode, YamlNode)>),
}

impl YamlNode {
    pub(super) fn as_str(&self) -> Option<&str> {
        match &self.value {
            YamlValue::Scalar(text) => Some(text),
            _ => None,
        }
    }

    /// Describes the value for an error message.
    pub(super) fn describe(&self) -> String {
        match &self.value {
            YamlValue::Scalar(text) => format!("{text:?}"),
            YamlValue::List(items) => format!("a list of {}", items.len()),
            YamlValue::Map(pairs) => format!("a mapping of {} keys", pairs.len()),
        }
    }
}

/// An unfinished list or mapping.
struct OpenNode {
    node: YamlNode,
    /// The key of the next value.
    key: Option<YamlNode>,
}

/// Parses the single document of `text`.
pub(super) fn parse(layer: &'static str, text: &str) -> Result<YamlNode, CalibrationError> {
    let wrong = |line, message: &str| CalibrationError::Syntax {
        layer,
        line,
        message: message.to_owned(),
    };
    let mut open: Vec<OpenNode> = Vec::new();
    let mut root = None;
    for event in Parser::new_from_str(text) {
        let (event, Span { start, .. }) =
            event.map_err(|error| wrong(error.marker().line(), error.info()))?;
        let line = start.line();
        let begin = |value| OpenNode {
            node: YamlNode { line, value },
            key: None,
        };
        let done = match event {
            Event::Alias(_) => return Err(wrong(line, "aliases are not supported")),
            Event::Scalar(_, _, anchor, ref tag)
            | Event::SequenceStart(anchor, ref tag)
            | Event::MappingStart(anchor, ref tag)
                if anchor != 0 || tag.is_some() =>
            {
                return Err(wrong(line, "anchors and tags are not supported"));
            }
            Event::Scalar(text, ..) => Some(YamlNode {
                line,
                value: YamlValue::Scalar(text.into_owned()),
            }),
            Event::SequenceStart(..) => {
                open.push(begin(YamlValue::List(Vec::new())));
                None
            }
            Event::MappingStart(..) => {
                open.push(begin(YamlValue::Map(Vec::new())));
                None
            }
            Event::SequenceEnd | Event::MappingEnd => open.pop().map(|open| open.node),
            Event::DocumentStart(_) if root.is_some() => {
                return Err(wrong(line, "expected one document, got another"));
            }
            _ => None,
        };
        if open.len() > MOST_DEPTH {
            return Err(wrong(line, "nested too deeply"));
        }
        let Some(done) = done else { continue };
        match open.last_mut() {
            None => root = Some(done),
            Some(parent) => parent.take(done).map_err(|message| wrong(line, &message))?,
        }
    }
    root.ok_or(wrong(1, "expected a document, got an empty file"))
}

impl OpenNode {
    /// Adds a complete item, key or value.
    fn take(&mut self, done: YamlNode) -> Result<(), String> {
        match (&mut self.node.value, self.key.take()) {
            (YamlValue::List(items), _) => items.push(done),
            (YamlValue::Map(pairs), Some(key)) => pairs.push((key, done)),
            (YamlValue::Map(pairs), None) => {
                let Some(name) = done.as_str() else {
                    return Err(format!("expected a key, got {}", done.describe()));
                };
                if pairs.iter().any(|(key, _)| key.as_str() == Some(name)) {
                    return Err(format!("key {name} is repeated"));
                }
                self.key = Some(done);
            }
            // Scalars have no content.
            (YamlValue::Scalar(_), _) => {}
        }
        Ok(())
    }
}
