//! The modules of a crate know each other in one direction only.
//!
//! The graph's nodes are the files and folders directly below `src/`. Its edges are the paths that begin
//! with `crate::` or climb to the root by `super::`. Tests are left out, and so is the root, whose
//! re-exports stand for the modules that they name.

use super::Problem;
use super::source::{code_only, is_test_file, lines_without_tests};
use super::tree::Tree;
use std::collections::{BTreeMap, VecDeque};

/// Files that stand for the crate itself.
const ROOTS: [&str; 2] = ["lib.rs", "main.rs"];

pub(super) fn problems(tree: &Tree) -> Vec<Problem> {
    let mut crates: Vec<&str> =
        tree.rust_files().filter_map(|(path, _)| in_source(path)).map(|(name, _)| name).collect();
    crates.dedup();
    crates.into_iter().flat_map(|name| problems_of_crate(tree, name)).collect()
}

/// Name of the crate and path below its `src/`.
fn in_source(path: &str) -> Option<(&str, &str)> {
    path.strip_prefix("crates/")?.split_once("/src/")
}

fn problems_of_crate(tree: &Tree, name: &str) -> Vec<Problem> {
    circles(&graph(tree, name)).iter().map(|circle| told(circle)).collect()
}

fn told(circle: &[Edge]) -> Problem {
    let edges: Vec<String> = circle
        .iter()
        .map(|edge| format!("{} uses {} ({}:{})", edge.from, edge.to, edge.path, edge.line))
        .collect();
    Problem {
        path: circle[0].path.clone(),
        line: circle[0].line,
        message: format!("circle of modules: {}; move what both need below them", edges.join(", ")),
    }
}

/// One module's use of another, where it is seen first.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Edge {
    from: String,
    to: String,
    path: String,
    line: usize,
}

/// Edges by the module that uses and the one that is used.
type Graph = BTreeMap<String, BTreeMap<String, Edge>>;

fn graph(tree: &Tree, name: &str) -> Graph {
    let files: Vec<(&str, &str, &str)> = tree
        .rust_files()
        .filter_map(|(path, text)| Some((path, text, in_source(path).filter(|(of, _)| *of == name)?.1)))
        .collect();
    let mut graph = Graph::new();
    for (_, _, inside) in &files {
        if !ROOTS.contains(inside) {
            graph.entry(module_path(inside)[0].to_owned()).or_default();
        }
    }
    let owners: BTreeMap<String, String> = files
        .iter()
        .filter(|(_, _, inside)| ROOTS.contains(inside))
        .flat_map(|(_, text, _)| owners(text, &graph))
        .collect();
    for (path, text, inside) in files {
        if ROOTS.contains(&inside) || is_test_file(inside) {
            continue;
        }
        let module = module_path(inside);
        let from = module[0].to_owned();
        for used in paths(text) {
            let Some(first) = first_in_crate(&used.words, module.len()) else { continue };
            let to = owners.get(first).map_or(first, String::as_str).to_owned();
            if to == from || !graph.contains_key(&to) {
                continue;
            }
            let edge = Edge { from: from.clone(), to: to.clone(), path: path.to_owned(), line: used.line };
            graph.entry(from.clone()).or_default().entry(to).or_insert(edge);
        }
    }
    graph
}

/// Modules from the crate's root to the file.
fn module_path(inside: &str) -> Vec<&str> {
    let path = inside.trim_end_matches(".rs");
    path.strip_suffix("/mod").unwrap_or(path).split('/').collect()
}

/// Names that the root re-exports, and the module that each is of.
fn owners(root: &str, graph: &Graph) -> BTreeMap<String, String> {
    let is_module = |word: &str| graph.contains_key(word);
    paths(root)
        .into_iter()
        .filter(|path| path.words.len() > 1)
        .filter_map(|path| {
            let first = path.words.iter().find(|word| !matches!(word.as_str(), "crate" | "self"))?;
            is_module(first).then(|| (path.alias.as_ref().or(path.words.last()).cloned(), first.clone()))
        })
        .filter_map(|(name, owner)| Some((name?, owner)))
        .filter(|(name, _)| !is_module(name))
        .collect()
}

