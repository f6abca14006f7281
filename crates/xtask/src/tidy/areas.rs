//! Parts of the repository that may be left out of a rule while they are put in order.

use super::Problem;
use super::tree::Tree;

/// Problems outside the open areas, and one for each open area of the tree that has none any more.
pub(super) fn without_the_open(tree: &Tree, found: Vec<Problem>, open: &[&str], list: &str) -> Vec<Problem> {
    let is_open = |problem: &Problem| open.contains(&area(&problem.path));
    let in_order: Vec<Problem> = open
        .iter()
        .filter(|name| tree.files().any(|(path, _)| area(path) == **name))
        .filter(|name| !found.iter().any(|problem| area(&problem.path) == **name))
        .map(|name| Problem {
            path: (*name).to_owned(),
            line: 0,
            message: format!("in order; remove it from the list in {list}"),
        })
        .collect();
    found.into_iter().filter(|problem| !is_open(problem)).chain(in_order).collect()
}

/// Crate's folder, folder of documents, or any other folder below the root; the file itself where it stands
/// above.
fn area(path: &str) -> &str {
    let parts = if path.starts_with("crates/") || path.starts_with("docs/") { 2 } else { 1 };
    path.match_indices('/').nth(parts - 1).map_or(path, |(end, _)| &path[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(path: &str) -> Problem {
        Problem { path: path.to_owned(), line: 1, message: "too long".to_owned() }
    }

    #[test]
    fn open_areas_are_left_out_and_named_when_they_are_in_order() {
        let found = vec![problem("crates/dem/src/a.rs"), problem("docs/a.md"), problem("docs/b/c.md")];
        let tree = Tree::made_up(&[("cases/check.rs", ""), ("crates/dem/src/a.rs", ""), ("docs/b/c.md", "")]);
        let kept = without_the_open(&tree, found, &["crates/dem", "cases", "docs/b", "tests"], "a.rs");
        let paths: Vec<&str> = kept.iter().map(|problem| problem.path.as_str()).collect();
        assert_eq!(paths, ["docs/a.md", "cases"]);
    }
}
