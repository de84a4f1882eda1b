//! A YAML document as a tree that knows its lines: as much of the language as calibration files
//! use.
//!
//! Left out: anchors and aliases, tags, and more than one document; each is an error.

use saphyr_parser::{Event, Parser, Span};

use super::CalibrationError;

/// Deeper than any calibration.
const MOST_DEPTH: usize = 16;

/// A value and the line on which it begins.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub line: usize,
    pub value: Value,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Scalar(String),
    List(Vec<Node>),
    /// Keys in the order of the file, none twice.
    Map(Vec<(Node, Node)>),
}

impl Node {
    pub(super) fn as_str(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar(text) => Some(text),
            _ => None,
        }
    }

    /// What it is, for an error.
    pub(super) fn describe(&self) -> String {
        match &self.value {
            Value::Scalar(text) => format!("{text:?}"),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Map(pairs) => format!("a mapping of {} keys", pairs.len()),
        }
    }
}

/// A list or mapping whose end has not come.
struct Open {
    node: Node,
    /// The key whose value comes next.
    key: Option<Node>,
}

/// Reads the one document of `text`.
pub(super) fn parse(layer: &'static str, text: &str) -> Result<Node, CalibrationError> {
    let wrong = |line, message: &str| CalibrationError::Syntax {
        layer,
        line,
        message: message.to_owned(),
    };
    let mut open: Vec<Open> = Vec::new();
    let mut root = None;
    for event in Parser::new_from_str(text) {
        let (event, Span { start, .. }) =
            event.map_err(|error| wrong(error.marker().line(), error.info()))?;
        let line = start.line();
        let begin = |value| Open {
            node: Node { line, value },
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
            Event::Scalar(text, ..) => Some(Node {
                line,
                value: Value::Scalar(text.into_owned()),
            }),
            Event::SequenceStart(..) => {
                open.push(begin(Value::List(Vec::new())));
                None
            }
            Event::MappingStart(..) => {
                open.push(begin(Value::Map(Vec::new())));
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

impl Open {
    /// Adds a finished item, key or value.
    fn take(&mut self, done: Node) -> Result<(), String> {
        match (&mut self.node.value, self.key.take()) {
            (Value::List(items), _) => items.push(done),
            (Value::Map(pairs), Some(key)) => pairs.push((key, done)),
            (Value::Map(pairs), None) => {
                let Some(name) = done.as_str() else {
                    return Err(format!("expected a key, got {}", done.describe()));
                };
                if pairs.iter().any(|(key, _)| key.as_str() == Some(name)) {
                    return Err(format!("key {name} is there twice"));
                }
                self.key = Some(done);
            }
            // Scalars are never open.
            (Value::Scalar(_), _) => {}
        }
        Ok(())
    }
}
