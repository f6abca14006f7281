//! Files as text: a page in Markdown, and lines for the terminal.

use super::{Column, FILES, FileTable, find};
use std::fmt::Write as _;

/// Page `docs/files.md`.
#[must_use]
pub fn page() -> String {
    let mut page = String::from(include_str!("templates/head.md"));
    for (command, files) in FILES {
        let _ = writeln!(page, "\n## {command}\n\n| file | written | content |\n|---|---|---|");
        for file in *files {
            let name = if file.columns.is_empty() {
                format!("`{}`", file.path)
            } else {
                format!("[`{}`](#{})", file.path, anchor(file.path))
            };
            let when = if file.when.is_empty() { "always" } else { file.when };
            let _ = writeln!(page, "| {name} | {when} | {} |", file.meaning);
        }
        for file in files.iter().filter(|file| !file.columns.is_empty()) {
            table(&mut page, file);
        }
    }
    page.push_str(include_str!("templates/solver.md"));
    page
}

/// Headline and columns of a file.
fn table(page: &mut String, file: &FileTable) {
    let word = file.form.word();
    let _ =
        write!(page, "\n### {}\n\n| {word} | unit | there with | meaning |\n|---|---|---|---|\n", file.path);
    for column in file.columns {
        let names: Vec<String> = column.names.iter().map(|name| format!("`{name}`")).collect();
        let (names, when) = (names.join(", "), column.when.words());
        let _ = writeln!(page, "| {names} | {} | {when} | {} |", unit(column), column.meaning);
    }
}

fn unit(column: &Column) -> &'static str {
    if column.unit.is_empty() { "–" } else { column.unit }
}

/// Anchor that readers of Markdown make of a headline.
fn anchor(headline: &str) -> String {
    let kept = headline.to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || "-_ ".contains(*c)).collect::<String>().replace(' ', "-")
}

/// Text about the file at a path; `None` where the program writes no such file.
#[must_use]
pub fn section(path: &str) -> Option<String> {
    let file = find(path)?;
    let mut text = format!("{}\n  {}\n", file.path, file.meaning);
    if !file.when.is_empty() {
        let _ = writeln!(text, "  written: {}", file.when);
    }
    for column in file.columns {
        let _ =
            writeln!(text, "\n  {}  [{}]\n      {}", column.names.join(", "), unit(column), column.meaning);
    }
    Some(text)
}
