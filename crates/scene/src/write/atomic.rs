//! Writing of files that are either complete or absent.

use crate::SceneError;
use crate::files::FileTable;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file under a temporary name beside it, flushes it to the disk and renames it.
///
/// # Errors
/// Errors of the operating system; the file is then as before.
pub fn write_atomically(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), SceneError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(SceneError::unwritable(path, "it is a directory; name a file"));
    }
    if path.exists() && (!path.is_file() || folder == Path::new("/dev")) {
        // Renaming would replace a device or pipe, or the link to one (/dev/stdout), by a file.
        return Err(SceneError::unwritable(path, "it is a device or pipe; name a file"));
    }
    let write = || -> io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".amberfield-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // Others may read the file as far as the umask allows, as for any other output.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let mut writer = BufWriter::with_capacity(1 << 16, builder.tempfile_in(folder)?);
        content(&mut writer)?;
        let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(|error| SceneError::unwritable(path, error))
}

/// Writes the rows of a table as CSV, after a header with the names of the fields.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_table<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), SceneError> {
    write_atomically(path, |writer| {
        let mut table = csv::Writer::from_writer(writer);
        rows.iter().try_for_each(|row| table.serialize(row))?;
        table.flush()
    })
}

/// Writes the rows of a file of the table of files as CSV, after its heading.
///
/// # Errors
/// As [`write_atomically`].
///
/// # Panics
/// When the rows have other fields than the file has columns.
pub fn write_rows<R: Serialize>(path: &Path, file: &FileTable, rows: &[R]) -> Result<(), SceneError> {
    let heading = file.heading();
    if let Some(first) = rows.first() {
        assert_eq!(fields(first), heading.join(","), "the fields of a row are the columns of {}", file.path);
    }
    write_atomically(path, |writer| {
        let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(writer);
        table.write_record(&heading)?;
        rows.iter().try_for_each(|row| table.serialize(row))?;
        table.flush()
    })
}

/// Names of the fields of a row, with commas between them.
fn fields(row: &impl Serialize) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    // Errors show in the result, which is then no heading.
    let _ = table.serialize(row);
    let text = table.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&text).lines().next().unwrap_or_default().to_owned()
}

/// Reads a table that [`write_table`] wrote.
///
/// # Errors
/// Files that cannot be read, and rows with other fields.
pub fn read_table<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>, SceneError> {
    let file = path.display().to_string();
    let failed =
        |reason: csv::Error| SceneError::Unreadable { file: file.clone(), reason: reason.to_string() };
    let mut reader = csv::Reader::from_path(path).map_err(failed)?;
    reader.deserialize().map(|row| row.map_err(failed)).collect()
}

/// Writes a text.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_text(path: &Path, text: &str) -> Result<(), SceneError> {
    write_atomically(path, |writer| writer.write_all(text.as_bytes()))
}

/// Writes a value as indented JSON.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), SceneError> {
    let mut text =
        serde_json::to_string_pretty(value).map_err(|error| SceneError::unwritable(path, error))?;
    text.push('\n');
    write_text(path, &text)
}
