//! Files of grains, of which the content tells the form.

use super::dump::read_dump;
use super::grains::GrainContext;
use super::names::MaterialNames;
use super::snapshot::{FileChoices, Snapshot, SnapshotOptions};
use super::text_table::{COMMENT, read_charge_column, read_table};
use super::vtk_legacy::read_legacy;
use super::vtk_xml::read_xml;
use super::words::cut_off;
use crate::SceneError;
use crate::source::{open_alone, unpack};
use std::io::{BufRead, Cursor, Read};
use std::path::Path;

/// Bytes at the beginning of a file by which its form is told.
const HEAD: u64 = 1 << 16;

/// First bytes of files that are not read, and what to do about them.
const REFUSED: [(&[u8], &str); 6] = [
    (b"\x28\xb5\x2f\xfd", "it is compressed with zstd; unpack it, or compress it with gzip"),
    (b"BZh", "it is compressed with bzip2; unpack it, or compress it with gzip"),
    (b"\xfd7zXZ", "it is compressed with xz; unpack it, or compress it with gzip"),
    (b"PK\x03\x04", "it is a ZIP archive or a workbook; save the table as CSV"),
    (b"\xff\xfe", "it is text in UTF-16; save it as UTF-8"),
    (b"\xfe\xff", "it is text in UTF-16; save it as UTF-8"),
];

/// Form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// Table with a header row.
    Table,
    /// Text dump of LAMMPS or LIGGGHTS.
    Dump,
    /// Legacy VTK file.
    VtkLegacy,
    /// XML file of VTK.
    VtkXml,
}

impl Form {
    /// Form of a file by its beginning.
    ///
    /// # Errors
    /// What to do about a form that is not read.
    fn of(head: &[u8]) -> Result<Self, &'static str> {
        if let Some((_, advice)) = REFUSED.iter().find(|(magic, _)| head.starts_with(magic)) {
            return Err(advice);
        }
        // A binary dump begins with the length of its name, which is negative.
        if [&b"DUMPATOM"[..], b"DUMPCUSTOM"]
            .iter()
            .any(|magic| head.get(8..).unwrap_or_default().starts_with(magic))
        {
            return Err("it is a binary dump; write a text dump, or convert it with binary2txt of LAMMPS");
        }
        let text = head.trim_ascii_start();
        if text.starts_with(b"ITEM:") {
            return Ok(Self::Dump);
        }
        if text.starts_with(b"# vtk") {
            return Ok(Self::VtkLegacy);
        }
        if text.starts_with(b"<?xml") || text.starts_with(b"<VTKFile") {
            return Ok(Self::VtkXml);
        }
        let is_data_file = |line: &[u8]| line.ends_with(b"xlo xhi");
        if text.split(|byte| *byte == b'\n').take(40).any(|line| is_data_file(line.trim_ascii_end())) {
            return Err("it is a data file of LAMMPS; write a dump with id type x y z radius q instead");
        }
        Ok(Self::Table)
    }
}

/// Content of a file, unpacked, without a byte-order mark.
struct Content<'r> {
    /// Beginning of the content.
    head: Vec<u8>,
    reader: Box<dyn BufRead + 'r>,
}

impl<'r> Content<'r> {
    fn open(file: &str, reader: impl BufRead + 'r) -> Result<Self, SceneError> {
        let cut = |error| cut_off(file, &error);
        let mut reader = unpack(reader).map_err(cut)?;
        let mut head = Vec::new();
        (&mut reader).take(HEAD).read_to_end(&mut head).map_err(cut)?;
        if head.starts_with(b"\xef\xbb\xbf") {
            head.drain(..3);
        }
        if head.starts_with(b"sep=") {
            // Excel's own first line says no more than the header row does.
            head.insert(0, COMMENT);
        }
        if head.is_empty() {
            return Err(SceneError::file(file, "there is nothing in it; check that it was written"));
        }
        Ok(Self { head, reader })
    }

    /// Beginning of the content, and a reader of all of it.
    fn parts(self) -> (Vec<u8>, impl BufRead + 'r) {
        (self.head.clone(), Cursor::new(self.head).chain(self.reader))
    }
}

/// Reads the grains of a file of any form.
///
/// # Errors
/// Forms that are not read, and bad values with their place.
pub(crate) fn read_grains(
    file: &str,
    reader: impl BufRead,
    choices: &FileChoices,
    context: &GrainContext<'_>,
) -> Result<Snapshot, SceneError> {
    let content = Content::open(file, reader)?;
    let form = Form::of(&content.head).map_err(|advice| SceneError::file(file, advice))?;
    let (head, reader) = content.parts();
    match form {
        Form::Table => {
            let refused = [
                (
                    choices.units.is_some(),
                    "units is for dumps and VTK files; a table names its units in its columns",
                ),
                (choices.step.is_some(), "step is for files with several frames; a table has one"),
            ];
            if let Some((_, problem)) = refused.iter().find(|(is_given, _)| *is_given) {
                return Err(SceneError::file(file, format!("{problem}; leave it out")));
            }
            read_table(file, &head, reader, context)
        }
        Form::Dump => read_dump(file, reader, choices, context),
        Form::VtkLegacy | Form::VtkXml => {
            if choices.step.is_some() {
                let problem = "step is for files with several frames; a VTK file has one; leave it out";
                return Err(SceneError::file(file, problem));
            }
            let mut bytes = Vec::new();
            { reader }.read_to_end(&mut bytes).map_err(|error| cut_off(file, &error))?;
            let bytes = bytes.trim_ascii_start();
            let points = if form == Form::VtkXml { read_xml(file, bytes) } else { read_legacy(file, bytes) }?;
            points.grains(file, choices, context)
        }
    }
}

/// Reads the column `charge_C` [C] of a table for a generator, one row per grain.
///
/// # Errors
/// As [`read_grains`]; another number of rows than grains.
pub(crate) fn read_charges(file: &str, bytes: &[u8], count: usize) -> Result<Vec<f64>, SceneError> {
    let content = Content::open(file, bytes)?;
    match Form::of(&content.head).map_err(|advice| SceneError::file(file, advice))? {
        Form::Table => {
            let (head, reader) = content.parts();
            read_charge_column(file, &head, reader, count)
        }
        _ => Err(SceneError::file(file, "it is no table; give one with the column charge_C")),
    }
}

impl Snapshot {
    /// Reads the grains of a file: a table in text, a text dump of LAMMPS or LIGGGHTS, or a VTK file, also
    /// packed by gzip. Its content tells the form.
    ///
    /// # Errors
    /// Files that cannot be read, bad values with their place, and units and steps that must be chosen.
    pub fn read(path: &Path, options: &SnapshotOptions) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let choices = FileChoices { units: options.units, step: options.step };
        let materials = MaterialNames::File { by_type: &options.materials_by_type };
        let context = GrainContext { domain: None, materials, allow_points: true };
        read_grains(&file, open_alone(path)?, &choices, &context)
    }
}