/// The word that a path of a module at this depth names in the crate's root.
fn first_in_crate(words: &[String], depth: usize) -> Option<&str> {
    let climbs = words.iter().take_while(|word| *word == "super").count();
    let is_from_root = words.first().is_some_and(|word| word == "crate");
    let start = match climbs {
        0 if is_from_root => 1,
        _ if climbs > 0 && climbs == depth => climbs,
        _ => return None,
    };
    words.get(start).map(String::as_str)
}

/// A path of the code: its words, the name that it gets by `as`, the line of its first word below the root.
#[derive(Debug, PartialEq, Eq)]
struct Used {
    words: Vec<String>,
    alias: Option<String>,
    line: usize,
}

/// Every path of two words or more outside tests, comments and strings; groups in braces are written out.
fn paths(text: &str) -> Vec<Used> {
    let kept: BTreeMap<usize, &str> = lines_without_tests(text).into_iter().collect();
    let mut outside_tests = String::new();
    for line in 1..=text.lines().count() {
        outside_tests.push_str(kept.get(&line).unwrap_or(&""));
        outside_tests.push('\n');
    }
    let code = code_only(&outside_tests);
    let tokens = tokens(&code);
    let mut found = Vec::new();
    let mut next = 0;
    while next < tokens.len() {
        next = read_path(&tokens, next, &[], &mut found).max(next + 1);
    }
    found
}

/// A word, `::` or one other character, and its line.
type Token<'a> = (&'a str, usize);

fn tokens(code: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    for (line, text) in (1..).zip(code.lines()) {
        let mut rest = text.trim_start();
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_alphanumeric() || c == '_';
            let length = match first {
                _ if rest.starts_with("::") => 2,
                _ if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
                _ => first.len_utf8(),
            };
            tokens.push((&rest[..length], line));
            rest = rest[length..].trim_start();
        }
    }
    tokens
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphanumeric() || c == '_')
}

/// Reads the path that begins at `start` behind the words of `before`; returns the index behind it.
fn read_path(tokens: &[Token<'_>], start: usize, before: &[Token<'_>], found: &mut Vec<Used>) -> usize {
    let at = |index: usize| tokens.get(index).map_or("", |(token, _)| *token);
    let mut words = before.to_vec();
    let mut next = start;
    while is_word(at(next)) || at(next) == "*" && !words.is_empty() {
        words.push(tokens[next]);
        next += 1;
        if at(next) != "::" {
            break;
        }
        next += 1;
    }
    if at(next) == "{" && at(next.wrapping_sub(1)) == "::" {
        next += 1;
        while next < tokens.len() && at(next) != "}" {
            next = read_path(tokens, next, &words, found).max(next + 1);
        }
        return next + 1;
    }
    let is_named = at(next) == "as" && is_word(at(next + 1));
    let alias = is_named.then(|| at(next + 1).to_owned());
    if words.len() > 1 {
        let climbs = words.iter().take_while(|(word, _)| matches!(*word, "crate" | "super" | "self")).count();
        let line = words[climbs.min(words.len() - 1)].1;
        let words = words.into_iter().filter(|(word, _)| *word != "self").map(|(word, _)| word.to_owned());
        found.push(Used { words: words.collect(), alias, line });
    }
    if is_named { next + 2 } else { next }
}

/// The shortest circle of every knot of modules, in the order of their names.
fn circles(graph: &Graph) -> Vec<Vec<Edge>> {
    let mut found: Vec<Vec<Edge>> = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    for module in graph.keys() {
        if told.contains(&module.as_str()) {
            continue;
        }
        let knot: Vec<&str> = reached(graph, module)
            .into_keys()
            .filter(|other| reached(graph, other).contains_key(module.as_str()))
            .collect();
        let shortest = knot.iter().filter_map(|member| circle_through(graph, member)).min_by_key(Vec::len);
        found.extend(shortest);
        told.extend(knot);
    }
    found
}

/// Modules that can be reached by one edge or more, each with the last edge of the shortest way there.
fn reached<'a>(graph: &'a Graph, start: &str) -> BTreeMap<&'a str, &'a Edge> {
    let mut last = BTreeMap::new();
    let mut waiting = VecDeque::from([start]);
    while let Some(module) = waiting.pop_front() {
        for (to, edge) in graph.get(module).into_iter().flatten() {
            if !last.contains_key(to.as_str()) {
                last.insert(to.as_str(), edge);
                waiting.push_back(to.as_str());
            }
        }
    }
    last
}

