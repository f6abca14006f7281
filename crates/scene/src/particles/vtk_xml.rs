//! XML files of VTK (`.vtu`, `.vtp`): ours, and those of LIGGGHTS and VTK itself.
//!
//! Arrays may stand in the text, or behind it as they are or in base64, also compressed with zlib.

use super::vtk_blocks::Blocks;
use super::vtk_numbers::NumberType;
use super::vtk_points::{VtkArray, VtkPoints, VtkValues};
use super::xml_tags::{Tag, Tags};
use crate::SceneError;
use crate::error::shorten;

/// Section of a file in which an array stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    Points,
    PointData,
    FieldData,
    /// Section that says nothing of the points.
    Another,
}

/// Reader of an XML file of VTK.
struct XmlReader<'b> {
    blocks: Blocks<'b>,
    section: Section,
    /// Number of points of the piece; `None` before it.
    count: Option<usize>,
    places: Option<VtkArray>,
    arrays: Vec<VtkArray>,
    materials: Vec<String>,
    groups: Vec<String>,
}

/// Reads an XML file of VTK.
///
/// # Errors
/// Other data than points, compressions other than zlib, and files that are cut short or damaged.
pub(super) fn read_xml(file: &str, bytes: &[u8]) -> Result<VtkPoints, SceneError> {
    let refuse = |problem: String| SceneError::file(file, problem);
    let (text, blocks) = Blocks::split(bytes);
    let text = std::str::from_utf8(text)
        .map_err(|_| refuse("its XML is not UTF-8 text; check that it was written whole".to_owned()))?;
    let mut reader = XmlReader {
        blocks,
        section: Section::Another,
        count: None,
        places: None,
        arrays: Vec::new(),
        materials: Vec::new(),
        groups: Vec::new(),
    };
    for tag in Tags::new(text) {
        reader.take(&tag).map_err(refuse)?;
    }
    let XmlReader { count, places, arrays, materials, groups, .. } = reader;
    match (count, places) {
        (Some(count), Some(places)) if places.components == 3 && places.values.len() / 3 == count => {
            Ok(VtkPoints { places, arrays, materials, groups })
        }
        (Some(count), Some(places)) => {
            let numbers = places.values.len();
            Err(refuse(format!("{numbers} numbers for the places of {count} points; check the file")))
        }
        _ => Err(refuse("the file has no piece with points; check that it was written whole".to_owned())),
    }
}

