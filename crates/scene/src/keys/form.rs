//! Values that a key takes.

use super::{Key, unknown_word};
use crate::tree::{Node, Range, Value};

/// Values that a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Number in a range.
    Number(Range),
    /// Whole number from the first to the second, both included.
    Whole(i64, i64),
    /// `true` or `false`.
    Boolean,
    /// Text in quotes.
    Text,
    /// One of several words, in quotes.
    Word(&'static [&'static str]),
    /// List of words.
    Words(&'static [&'static str]),
    /// Three numbers, each in a range.
    Vector(Range),
    /// Numbers, each in a range.
    Numbers(Range),
    /// Pairs of numbers, each in its range.
    Pairs(Range, Range),
    /// Three whole numbers, each from the first to the second.
    Wholes(i64, i64),
    /// List of texts.
    Texts,
    /// Value that another reader checks.
    Anything,
    /// Table with keys.
    Table(&'static [Key]),
    /// Several tables with the same keys.
    Tables(&'static [Key]),
    /// Value of one of several forms, which differ in kind.
    Either(&'static [Form]),
}

impl Form {
    /// Keys of a table; none for other values.
    #[must_use]
    pub fn keys(&self) -> &'static [Key] {
        match self {
            Self::Table(keys) | Self::Tables(keys) => keys,
            Self::Either(forms) => {
                forms.iter().map(Self::keys).find(|keys| !keys.is_empty()).unwrap_or_default()
            }
            _ => &[],
        }
    }

    /// Tells whether the value is a list of tables.
    #[must_use]
    pub fn is_list(&self) -> bool {
        matches!(self, Self::Tables(_))
    }

    /// Description of the values that are taken, for messages; numbers have a unit, which may be empty.
    #[must_use]
    pub fn expected(&self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Self::Number(range) => format!("a number {range}{unit}"),
            Self::Whole(least, most) if *most == i64::MAX => format!("a whole number from {least}"),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Boolean => "true or false".to_owned(),
            Self::Text => "a text in quotes".to_owned(),
            Self::Word([word]) => quoted(&[word]),
            Self::Word(words) => format!("one of {}", quoted(words)),
            Self::Words(words) => format!("a list of some of {}", quoted(words)),
            Self::Vector(range) => format!("three numbers [x, y, z], each {range}{unit}"),
            Self::Numbers(range) => format!("an array of numbers, each {range}{unit}"),
            Self::Pairs(first, second) => {
                format!("an array of pairs [a, b], a {first}{unit}, b {second}")
            }
            Self::Wholes(least, most) => format!("three whole numbers, each from {least} to {most}"),
            Self::Texts => "a list of texts in quotes".to_owned(),
            Self::Anything => "a value".to_owned(),
            Self::Table(keys) => {
                let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
                format!("a table {{ {} }}", names.join(", "))
            }
            Self::Tables(_) => "tables, each under [[…]]".to_owned(),
            Self::Either(forms) => {
                let forms: Vec<String> = forms.iter().map(|form| form.expected(unit.trim_start())).collect();
                forms.join(", or ")
            }
        }
    }

    /// Description of the values in which a table is called that, and its keys are not named.
    pub(super) fn outline(&self, unit: &str) -> String {
        match self {
            Self::Table(_) => "a table".to_owned(),
            Self::Either(forms) => {
                forms.iter().map(|form| form.outline(unit)).collect::<Vec<_>>().join(", or ")
            }
            other => other.expected(unit),
        }
    }

    /// Reason why a value is not taken, and what to write; `None` if it is taken. What is inside tables is
    /// not looked at.
    pub(crate) fn refuse(&self, key: &Key, node: &Node) -> Option<String> {
        let other_kind = || {
            let example =
                if key.example.is_empty() { String::new() } else { format!(", as {}", key.example) };
            Some(format!("expected {}, got {}; write it{example}", key.values(), node.kind()))
        };
        match (self, &node.value) {
            (Self::Number(range), Value::Float(_) | Value::Integer(_)) => {
                refuse_number(*range, key.unit, node)
            }
            (Self::Whole(least, most), Value::Integer(number)) => {
                let taken = (least..=most).contains(&number);
                (!taken).then(|| format!("out of range; give {}", self.expected("")))
            }
            (Self::Anything, _)
            | (Self::Boolean, Value::Boolean(_))
            | (Self::Table(_), Value::Table(_))
            | (Self::Tables(_), Value::Array(_)) => None,
            (Self::Text, Value::Text(text)) => refuse_text(text),
            (Self::Word(words), Value::Text(text)) => {
                (!words.contains(&text.as_str())).then(|| unknown_word(text, words, key))
            }
            (Self::Words(words), Value::Array(items)) => items.iter().find_map(|item| match &item.value {
                Value::Text(text) if words.contains(&text.as_str()) => None,
                Value::Text(text) => Some(unknown_word(text, words, key)),
                _ => Some(format!("{} is no word; give {}", item.shown(), self.expected(""))),
            }),
            (Self::Texts, Value::Array(items)) => items.iter().find_map(|item| match &item.value {
                Value::Text(text) => refuse_text(text),
                _ => Some(format!("{} is no text; give {}", item.shown(), self.expected(""))),
            }),
            (Self::Vector(_), Value::Array(items)) if items.len() != 3 => {
                Some(format!("expected three numbers [x, y, z], got {}", items.len()))
            }
            (Self::Vector(range) | Self::Numbers(range), Value::Array(items)) => {
                items.iter().find_map(|item| match item.value {
                    Value::Float(_) | Value::Integer(_) => refuse_number(*range, key.unit, item)
                        .map(|problem| format!("{} is {problem}", item.shown())),
                    _ => Some(format!("{} is not a number; give {}", item.shown(), self.expected(key.unit))),
                })
            }
            (Self::Pairs(first, second), Value::Array(items)) => refuse_pairs(*first, *second, key, items),
            (Self::Wholes(least, most), Value::Array(items)) => {
                let taken =
                    |item: &Node| matches!(item.value, Value::Integer(n) if (*least..=*most).contains(&n));
                let good = items.len() == 3 && items.iter().all(taken);
                (!good).then(|| format!("give {}", self.expected("")))
            }
            (Self::Either(forms), _) => match forms.iter().find(|form| form.is_of_kind(node)) {
                Some(form) => form.refuse(key, node),
                None => other_kind(),
            },
            _ => other_kind(),
        }
    }

    /// Tells whether a value is of the form's kind, though perhaps out of its range.
    fn is_of_kind(&self, node: &Node) -> bool {
        match self {
            Self::Number(_) => matches!(node.value, Value::Float(_) | Value::Integer(_)),
            Self::Whole(..) => matches!(node.value, Value::Integer(_)),
            Self::Boolean => matches!(node.value, Value::Boolean(_)),
            Self::Text | Self::Word(_) => matches!(node.value, Value::Text(_)),
            Self::Anything => true,
            Self::Words(_)
            | Self::Texts
            | Self::Vector(_)
            | Self::Numbers(_)
            | Self::Pairs(..)
            | Self::Wholes(..)
            | Self::Tables(_) => {
                matches!(node.value, Value::Array(_))
            }
            Self::Table(_) => matches!(node.value, Value::Table(_)),
            Self::Either(forms) => forms.iter().any(|form| form.is_of_kind(node)),
        }
    }
}

