//! Documents name only files and folders that are there.

use super::Problem;
use super::tree::Tree;

/// Folders of the root whose paths documents name in backticks.
const FOLDERS: [&str; 6] = ["cases/", "crates/", "docker/", "docs/", "openfoam-solver/", "tests/"];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.files().filter(|(path, _)| path.ends_with(".md") && !is_template(path)) {
        let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
        for (line, content) in (1..).zip(text.lines()) {
            let linked = links(content).map(|link| (link, resolved(folder, link)));
            let named = paths_in_backticks(content).map(|name| (name, name.to_owned()));
            for (name, place) in linked.chain(named) {
                if !tree.has(place.trim_end_matches('/')) {
                    let message = format!("'{name}' is not there; name the file that is meant");
                    problems.push(Problem { path: path.to_owned(), line, message });
                }
            }
        }
    }
    problems
}

/// Whether a document is a template, whose links hold in the folder of the page that is made from it.
fn is_template(path: &str) -> bool {
    path.contains("/templates/")
}

/// Targets of the line's links into this repository, without their anchors.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.split('#').next().unwrap_or_default())
        .filter(|target| !target.is_empty() && !target.contains("://"))
}

/// Whole paths in backticks; patterns and names with placeholders are no paths.
fn paths_in_backticks(line: &str) -> impl Iterator<Item = &str> {
    line.split('`')
        .skip(1)
        .step_by(2)
        .filter(|name| FOLDERS.iter().any(|folder| name.starts_with(folder)))
        .filter(|name| name.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c)))
}

/// Path from the root of a link in a document of this folder.
fn resolved(folder: &str, link: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in link.split('/') {
        match part {
            "." | "" => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(path: &str, text: &str) -> Vec<(usize, String)> {
        let tree = Tree::made_up(&[(path, text), ("crates/core/src/a.rs", ""), ("docs/b.md", "")]);
        problems(&tree).into_iter().map(|problem| (problem.line, problem.message)).collect()
    }

    #[test]
    fn what_is_not_there_is_found_with_its_line() {
        let found = messages("docs/a.md", "Good.\nSee [b](c.md) and `crates/core/src/b.rs`.\n");
        assert_eq!(
            found,
            [
                (2, "'c.md' is not there; name the file that is meant".to_owned()),
                (2, "'crates/core/src/b.rs' is not there; name the file that is meant".to_owned()),
            ]
        );
    }

    #[test]
    fn files_folders_anchors_and_addresses_are_good() {
        let text = "[b](b.md#part) [a](../crates/core) [c](https://example.org/c) [d](#d)\n\
                    `crates/core/src/a.rs` `crates/core/` `crates/*/src` `docs/<name>.md`\n";
        assert_eq!(messages("docs/a.md", text), []);
        assert_eq!(messages("README.md", "[b](docs/b.md)\n"), []);
    }
}
