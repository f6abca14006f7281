//! Typed access to the values of a table.

mod check;
mod lists;

use crate::SceneError;
use crate::error::{Problems, shorten};
use crate::keys::{Form, Key, Without, unknown_key};
use crate::tree::{Entries, Node, Place, Range, Value};
use nalgebra::Vector3;

pub use check::check_keys;
pub(crate) use lists::drop_empty_lists;

/// Table of the tree, with typed access to its values.
///
/// Values are checked by the table of keys. Reading functions return `None` when the key is absent.
#[derive(Clone, Debug)]
pub(crate) struct SceneTable<'a> {
    entries: &'a Entries,
    /// Keys that the table may have.
    keys: &'static [Key],
    /// Path of keys from the document to the table; empty for the document.
    path: String,
    place: Place,
}

impl<'a> SceneTable<'a> {
    /// Table of a whole document, whose keys must be known.
    pub(crate) fn document(
        entries: &'a Entries,
        place: Place,
        keys: &'static [Key],
    ) -> Result<Self, SceneError> {
        let table = Self { entries, keys, path: String::new(), place };
        table.refuse_unknown()?;
        Ok(table)
    }

    /// Table of a node that a key holds, or one of several; it must be a table with known keys only.
    pub(crate) fn new(node: &'a Node, path: impl Into<String>, key: &Key) -> Result<Self, SceneError> {
        let (path, keys) = (path.into(), key.form.keys());
        let Value::Table(entries) = &node.value else {
            return Err(SceneError::Value {
                place: node.place.to_string(),
                key: path,
                value: node.shown(),
                problem: format!("expected {}, got {}", Form::Table(keys).expected(""), node.kind()),
            });
        };
        let table = Self { entries, keys, path, place: node.place.clone() };
        table.refuse_unknown()?;
        Ok(table)
    }

    fn refuse_unknown(&self) -> Result<(), SceneError> {
        let mut problems = Problems::default();
        for (name, node) in self.entries {
            if !self.keys.iter().any(|key| key.name == name) {
                problems.keep::<()>(Err(SceneError::UnknownKey {
                    place: node.place.to_string(),
                    key: self.key(&shorten(name)),
                    advice: unknown_key(name, &self.path, self.keys, node),
                }));
            }
        }
        problems.finish()
    }

