//! Nodes of the tree: values with their places.

use crate::error::shorten;
use std::fmt;
use std::sync::Arc;

/// Source of a text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Origin {
    /// File, as the user named it.
    File(Arc<str>),
    /// Program that made the text: a line of it would tell its user nothing.
    Program,
}

impl Origin {
    /// Place of a line, counted from 1; 0 for the text as a whole.
    pub(crate) fn line(&self, line: usize) -> Place {
        match self {
            Self::File(file) => Place::Line { file: Arc::clone(file), line },
            Self::Program => Place::Line { file: "the scene".into(), line: 0 },
        }
    }
}

/// Place where a value was written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Place {
    /// Line of a file.
    Line {
        /// File, as the user named it.
        file: Arc<str>,
        /// Line number from 1; 0 when the file as a whole is meant.
        line: usize,
    },
    /// Override `--set` on the command line.
    Set(Arc<str>),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { file, line: 0 } => f.write_str(file),
            Self::Line { file, line } => write!(f, "{file}:{line}"),
            Self::Set(text) => write!(f, "--set {}", shorten(text)),
        }
    }
}

/// Keys and nodes of a table, in the order of the text.
pub(crate) type Entries = Vec<(String, Node)>;

/// Value of TOML.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// String.
    Text(String),
    /// Integer.
    Integer(i64),
    /// Floating-point number; may be nan or inf.
    Float(f64),
    /// Boolean.
    Boolean(bool),
    /// Value that no scene uses, such as a date or an integer beyond 64 bits, as it was written.
    Other(String),
    /// Array.
    Array(Vec<Node>),
    /// Table.
    Table(Entries),
}

/// Value and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

impl Node {
    /// Text of the value as a scene would have it, shortened for messages.
    pub(crate) fn shown(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{}\"", shorten(text)),
            Value::Float(number) => format!("{number:?}"),
            other => shorten(&Self::toml(other).to_string()),
        }
    }

    /// Converts the node to a plain TOML value.
    pub(crate) fn to_toml(&self) -> toml::Value {
        Self::toml(&self.value)
    }

    fn toml(value: &Value) -> toml::Value {
        match value {
            Value::Text(text) | Value::Other(text) => toml::Value::String(text.clone()),
            Value::Integer(number) => toml::Value::Integer(*number),
            Value::Float(number) => toml::Value::Float(*number),
            Value::Boolean(flag) => toml::Value::Boolean(*flag),
            Value::Array(items) => toml::Value::Array(items.iter().map(Self::to_toml).collect()),
            Value::Table(entries) => {
                toml::Value::Table(entries.iter().map(|(key, node)| (key.clone(), node.to_toml())).collect())
            }
        }
    }

    /// Number, of a float or an integer.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.value {
            Value::Float(number) => Some(number),
            #[expect(clippy::cast_precision_loss, reason = "scenes hold no integers beyond 2^53")]
            Value::Integer(number) => Some(number as f64),
            _ => None,
        }
    }

    /// Name of the kind of value, for messages.
    pub(crate) fn kind(&self) -> &'static str {
        match self.value {
            Value::Text(_) => "a text",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Other(_) => "a date or a number beyond 64 bits",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}
