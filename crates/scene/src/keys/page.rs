//! Keys as text: a page in Markdown, and lines for the terminal.

use super::{Key, SCENE, STUDY, Without, all, find};
use std::fmt::Write as _;

/// Head of a table of keys.
const HEAD: &str = "| key | value | without it | meaning | example |\n|---|---|---|---|---|\n";

/// Page `docs/scene.md`.
#[must_use]
pub fn page() -> String {
    let mut page = String::from(include_str!("page_head.md"));
    for section in SCENE {
        table(&mut page, section);
    }
    page.push_str(include_str!("page_studies.md"));
    let (sections, alone): (Vec<&Key>, Vec<&Key>) = STUDY.iter().partition(|key| key.form.is_list());
    page.push_str(HEAD);
    rows(&mut page, "", alone);
    for section in sections {
        table(&mut page, section);
    }
    page
}

/// Headline, meaning and keys of a section.
fn table(page: &mut String, section: &Key) {
    let [open, close] = if section.form.is_list() { ["[[", "]]"] } else { ["[", "]"] };
    let _ = write!(page, "\n## {open}{}{close}\n\n{}", section.name, section.meaning);
    let _ = write!(page, " Without it: {}.\n\n{HEAD}", without(section));
    rows(page, "", section.form.keys());
}

/// Rows of keys with what is below them; where several keys have the same keys below them, only the first
/// shows these.
fn rows<'a>(page: &mut String, before: &str, keys: impl IntoIterator<Item = &'a Key>) {
    let mut shown: &[Key] = &[];
    for key in keys {
        let path = format!("{before}{}", key.name);
        let cell = |text: &str| text.replace('|', "\\|");
        let example = if key.example.is_empty() { String::new() } else { format!("`{}`", cell(key.example)) };
        let (values, without) = (cell(&values(key)), cell(&without(key)));
        let _ = writeln!(page, "| `{path}` | {values} | {without} | {} | {example} |", cell(key.meaning));
        let below = key.form.keys();
        if !std::ptr::eq(below, shown) {
            rows(page, &format!("{path}."), below);
        }
        shown = if below.is_empty() { shown } else { below };
    }
}

/// Values of a key, short where they are a table's keys, which have lines of their own.
fn values(key: &Key) -> String {
    if key.form.keys().is_empty() { key.values() } else { key.form.outline(key.unit) }
}

fn without(key: &Key) -> String {
    match key.without {
        Without::Required => "must be there".to_owned(),
        Without::Value(value) => value.to_owned(),
        Without::Words(words) => words.to_owned(),
    }
}

/// Text about the key at a path and those below it, or about all keys for an empty path; `None` where there
/// is no such key.
#[must_use]
pub fn section(path: &str) -> Option<String> {
    let mut text = String::new();
    if path.is_empty() {
        for (path, key) in all() {
            let _ = writeln!(text, "{path:<44} {}", key.meaning);
        }
        return Some(text);
    }
    let key = find(path)?;
    let _ = writeln!(text, "{path}\n  {}\n  value:      {}", key.meaning, key.values());
    let _ = writeln!(text, "  without it: {}\n  since:      {}", without(key), key.since);
    if !key.example.is_empty() {
        let _ = writeln!(text, "  example:    {}", key.line());
    }
    for below in key.form.keys() {
        let _ = writeln!(text, "\n  {path}.{:<30} {}", below.name, below.meaning);
        let _ = writeln!(text, "      {}", values(below));
    }
    Some(text)
}
