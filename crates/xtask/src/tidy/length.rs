//! Files that can be read in one go, functions that can be seen at once.

use super::Problem;
use super::source::{is_test_file, lines_without_tests, test_modules};
use super::tree::Tree;

/// Longest Rust file, in lines without its tests.
const FILE_LINES: usize = 400;
/// Longest module of tests that stands in the file that it tests, in lines.
const TEST_LINES: usize = 150;
/// Longest function, in lines from its signature to its closing brace.
const FUNCTION_LINES: usize = 70;
/// Longest function that reads as a list, in lines.
const LIST_LINES: usize = 90;
/// Deepest nesting of a list: its entries, and one level within them.
const LIST_NESTING: usize = 2;
/// Columns of one level of rustfmt's indentation.
const INDENTATION: usize = 4;

/// Files that are longer for a reason: path, lines allowed, reason.
const LONG_FILES: [(&str, usize, &str); 0] = [];

/// Functions that read as a list although they nest deeper: path, name, reason.
const LISTS: [(&str, &str, &str); 0] = [];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = too_long(tree, &LONG_FILES);
    for (path, text) in tree.rust_files() {
        for function in long_functions(text) {
            let limit = function.limit(path, &LISTS);
            if function.length > limit {
                let message =
                    format!("function of {} lines, limit {limit}; split it by purpose", function.length);
                problems.push(Problem { path: path.to_owned(), line: function.line, message });
            }
        }
        let long_tests = test_modules(text).into_iter().filter(|(first, last)| last + 1 - first > TEST_LINES);
        for (line, last) in long_tests {
            let lines = last + 1 - line;
            let message =
                format!("tests of {lines} lines, limit {TEST_LINES}; move them to tests.rs beside the file");
            problems.push(Problem { path: path.to_owned(), line, message });
        }
    }
    problems
}

fn too_long(tree: &Tree, exceptions: &[(&str, usize, &str)]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.rust_files() {
        let lines = if is_test_file(path) { text.lines().count() } else { lines_without_tests(text).len() };
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

/// A function over the limit.
#[derive(Debug, PartialEq, Eq)]
struct LongFunction<'a> {
    name: &'a str,
    /// First line, from 1.
    line: usize,
    length: usize,
    /// Levels of nesting in its body; 1 for statements only.
    nesting: usize,
}

impl LongFunction<'_> {
    fn limit(&self, path: &str, lists: &[(&str, &str, &str)]) -> usize {
        let is_listed = lists.iter().any(|(file, name, _)| *file == path && *name == self.name);
        if self.nesting <= LIST_NESTING || is_listed { LIST_LINES } else { FUNCTION_LINES }
    }
}

/// Functions over the smaller limit, told by rustfmt's indentation.
fn long_functions(text: &str) -> Vec<LongFunction<'_>> {
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
        let outside = indentation(line);
        let closing = format!("{}}}", &line[..outside]);
        let length =
            lines[start..].iter().position(|candidate| *candidate == closing).map_or(0, |end| end + 1);
        if length > FUNCTION_LINES {
            let deepest = lines[start..start + length].iter().map(|line| indentation(line)).max();
            let nesting = (deepest.unwrap_or(outside) - outside) / INDENTATION;
            found.push(LongFunction { name: name(body), line: start + 1, length, nesting });
        }
    }
    found
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start_matches(' ').len()
}

/// Name in a function's signature.
fn name(signature: &str) -> &str {
    let behind = signature.split_once("fn ").map_or(signature, |(_, behind)| behind);
    behind.split(['(', '<']).next().unwrap_or(behind)
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
    fn tests_in_a_file_do_not_count_until_they_need_a_file_of_their_own() {
        let code = lines(FILE_LINES);
        let with_tests = |count| format!("{code}#[cfg(test)]\nmod tests {{\n{}}}\n", lines(count));
        let messages = |text: &str| problems(&Tree::made_up(&[("crates/core/src/a.rs", text)])).len();
        assert_eq!(messages(&with_tests(TEST_LINES - 3)), 0);
        assert_eq!(messages(&with_tests(TEST_LINES - 2)), 1);
        assert_eq!(messages(&format!("{code}#[cfg(test)]\nmod tests;\n")), 0);
    }

    #[test]
    fn files_of_tests_count_as_they_are() {
        let text = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", lines(FILE_LINES));
        assert_eq!(too_long(&Tree::made_up(&[("crates/core/tests/a.rs", &text)]), &[]).len(), 1);
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
        let expected = LongFunction { name: "run", line: 2, length: FUNCTION_LINES + 1, nesting: 1 };
        assert_eq!(long_functions(&over), [expected]);
    }

    #[test]
    fn functions_that_read_as_a_list_may_be_longer() {
        let limit = |innermost: &str| {
            let entry = format!("    if a {{\n{innermost}    }}\n");
            let text = format!("fn run() {{\n{}}}\n", entry.repeat(FUNCTION_LINES / 2));
            long_functions(&text)[0]
                .limit("crates/core/src/a.rs", &[("crates/core/src/b.rs", "run", "a table")])
        };
        assert_eq!(limit("        step();\n"), LIST_LINES);
        assert_eq!(limit("        if b {\n            step();\n        }\n"), FUNCTION_LINES);
        let deep = LongFunction { name: "run", line: 1, length: 80, nesting: 5 };
        assert_eq!(
            deep.limit("crates/core/src/b.rs", &[("crates/core/src/b.rs", "run", "a table")]),
            LIST_LINES
        );
    }
}