/// Words in quotes, separated by commas.
fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}

fn refuse_number(range: Range, unit: &str, node: &Node) -> Option<String> {
    let number = node.number()?;
    if range.contains(number) {
        return None;
    }
    let problem = if number.is_finite() { "out of range" } else { "not finite" };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    Some(format!("{problem}; give a number {range}{unit}"))
}

fn refuse_pairs(first: Range, second: Range, key: &Key, items: &[Node]) -> Option<String> {
    if items.is_empty() {
        return Some(format!("there is no pair; give {}", key.values()));
    }
    items.iter().find_map(|item| {
        let numbers = match &item.value {
            Value::Array(pair) => pair.iter().filter_map(Node::number).collect(),
            _ => Vec::new(),
        };
        let is_good =
            matches!(numbers[..], [a, b] if first.contains(a) && second.contains(b)) && is_pair(&item.value);
        (!is_good).then(|| format!("{} is none of them; give {}", item.shown(), key.values()))
    })
}

/// Tells whether a value is an array of two.
fn is_pair(value: &Value) -> bool {
    matches!(value, Value::Array(items) if items.len() == 2)
}

fn refuse_text(text: &str) -> Option<String> {
    if text.is_empty() {
        Some("the text is empty; give a name".to_owned())
    } else if text.contains('\0') {
        Some("the text holds a zero byte; remove it".to_owned())
    } else {
        None
    }
}
