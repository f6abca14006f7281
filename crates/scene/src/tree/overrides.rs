//! Overrides `--set KEY=VALUE`.

use super::node::{Entries, Node, Place, Value};
use super::parse::parse_with;
use crate::SceneError;
use crate::error::shorten;
use std::sync::Arc;

/// Writes overrides into a document.
///
/// A key is a dotted path, in which array items are counted from 0 (`walls.0.charging`, `walls[0].charging`).
/// A value is TOML; what is not valid TOML is taken as a text.
///
/// # Errors
/// Overrides without `=`, paths through values that have no keys, and array items that do not exist.
pub(crate) fn apply_overrides(document: &mut Entries, overrides: &[String]) -> Result<(), SceneError> {
    for text in overrides {
        let place = Place::Set(text.as_str().into());
        let Some((key, value)) = text.split_once('=') else {
            return Err(SceneError::Override {
                place: place.to_string(),
                problem: "write KEY=VALUE, as in electric_field.tolerance=1e-3".to_owned(),
            });
        };
        let dotted = key.trim().replace('[', ".").replace(']', "");
        let parts: Vec<&str> = dotted.split('.').map(|part| part.trim().trim_matches('"')).collect();
        if parts.iter().any(|part| part.is_empty()) {
            return Err(SceneError::Override {
                place: place.to_string(),
                problem: "the key has an empty part; write it as in electric_field.tolerance".to_owned(),
            });
        }
        set(document, &parts, parse_value(value.trim(), &place), &place, key)?;
    }
    Ok(())
}

/// Reads the value of an override.
fn parse_value(text: &str, place: &Place) -> Node {
    let here = Arc::new(place.clone());
    let line = format!("value = {text}");
    match parse_with(&line, &|_| (*here).clone()) {
        Ok(mut entries) if entries.len() == 1 && entries[0].0 == "value" => entries.remove(0).1,
        // No TOML, or a text with a line break that would add a second key.
        _ => Node { value: Value::Text(text.to_owned()), place: place.clone() },
    }
}

/// Sets the value at a path below a table; adds tables that are not there.
fn set(
    entries: &mut Entries,
    parts: &[&str],
    value: Node,
    place: &Place,
    key: &str,
) -> Result<(), SceneError> {
    let Some((first, rest)) = parts.split_first() else { return Ok(()) };
    let index = match entries.iter().position(|(name, _)| name == first) {
        Some(index) => index,
        None => {
            let table = Node { value: Value::Table(Vec::new()), place: place.clone() };
            entries.push(((*first).to_owned(), table));
            entries.len() - 1
        }
    };
    set_node(&mut entries[index].1, rest, value, place, key)
}

/// Sets the value at a path below a node.
fn set_node(node: &mut Node, rest: &[&str], value: Node, place: &Place, key: &str) -> Result<(), SceneError> {
    let Some((next, after)) = rest.split_first() else {
        *node = value;
        return Ok(());
    };
    let bad = |problem: String| SceneError::Override { place: place.to_string(), problem };
    match &mut node.value {
        Value::Table(entries) => set(entries, rest, value, place, key),
        Value::Array(items) => {
            let count = items.len();
            let item =
                next.parse::<usize>().ok().and_then(|index| items.get_mut(index)).ok_or_else(|| {
                    bad(format!(
                        "{}: '{}' is not one of the {count} items; count them from 0",
                        shorten(key),
                        shorten(next)
                    ))
                })?;
            set_node(item, after, value, place, key)
        }
        _ => Err(bad(format!("{} goes through a value that has no keys; shorten the path", shorten(key)))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::Origin;
    use crate::tree::parse_document;

    fn apply(text: &str, set: &str) -> Result<Entries, SceneError> {
        let mut document = parse_document(&Origin::File("s.toml".into()), text)?;
        apply_overrides(&mut document, &[set.to_owned()])?;
        Ok(document)
    }

    fn find<'a>(entries: &'a Entries, path: &[&str]) -> &'a Node {
        let node = &entries.iter().find(|(key, _)| key == path[0]).unwrap().1;
        match (&node.value, path.len()) {
            (_, 1) => node,
            (Value::Table(inner), _) => find(inner, &path[1..]),
            _ => panic!("no such path"),
        }
    }

    #[test]
    fn value_is_toml_or_text() {
        let document = apply("[a]\nb = 1\n", "a.b=2.5").unwrap();
        assert_eq!(find(&document, &["a", "b"]).value, Value::Float(2.5));
        let document = apply("", "a.b=grounded wall").unwrap();
        assert_eq!(find(&document, &["a", "b"]).value, Value::Text("grounded wall".into()));
        let document = apply("", "a={ c = 3 }").unwrap();
        assert_eq!(find(&document, &["a", "c"]).value, Value::Integer(3));
    }

    #[test]
    fn array_items_are_counted_from_zero() {
        let document = apply("[[w]]\nx = 1\n[[w]]\nx = 2\n", "w.1.x=5").unwrap();
        let Value::Array(items) = &find(&document, &["w"]).value else { panic!("array") };
        let Value::Table(second) = &items[1].value else { panic!("table") };
        assert_eq!(find(second, &["x"]).value, Value::Integer(5));
        assert!(apply("[[w]]\nx = 1\n", "w.7.x=5").is_err());
    }

    #[test]
    fn malformed_overrides_are_refused() {
        for bad in ["novalue", "=3", "a..b=1", "a.b.c=1"] {
            assert!(apply("[a]\nb = 1\n", bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn injected_lines_do_not_become_keys() {
        let document = apply("", "a=1\nb=2").unwrap();
        assert_eq!(document.len(), 1);
    }
}
