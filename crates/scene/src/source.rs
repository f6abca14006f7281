//! Files of a scene: its folder, and a fingerprint of all files that were read.

use crate::SceneError;
use crate::table::SceneTable;
use amberfield_core::Fingerprint;
use flate2::bufread::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Folder of a scene, and fingerprints of the files that were read from it.
#[derive(Debug)]
pub(crate) struct SceneSource {
    folder: PathBuf,
    /// Folder with the mesh of a case that has none of its own.
    mesh: Option<PathBuf>,
    /// Names and fingerprints, in the order of reading.
    read: Vec<(String, u64)>,
}

impl SceneSource {
    pub(crate) fn new(folder: &Path, mesh: Option<&Path>) -> Self {
        Self { folder: folder.to_path_buf(), mesh: mesh.map(Path::to_path_buf), read: Vec::new() }
    }

    /// Path of a name in the scene, relative to the scene's folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Folder with the mesh of a case that has none of its own.
    pub(crate) fn mesh(&self) -> Option<&Path> {
        self.mesh.as_deref()
    }

    /// Reads the file that a key names and keeps its fingerprint.
    pub(crate) fn read_file(
        &mut self,
        table: &SceneTable<'_>,
        key: &str,
        name: &str,
    ) -> Result<Vec<u8>, SceneError> {
        let bytes = read_bytes(&self.path(name)).map_err(|reason| table.bad(key, reason))?;
        let mut print = Fingerprint::new();
        print.add(&bytes);
        self.add(name, &print);
        Ok(bytes)
    }

    /// Opens the file that a key names; [`Self::add`] its fingerprint when it is read.
    pub(crate) fn open_file(
        &self,
        table: &SceneTable<'_>,
        key: &str,
        name: &str,
    ) -> Result<SceneFile, SceneError> {
        let path = self.path(name);
        let file = open(&path).map_err(|reason| table.bad(key, reason))?;
        let mut file = BufReader::with_capacity(BLOCK, file);
        match file.fill_buf() {
            Ok([]) => return Err(table.bad(key, empty(&path))),
            Ok(_) => {}
            Err(error) => return Err(table.bad(key, unreadable(&path, &error))),
        }
        Ok(SceneFile { file, print: Fingerprint::new() })
    }

    /// Error of a file that is not UTF-8 text; `None` where it is, or cannot be read once more.
    pub(crate) fn not_text(&self, name: &str) -> Option<SceneError> {
        let bytes = read_bytes(&self.path(name)).ok()?;
        let mut text = Vec::new();
        unpack(&bytes[..]).ok()?.read_to_end(&mut text).ok()?;
        decode(name, &text).err()
    }

    /// Keeps the fingerprint of what was read otherwise.
    pub(crate) fn add(&mut self, name: &str, print: &Fingerprint) {
        self.read.push((name.to_owned(), print.value()));
    }

    /// Names and fingerprints of all that was read, in its order.
    pub(crate) fn fingerprints(&self) -> &[(String, u64)] {
        &self.read
    }
}

/// Bytes of a file read at once.
const BLOCK: usize = 1 << 20;

/// Open file that is fingerprinted as it is read.
#[derive(Debug)]
pub(crate) struct SceneFile {
    file: BufReader<File>,
    /// Fingerprint of what was read so far.
    pub(crate) print: Fingerprint,
}

impl Read for SceneFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.print.add(&buffer[..count]);
        Ok(count)
    }
}

impl BufRead for SceneFile {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.file.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.print.add(&self.file.buffer()[..count]);
        self.file.consume(count);
    }
}

/// First bytes of what gzip has compressed.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Unpacks what gzip has compressed, which its first bytes tell, and passes on anything else.
pub(crate) fn unpack<'r>(mut reader: impl BufRead + 'r) -> io::Result<Box<dyn BufRead + 'r>> {
    if reader.fill_buf()?.starts_with(&GZIP) {
        Ok(Box::new(BufReader::with_capacity(BLOCK, MultiGzDecoder::new(reader))))
    } else {
        Ok(Box::new(reader))
    }
}

/// Opens a file or pipe that is not empty; its name stands in messages.
pub(crate) fn open_alone(path: &Path) -> Result<BufReader<File>, SceneError> {
    let unreadable = |reason| SceneError::Unreadable { file: path.display().to_string(), reason };
    let mut file = BufReader::with_capacity(BLOCK, open(path).map_err(unreadable)?);
    match file.fill_buf() {
        Ok([]) => Err(unreadable(empty(path))),
        Ok(_) => Ok(file),
        Err(error) => Err(unreadable(self::unreadable(path, &error))),
    }
}

fn empty(path: &Path) -> String {
    format!("{} is empty; check that it was written", path.display())
}

fn unreadable(path: &Path, error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => format!("there is no file {}; check the path", path.display()),
        _ => format!("cannot read {}: {error}", path.display()),
    }
}

/// Opens a file or pipe.
///
/// Devices are refused, since some of them never end.
fn open(path: &Path) -> Result<File, String> {
    if path.is_dir() {
        return Err(format!("{} is a directory; name a file", path.display()));
    }
    if is_device(path) {
        return Err(format!("{} is a device; name a file", path.display()));
    }
    File::open(path).map_err(|error| unreadable(path, &error))
}

/// Reads a file or pipe that is not empty.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes).map_err(|error| unreadable(path, &error))?;
    if bytes.is_empty() { Err(empty(path)) } else { Ok(bytes) }
}

#[cfg(unix)]
fn is_device(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    std::fs::metadata(path)
        .is_ok_and(|found| found.file_type().is_char_device() || found.file_type().is_block_device())
}

#[cfg(not(unix))]
fn is_device(_: &Path) -> bool {
    false
}

/// Reads the text of a scene file: UTF-8, with or without a byte-order mark.
pub(crate) fn read_text(path: &Path) -> Result<String, SceneError> {
    let file = path.display().to_string();
    let bytes = read_bytes(path).map_err(|reason| SceneError::Unreadable { file: file.clone(), reason })?;
    decode(&file, &bytes).map(ToOwned::to_owned)
}

/// Decodes UTF-8 text and leaves out its byte-order mark.
pub(crate) fn decode<'b>(file: &str, bytes: &'b [u8]) -> Result<&'b str, SceneError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count() as u64;
        let bad = bytes[error.valid_up_to()];
        SceneError::data(file, line, format!("byte 0x{bad:02x} is not UTF-8 text; save the file as UTF-8"))
    })
}
