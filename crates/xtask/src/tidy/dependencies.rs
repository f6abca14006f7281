//! The workspace names no library that no crate uses.

use super::Problem;
use super::tree::Tree;

const ROOT: &str = "Cargo.toml";
const COMMON: &str = "workspace.dependencies";

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let Some(root) = tree.text(ROOT) else { return Vec::new() };
    let used: Vec<&str> = tree
        .files()
        .filter(|(path, _)| path.ends_with("/Cargo.toml"))
        .flat_map(|(_, manifest)| keys(manifest))
        .filter(|(table, _, _)| table.ends_with("dependencies"))
        .map(|(_, key, _)| key)
        .collect();
    keys(root)
        .filter(|(table, key, _)| *table == COMMON && !used.contains(key))
        .map(|(_, key, line)| Problem {
            path: ROOT.to_owned(),
            line,
            message: format!("no crate uses '{key}'; remove it"),
        })
        .collect()
}

/// Table, first part of the key and line of every entry.
fn keys(manifest: &str) -> impl Iterator<Item = (&str, &str, usize)> {
    let mut table = "";
    (1..).zip(manifest.lines()).filter_map(move |(line, text)| {
        if let Some(header) = text.strip_prefix('[') {
            table = header.trim_end().trim_end_matches(']');
            return None;
        }
        let (key, _) = text.split_once('=')?;
        Some((table, key.split('.').next().unwrap_or(key).trim(), line))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_no_crate_uses_is_reported() {
        let tree = Tree::made_up(&[
            (
                "Cargo.toml",
                "[workspace.dependencies]\ncsv = \"1\"\npng = \"0.18\"\nrand = { version = \"1\" }\n",
            ),
            (
                "crates/scene/Cargo.toml",
                "[package]\npng = 1\n[dependencies]\ncsv.workspace = true\n\
                 [dev-dependencies]\nrand = { workspace = true }\n",
            ),
        ]);
        let found: Vec<(usize, String)> =
            problems(&tree).into_iter().map(|problem| (problem.line, problem.message)).collect();
        assert_eq!(found, [(3, "no crate uses 'png'; remove it".to_owned())]);
    }
}
