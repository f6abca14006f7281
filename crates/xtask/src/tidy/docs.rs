//! An item's documentation begins with a noun or a verb, so that it can be read alone.

use super::Problem;
use super::tree::Tree;

/// First words that lean on a sentence before, or are neither noun nor verb. "Whether" is the usual word
/// for a truth value and stays.
const LEANING: [&str; 66] = [
    "Of", "By", "Its", "Their", "His", "Her", "It", "They", "As", "So", "That", "This", "These", "Those",
    "Such", "Whose", "Whom", "Which", "Who", "What", "Where", "When", "While", "Why", "How", "If", "Because",
    "Than", "Like", "From", "For", "With", "Without", "Within", "At", "On", "Onto", "Over", "Under", "In",
    "Into", "To", "Through", "After", "Before", "Behind", "Beside", "Beyond", "Between", "Around", "Across",
    "Against", "Among", "About", "Above", "Below", "Until", "During", "And", "Or", "But", "Also", "Not",
    "Other", "Others", "Same",
];

/// First words after an article that lean likewise.
const LEANING_PAIRS: [&str; 4] = ["The same", "The other", "The others", "The one"];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (path, text) in tree.rust_files() {
        let mut before = None;
        for (line, content) in (1..).zip(text.lines()) {
            let documentation = documentation(content);
            let first = documentation.filter(|_| before.is_none()).and_then(leaning_words);
            if let Some(words) = first {
                let message = format!("documentation begins with '{words}'; begin with a noun or a verb");
                problems.push(Problem { path: path.to_owned(), line, message });
            }
            before = documentation;
        }
    }
    problems
}

fn documentation(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))
}

/// The words at the beginning that lean on others.
fn leaning_words(documentation: &str) -> Option<&str> {
    let text = documentation.trim_start();
    let end_of = |count: usize| {
        let mut ends = text.match_indices(|c: char| !c.is_alphabetic()).map(|(end, _)| end);
        ends.nth(count - 1).unwrap_or(text.len())
    };
    let (first, pair) = (&text[..end_of(1)], &text[..end_of(2)]);
    let leans = |words: &&str| LEANING.contains(words) || LEANING_PAIRS.contains(words);
    [pair, first].into_iter().find(leans)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_words_that_lean_on_others_are_found() {
        let text = "//! By what it moves.\n\n\
                    mod a;\n/// Of a mesh.\n/// Its cells.\nfn a() {}\n\
                    fn b() {}\n/// The same, twice.\n#[must_use]\n/// Where it is.\nfn c() {}\n";
        let found = problems(&Tree::made_up(&[("crates/core/src/a.rs", text)]));
        let lines: Vec<usize> = found.iter().map(|problem| problem.line).collect();
        assert_eq!(lines, [1, 4, 8, 10]);
        assert!(found[2].message.contains("'The same'"), "{}", found[2].message);
    }

    #[test]
    fn nouns_verbs_and_later_lines_are_free() {
        let text = "/// Charge,\n/// By which it moves.\nfn a() {}\n/// Whether it moves.\n/// Formula.\n";
        assert_eq!(problems(&Tree::made_up(&[("crates/core/src/a.rs", text)])), []);
        assert_eq!(leaning_words(" The samest"), None);
        assert_eq!(leaning_words(" Ofc"), None);
    }
}
