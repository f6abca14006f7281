//! Legacy VTK files (`# vtk DataFile`), in text or binary, as LIGGGHTS and its tools write them.
//!
//! Points are read with the arrays of their data, from polygonal data and unstructured grids. The form is
//! described in "VTK file formats" of the VTK user's guide.

use super::vtk_numbers::NumberType;
use super::vtk_points::{VtkArray, VtkPoints, VtkValues};
use crate::SceneError;
use crate::error::shorten;
use std::borrow::Cow;

/// Place in a file, from which words and numbers are taken.
struct Cursor<'b> {
    file: &'b str,
    bytes: &'b [u8],
    at: usize,
    is_binary: bool,
}

/// Reads a legacy VTK file.
///
/// # Errors
/// Other data than points, and files that are cut short or damaged.
pub(super) fn read_legacy(file: &str, bytes: &[u8]) -> Result<VtkPoints, SceneError> {
    let mut cursor = Cursor { file, bytes, at: 0, is_binary: false };
    cursor.line();
    cursor.line();
    cursor.is_binary = match cursor.line().trim().to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        other => {
            return Err(cursor.bad(&format!("the third line is \"{}\", not ASCII or BINARY", shorten(other))));
        }
    };
    let mut places = None;
    let mut arrays = Vec::new();
    // Number of entries of the arrays that follow, and whether they are the points'.
    let mut of_points = None;
    while let Some(word) = cursor.word() {
        match word.to_ascii_uppercase().as_str() {
            "DATASET" => match cursor.word().unwrap_or_default().to_ascii_uppercase().as_str() {
                "POLYDATA" | "UNSTRUCTURED_GRID" => {}
                other => {
                    let problem = format!(
                        "a dataset {}; only POLYDATA and UNSTRUCTURED_GRID have grains",
                        shorten(other)
                    );
                    return Err(cursor.bad(&problem));
                }
            },
            "POINTS" => {
                let count = cursor.count()?;
                let kind = cursor.number_type()?;
                let values = cursor.values(kind, count, 3)?;
                places = Some(VtkArray { name: "POINTS".to_owned(), components: 3, values });
            }
            "POINT_DATA" => of_points = Some((true, cursor.count()?)),
            "CELL_DATA" => of_points = Some((false, cursor.count()?)),
            keyword => match of_points {
                Some((is_points, count)) => {
                    let read = cursor.attribute(keyword, count)?;
                    arrays.extend(read.into_iter().filter(|_| is_points));
                }
                None => cursor.skip(keyword)?,
            },
        }
    }
    match places {
        Some(places) => Ok(VtkPoints { places, arrays, materials: Vec::new(), groups: Vec::new() }),
        None => Err(cursor.bad("no POINTS")),
    }
}

impl<'b> Cursor<'b> {
    /// Error of the file.
    fn bad(&self, problem: &str) -> SceneError {
        SceneError::file(self.file, format!("{problem}; check the file (at byte {})", self.at))
    }

