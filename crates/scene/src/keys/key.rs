//! Entry of the table of keys.

use super::Form;

/// Version of a key that names none.
const FIRST: &str = "0.1.0";

/// Key of a scene or a study.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name as it stands in the file.
    pub name: &'static str,
    /// Values that it takes.
    pub form: Form,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// Effect of leaving the key out.
    pub without: Without,
    /// Sentence about the key.
    pub meaning: &'static str,
    /// Value in TOML, for an example; empty for tables that are not written in one line.
    pub example: &'static str,
    /// Further names under which people look for it.
    pub also: &'static [&'static str],
    /// Version that has it first.
    pub since: &'static str,
}

/// Effect of leaving a key out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Without {
    /// The key must be there.
    Required,
    /// Value in TOML that has the same effect.
    Value(&'static str),
    /// Words for what holds.
    Words(&'static str),
}

impl Key {
    /// Key without a unit, an example and other names; nothing holds where it is absent.
    pub(super) const fn new(name: &'static str, form: Form, meaning: &'static str) -> Self {
        let without = Without::Words("none");
        Self { name, form, unit: "", without, meaning, example: "", also: &[], since: FIRST }
    }

    /// Adds the unit.
    pub(super) const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// Makes the key one that must be there.
    pub(super) const fn required(mut self) -> Self {
        self.without = Without::Required;
        self
    }

    /// Adds the value, in TOML, that holds where the key is absent.
    pub(super) const fn default(mut self, value: &'static str) -> Self {
        self.without = Without::Value(value);
        self
    }

    /// Says in words what holds where the key is absent.
    pub(super) const fn without(mut self, words: &'static str) -> Self {
        self.without = Without::Words(words);
        self
    }

    /// Adds a value, in TOML, as an example.
    pub(super) const fn example(mut self, value: &'static str) -> Self {
        self.example = value;
        self
    }

    /// Adds other names under which people look for the key.
    pub(super) const fn also(mut self, names: &'static [&'static str]) -> Self {
        self.also = names;
        self
    }

    /// Values in words, with their unit.
    #[must_use]
    pub fn values(&self) -> String {
        self.form.expected(self.unit)
    }

    /// Line of an example, `name = value`.
    #[must_use]
    pub fn line(&self) -> String {
        if self.example.is_empty() { String::new() } else { format!("{} = {}", self.name, self.example) }
    }
}
