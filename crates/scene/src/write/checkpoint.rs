//! Checkpoints: a header that identifies the file, a payload, and a checksum over both.
//!
//! Layout, little endian: magic (8 bytes), format version (u32), length and text of the program version
//! (u16), length and bincode of the scene's physics (u32), length of the payload (u64), CRC-32 of
//! everything else (u32), payload (bincode 2). Only this module knows the format: bincode is no longer
//! maintained and may be replaced here.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::error::shorten;
use crate::scene::{Physics, told};
use serde::{Serialize, de::DeserializeOwned};
use std::path::Path;

/// First bytes of every checkpoint.
const MAGIC: [u8; 8] = *b"AMBRFLD\x1a";
/// Version of the layout.
const FORMAT: u32 = 6;
/// Version of the program that writes and reads.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// Writes a checkpoint of a state, for a scene with the given physics.
///
/// # Errors
/// Errors of the operating system.
pub fn write_checkpoint(path: &Path, physics: &Physics, state: &impl Serialize) -> Result<(), SceneError> {
    let payload = bincode::serde::encode_to_vec(state, bincode::config::standard())
        .map_err(|error| SceneError::unwritable(path, error))?;
    let physics = bincode::serde::encode_to_vec(physics, bincode::config::standard())
        .map_err(|error| SceneError::unwritable(path, error))?;
    let header = header(PROGRAM, &physics, payload.len() as u64);
    let checksum = checksum(&header, &payload);
    write_atomically(path, |writer| {
        writer.write_all(&header)?;
        writer.write_all(&checksum.to_le_bytes())?;
        writer.write_all(&payload)
    })
}

/// Header of a checkpoint, without the checksum.
fn header(program: &str, physics: &[u8], payload: u64) -> Vec<u8> {
    let mut header = MAGIC.to_vec();
    header.extend(FORMAT.to_le_bytes());
    header.extend(u16::try_from(program.len()).expect("versions are short").to_le_bytes());
    header.extend(program.as_bytes());
    header.extend(u32::try_from(physics.len()).expect("scenes are short").to_le_bytes());
    header.extend(physics);
    header.extend(payload.to_le_bytes());
    header
}

/// CRC-32 of header and payload.
fn checksum(header: &[u8], payload: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(header);
    hasher.update(payload);
    hasher.finalize()
}

/// Reads a checkpoint of a scene with the given physics.
///
/// # Errors
/// Files that are no checkpoint, are of another version or another scene, are cut short or damaged.
pub fn read_checkpoint<T: DeserializeOwned>(path: &Path, physics: &Physics) -> Result<T, SceneError> {
    let bad = |problem: String| SceneError::Checkpoint { path: path.to_path_buf(), problem };
    if path.is_dir() {
        return Err(bad("is a directory; name a checkpoint file (checkpoints/*.amber)".to_owned()));
    }
    let bytes = std::fs::read(path).map_err(|error| bad(format!("cannot be read: {error}")))?;
    let payload = open(&bytes, physics).map_err(bad)?;
    decode(payload)
        .map_err(|error| bad(format!("its state cannot be read ({error}); take another checkpoint")))
}

/// Decodes a state from its bytes.
///
/// A limit on the memory makes it an error when a damaged text or list claims to be far longer than the whole
/// payload. bincode needs a limit that is known at compile time, so there are four of them.
fn decode<T: DeserializeOwned>(payload: &[u8]) -> Result<T, bincode::error::DecodeError> {
    const KILO: usize = 1 << 10;
    const MEGA: usize = 1 << 20;
    const GIGA: usize = 1 << 30;
    let plain = bincode::config::standard();
    // The factor 16: a small integer takes one byte of the file but counts as eight.
    let state = match payload.len() {
        0..KILO => bincode::serde::decode_from_slice(payload, plain.with_limit::<{ 16 * KILO }>()),
        KILO..MEGA => bincode::serde::decode_from_slice(payload, plain.with_limit::<{ 16 * MEGA }>()),
        MEGA..GIGA => bincode::serde::decode_from_slice(payload, plain.with_limit::<{ 16 * GIGA }>()),
        _ => bincode::serde::decode_from_slice(payload, plain.with_limit::<{ KILO * GIGA }>()),
    };
    state.map(|(state, _)| state)
}

