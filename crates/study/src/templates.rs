//! Templates of the pages: Markdown with the places of the numbers, by minijinja.
//!
//! Templates are wrapped like all prose of the project. Numbers change the lengths of lines, so lines that
//! go on are joined before a template is filled, and [`wrapped`] breaks those of the page anew.

use minijinja::{Environment, UndefinedBehavior, Value};

/// Fills a template.
///
/// Filters write numbers: `fixed(1)` as 1.2, `scientific(1)` as 1.2e-3, `signed(1)` as +1.2, `rounded` as
/// two digits, `number` as the shortest text that is the number; `verdict` writes whether a goal is met.
/// An absent number is a dash.
///
/// # Panics
/// On a template that names what is not given, which is our own bug.
#[must_use]
pub fn fill(template: &str, context: Value) -> String {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment.set_undefined_behavior(UndefinedBehavior::SemiStrict);
    environment.add_filter("fixed", fixed);
    environment.add_filter("scientific", scientific);
    environment.add_filter("signed", signed);
    environment.add_filter("rounded", rounded);
    environment.add_filter("number", number);
    environment.add_filter("verdict", verdict);
    let text = environment.render_str(&joined(template), context);
    text.expect("a template and the values for it belong together")
}

const ABSENT: &str = "–";

fn written(value: Option<f64>, write: impl Fn(f64) -> String) -> String {
    value.map_or_else(|| ABSENT.to_owned(), write)
}

fn fixed(value: Option<f64>, decimals: usize) -> String {
    written(value, |value| format!("{value:.decimals$}"))
}

fn scientific(value: Option<f64>, decimals: usize) -> String {
    written(value, |value| format!("{value:.decimals$e}"))
}

fn signed(value: Option<f64>, decimals: usize) -> String {
    written(value, |value| format!("{value:+.decimals$}"))
}

fn number(value: Option<f64>) -> String {
    written(value, |value| value.to_string())
}

/// Writes a ratio as a sentence gives it.
fn rounded(ratio: Option<f64>) -> String {
    written(ratio, |ratio| {
        if ratio == f64::INFINITY {
            return "∞".to_owned();
        }
        if ratio < 10.0 {
            return format!("{ratio:.1}");
        }
        let digits = 10_f64.powf(ratio.log10().floor() - 1.0);
        format!("{:.0}", (ratio / digits).round() * digits)
    })
}

fn verdict(met: Option<bool>) -> &'static str {
    match met {
        Some(true) => "**met**",
        Some(false) => "**missed**",
        None => "not measured",
    }
}

/// Longest line of a page [characters]; tables, pictures and headings are not broken.
const WIDTH: usize = 110;

/// Breaks the paragraphs and the points of lists of a page.
#[must_use]
pub fn wrapped(page: &str) -> String {
    let mut text = String::with_capacity(page.len());
    for line in page.lines() {
        let stays = ["|", "#", "![", "    ", "<"].iter().any(|start| line.starts_with(start));
        if stays || line.chars().count() <= WIDTH {
            text.push_str(line);
        } else {
            text.push_str(&broken(line));
        }
        text.push('\n');
    }
    text
}

/// One paragraph or point of a list in several lines.
fn broken(line: &str) -> String {
    let indent = if line.starts_with("* ") { "  " } else { "" };
    let mut text = String::with_capacity(line.len());
    let mut width = 0;
    for words in together(line) {
        let length = words.chars().count();
        if width == 0 {
            width = length;
        } else if width + 1 + length <= WIDTH {
            text.push(' ');
            width += 1 + length;
        } else {
            text.push('\n');
            text.push_str(indent);
            width = indent.len() + length;
        }
        text.push_str(&words);
    }
    text
}

/// Words of a line; one that must not begin a line stays with the word before it.
fn together(line: &str) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for word in line.split(' ') {
        match all.last_mut() {
            Some(before) if begins_a_list(word) => {
                before.push(' ');
                before.push_str(word);
            }
            _ => all.push(word.to_owned()),
        }
    }
    all
}

/// Whether a word at the beginning of a line would make a point of a list or a heading of it.
fn begins_a_list(word: &str) -> bool {
    let number = word.trim_end_matches(['.', ')']);
    ["*", "-", "+"].contains(&word)
        || word.starts_with('#')
        || number.len() < word.len() && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit())
}

/// The template with every paragraph and every point of a list in one line.
fn joined(template: &str) -> String {
    let mut text = String::with_capacity(template.len());
    let mut goes_on = false;
    for line in template.lines() {
        let begins_anew = line.is_empty()
            || ["|", "#", "* ", "![", "    "].iter().any(|start| line.starts_with(start))
            || is_block(line);
        if goes_on && !begins_anew {
            // The space goes where the template says that nothing stands between.
            let end = text.trim_end_matches('\n').len();
            text.truncate(end);
            text.push(' ');
        }
        text.push_str(if begins_anew { line } else { line.trim_start() });
        text.push('\n');
        let alone = line.is_empty() || is_block(line) || line.starts_with(['|', '#']);
        goes_on = !alone && !line.starts_with("    ") && !line.starts_with("![");
    }
    text
}

/// Whether a line is a block of the template language and nothing else.
fn is_block(line: &str) -> bool {
    line.starts_with("{%") && line.ends_with("%}") && line.matches("{%").count() == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use minijinja::context;

    #[test]
    fn lines_that_go_on_are_joined() {
        let template = "# A\n\nOne\ntwo.\n\n* Point\n  goes on.\n* Next\n\n| a |\n| b |\n\n    code\n";
        assert_eq!(
            joined(template),
            "# A\n\nOne two.\n\n* Point goes on.\n* Next\n\n| a |\n| b |\n\n    code\n"
        );
    }

    #[test]
    fn lines_of_a_page_are_broken_and_say_the_same() {
        let words = "The error - 12. of it - falls with the tolerance that was asked for. ".repeat(8);
        let page = format!("# Head {words}\n\n{words}\n\n* {words}\n| {words} |\n");
        let text = wrapped(&page);
        let prose = text.lines().filter(|line| !line.starts_with(['#', '|']));
        assert!(prose.clone().all(|line| line.chars().count() <= WIDTH));
        assert!(prose.clone().all(|line| !line.trim_start().starts_with(['-', '1'])));
        assert_eq!(text.split_whitespace().collect::<Vec<_>>(), page.split_whitespace().collect::<Vec<_>>());
        assert_eq!(wrapped(&text), text);
    }

    #[test]
    fn numbers_are_written_as_asked() {
        let template =
            "{{ a|fixed(1) }} {{ a|scientific(1) }} {{ a|signed(0) }} {{ a|rounded }} {{ b|fixed(1) }}";
        let text = fill(template, context! { a => 123.46, b => None::<f64> });
        assert_eq!(text, "123.5 1.2e2 +123 120 –\n");
    }

    #[test]
    fn blocks_leave_no_lines() {
        let template = "{% for x in all %}\n| {{ x|number }} |\n{% endfor %}\n";
        assert_eq!(fill(template, context! { all => [1.0, 0.5] }), "| 1 |\n| 0.5 |\n");
    }
}
