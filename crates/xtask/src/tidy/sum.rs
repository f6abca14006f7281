//! The sum of the field is written in the same words wherever it stands.

use super::Problem;
use super::tree::Tree;

/// The sum as it stands on a line of its own.
const SUM: &str = "E = near + middle + far + correction + faces + external";
/// Beginning of a line that states the sum, in these words or in others.
const BEGINNING: &str = "E = near";

/// Files that must state the sum: what a reader of the code or of the equations opens first.
const STATED_IN: [&str; 5] = [
    "crates/field/src/lib.rs",
    "crates/field/src/sum.rs",
    "crates/field/src/electric_field.rs",
    "docs/equations.md",
    "ARCHITECTURE.md",
];

/// Lists of the sum's parts in the code.
const LISTS: [List; 2] = [
    List {
        path: "crates/field/src/values.rs",
        begins: "pub struct Components {",
        before: "pub ",
        behind: ": Vec<",
    },
    List {
        path: "crates/scene/src/write/field_csv.rs",
        begins: "fn named(&self)",
        before: "(\"",
        behind: "\", self.",
    },
];

/// A list of the parts, a line each: its file, the line that begins it, and what stands around each name.
struct List {
    path: &'static str,
    begins: &'static str,
    before: &'static str,
    behind: &'static str,
}

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    [not_stated(tree), in_other_words(tree), lists(tree)].concat()
}

/// Names of the parts, in order.
fn parts() -> Vec<&'static str> {
    SUM.trim_start_matches("E = ").split(" + ").collect()
}

/// The words of a line, without the signs of a comment.
fn said(line: &str) -> &str {
    line.trim().trim_start_matches(['/', '!']).trim()
}

/// Files that must state the sum and do not.
fn not_stated(tree: &Tree) -> Vec<Problem> {
    let silent = |path: &&str| tree.text(path).is_some_and(|text| text.lines().all(|line| said(line) != SUM));
    let problem = |path: &str| Problem {
        path: path.to_owned(),
        line: 0,
        message: format!("the sum is missing; state it on a line of its own: {SUM}"),
    };
    STATED_IN.into_iter().filter(silent).map(problem).collect()
}

/// Lines anywhere that state the sum with other parts.
fn in_other_words(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.files().filter(|(path, _)| !path.ends_with("tidy/sum.rs")) {
        for (line, words) in (1..).zip(text.lines().map(said)) {
            if words.starts_with(BEGINNING) && words != SUM {
                let message = format!("the sum in other words; it reads: {SUM}");
                problems.push(Problem { path: path.to_owned(), line, message });
            }
        }
    }
    problems
}

/// Lists whose names are not those of the sum in its order.
fn lists(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for list in LISTS {
        let Some(text) = tree.text(list.path) else { continue };
        let names = names(text, &list);
        if names != parts() {
            problems.push(Problem {
                path: list.path.to_owned(),
                line: 0,
                message: format!("'{}' lists {names:?}, not the parts of {SUM}", list.begins),
            });
        }
    }
    problems
}

/// The names of a list: from its beginning to the first line that closes it.
fn names<'a>(text: &'a str, list: &List) -> Vec<&'a str> {
    let inside = text.lines().skip_while(|line| !line.contains(list.begins)).skip(1);
    inside
        .take_while(|line| *line != "}" && *line != "    }")
        .filter_map(|line| line.trim_start().strip_prefix(list.before)?.split_once(list.behind))
        .map(|(name, _)| name)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        problems(&Tree::made_up(&[(path, text)])).into_iter().map(|problem| problem.line).collect()
    }

    #[test]
    fn the_sum_is_stated_in_comments_and_in_text() {
        assert_eq!(lines("crates/field/src/sum.rs", &format!("//! The sum.\n//!\n//! {SUM}\n")), []);
        assert_eq!(lines("crates/field/src/electric_field.rs", &format!("    /// {SUM}\n")), []);
        assert_eq!(lines("docs/equations.md", &format!("Text.\n\n    {SUM}\n")), []);
        assert_eq!(lines("crates/field/src/sum.rs", "//! The sum.\n"), [0]);
        assert_eq!(lines("docs/equations.md", &format!("In a sentence {SUM}\n")), [0]);
    }

    #[test]
    fn other_words_are_reported_anywhere() {
        assert_eq!(lines("README.md", "Text.\n\n    E = near + far\n"), [3]);
        assert_eq!(lines("crates/dem/src/a.rs", "/// E = near + middle + far + correction + faces\n"), [1]);
        assert_eq!(lines("README.md", &format!("{SUM}\nF = q E\n")), []);
    }

    #[test]
    fn components_stand_in_the_order_of_the_sum() {
        let list = |names: &[&str]| {
            let fields: String =
                names.iter().map(|name| format!("    /// A part.\n    pub {name}: Vec<E>,\n")).collect();
            format!(
                "pub struct Components {{\n{fields}}}\n\npub struct Other {{\n    pub more: Vec<E>,\n}}\n"
            )
        };
        let path = "crates/field/src/values.rs";
        assert_eq!(lines(path, &list(&parts())), []);
        assert_eq!(lines(path, &list(&parts()[..5])), [0]);
        assert_eq!(lines(path, &list(&["near", "far", "middle", "correction", "faces", "external"])), [0]);
    }

    #[test]
    fn columns_are_named_as_the_parts() {
        let list = |names: &[&str]| {
            let rows: String =
                names.iter().map(|name| format!("            (\"{name}\", self.{name}),\n")).collect();
            format!("    fn named(&self) -> Names {{\n        [\n{rows}        ]\n    }}\n")
        };
        let path = "crates/scene/src/write/field_csv.rs";
        assert_eq!(lines(path, &list(&parts())), []);
        assert_eq!(lines(path, &list(&["near", "far"])), [0]);
    }
}
