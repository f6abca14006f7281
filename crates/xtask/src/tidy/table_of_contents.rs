//! `lib.rs` is a table of contents: documentation, modules, re-exports.

use super::Problem;
use super::tree::Tree;

/// First words of items that belong into a module.
const ITEMS: [&str; 10] =
    ["fn", "struct", "enum", "union", "impl", "trait", "const", "static", "type", "macro_rules!"];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.rust_files().filter(|(path, _)| path.ends_with("/src/lib.rs")) {
        if !text.starts_with("//!") {
            let message = "lib.rs opens with the crate's documentation".to_owned();
            problems.push(Problem { path: path.to_owned(), line: 1, message });
        }
        for (line, code) in (1..).zip(text.lines()) {
            let mut words =
                code.split([' ', '<', '(']).skip_while(|word| *word == "pub" || *word == "unsafe");
            if let Some(item) = words.next().filter(|word| ITEMS.contains(word)) {
                let message =
                    format!("'{item}' in lib.rs; it holds documentation, modules and re-exports only");
                problems.push(Problem { path: path.to_owned(), line, message });
            }
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_in_lib_are_reported() {
        let text = "//! Some.\n\nmod a;\npub use a::A;\n\npub fn run() {}\nimpl<T> A<T> {}\n";
        let tree = Tree::made_up(&[("crates/core/src/lib.rs", text)]);
        assert_eq!(problems(&tree).iter().map(|problem| problem.line).collect::<Vec<_>>(), [6, 7]);
    }

    #[test]
    fn other_files_may_hold_items() {
        let tree = Tree::made_up(&[("crates/core/src/a.rs", "pub fn run() {}\n")]);
        assert_eq!(problems(&tree), []);
    }
}
