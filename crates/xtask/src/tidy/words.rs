//! Words that must not appear.

use super::Problem;
use super::source::{is_test_file, lines_without_tests};
use super::tree::Tree;

/// File that lists the words and is therefore not searched.
const THIS_FILE: &str = "crates/xtask/src/tidy/words.rs";

/// Notes to oneself: nowhere.
const NOTES: [&str; 4] = ["TODO", "FIXME", "XXX", "HACK"];
/// Folders of one machine: nowhere.
const MACHINE_PATHS: [&str; 5] = ["/work/", "/root/", "/home/", "/tmp/", "/Users/"];
/// Panics without a reason: not outside tests.
const PANICS: [(&str, &str); 3] = [
    (".unwrap()", "return an error, or expect(\"why impossible\")"),
    ("todo!(", "finish it or leave it out"),
    ("#[allow(", "use #[expect(lint, reason = \"…\")]"),
];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.files().filter(|(path, _)| *path != THIS_FILE) {
        for (line, code) in (1..).zip(text.lines()) {
            let mut report = |message| problems.push(Problem { path: path.to_owned(), line, message });
            for note in NOTES.iter().filter(|note| has_word(code, note)) {
                report(format!("'{note}': finish it, or open an issue"));
            }
            for place in MACHINE_PATHS.iter().filter(|place| code.contains(*place)) {
                report(format!("'{place}' exists on one machine only"));
            }
        }
        if path.ends_with(".rs") {
            problems.extend(panics(path, text));
        }
    }
    problems
}

/// Panics outside tests and documentation.
fn panics(path: &str, text: &str) -> Vec<Problem> {
    if is_test_file(path) {
        return Vec::new();
    }
    let mut problems = Vec::new();
    let code = lines_without_tests(text).into_iter();
    for (line, code) in code.filter(|(_, line)| !line.trim_start().starts_with("//")) {
        for (word, advice) in PANICS.iter().filter(|(word, _)| code.contains(word)) {
            problems.push(Problem {
                path: path.to_owned(),
                line,
                message: format!("'{word}' outside tests; {advice}"),
            });
        }
    }
    problems
}

/// Whether the word stands alone, not inside a longer one.
fn has_word(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(start, _)| {
        let joins = |c: char| c.is_alphanumeric() || c == '_';
        let before = text[..start].chars().next_back();
        let after = text[start + word.len()..].chars().next();
        !before.is_some_and(joins) && !after.is_some_and(joins)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        problems(&Tree::made_up(&[(path, text)])).into_iter().map(|problem| problem.line).collect()
    }

    #[test]
    fn notes_and_machine_paths_are_found_in_any_file() {
        assert_eq!(lines("README.md", "Good.\nTODO: write\nsee /home/me/file\n"), [2, 3]);
        assert_eq!(lines("README.md", "MASTODON and aXXXb\n"), []);
    }

    #[test]
    fn unwrap_is_for_tests() {
        let text =
            "fn a() {\n    b().unwrap();\n}\n\n#[cfg(test)]\nmod tests {\n    fn c() { b().unwrap(); }\n}\n";
        assert_eq!(lines("crates/core/src/a.rs", text), [2]);
        assert_eq!(lines("crates/core/tests/a.rs", text), []);
    }

    #[test]
    fn examples_in_documentation_may_unwrap() {
        assert_eq!(lines("crates/core/src/a.rs", "/// a().unwrap();\nfn a() {}\n"), []);
    }

    #[test]
    fn allow_is_replaced_by_expect() {
        assert_eq!(lines("crates/core/src/a.rs", "#[allow(dead_code)]\nfn a() {}\n"), [1]);
    }
}
