//! Files that can be read in one go, functions that can be seen at once.

use super::Problem;
use super::tree::Tree;

/// Longest Rust file, in lines.
const FILE_LINES: usize = 400;
/// Longest function, in lines from its signature to its closing brace.
const FUNCTION_LINES: usize = 70;

/// Files that are longer for a reason: path, lines allowed, reason.
const LONG_FILES: [(&str, usize, &str); 0] = [];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = too_long(tree, &LONG_FILES);
    for (path, text) in tree.rust_files() {
        for (line, length) in long_functions(text) {
            problems.push(Problem {
                path: path.to_owned(),
                line,
                message: format!("function of {length} lines, limit {FUNCTION_LINES}; split it by purpose"),
            });
        }
    }
    problems
}

fn too_long(tree: &Tree, exceptions: &[(&str, usize, &str)]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.rust_files() {
        let lines = text.lines().count();
        let exception = exceptions.iter().find(|(name, ..)| *name == path);
        let limit = exception.map_or(FILE_LINES, |(_, limit, _)| *limit);
        let message = if lines > limit {
            format!("file of {lines} lines, limit {limit}; split it by purpose or list it with a reason")
        } else if exception.is_some() && lines <= FILE_LINES {
            format!("file of {lines} lines needs no exception any more; remove it from the list")
        } else {
            continue;
        };
        problems.push(Problem { path: path.to_owned(), line: 0, message });
    }
    for (path, ..) in exceptions {
        if tree.text(path).is_none() {
            let message = "listed as a long file but not there; remove it from the list".to_owned();
            problems.push(Problem { path: (*path).to_owned(), line: 0, message });
        }
    }
    problems
}

/// First line and length of functions over the limit, told by rustfmt's indentation.
fn long_functions(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let body = line.trim_start();
        let is_function = body.starts_with("fn ")
            || (body.contains(" fn ")
                && ["pub", "const", "async", "unsafe", "extern"].iter().any(|word| body.starts_with(word)));
        if !is_function || body.ends_with(';') || body.ends_with('}') {
            continue;
        }
        let closing = format!("{}}}", &line[..line.len() - body.len()]);
        let length =
            lines[start..].iter().position(|candidate| *candidate == closing).map_or(0, |end| end + 1);
        if length > FUNCTION_LINES {
            found.push((start + 1, length));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(count: usize) -> String {
        "// a line\n".repeat(count)
    }

    #[test]
    fn long_file_is_reported_unless_listed() {
        let text = lines(FILE_LINES + 1);
        let tree = Tree::made_up(&[("crates/core/src/a.rs", &text)]);
        assert_eq!(too_long(&tree, &[]).len(), 1);
        assert_eq!(too_long(&tree, &[("crates/core/src/a.rs", 500, "a table")]), []);
    }

    #[test]
    fn stale_exceptions_are_reported() {
        let tree = Tree::made_up(&[("crates/core/src/a.rs", "//! Short.\n")]);
        let exceptions =
            [("crates/core/src/a.rs", 500, "was long"), ("crates/core/src/gone.rs", 500, "is gone")];
        assert_eq!(too_long(&tree, &exceptions).len(), 2);
    }

    #[test]
    fn function_length_counts_to_its_own_brace() {
        let body = "        step();\n".repeat(FUNCTION_LINES - 2);
        let fits = format!("impl A {{\n    pub fn run() {{\n{body}    }}\n}}\n");
        assert_eq!(long_functions(&fits), []);
        let over = format!("impl A {{\n    pub fn run() {{\n        step();\n{body}    }}\n}}\n");
        assert_eq!(long_functions(&over), [(2, FUNCTION_LINES + 1)]);
    }
}
