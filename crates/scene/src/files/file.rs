//! File that the program writes.

use super::{Column, When};

/// File that the program writes.
#[derive(Clone, Copy, Debug)]
pub struct FileTable {
    /// Path in the folder of the results; parts in capitals stand for words and numbers that differ.
    pub path: &'static str,
    /// Form of the content.
    pub form: Form,
    /// Condition under which the file is written; empty where there is none.
    pub when: &'static str,
    /// Sentences about the file.
    pub meaning: &'static str,
    /// Columns in their order; empty where the file has none.
    pub columns: &'static [Column],
}

/// Form of a file's content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Comma-separated values with a heading.
    Csv,
    /// VTK unstructured grid.
    Vtu,
    /// JSON object.
    Json,
    /// Any other.
    Other,
}

impl Form {
    /// Word for a column of the form.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Csv | Self::Other => "column",
            Self::Vtu => "array",
            Self::Json => "key",
        }
    }
}

impl FileTable {
    /// Comma-separated values that are always written.
    pub(super) const fn csv(path: &'static str, meaning: &'static str, columns: &'static [Column]) -> Self {
        Self { path, form: Form::Csv, when: "", meaning, columns }
    }

    /// File without columns.
    pub(super) const fn plain(path: &'static str, meaning: &'static str) -> Self {
        Self { path, form: Form::Other, when: "", meaning, columns: &[] }
    }

    /// Sets the form.
    pub(super) const fn form(mut self, form: Form) -> Self {
        self.form = form;
        self
    }

    /// Sets the condition under which the file is written.
    pub(super) const fn when(mut self, when: &'static str) -> Self {
        self.when = when;
        self
    }

    /// Names of all columns whose condition holds, in their order.
    pub fn names(&self, holds: impl Fn(When) -> bool) -> impl Iterator<Item = &'static str> {
        self.columns.iter().filter(move |column| holds(column.when)).flat_map(|column| column.names).copied()
    }

    /// Heading of a file that has the same columns in every run.
    #[must_use]
    pub fn heading(&self) -> Vec<String> {
        self.names(|when| when == When::Always).map(ToOwned::to_owned).collect()
    }

    /// Whether the file may have a column, array or key of this name.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.names(|_| true).any(|pattern| fits(pattern, name))
    }

    /// Whether a path is one of this file; folders before it do not matter.
    #[must_use]
    pub fn is_at(&self, path: &str) -> bool {
        let parts: Vec<&str> = path.split('/').collect();
        let patterns: Vec<&str> = self.path.split('/').collect();
        parts.len() >= patterns.len()
            && parts[parts.len() - patterns.len()..]
                .iter()
                .zip(&patterns)
                .all(|(part, pattern)| fits(pattern, part))
    }
}

/// Whether a name is one of a pattern, in which words in capitals stand for any characters.
fn fits(pattern: &str, name: &str) -> bool {
    const WORDS: [&str; 6] = ["STAGE", "STEP", "NAME", "OUTLET", "DATE", "LIMIT"];
    let places = WORDS.iter().filter_map(|word| Some((pattern.find(word)?, word.len())));
    let Some((start, length)) = places.min() else { return pattern == name };
    let after = &pattern[start + length..];
    let Some(rest) = name.strip_prefix(&pattern[..start]) else { return false };
    (0..=rest.len()).any(|end| rest.is_char_boundary(end) && fits(after, &rest[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_in_capitals_stand_for_anything() {
        assert!(fits("particles_STEP.vtu", "particles_012.vtu") && !fits("a_STEP.vtu", "a_1.csv"));
        assert!(fits("DATE-NAME-extremes.csv", "2026-01-31-x-extremes.csv"));
        assert!(fits("step", "step") && !fits("step", "steps"));
        let file = FileTable::plain("particles/grains_STEP.vtu", "");
        assert!(file.is_at("a/b/particles/grains_1.vtu") && !file.is_at("grains_1.vtu"));
    }
}
