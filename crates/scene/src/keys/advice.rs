//! Advice for keys and words that no scene has: what was meant, by its sense and by its spelling.

use super::{Form, Key, all};
use crate::tree::{Node, Value, nearest};

/// Units that people append to names of keys, beside those that keys have.
const UNITS: [&str; 18] = [
    "_m", "_mm", "_um", "_cm", "_nm", "_s", "_ms", "_us", "_C", "_nC", "_pC", "_e", "_V", "_kV", "_Pa",
    "_MPa", "_GPa", "_J",
];
/// Words of other programs and of everyday speech, and the ones that stand for them here.
const WORDS: [(&str, &str); 18] = [
    ("conducting", "grounded"),
    ("conductor", "grounded"),
    ("earthed", "grounded"),
    ("ground", "grounded"),
    ("metal", "grounded"),
    ("dirichlet", "grounded"),
    ("insulator", "insulating"),
    ("isolating", "insulating"),
    ("dielectric", "insulating"),
    ("neumann", "insulating"),
    ("symmetry", "insulating"),
    ("zerogradient", "insulating"),
    ("cyclic", "periodic"),
    ("free", "open"),
    ("vtu", "vtk"),
    ("paraview", "vtk"),
    ("remove", "delete"),
    ("exact", "direct"),
];
/// Share of a name's letters that may be wrong in a misspelling of it.
const MISSPELT: f64 = 0.4;

/// Advice for a key that a table does not have.
///
/// `path` is the table's, empty for the document; `value` is what the key was given.
pub(crate) fn unknown_key(name: &str, path: &str, keys: &'static [Key], value: &Node) -> String {
    let full = |known: &str| if path.is_empty() { known.to_owned() } else { format!("{path}.{known}") };
    if let Some(key) = keys.iter().find(|key| means(key, name)) {
        return format!("; {} is {}", full(key.name), told(key, name));
    }
    let names: Vec<&'static str> = keys.iter().map(|key| key.name).collect();
    if let Some(near) = nearest(name, &names)
        && is_misspelling(name, near)
    {
        return format!("; the nearest known key is {}", full(near));
    }
    // A table of this name is no answer to a value that is none.
    let is_table = matches!(value.value, Value::Table(_));
    let fits = |key: &Key| is_table || key.form.keys().is_empty();
    // Of several, the one that is not deep inside of a list is meant.
    let depth = |(path, _): &(String, &Key)| path.matches('.').count();
    let named = all().filter(|(_, key)| key.name == name && fits(key)).min_by_key(depth);
    let meant = || all().find(|(_, key)| means(key, name) && fits(key));
    if let Some((path, key)) = named.or_else(meant) {
        return format!("; {path} is {}", told(key, name));
    }
    format!("; the keys here are {}", names.join(", "))
}

/// Advice for a word that a key does not take.
pub(crate) fn unknown_word(word: &str, words: &'static [&'static str], key: &Key) -> String {
    let lower = word.to_lowercase();
    let stands_for = WORDS.iter().find(|(other, here)| *other == lower && words.contains(here));
    if let Some((_, here)) = stands_for {
        return format!("the word for this is \"{here}\"; give {}", Form::Word(words).expected(""));
    }
    if let Some(below) = key.form.keys().iter().find(|below| means(below, word)) {
        return format!("write {} = {{ {} }}, {}", key.name, below.line(), told(below, word));
    }
    let near = match nearest(word, words) {
        Some(near) if is_misspelling(word, near) => format!(" (nearest: \"{near}\")"),
        _ => String::new(),
    };
    format!("give {}{near}", key.values())
}

/// Advice for a path that no key of a scene has.
#[must_use]
pub fn advice(path: &str) -> String {
    let name = path.rsplit(['.', ']']).next().unwrap_or(path);
    let found: Vec<String> = all()
        .filter(|(_, key)| key.name == name || means(key, name))
        .map(|(path, key)| format!("{path}, {}", told(key, name)))
        .collect();
    if !found.is_empty() {
        return format!("no key {path}; there is {}", found.join("; and "));
    }
    let paths: Vec<String> = all().map(|(path, _)| path).collect();
    let names: Vec<&str> = paths.iter().map(String::as_str).collect();
    let near = nearest(path, &names).map_or_else(String::new, |near| format!("; the nearest is {near}"));
    format!("no key {path}{near}; `amberfield keys` lists all")
}

/// Tells whether people look for a key under a name.
fn means(key: &Key, name: &str) -> bool {
    let names = || std::iter::once(&key.name).chain(key.also);
    names().any(|known| plain(known) == plain(name) || plain(bare(known)) == plain(bare(name)))
}

/// Name in small letters, without what separates words.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Name without its unit.
fn bare(name: &str) -> &str {
    UNITS.iter().filter_map(|unit| name.strip_suffix(unit)).min_by_key(|rest| rest.len()).unwrap_or(name)
}

/// Meaning of a key with its unit, an example, and what an input under another name must be turned into.
fn told(key: &Key, name: &str) -> String {
    let meaning = key.meaning.trim_end_matches('.');
    let mut first = meaning.chars();
    let meaning: String = first.next().into_iter().flat_map(char::to_lowercase).chain(first).collect();
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    let line = key.line();
    let example = if line.is_empty() { String::new() } else { format!("; write {line}") };
    format!("the {meaning}{unit}{}{example}", conversion(key, name))
}

/// Conversion from the quantity that a name stands for, in words; empty where there is none.
fn conversion(key: &Key, name: &str) -> &'static str {
    let name = name.to_lowercase();
    if key.name == "radius_m" && (name.starts_with('d')) {
        ", half the diameter"
    } else if key.name.ends_with("_eV") && name.ends_with("_j") {
        " (1 eV is 1.602e-19 J)"
    } else if key.name == "viscosity_Pa_s" && (name.ends_with("m2_s") || name == "nu") {
        ", the kinematic viscosity times the density"
    } else {
        ""
    }
}

/// Tells whether a name may be a misspelling of a known one.
fn is_misspelling(name: &str, known: &str) -> bool {
    let distance = strsim::damerau_levenshtein(&name.to_lowercase(), &known.to_lowercase());
    #[expect(clippy::cast_precision_loss, reason = "names are short")]
    let share = distance as f64 / known.chars().count().max(1) as f64;
    share <= MISSPELT
}
