//! The rules of this repository that no other tool knows.

mod circles;
mod dependencies;
mod docs;
mod edges;
mod laws;
mod length;
mod links;
mod source;
mod sum;
mod table_of_contents;
mod tree;
mod width;
mod words;

use anyhow::{Result, bail};
use std::path::Path;
use tree::Tree;

/// Something that breaks a rule.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Problem {
    path: String,
    /// Line from 1; 0 for the whole file.
    line: usize,
    message: String,
}

/// Reads the repository and fails when a rule is broken.
pub(crate) fn run(root: &Path) -> Result<()> {
    let tree = Tree::read(root)?;
    let problems = all_problems(&tree);
    for problem in &problems {
        match problem.line {
            0 => println!("{}: {}", problem.path, problem.message),
            line => println!("{}:{line}: {}", problem.path, problem.message),
        }
    }
    if problems.is_empty() {
        println!("tidy: {} files, nothing to say", tree.len());
        return Ok(());
    }
    bail!("tidy: {} problems", problems.len())
}

fn all_problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = [
        circles::problems(tree),
        dependencies::problems(tree),
        docs::problems(tree),
        edges::problems(tree),
        laws::problems(tree),
        length::problems(tree),
        links::problems(tree),
        sum::problems(tree),
        table_of_contents::problems(tree),
        width::problems(tree),
        words::problems(tree),
    ]
    .concat();
    problems.sort();
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

    #[test]
    fn a_small_clean_tree_has_no_problems() {
        let tree = Tree::made_up(&[
            (
                "crates/laws/Cargo.toml",
                "[package]\ndescription = \"Laws.\"\n[dependencies]\namberfield-core.workspace = true\n",
            ),
            ("crates/laws/src/lib.rs", "//! Laws.\n\npub mod hooke;\n"),
            ("crates/laws/src/hooke.rs", "//! Spring: F = −k x.\n\npub fn force() {}\n"),
        ]);
        let mut problems = all_problems(&tree);
        problems.retain(|problem| !problem.message.starts_with("in order"));
        assert_eq!(problems, []);
    }

    #[test]
    fn this_repository_can_be_read() {
        let tree = Tree::read(Path::new(ROOT)).unwrap();
        assert!(tree.text("crates/xtask/src/tidy/mod.rs").is_some());
        assert!(tree.files().all(|(path, _)| !path.starts_with("target/") && !path.starts_with(".git/")));
    }
}
