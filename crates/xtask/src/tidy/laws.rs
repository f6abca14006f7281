//! A law's file opens with its equation.

use super::Problem;
use super::tree::Tree;

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    tree.rust_files()
        .filter(|(path, _)| path.starts_with("crates/laws/src/") && !path.ends_with("/lib.rs"))
        .filter(|(_, text)| !opens_with_an_equation(text))
        .map(|(path, _)| Problem {
            path: path.to_owned(),
            line: 1,
            message:
                "a law opens with its equation: put it into the first three lines of the file's documentation"
                    .to_owned(),
        })
        .collect()
}

/// Lines of documentation within which the equation stands.
const OPENING_LINES: usize = 3;

/// Whether the first lines of the file's documentation hold a relation.
fn opens_with_an_equation(text: &str) -> bool {
    text.lines()
        .map_while(|line| line.strip_prefix("//!"))
        .take(OPENING_LINES)
        .any(|line| line.contains(['=', '≤', '<']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_first_is_reported_once() {
        let tree = Tree::made_up(&[
            ("crates/laws/src/lib.rs", "//! Laws.\n"),
            ("crates/laws/src/good.rs", "//! Spring:\n//! F = −k x.\n"),
            ("crates/laws/src/late.rs", "//! A spring.\n//!\n//! It pulls.\n//! F = −k x.\n"),
            ("crates/laws/src/silent.rs", "fn force() {}\n"),
        ]);
        let found: Vec<String> = problems(&tree).into_iter().map(|problem| problem.path).collect();
        assert_eq!(found, ["crates/laws/src/late.rs", "crates/laws/src/silent.rs"]);
    }
}
