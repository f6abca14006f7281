//! Places of a scene's keys, for messages of checks that are made after it was read.

use crate::tree::{Entries, Node, Value};

/// Lists whose items stand in the order of their names, whatever that of the file.
const SORTED: [&str; 2] = ["feeds", "outlets"];

/// Places and values of the keys of all sections.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct KeyPlaces(Vec<Section>);

/// Section, or item of one that is a list.
#[derive(Clone, Debug, PartialEq)]
struct Section {
    section: String,
    /// Path of its keys: `feeds[0]`.
    path: String,
    node: Node,
}

impl Section {
    /// Node of a key.
    fn key(&self, name: &str) -> Option<&Node> {
        let Value::Table(entries) = &self.node.value else { return None };
        entries.iter().find(|(known, _)| known == name).map(|(_, node)| node)
    }

    /// Name that the section gives itself.
    fn name(&self) -> &str {
        match self.key("name").map(|node| &node.value) {
            Some(Value::Text(name)) => name,
            _ => "",
        }
    }
}

impl KeyPlaces {
    /// Places of a scene's keys.
    pub(super) fn new(entries: &Entries) -> Self {
        let mut all = Vec::new();
        for (section, node) in entries {
            let of =
                |path: String, node: &Node| Section { section: section.clone(), path, node: node.clone() };
            let Value::Array(items) = &node.value else {
                all.push(of(section.clone(), node));
                continue;
            };
            let numbered = items.iter().enumerate();
            let mut found: Vec<_> =
                numbered.map(|(number, item)| of(format!("{section}[{number}]"), item)).collect();
            if SORTED.contains(&section.as_str()) {
                found.sort_by(|a, b| a.name().cmp(b.name()));
            }
            all.extend(found);
        }
        Self(all)
    }

    /// Place and value of a key, as a message begins with them: the first of several names that is there.
    /// `number` counts the items of a list in the order of the scene. `None` where the text has no such
    /// section.
    pub(super) fn cite(&self, section: &str, number: usize, names: &[&str]) -> Option<String> {
        let of = self.0.iter().filter(|of| of.section == section).nth(number)?;
        let given = names.iter().find_map(|name| Some((*name, of.key(name)?)));
        Some(match (given, names) {
            (Some((name, node)), _) => format!("{}: {}.{name} = {}", node.place, of.path, node.shown()),
            (None, [name, ..]) => format!("{}: {}.{name}", of.node.place, of.path),
            (None, []) => format!("{}: {}", of.node.place, of.path),
        })
    }
}
