//! Files of a scene: its folder, and a fingerprint of all files that were read.

use crate::SceneError;
use crate::tree::SceneTable;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Fingerprint of bytes, the 64-bit FNV-1a hash (Fowler, Noll, Vo).
///
/// It is stable across versions and machines, and guards against mistakes, not against malice.
#[derive(Clone, Debug)]
pub(crate) struct Fingerprint(u64);

impl Fingerprint {
    /// Fingerprint of no bytes, the offset basis of FNV-1a.
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes; the multiplier is the prime of FNV-1a.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    pub(crate) fn value(&self) -> u64 {
        self.0
    }
}

/// Folder of a scene, and the fingerprint of the files that were read from it.
#[derive(Debug)]
pub(crate) struct SceneSource {
    folder: PathBuf,
    fingerprint: Fingerprint,
}

impl SceneSource {
    pub(crate) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), fingerprint: Fingerprint::new() }
    }

    /// Path of a name in the scene, relative to the scene's folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Reads the file that a key names and adds its bytes to the fingerprint.
    pub(crate) fn read_file(
        &mut self,
        table: &SceneTable<'_>,
        key: &str,
        name: &str,
    ) -> Result<Vec<u8>, SceneError> {
        let bytes = read_bytes(&self.path(name)).map_err(|reason| table.bad(key, reason))?;
        self.fingerprint.add(&bytes);
        Ok(bytes)
    }

    /// Adds more bytes to the fingerprint.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        self.fingerprint.add(bytes);
    }

    /// Fingerprint of all bytes that were added.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.fingerprint.value()
    }
}

/// Reads a file or pipe that is not empty.
///
/// Devices are refused, since some of them never end.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    if path.is_dir() {
        return Err(format!("{} is a directory; name a file", path.display()));
    }
    if is_device(path) {
        return Err(format!("{} is a device; name a file", path.display()));
    }
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => format!("there is no file {}; check the path", path.display()),
        _ => format!("cannot read {}: {error}", path.display()),
    })?;
    if bytes.is_empty() {
        Err(format!("{} is empty; check that it was written", path.display()))
    } else {
        Ok(bytes)
    }
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