impl XmlReader<'_> {
    /// Takes in a tag with the text behind it.
    fn take(&mut self, tag: &Tag<'_>) -> Result<(), String> {
        match tag.name {
            "VTKFile" => {
                let kind = tag.attribute("type").unwrap_or_default();
                if !matches!(kind, "UnstructuredGrid" | "PolyData") {
                    return Err(format!(
                        "a VTK file of type \"{}\"; only UnstructuredGrid and PolyData have grains; name \
                                        one of the files that it lists, if it is a list",
                        shorten(kind)
                    ));
                }
                self.blocks.configure(tag)
            }
            "Piece" => {
                let count = tag.attribute("NumberOfPoints").and_then(|text| text.trim().parse().ok());
                let count = count.ok_or("a piece without NumberOfPoints; check the file")?;
                if self.count.is_some_and(|before| before > 0) && count > 0 {
                    return Err("several pieces with points; merge them, for example in ParaView".to_owned());
                }
                if count > 0 || self.count.is_none() {
                    (self.count, self.places) = (Some(count), None);
                    self.arrays.clear();
                }
                Ok(())
            }
            "Points" => self.enter(Section::Points),
            "PointData" => self.enter(Section::PointData),
            "FieldData" => self.enter(Section::FieldData),
            "/Points" | "/PointData" | "/FieldData" | "CellData" | "Cells" | "Verts" | "Lines" | "Strips"
            | "Polys" => self.enter(Section::Another),
            "DataArray" | "Array" => self.array(tag),
            _ => Ok(()),
        }
    }

    fn enter(&mut self, section: Section) -> Result<(), String> {
        self.section = section;
        Ok(())
    }

    /// Reads an array of the present section.
    fn array(&mut self, tag: &Tag<'_>) -> Result<(), String> {
        let name = tag.attribute("Name").unwrap_or_default();
        match self.section {
            Section::Another => Ok(()),
            Section::FieldData => {
                match name {
                    "materials" => self.materials = texts(tag)?,
                    "groups" => self.groups = texts(tag)?,
                    _ => {}
                }
                Ok(())
            }
            // Empty pieces are passed over.
            Section::Points | Section::PointData if self.count.is_none_or(|count| count == 0) => Ok(()),
            Section::Points => {
                self.places = Some(self.numbers(name, tag)?);
                Ok(())
            }
            Section::PointData => {
                if tag.attribute("type") != Some("String") {
                    let array = self.numbers(name, tag)?;
                    self.arrays.push(array);
                }
                Ok(())
            }
        }
    }

    fn numbers(&self, name: &str, tag: &Tag<'_>) -> Result<VtkArray, String> {
        let about = |problem: &str| format!("array {}: {problem}", shorten(name));
        let kind = tag.attribute("type").unwrap_or_default();
        let kind = NumberType::named(kind)
            .ok_or_else(|| about(&format!("\"{}\" is no type of numbers", shorten(kind))))?;
        let components = match tag.attribute("NumberOfComponents") {
            Some(text) => text.trim().parse().map_err(|_| about("NumberOfComponents is no number"))?,
            None => 1,
        };
        let values = match tag.attribute("format").unwrap_or("ascii") {
            "ascii" => kind
                .of_words(tag.text.split_ascii_whitespace())
                .map_err(|word| about(&format!("\"{}\" is no number of its type", shorten(word))))?,
            "binary" => self.bytes_of(kind, self.blocks.inline(tag.text).map_err(|problem| about(&problem))?),
            "appended" => {
                let offset = tag.attribute("offset").and_then(|text| text.trim().parse().ok());
                let offset = offset.ok_or_else(|| about("no offset"))?;
                self.bytes_of(kind, self.blocks.appended(offset).map_err(|problem| about(&problem))?)
            }
            other => return Err(about(&format!("the format \"{}\" is not known", shorten(other)))),
        };
        Ok(VtkArray { name: name.to_owned(), components, values })
    }

    fn bytes_of(&self, kind: NumberType, bytes: Vec<u8>) -> VtkValues {
        kind.of_bytes(&bytes, self.blocks.is_big_endian())
    }
}

/// Texts of an array of the type String: their bytes as numbers, each text with a 0 at its end.
fn texts(tag: &Tag<'_>) -> Result<Vec<String>, String> {
    let bytes = tag.text.split_ascii_whitespace().map(str::parse::<u8>).collect::<Result<Vec<u8>, _>>();
    let bytes = bytes.map_err(|_| "names are no list of bytes in text; check the file".to_owned())?;
    let mut texts: Vec<String> =
        bytes.split(|byte| *byte == 0).map(|text| String::from_utf8_lossy(text).into_owned()).collect();
    // Behind the last 0 there is nothing.
    texts.pop();
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_another_number_than_promised_are_refused() {
        let text = "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints=\"2\"><Points>\
                    <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray>\
                    </Points></Piece></PolyData></VTKFile>";
        let refused = read_xml("a.vtp", text.as_bytes()).unwrap_err().to_string();
        assert_eq!(refused, "a.vtp: 3 numbers for the places of 2 points; check the file");
        let read = read_xml("a.vtp", text.replace("\"2\"", "\"1\"").as_bytes()).unwrap();
        assert_eq!(read.places.values, VtkValues::Floats(vec![1.0, 2.0, 3.0]));
    }
}