    /// Entry of a name in the table of keys.
    ///
    /// # Panics
    /// If a reader asks for a key that is not in the table, which a run of its section shows.
    pub(crate) fn entry(&self, name: &str) -> &'static Key {
        let entry = self.keys.iter().find(|key| key.name == name);
        entry.unwrap_or_else(|| panic!("{} is not in the table of keys", self.key(name)))
    }

    /// Checks that a key's value is one that the key takes, and that it is there if it must be.
    pub(crate) fn check(&self, name: &str) -> Result<(), SceneError> {
        let found = self.checked(name)?;
        if self.entry(name).without == Without::Required {
            self.required(found, name).map(drop)
        } else {
            Ok(())
        }
    }

    /// Node of a key whose value is one that the key takes.
    fn checked(&self, name: &str) -> Result<Option<&'a Node>, SceneError> {
        let entry = self.entry(name);
        let Some(node) = self.get(name) else { return Ok(None) };
        let problem = match entry.form.is_list() {
            true => self.refuse_as_list(name, node),
            false => entry.form.refuse(entry, node),
        };
        match problem {
            None => Ok(Some(node)),
            Some(problem) => Err(self.bad(name, problem)),
        }
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

    /// Names of the keys that the table may have.
    pub(crate) fn known(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
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

    /// Unwraps a value of a key that is required.
    fn required<T>(&self, value: Option<T>, name: &str) -> Result<T, SceneError> {
        let entry = self.entry(name);
        let example = if entry.example.is_empty() { String::new() } else { format!(", as {}", entry.line()) };
        value.ok_or_else(|| self.missing(name, format!("give {}{example}", entry.values())))
    }

    /// Number in the key's range.
    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>, SceneError> {
        Ok(self.checked(name)?.and_then(Node::number))
    }

    /// Number in a range that is narrower than the key's.
    pub(crate) fn number_in(&self, name: &str, range: Range) -> Result<Option<f64>, SceneError> {
        match self.number(name)? {
            Some(number) if !range.contains(number) => {
                Err(self.bad(name, format!("out of range; give a number {range}")))
            }
            number => Ok(number),
        }
    }

    /// Number in the key's range, under a key that is required.
    pub(crate) fn need_number(&self, name: &str) -> Result<f64, SceneError> {
        let number = self.number(name)?;
        self.required(number, name)
    }

    /// Number in the key's range, or the word `auto` (`Some(None)`).
    pub(crate) fn number_or_auto(&self, name: &str) -> Result<Option<Option<f64>>, SceneError> {
        Ok(self.checked(name)?.map(Node::number))
    }

    /// Whole number in the key's range.
    pub(crate) fn integer(&self, name: &str) -> Result<Option<i64>, SceneError> {
        Ok(self.checked(name)?.and_then(|node| match node.value {
            Value::Integer(number) => Some(number),
            _ => None,
        }))
    }

    /// Three whole numbers in the key's range; other values are none.
    pub(crate) fn integers(&self, name: &str) -> Result<Option<[i64; 3]>, SceneError> {
        let Some(Node { value: Value::Array(items), .. }) = self.checked(name)? else { return Ok(None) };
        let whole = |item: &Node| if let Value::Integer(number) = item.value { Some(number) } else { None };
        let numbers: Vec<i64> = items.iter().filter_map(whole).collect();
        Ok(numbers.try_into().ok())
    }

    /// Boolean.
    pub(crate) fn boolean(&self, name: &str) -> Result<Option<bool>, SceneError> {
        Ok(self.checked(name)?.and_then(|node| match node.value {
            Value::Boolean(flag) => Some(flag),
            _ => None,
        }))
    }

    /// Text that is not empty.
    pub(crate) fn text(&self, name: &str) -> Result<Option<&'a str>, SceneError> {
        Ok(self.checked(name)?.and_then(|node| match &node.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        }))
    }

    /// Value of one of the key's words; other values are none.
    pub(crate) fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> Result<Option<T>, SceneError> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        let value = words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
        Ok(Some(value.unwrap_or_else(|| panic!("{} takes {text} but nobody reads it", self.key(name)))))
    }

    /// Vector of three numbers, each in the key's range; other values are none.
    pub(crate) fn vector(&self, name: &str) -> Result<Option<Vector3<f64>>, SceneError> {
        Ok(self.numbers(name)?.map(|numbers| Vector3::from_column_slice(&numbers)))
    }

    /// Vector of three numbers, under a key that is required.
    pub(crate) fn need_vector(&self, name: &str) -> Result<Vector3<f64>, SceneError> {
        let vector = self.vector(name)?;
        self.required(vector, name)
    }

    /// Array of numbers, each in the key's range; other values are none.
    pub(crate) fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, SceneError> {
        Ok(self.checked(name)?.and_then(|node| match &node.value {
            Value::Array(items) => Some(items.iter().filter_map(Node::number).collect()),
            _ => None,
        }))
    }

    /// Pairs of numbers, each in its range; other values are none.
    pub(crate) fn pairs(&self, name: &str) -> Result<Option<Vec<[f64; 2]>>, SceneError> {
        let Some(Node { value: Value::Array(items), .. }) = self.checked(name)? else { return Ok(None) };
        let pair = |item: &Node| match &item.value {
            Value::Array(pair) => {
                let numbers: Vec<f64> = pair.iter().filter_map(Node::number).collect();
                <[f64; 2]>::try_from(numbers).ok()
            }
            _ => None,
        };
        Ok(Some(items.iter().filter_map(pair).collect()))
    }

    /// Array of numbers under a key that is required.
    pub(crate) fn need_numbers(&self, name: &str) -> Result<Vec<f64>, SceneError> {
        let numbers = self.numbers(name)?;
        self.required(numbers, name)
    }

    /// Words of a list.
    pub(crate) fn words(&self, name: &str) -> Result<Option<Vec<&'a str>>, SceneError> {
        Ok(self.checked(name)?.and_then(|node| match &node.value {
            Value::Array(items) => Some(
                items
                    .iter()
                    .filter_map(
                        |item| if let Value::Text(word) = &item.value { Some(word.as_str()) } else { None },
                    )
                    .collect(),
            ),
            _ => None,
        }))
    }

    /// Table below a key; other values are none.
    pub(crate) fn table(&self, name: &str) -> Result<Option<SceneTable<'a>>, SceneError> {
        match self.checked(name)? {
            Some(node)
                if matches!(node.value, Value::Table(_)) && !self.entry(name).form.keys().is_empty() =>
            {
                SceneTable::new(node, self.key(name), self.entry(name)).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Tables of a list, each of which may be refused.
    pub(crate) fn tables(
        &self,
        name: &str,
    ) -> Result<Option<impl Iterator<Item = Result<SceneTable<'a>, SceneError>> + use<'a>>, SceneError> {
        let (path, entry) = (self.key(name), self.entry(name));
        Ok(self.checked(name)?.and_then(|node| match &node.value {
            Value::Array(items) if entry.form.is_list() => Some(
                items
                    .iter()
                    .enumerate()
                    .map(move |(index, node)| SceneTable::new(node, format!("{path}[{index}]"), entry)),
            ),
            _ => None,
        }))
    }
}
