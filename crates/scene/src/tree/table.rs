//! Typed access to the values of a table.

use super::node::{Entries, Node, Place, Value};
use super::range::Range;
use crate::SceneError;
use crate::error::shorten;
use nalgebra::Vector3;

/// Table of the tree, with typed access to its values.
///
/// Reading functions return `None` when the key is absent.
#[derive(Clone, Debug)]
pub(crate) struct SceneTable<'a> {
    entries: &'a Entries,
    /// Path of keys from the document to the table; empty for the document.
    path: String,
    place: Place,
}

/// Known name that is nearest to a misspelt one.
pub(crate) fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    // The cost of the comparison grows with the length, and such a long name is no misspelling.
    if name.chars().count() > 200 {
        return None;
    }
    let lower = name.to_lowercase();
    known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(&lower, &candidate.to_lowercase()), *candidate))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

impl<'a> SceneTable<'a> {
    /// Table of a whole document, whose keys must be known.
    pub(crate) fn document(entries: &'a Entries, place: Place, known: &[&str]) -> Result<Self, SceneError> {
        let table = Self { entries, path: String::new(), place };
        table.refuse_unknown(known)?;
        Ok(table)
    }

    /// Table of a node, which must be a table with known keys only.
    pub(crate) fn new(node: &'a Node, path: impl Into<String>, known: &[&str]) -> Result<Self, SceneError> {
        let path = path.into();
        let Value::Table(entries) = &node.value else {
            return Err(SceneError::Value {
                place: node.place.to_string(),
                key: path,
                value: node.shown(),
                problem: format!("expected a table with keys {}, got {}", known.join(", "), node.kind()),
            });
        };
        let table = Self { entries, path, place: node.place.clone() };
        table.refuse_unknown(known)?;
        Ok(table)
    }

    fn refuse_unknown(&self, known: &[&str]) -> Result<(), SceneError> {
        let mut problems = crate::error::Problems::default();
        for (key, node) in self.entries {
            if !known.contains(&key.as_str()) {
                let advice = nearest(key, known).map_or_else(String::new, |near| {
                    format!("; the nearest known key is {}", self.key(near))
                });
                problems.keep::<()>(Err(SceneError::UnknownKey {
                    place: node.place.to_string(),
                    key: self.key(&shorten(key)),
                    advice,
                }));
            }
        }
        problems.finish()
    }

    /// Place of the table.
    pub(crate) fn place(&self) -> &Place {
        &self.place
    }

    /// Full path of one of the keys of the table.
    pub(crate) fn key(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Node of a key.
    pub(crate) fn get(&self, key: &str) -> Option<&'a Node> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// Tells whether a key is present.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Keys that are present.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.entries.iter().map(|(key, _)| key.as_str())
    }

    /// Error about the value of a key.
    pub(crate) fn bad(&self, key: &str, problem: impl Into<String>) -> SceneError {
        match self.get(key) {
            Some(node) => SceneError::Value {
                place: node.place.to_string(),
                key: self.key(key),
                value: node.shown(),
                problem: problem.into(),
            },
            None => self.missing(key, problem),
        }
    }

    /// Place of a key's value, or of the table where the key is absent.
    pub(crate) fn place_of(&self, key: &str) -> &Place {
        self.get(key).map_or(&self.place, |node| &node.place)
    }

    /// Error about a key of a section below, found when sections are compared with each other.
    pub(crate) fn bad_below(
        &self,
        section: &str,
        key: &str,
        value: &str,
        problem: impl Into<String>,
    ) -> SceneError {
        let below = self.get(section).and_then(|node| match &node.value {
            Value::Table(entries) => {
                entries.iter().find(|(name, _)| name == key).map(|(_, node)| &node.place)
            }
            _ => None,
        });
        SceneError::Value {
            place: below.unwrap_or_else(|| self.place_of(section)).to_string(),
            key: format!("{section}.{key}"),
            value: value.to_owned(),
            problem: problem.into(),
        }
    }

    /// Error about a key that is absent.
    pub(crate) fn missing(&self, key: &str, advice: impl Into<String>) -> SceneError {
        SceneError::Missing { place: self.place.to_string(), key: self.key(key), advice: advice.into() }
    }

    /// Unwraps a value, or returns an error that says what to write.
    pub(crate) fn need<T>(&self, value: Option<T>, key: &str, advice: &str) -> Result<T, SceneError> {
        value.ok_or_else(|| self.missing(key, advice))
    }

