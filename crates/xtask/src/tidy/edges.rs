//! Edges between crates, of which the table allows some, and what every manifest says.

use super::Problem;
use super::tree::Tree;

/// Crate folder and the crates it may link. A new edge is a change of its own with a line in ARCHITECTURE.md.
const ALLOWED: [(&str, &[&str]); 15] = [
    ("core", &[]),
    ("laws", &["core"]),
    ("field", &["core", "laws"]),
    ("gas", &["core", "laws", "field"]),
    ("dem", &["core", "laws", "field", "gas"]),
    ("wire", &["core"]),
    ("coupling", &["core", "field", "gas", "wire"]),
    ("capi", &["core", "laws", "field", "wire", "coupling"]),
    ("oracle", &["core"]),
    ("scene", &["core"]),
    ("draw", &["core"]),
    ("study", &["core", "coupling", "dem", "field", "gas", "oracle", "scene", "draw"]),
    ("cli", &["core", "laws", "field", "gas", "dem", "coupling", "oracle", "scene", "draw", "study"]),
    ("python", &["core", "field", "dem", "scene", "cli"]),
    ("xtask", &[]),
];

/// Crate of exact solutions, which tests may use on top. The oracle itself gets nothing, it judges the
/// others.
const ALLOWED_IN_TESTS: &str = "oracle";

const PREFIX: &str = "amberfield-";

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.files() {
        let folder = path.strip_prefix("crates/").and_then(|rest| rest.strip_suffix("/Cargo.toml"));
        let Some(folder) = folder else { continue };
        let mut report = |line, message| problems.push(Problem { path: path.to_owned(), line, message });
        if !text.lines().any(|line| line.starts_with("description = \"")) {
            report(0, "no description; say in one sentence what this crate alone may do".to_owned());
        }
        let Some((_, allowed)) = ALLOWED.iter().find(|(name, _)| *name == folder) else {
            let message = format!(
                "crate '{folder}' is not in the table of allowed edges; \
                 add it there and to ARCHITECTURE.md"
            );
            report(0, message);
            continue;
        };
        for edge in edges(text) {
            let in_tests = edge.in_tests && edge.to == ALLOWED_IN_TESTS && folder != ALLOWED_IN_TESTS;
            if !allowed.contains(&edge.to) && !in_tests {
                report(
                    edge.line,
                    format!("'{folder}' may not use '{}'; allowed: {}", edge.to, allowed.join(", ")),
                );
            }
        }
    }
    problems
}

struct Edge<'a> {
    to: &'a str,
    line: usize,
    in_tests: bool,
}

/// Dependencies on crates of this repository, in tables of any kind.
fn edges(manifest: &str) -> Vec<Edge<'_>> {
    let mut edges = Vec::new();
    let mut table = "";
    for (line, text) in (1..).zip(manifest.lines().map(str::trim)) {
        if let Some(header) = text.strip_prefix('[') {
            table = header.trim_end_matches(']');
        }
        let key = if text.starts_with('[') { table.rsplit('.').next().unwrap_or_default() } else { text };
        if !table.contains("dependencies") {
            continue;
        }
        if let Some(rest) = key.trim_matches('"').strip_prefix(PREFIX) {
            let end =
                rest.find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_')).unwrap_or(rest.len());
            edges.push(Edge { to: &rest[..end], line, in_tests: table.contains("dev-dependencies") });
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(path: &str, manifest: &str) -> Vec<(usize, String)> {
        let manifest = format!("description = \"Some.\"\n{manifest}");
        let tree = Tree::made_up(&[(path, &manifest)]);
        problems(&tree).into_iter().map(|problem| (problem.line, problem.message)).collect()
    }

    #[test]
    fn forbidden_edge_is_found_with_its_line() {
        let found = messages(
            "crates/laws/Cargo.toml",
            "[dependencies]\namberfield-core.workspace = true\namberfield-field = { path = \"../field\" }\n",
        );
        assert_eq!(found, [(4, "'laws' may not use 'field'; allowed: core".to_owned())]);
    }

    #[test]
    fn edges_in_own_tables_and_targets_are_found() {
        let found = messages(
            "crates/oracle/Cargo.toml",
            "[dependencies.amberfield-laws]\nworkspace = true\n\
             [target.'cfg(unix)'.dependencies]\namberfield-dem.workspace = true\n",
        );
        assert_eq!(found.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [2, 5]);
    }

    #[test]
    fn tests_may_use_the_oracle_but_the_oracle_nothing_more() {
        assert_eq!(
            messages("crates/dem/Cargo.toml", "[dev-dependencies]\namberfield-oracle.workspace = true\n"),
            []
        );
        let found =
            messages("crates/oracle/Cargo.toml", "[dev-dependencies]\namberfield-field.workspace = true\n");
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn unknown_crates_and_missing_descriptions_are_reported() {
        let tree = Tree::made_up(&[("crates/extra/Cargo.toml", "[package]\n")]);
        assert_eq!(problems(&tree).len(), 2);
    }

    #[test]
    fn other_words_with_the_prefix_are_not_edges() {
        assert_eq!(
            messages("crates/core/Cargo.toml", "name = \"amberfield-core\"\n[features]\namberfield-x = []\n"),
            []
        );
    }
}