/// The shortest circle through a module.
fn circle_through(graph: &Graph, module: &str) -> Option<Vec<Edge>> {
    let last = reached(graph, module);
    let mut circle = vec![(*last.get(module)?).clone()];
    while circle[0].from != module {
        let before = last.get(circle[0].from.as_str()).expect("the way there is complete");
        circle.insert(0, (*before).clone());
    }
    Some(circle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIB: (&str, &str) =
        ("crates/laws/src/lib.rs", "mod a;\nmod b;\nmod c;\npub use b::{B, Inner as Outer};\n");

    fn messages(files: &[(&str, &str)]) -> Vec<String> {
        let tree = Tree::made_up(&[&[LIB], files].concat());
        problems_of_crate(&tree, "laws").into_iter().map(|problem| problem.message).collect()
    }

    #[test]
    fn a_circle_is_named_with_one_place_for_each_edge() {
        let found = messages(&[
            ("crates/laws/src/a.rs", "use std::fmt;\nuse crate::b::B;\n"),
            ("crates/laws/src/b/mod.rs", "mod deep;\nuse crate::{\n    c::C,\n};\n"),
            ("crates/laws/src/b/deep.rs", "fn f() {}\n"),
            ("crates/laws/src/c.rs", "fn f() {\n    crate::a::g();\n}\n"),
        ]);
        assert_eq!(
            found,
            ["circle of modules: a uses b (crates/laws/src/a.rs:2), b uses c (crates/laws/src/b/mod.rs:3), \
              c uses a (crates/laws/src/c.rs:2); move what both need below them"]
        );
    }

    #[test]
    fn one_direction_is_no_circle() {
        let found = messages(&[
            ("crates/laws/src/a.rs", "use crate::b::B;\nuse crate::c::C;\n"),
            ("crates/laws/src/b.rs", "use crate::c::C;\n"),
            ("crates/laws/src/c.rs", "use std::fmt;\n"),
        ]);
        assert_eq!(found, [""; 0]);
    }

    #[test]
    fn re_exports_of_the_root_stand_for_their_modules() {
        for used in ["crate::B", "crate::Outer", "crate::{fmt, B}"] {
            let text = format!("use {used};\n");
            let found =
                messages(&[("crates/laws/src/a.rs", &text), ("crates/laws/src/b.rs", "use crate::a::A;\n")]);
            assert_eq!(found.len(), 1, "{used}");
        }
        let text = "use crate::Inner;\n";
        let found =
            messages(&[("crates/laws/src/a.rs", text), ("crates/laws/src/b.rs", "use crate::a::A;\n")]);
        assert_eq!(found, [""; 0]);
    }

    #[test]
    fn super_is_followed_to_the_root_only() {
        let with = |text: &str| {
            messages(&[
                ("crates/laws/src/a/mod.rs", "mod deep;\nmod c;\n"),
                ("crates/laws/src/a/deep.rs", text),
                ("crates/laws/src/c.rs", "use super::a::A;\n"),
            ])
            .len()
        };
        assert_eq!(with("use super::super::c::C;\n"), 1);
        assert_eq!(with("use super::super::{B, c::{C, D}};\n"), 1);
        assert_eq!(with("use super::c::C;\n"), 0);
    }

    #[test]
    fn tests_comments_and_strings_make_no_edges() {
        let found = messages(&[
            (
                "crates/laws/src/a.rs",
                "// crate::b::B\nconst A: &str = \"crate::b\";\n\
                 #[cfg(test)]\nmod tests {\n    use crate::b::B;\n}\n",
            ),
            ("crates/laws/src/a/tests.rs", "use crate::b::B;\n"),
            ("crates/laws/src/b.rs", "use crate::a::A;\n"),
        ]);
        assert_eq!(found, [""; 0]);
    }

    #[test]
    fn each_knot_is_told_once_by_its_shortest_circle() {
        let found = messages(&[
            ("crates/laws/src/a.rs", "use crate::b::B;\n"),
            ("crates/laws/src/b.rs", "use crate::{c::C, d::D};\n"),
            ("crates/laws/src/c.rs", "use crate::a::A;\nuse crate::b::B;\n"),
            ("crates/laws/src/d.rs", "use std::fmt;\n"),
        ]);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("b uses c") && found[0].contains("c uses b"), "{}", found[0]);
    }
}
