//! Check of a whole document by a table of keys.

use super::SceneTable;
use crate::SceneError;
use crate::error::Problems;
use crate::keys::Key;
use crate::tree::{Origin, parse_document};

/// Checks the keys of a document, whether they are known, required and of a value that they take; `file` is
/// its name in messages.
///
/// # Errors
/// All problems that there are, each with its place.
pub fn check_keys(file: &str, text: &str, keys: &'static [Key]) -> Result<(), SceneError> {
    let origin = Origin::File(file.into());
    let entries = parse_document(&origin, text)?;
    let mut problems = Problems::default();
    if let Some(document) = problems.keep(SceneTable::document(&entries, origin.line(0), keys)) {
        check_table(&document, &mut problems);
    }
    problems.finish()
}

fn check_table(table: &SceneTable<'_>, problems: &mut Problems) {
    for name in table.known() {
        if problems.keep(table.check(name)).is_none() {
            continue;
        }
        if let Some(Some(below)) = problems.keep(table.table(name)) {
            check_table(&below, problems);
        }
        for item in problems.keep(table.tables(name)).flatten().into_iter().flatten() {
            if let Some(item) = problems.keep(item) {
                check_table(&item, problems);
            }
        }
    }
}