/// Payload of a file that passes all checks.
fn open<'b>(bytes: &'b [u8], physics: &Physics) -> Result<&'b [u8], String> {
    let cut = || "is cut short; take an earlier checkpoint".to_owned();
    let mut rest = bytes;
    let mut take = |count: usize| -> Option<&'b [u8]> {
        let (taken, after) = rest.split_at_checked(count)?;
        rest = after;
        Some(taken)
    };
    let magic = take(MAGIC.len()).ok_or_else(cut)?;
    if magic != MAGIC {
        return Err("is not a checkpoint of amberfield; name a file checkpoints/*.amber".to_owned());
    }
    let format = u32::from_le_bytes(take(4).ok_or_else(cut)?.try_into().expect("four bytes"));
    if format != FORMAT {
        return Err(format!(
            "has format {format}, this version reads {FORMAT}; continue with the version that wrote it"
        ));
    }
    let length = u16::from_le_bytes(take(2).ok_or_else(cut)?.try_into().expect("two bytes"));
    let program = take(usize::from(length)).ok_or_else(cut)?.to_vec();
    let length = u32::from_le_bytes(take(4).ok_or_else(cut)?.try_into().expect("four bytes"));
    let found = take(length as usize).ok_or_else(cut)?.to_vec();
    let payload = u64::from_le_bytes(take(8).ok_or_else(cut)?.try_into().expect("eight bytes"));
    let expected = u32::from_le_bytes(take(4).ok_or_else(cut)?.try_into().expect("four bytes"));
    if rest.len() as u64 != payload {
        return Err(format!(
            "has {} bytes of state where {payload} were written: cut short or damaged; \
             take an earlier checkpoint",
            rest.len()
        ));
    }
    let header = &bytes[..bytes.len() - rest.len() - 4];
    if checksum(header, rest) != expected {
        return Err("is damaged (its checksum differs); take an earlier checkpoint".to_owned());
    }
    if program != PROGRAM.as_bytes() {
        return Err(format!(
            "was written by version {}, this is {PROGRAM}; continue with the version that wrote it",
            shorten(&String::from_utf8_lossy(&program))
        ));
    }
    let found: Physics = decode(&found)
        .map_err(|error| format!("its scene cannot be read ({error}); take another checkpoint"))?;
    match &physics.changes_since(&found)[..] {
        [] => Ok(rest),
        changes => Err(format!("belongs to another scene: {}", told(changes))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, serde::Deserialize)]
    enum Tagged {
        Plain,
        Full { number: f64, counts: [usize; 3] },
    }

    type State = (u64, Vec<f64>, String, [Tagged; 2]);

    fn written() -> (tempfile::TempDir, std::path::PathBuf, State) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.amber");
        let state: State = (
            7,
            vec![0.1, -0.0, f64::MIN_POSITIVE, f64::INFINITY],
            "x".into(),
            [Tagged::Full { number: f64::NEG_INFINITY, counts: [1, 2, 3] }, Tagged::Plain],
        );
        write_checkpoint(&path, &Physics::default(), &state).unwrap();
        (folder, path, state)
    }

    fn problem(path: &Path) -> String {
        read_checkpoint::<State>(path, &Physics::default()).unwrap_err().to_string()
    }

    #[test]
    fn state_comes_back_bitwise() {
        let (_folder, path, state) = written();
        assert_eq!(read_checkpoint::<State>(&path, &Physics::default()).unwrap(), state);
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_is_refused() {
        let (_folder, path, _) = written();
        let bytes = std::fs::read(&path).unwrap();
        for length in 0..bytes.len() {
            assert!(open(&bytes[..length], &Physics::default()).is_err(), "{length}");
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert!(open(&flipped, &Physics::default()).is_err(), "{bit}");
        }
    }

    #[test]
    fn other_versions_are_named() {
        let (_folder, path, _) = written();
        let payload = [1, 2, 3];
        let header = header("0.0.9", &[0, 0], 3);
        let mut bytes = header.clone();
        bytes.extend(checksum(&header, &payload).to_le_bytes());
        bytes.extend(payload);
        std::fs::write(&path, bytes).unwrap();
        assert!(problem(&path).contains("version 0.0.9"));
        std::fs::write(&path, b"# no checkpoint at all").unwrap();
        assert!(problem(&path).contains("not a checkpoint"));
    }
}
