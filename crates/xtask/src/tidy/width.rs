//! No line is wider than a reader's window: code, comments and documents alike.

use super::Problem;
use super::tree::Tree;

/// Widest line, in characters.
const WIDTH: usize = 110;

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.files() {
        let mut in_fence = false;
        for (line, content) in (1..).zip(text.lines()) {
            let width = content.chars().count();
            in_fence ^= content.trim_start().starts_with("```");
            let is_left_out = is_unbreakable(content)
                || path.ends_with(".md") && (in_fence || is_table_row(content))
                || path.ends_with(".rs") && is_table_row(documentation(content))
                || path.ends_with(".toml") && holds_an_inline_table(content);
            if width > WIDTH && !is_left_out {
                let message = format!("{width} characters, limit {WIDTH}; break the line");
                problems.push(Problem { path: path.to_owned(), line, message });
            }
        }
    }
    problems
}

/// Whether the line is one word, one link or one picture behind its indentation and marks.
fn is_unbreakable(line: &str) -> bool {
    let content = line.trim_start_matches([' ', '/', '!', '#', '*', '-', '>']);
    let target = content.strip_prefix('[').and_then(|link| link.split_once("](")).map(|(_, target)| target);
    !target.unwrap_or(content).trim_end().contains(' ')
}

fn is_table_row(line: &str) -> bool {
    line.trim_start().starts_with('|')
}

/// Documentation that stands in the line.
fn documentation(line: &str) -> &str {
    let line = line.trim_start();
    line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).unwrap_or_default()
}

/// Whether a line of TOML holds a table in braces, which must stand in one line.
fn holds_an_inline_table(line: &str) -> bool {
    line.split_once(" = {").is_some_and(|(key, _)| !key.contains(['#', ' ']))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        problems(&Tree::made_up(&[(path, text)])).into_iter().map(|problem| problem.line).collect()
    }

    #[test]
    fn characters_count_and_not_bytes() {
        let text = format!("a {}\na {}\n", "ε".repeat(WIDTH - 2), "ε".repeat(WIDTH - 1));
        assert_eq!(lines("crates/core/src/a.rs", &text), [2]);
        assert_eq!(lines("docker/dem.Dockerfile", &text), [2]);
    }

    #[test]
    fn rows_of_tables_and_fenced_blocks_of_documents_are_left_out() {
        let wide = "word ".repeat(30);
        let text = format!("| {wide}|\n```text\n{wide}\n```\n{wide}\n");
        assert_eq!(lines("docs/a.md", &text), [5]);
        assert_eq!(lines("crates/core/src/a.rs", &format!("/// | {wide}|\n// | {wide}|\n")), [2]);
    }

    #[test]
    fn links_and_pictures_alone_in_their_line_are_left_out() {
        let words = "word ".repeat(30);
        let address = format!("https://example.org/{}", "a".repeat(WIDTH));
        let text = format!("{address}\n* [{words}]({address})\n![{words}]({address})\nsee {address}\n");
        assert_eq!(lines("docs/a.md", &text), [4]);
        assert_eq!(lines("crates/core/src/a.rs", &format!("    /// <{address}>\n")), []);
    }

    #[test]
    fn inline_tables_of_toml_are_left_out() {
        let wide = "a, ".repeat(40);
        let text = format!("generate = {{ {wide} }}\nset = [{wide}]\n# generate = {{ {wide} }}\n");
        assert_eq!(lines("cases/a/scene.toml", &text), [2, 3]);
    }
}
