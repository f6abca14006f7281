//! TOML text to tree.

use super::node::{Entries, Node, Place, Value};
use crate::SceneError;
use crate::error::shorten;
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// Turns byte offsets into places.
struct Lines<'a> {
    locate: &'a dyn Fn(usize) -> Place,
}

/// Parses a document.
///
/// # Errors
/// Text that is not TOML.
pub(crate) fn parse_document(file: &Arc<str>, text: &str) -> Result<Entries, SceneError> {
    let starts: Vec<usize> = std::iter::once(0)
        .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(k, _)| k + 1))
        .collect();
    let locate = |offset: usize| Place::Line {
        file: Arc::clone(file),
        line: starts.partition_point(|start| *start <= offset),
    };
    parse_with(text, &locate)
}

/// Parses a document whose places are given by a function of the byte offset.
pub(super) fn parse_with(text: &str, locate: &dyn Fn(usize) -> Place) -> Result<Entries, SceneError> {
    let table = DeTable::parse(text).map_err(|error| SceneError::Syntax {
        place: locate(error.span().map_or(0, |span| span.start)).to_string(),
        message: shorten(error.message()),
    })?;
    let lines = Lines { locate };
    Ok(lines.entries(table.get_ref()))
}

impl Lines<'_> {
    fn entries(&self, table: &DeTable<'_>) -> Entries {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        entries
            .into_iter()
            .map(|(key, value)| {
                // A table's own span may be empty or elsewhere for dotted keys; its key always has a place.
                let place = (self.locate)(key.span().start);
                (key.get_ref().to_string(), self.node(value.get_ref(), place))
            })
            .collect()
    }

    fn node(&self, value: &DeValue<'_>, place: Place) -> Node {
        let value = match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
                .map_or_else(|_| Value::Other(number.as_str().to_owned()), Value::Integer),
            DeValue::Float(number) => number
                .as_str()
                .parse()
                .map_or_else(|_| Value::Other(number.as_str().to_owned()), Value::Float),
            DeValue::Boolean(flag) => Value::Boolean(*flag),
            DeValue::Datetime(date) => Value::Other(date.to_string()),
            DeValue::Array(items) => Value::Array(
                items
                    .iter()
                    .map(|item| self.node(item.get_ref(), (self.locate)(item.span().start)))
                    .collect(),
            ),
            DeValue::Table(table) => Value::Table(self.entries(table)),
        };
        Node { value, place }
    }
}
