//! Lists of tables, as `[[feeds]]`.

use super::SceneTable;
use crate::keys::Key;
use crate::tree::{Entries, Node, Value};

/// Removes lists of tables that have no item: they mean what their absence means.
pub(crate) fn drop_empty_lists(entries: &mut Entries, keys: &[Key]) {
    let form_of = |name: &str| keys.iter().find(|key| key.name == name).map(|key| key.form);
    entries.retain(|(name, node)| {
        let is_empty = matches!(&node.value, Value::Array(items) if items.is_empty());
        !(is_empty && form_of(name).is_some_and(|form| form.is_list()))
    });
    for (name, node) in entries {
        let below = form_of(name).map_or(&[][..], |form| form.keys());
        match &mut node.value {
            Value::Table(inner) => drop_empty_lists(inner, below),
            Value::Array(items) => items.iter_mut().for_each(|item| {
                if let Value::Table(inner) = &mut item.value {
                    drop_empty_lists(inner, below);
                }
            }),
            _ => {}
        }
    }
}

impl SceneTable<'_> {
    /// Reason why a value is no list of tables, and what to write.
    pub(super) fn refuse_as_list(&self, name: &str, node: &Node) -> Option<String> {
        let path = self.key(name);
        // The numbers of items are not written.
        let heading = path.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest));
        (!matches!(node.value, Value::Array(_))).then(|| {
            format!(
                "expected tables, got {}; write [[{}]] once for each, with its keys below it",
                node.kind(),
                heading.collect::<String>()
            )
        })
    }
}
