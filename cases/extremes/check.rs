//! Table of extreme scenes: the command fails where a scene does not end as the study expects.

use crate::support::{Case, full_size};

/// Mark of scenes that take longer than all others together.
const FULL: &str = "[[extremes]] # at full size only\n";

#[test]
fn what_is_pushed_to_an_end_behaves_as_stated() {
    let case = Case::new("extremes");
    if !full_size() {
        let all = std::fs::read_to_string(case.path("study.toml")).expect("a study");
        let mut parts = all.split(FULL);
        let first = parts.next().expect("the head of the study").to_owned();
        let rest = parts.filter_map(|part| part.split_once("[[extremes]]\n"));
        case.write("study.toml", &rest.fold(first, |text, (_, others)| text + "[[extremes]]\n" + others));
    }
    let page = case.study("study.toml", "stability");
    let said = page.lines().find(|line| line.contains("scenes end as expected")).expect("a verdict");
    let numbers: Vec<&str> =
        said.split(|c: char| !c.is_ascii_digit()).filter(|number| !number.is_empty()).collect();
    assert!(numbers.len() == 2 && numbers[0] == numbers[1] && numbers[0].len() >= 2, "{said}");
}