    /// Rest of the line.
    fn line(&mut self) -> Cow<'b, str> {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
        self.at += end;
        String::from_utf8_lossy(&rest[..end])
    }

    /// Next word; `None` at the end.
    fn word(&mut self) -> Option<Cow<'b, str>> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + length;
        Some(String::from_utf8_lossy(&rest[start..start + length]))
    }

    fn count(&mut self) -> Result<usize, SceneError> {
        let word = self.word().unwrap_or_default();
        word.parse().map_err(|_| self.bad(&format!("\"{}\" is no count", shorten(&word))))
    }

    fn number_type(&mut self) -> Result<NumberType, SceneError> {
        let word = self.word().unwrap_or_default();
        NumberType::named(&word)
            .ok_or_else(|| self.bad(&format!("\"{}\" is no type of numbers", shorten(&word))))
    }

    /// Numbers of entries.
    fn values(&mut self, kind: NumberType, count: usize, components: usize) -> Result<VtkValues, SceneError> {
        let cut = |cursor: &Self| {
            cursor.bad(&format!("{count} times {components} numbers were promised: cut short"))
        };
        let numbers = count.checked_mul(components).ok_or_else(|| cut(self))?;
        if self.is_binary {
            // Data begin behind the end of the line.
            self.line();
            let end = numbers.checked_mul(kind.size()).and_then(|length| length.checked_add(self.at));
            let bytes = end.and_then(|end| self.bytes.get(self.at..end)).ok_or_else(|| cut(self))?;
            self.at += bytes.len();
            return Ok(kind.of_bytes(bytes, true));
        }
        if numbers > self.bytes.len() - self.at {
            return Err(cut(self));
        }
        let mut words = Vec::with_capacity(numbers);
        for _ in 0..numbers {
            words.push(self.word().ok_or_else(|| cut(self))?);
        }
        kind.of_words(words.iter().map(AsRef::as_ref))
            .map_err(|word| self.bad(&format!("\"{}\" is no number of its type", shorten(word))))
    }

    /// Passes over cells, metadata and fields before the data of points.
    fn skip(&mut self, keyword: &str) -> Result<(), SceneError> {
        match keyword {
            "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS" => {
                let (first, second) = (self.count()?, self.count()?);
                let start = self.at;
                match self.word().as_deref() {
                    // Since version 5.1 there are two lists, each with its type.
                    Some("OFFSETS" | "offsets") => {
                        let kind = self.number_type()?;
                        self.values(kind, first, 1)?;
                        self.word();
                        let kind = self.number_type()?;
                        self.values(kind, second, 1)?;
                    }
                    _ => {
                        self.at = start;
                        self.values(NumberType::I32, second, 1)?;
                    }
                }
                Ok(())
            }
            "CELL_TYPES" => {
                let count = self.count()?;
                self.values(NumberType::I32, count, 1).map(drop)
            }
            "FIELD" | "METADATA" => self.attribute(keyword, 0).map(drop),
            other => Err(self.bad(&format!("\"{}\" where a section should begin", shorten(other)))),
        }
    }

    /// Arrays of an attribute of entries.
    fn attribute(&mut self, keyword: &str, count: usize) -> Result<Vec<VtkArray>, SceneError> {
        let name = match keyword {
            "METADATA" => {
                // It ends with an empty line.
                self.line();
                while self.at < self.bytes.len() && !self.line().trim().is_empty() {}
                return Ok(Vec::new());
            }
            _ => self.word().unwrap_or_default().into_owned(),
        };
        let array = |values, components| vec![VtkArray { name: name.clone(), components, values }];
        match keyword {
            "SCALARS" => {
                let kind = self.number_type()?;
                let rest = self.rest_of_line();
                let components = if rest.is_empty() { 1 } else { rest.parse().unwrap_or(0) };
                if !(1..=4).contains(&components) {
                    return Err(
                        self.bad(&format!("{name} has \"{}\" components, not 1 to 4", shorten(&rest)))
                    );
                }
                let start = self.at;
                if self.word().is_some_and(|word| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
                    self.word();
                } else {
                    self.at = start;
                }
                Ok(array(self.values(kind, count, components)?, components))
            }
            "VECTORS" | "NORMALS" => {
                let kind = self.number_type()?;
                Ok(array(self.values(kind, count, 3)?, 3))
            }
            "TENSORS" => {
                let kind = self.number_type()?;
                Ok(array(self.values(kind, count, 9)?, 9))
            }
            "TEXTURE_COORDINATES" => {
                let components = self.count()?;
                let kind = self.number_type()?;
                Ok(array(self.values(kind, count, components)?, components))
            }
            "LOOKUP_TABLE" => {
                let colours = self.count()?;
                let kind = if self.is_binary { NumberType::U8 } else { NumberType::F64 };
                self.values(kind, colours, 4)?;
                Ok(Vec::new())
            }
            "FIELD" => self.field(),
            other => Err(self.bad(&format!("\"{}\" where an array should begin", shorten(other)))),
        }
    }

    /// Arrays of a field.
    fn field(&mut self) -> Result<Vec<VtkArray>, SceneError> {
        let mut arrays = Vec::new();
        for _ in 0..self.count()? {
            let mut name = self.word();
            while name.as_deref() == Some("METADATA") {
                self.attribute("METADATA", 0)?;
                name = self.word();
            }
            let Some(name) = name else { return Err(self.bad("a field is cut short")) };
            let (components, count) = (self.count()?, self.count()?);
            let word = self.word().unwrap_or_default();
            if word == "string" {
                self.line();
                for _ in 0..count.saturating_mul(components) {
                    if self.at == self.bytes.len() {
                        return Err(self.bad("a field is cut short"));
                    }
                    self.line();
                }
                continue;
            }
            let kind = NumberType::named(&word)
                .ok_or_else(|| self.bad(&format!("\"{}\" is no type of numbers", shorten(&word))))?;
            let values = self.values(kind, count, components)?;
            arrays.push(VtkArray { name: name.into_owned(), components, values });
        }
        Ok(arrays)
    }

    /// Rest of a line, which is not passed in binary data of the next.
    fn rest_of_line(&mut self) -> String {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.at += end;
        String::from_utf8_lossy(&rest[..end]).trim().to_owned()
    }
}
