//! Parser from TOML text to the tree.

use super::node::{Entries, Node, Origin, Place, Value};
use crate::SceneError;
use crate::error::shorten;
use toml::de::{DeTable, DeValue};

/// Converter from the library's values to nodes.
struct Converter<'a> {
    /// Place of a byte offset.
    locate: &'a dyn Fn(usize) -> Place,
}

/// Parses a document.
///
/// # Errors
/// Text that is not TOML.
pub(crate) fn parse_document(origin: &Origin, text: &str) -> Result<Entries, SceneError> {
    let starts: Vec<usize> = std::iter::once(0)
        .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(k, _)| k + 1))
        .collect();
    let locate = |offset: usize| origin.line(starts.partition_point(|start| *start <= offset));
    parse_with(text, &locate)
}

/// Parses a text; `locate` gives the place of a byte offset.
pub(super) fn parse_with(text: &str, locate: &dyn Fn(usize) -> Place) -> Result<Entries, SceneError> {
    let table = DeTable::parse(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let advice = match has_decimal_comma(text, at) {
            true => "; a number has a decimal point: 0.3, not 0,3",
            false => "",
        };
        SceneError::Syntax {
            place: locate(at).to_string(),
            message: format!("{}{advice}", shorten(error.message())),
        }
    })?;
    let converter = Converter { locate };
    Ok(converter.entries(table.get_ref()))
}

/// Whether a comma between digits stands where a text cannot be read further, at a byte offset.
fn has_decimal_comma(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    let is_digit = |place: usize| bytes.get(place).is_some_and(u8::is_ascii_digit);
    // The library names the comma, or what stands beside it.
    (at.saturating_sub(1)..=at + 1).any(|comma| {
        comma > 0 && bytes.get(comma) == Some(&b',') && is_digit(comma - 1) && is_digit(comma + 1)
    })
}

impl Converter<'_> {
    fn entries(&self, table: &DeTable<'_>) -> Entries {
        let mut entries: Vec<_> = table.iter().collect();
        // The library sorts keys by name; messages appear in the order of the text.
        entries.sort_by_key(|(key, _)| key.span().start);
        entries
            .into_iter()
            .map(|(key, value)| {
                // The span of a table may be empty or elsewhere for dotted keys; that of its key is always
                // right.
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