    /// Number in a range.
    pub(crate) fn number(&self, key: &str, range: Range) -> Result<Option<f64>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let number = as_number(node).ok_or_else(|| {
            self.bad(key, format!("expected a number, got {}; write one {range}", node.kind()))
        })?;
        if range.contains(number) {
            Ok(Some(number))
        } else if number.is_finite() {
            Err(self.bad(key, format!("out of range; give a number {range}")))
        } else {
            Err(self.bad(key, format!("not finite; give a number {range}")))
        }
    }

    /// Number in a range, under a key that is required.
    pub(crate) fn need_number(&self, key: &str, range: Range) -> Result<f64, SceneError> {
        let number = self.number(key, range)?;
        self.need(number, key, &format!("give a number {range}"))
    }

    /// Number in a range, or the word `auto` (`Some(None)`).
    pub(crate) fn number_or_auto(&self, key: &str, range: Range) -> Result<Option<Option<f64>>, SceneError> {
        match self.get(key).map(|node| &node.value) {
            Some(Value::Text(word)) if word == "auto" => Ok(Some(None)),
            Some(Value::Text(_)) => Err(self.bad(key, format!("give a number {range}, or \"auto\""))),
            _ => Ok(self.number(key, range)?.map(Some)),
        }
    }

    /// Integer in a range.
    pub(crate) fn integer(&self, key: &str, low: i64, high: i64) -> Result<Option<i64>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        match node.value {
            Value::Integer(number) if (low..=high).contains(&number) => Ok(Some(number)),
            Value::Integer(_) => {
                Err(self.bad(key, format!("out of range; give an integer from {low} to {high}")))
            }
            _ => Err(self.bad(key, format!("expected an integer from {low} to {high}, got {}", node.kind()))),
        }
    }

    /// Boolean.
    pub(crate) fn boolean(&self, key: &str) -> Result<Option<bool>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        match node.value {
            Value::Boolean(flag) => Ok(Some(flag)),
            _ => Err(self.bad(key, format!("expected true or false, got {}", node.kind()))),
        }
    }

    /// Text that is not empty.
    pub(crate) fn text(&self, key: &str) -> Result<Option<&'a str>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        match &node.value {
            Value::Text(text) if text.is_empty() => Err(self.bad(key, "the text is empty; give a name")),
            Value::Text(text) if text.contains('\0') => {
                Err(self.bad(key, "the text holds a zero byte; remove it"))
            }
            Value::Text(text) => Ok(Some(text)),
            _ => Err(self.bad(key, format!("expected a text in quotes, got {}", node.kind()))),
        }
    }

    /// Value of one of several words.
    pub(crate) fn word<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let names: Vec<&str> = words.iter().map(|(name, _)| *name).collect();
        let Value::Text(text) = &node.value else {
            return Err(self.bad(key, format!("expected one of {}, got {}", names.join(", "), node.kind())));
        };
        if let Some((_, value)) = words.iter().find(|(name, _)| name == text) {
            return Ok(Some(*value));
        }
        let near = nearest(text, &names).map_or_else(String::new, |near| format!(" (nearest: \"{near}\")"));
        Err(self.bad(key, format!("give one of {}{near}", names.join(", "))))
    }

    /// Vector of three numbers, each in a range.
    pub(crate) fn vector(&self, key: &str, range: Range) -> Result<Option<Vector3<f64>>, SceneError> {
        let Some(numbers) = self.numbers(key, range)? else { return Ok(None) };
        match numbers[..] {
            [x, y, z] => Ok(Some(Vector3::new(x, y, z))),
            _ => Err(self.bad(key, format!("expected three numbers [x, y, z], got {}", numbers.len()))),
        }
    }

    /// Vector of three numbers, each in a range, under a key that is required.
    pub(crate) fn need_vector(&self, key: &str, range: Range) -> Result<Vector3<f64>, SceneError> {
        let vector = self.vector(key, range)?;
        self.need(vector, key, &format!("give three numbers [x, y, z], each {range}"))
    }

    /// Array of numbers, each in a range.
    pub(crate) fn numbers(&self, key: &str, range: Range) -> Result<Option<Vec<f64>>, SceneError> {
        let Some(items) = self.items(key)? else { return Ok(None) };
        items
            .iter()
            .map(|item| match as_number(item) {
                Some(number) if range.contains(number) => Ok(number),
                Some(_) => {
                    Err(self.bad(key, format!("{} is out of range; give numbers {range}", item.shown())))
                }
                None => Err(self.bad(key, format!("{} is not a number; give numbers {range}", item.shown()))),
            })
            .collect::<Result<Vec<_>, _>>()
            .map(Some)
    }

    /// Items of an array.
    pub(crate) fn items(&self, key: &str) -> Result<Option<&'a [Node]>, SceneError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        match &node.value {
            Value::Array(items) => Ok(Some(items)),
            _ => Err(self.bad(key, format!("expected an array [ … ], got {}", node.kind()))),
        }
    }

    /// Table below a key.
    pub(crate) fn table(&self, key: &str, known: &[&str]) -> Result<Option<SceneTable<'a>>, SceneError> {
        self.get(key).map(|node| SceneTable::new(node, self.key(key), known)).transpose()
    }
}

fn as_number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Float(number) => Some(number),
        #[expect(clippy::cast_precision_loss, reason = "scenes hold no integers beyond 2^53")]
        Value::Integer(number) => Some(number as f64),
        _ => None,
    }
}
