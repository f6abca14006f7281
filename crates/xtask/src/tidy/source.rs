//! Rust source as the rules read it: without tests, without comments and strings.

/// Whether all of a file is a test, an example or a measurement.
pub(super) fn is_test_file(path: &str) -> bool {
    let is_test = |part: &str| matches!(part, "tests" | "benches" | "examples" | "tests.rs");
    path.starts_with("cases/") || path.split('/').any(is_test)
}

/// Lines of a file that are compiled outside tests: line from 1 and text.
///
/// An item below `#[cfg(test)]` is left out whole; its end is told by rustfmt's indentation.
pub(super) fn lines_without_tests(text: &str) -> Vec<(usize, &str)> {
    let lines: Vec<(usize, &str)> = (1..).zip(text.lines()).collect();
    let mut kept = Vec::new();
    let mut next = 0;
    while next < lines.len() {
        let (_, line) = lines[next];
        if is_for_tests(line) {
            next = end_of_item(&lines, next);
        } else {
            kept.push(lines[next]);
            next += 1;
        }
    }
    kept
}

/// Lines, from the first to the last, of every module of tests that stands in this file.
pub(super) fn test_modules(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<(usize, &str)> = (1..).zip(text.lines()).collect();
    let mut modules = Vec::new();
    for (start, (line, code)) in lines.iter().enumerate() {
        if is_for_tests(code) {
            let last = end_of_item(&lines, start);
            if lines[start..last].iter().any(|(_, code)| code.trim_start().starts_with("mod ")) {
                modules.push((*line, lines[last - 1].0));
            }
        }
    }
    modules
}

fn is_for_tests(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with("#[cfg(test)]") || line.starts_with("#[cfg(all(test")
}

/// Index of the line behind the item whose attribute stands in the line `start`.
fn end_of_item(lines: &[(usize, &str)], start: usize) -> usize {
    let (_, attribute) = lines[start];
    let indentation = &attribute[..attribute.len() - attribute.trim_start().len()];
    let is_last = |line: &str| {
        let ours = line.strip_prefix(indentation).filter(|rest| !rest.starts_with(' '));
        ours.is_some_and(|rest| !rest.starts_with(['#', '/']) && rest.ends_with([';', '}', ',']))
    };
    let ends = lines[start + 1..].iter().position(|(_, line)| is_last(line));
    ends.map_or(lines.len(), |ends| start + 1 + ends + 1)
}

/// The text with comments, strings and characters replaced by blanks; lines stay where they are.
pub(super) fn code_only(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let blanked = length_of_comment(rest).or_else(|| length_of_literal(rest, &code));
        let length = blanked.unwrap_or(first.len_utf8());
        let (piece, behind) = rest.split_at(length);
        if blanked.is_some() {
            code.extend(piece.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        } else {
            code.push_str(piece);
        }
        rest = behind;
    }
    code
}

/// Bytes of the comment with which the text begins.
fn length_of_comment(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    text.starts_with("/*").then(|| text.find("*/").map_or(text.len(), |end| end + 2))
}

/// Bytes of the string or character with which the text begins; `before` tells a raw string from a name.
fn length_of_literal(text: &str, before: &str) -> Option<usize> {
    let is_in_a_name = before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
    if !is_in_a_name && text.starts_with("r") {
        let hashes = text[1..].chars().take_while(|c| *c == '#').count();
        if text[1 + hashes..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(hashes));
            let inside = &text[2 + hashes..];
            return Some(inside.find(&end).map_or(text.len(), |at| 2 + hashes + at + end.len()));
        }
    }
    if text.starts_with('"') {
        return Some(length_to(text, '"'));
    }
    // A lifetime has no second quote behind its first character.
    let mut characters = text.strip_prefix('\'')?.chars();
    let is_character = characters.next() == Some('\\') || characters.next() == Some('\'');
    is_character.then(|| length_to(text, '\''))
}

/// Bytes to the closing quote, over escaped ones.
fn length_to(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return at + c.len_utf8(),
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TESTED: &str = "\
use a::A;
#[cfg(test)]
use b::B;

fn run() {
    #[cfg(test)]
    if true {
        stop();
    }
    go();
}

#[cfg(test)]
mod tests {
    fn check() {
        go();
    }
}

fn last() {}
";

    #[test]
    fn items_of_tests_are_left_out_whole() {
        let kept: Vec<usize> = lines_without_tests(TESTED).into_iter().map(|(line, _)| line).collect();
        assert_eq!(kept, [1, 4, 5, 10, 11, 12, 19, 20]);
    }

    #[test]
    fn modules_of_tests_are_found_with_their_lines() {
        assert_eq!(test_modules(TESTED), [(13, 18)]);
        assert_eq!(test_modules("#[cfg(test)]\nmod tests;\n"), [(1, 2)]);
    }

    #[test]
    fn comments_and_literals_are_blanked() {
        let text = "a(\"x\\\"y\", 'q', '\\'', r#\"\"z\"#); // b\nc::<'d>(); /* e\nf */ g";
        let code = code_only(text);
        let words: Vec<&str> =
            code.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
        assert_eq!(words, ["a", "c", "d", "g"]);
        assert_eq!(code.lines().count(), 3);
    }

    #[test]
    fn names_that_end_in_r_are_no_raw_strings() {
        assert_eq!(code_only("for\"x\""), "for   ");
    }
}
