//! Layout of a checkpoint.
//!
//! Little endian: magic (8 bytes), format version (u32), length and text of the program version (u16), length
//! and bincode of the scene's physics (u32), length and bincode of the grains for other scenes (u64), length
//! of the state (u64), CRC-32 of everything else (u32), state (bincode 2). Only this module knows the format:
//! bincode is no longer maintained and may be replaced here.

use crate::error::shorten;
use serde::{Serialize, de::DeserializeOwned};

/// First bytes of every checkpoint.
const MAGIC: [u8; 8] = *b"AMBRFLD\x1a";
/// Version of the layout.
const FORMAT: u32 = 7;
/// Version of the program that writes and reads.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// Parts of a checkpoint, as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Parts<'b> {
    /// Physics of the scene.
    pub(crate) physics: &'b [u8],
    /// Grains for other scenes.
    pub(crate) grains: &'b [u8],
    /// State of the run.
    pub(crate) state: &'b [u8],
}

impl<'b> Parts<'b> {
    /// Bytes before the state: header and checksum.
    pub(crate) fn head(&self) -> Vec<u8> {
        let mut head = self.header(PROGRAM);
        head.extend(checksum(&head, self.state).to_le_bytes());
        head
    }

    /// Header without the checksum.
    fn header(&self, program: &str) -> Vec<u8> {
        let mut header = MAGIC.to_vec();
        header.extend(FORMAT.to_le_bytes());
        header.extend(u16::try_from(program.len()).expect("versions are short").to_le_bytes());
        header.extend(program.as_bytes());
        header.extend(u32::try_from(self.physics.len()).expect("scenes are short").to_le_bytes());
        header.extend(self.physics);
        header.extend((self.grains.len() as u64).to_le_bytes());
        header.extend(self.grains);
        header.extend((self.state.len() as u64).to_le_bytes());
        header
    }

    /// Parts of a file that passes all checks; else what is wrong with it, and what to do.
    pub(crate) fn of(bytes: &'b [u8]) -> Result<Self, String> {
        let cut = || "is cut short; take an earlier checkpoint".to_owned();
        let mut rest = bytes;
        let mut take = |count: u64| -> Option<&'b [u8]> {
            let (taken, after) = rest.split_at_checked(usize::try_from(count).ok()?)?;
            rest = after;
            Some(taken)
        };
        let magic = take(MAGIC.len() as u64).ok_or_else(cut)?;
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
        let program = take(length.into()).ok_or_else(cut)?;
        let length = u32::from_le_bytes(take(4).ok_or_else(cut)?.try_into().expect("four bytes"));
        let physics = take(length.into()).ok_or_else(cut)?;
        let length = u64::from_le_bytes(take(8).ok_or_else(cut)?.try_into().expect("eight bytes"));
        let grains = take(length).ok_or_else(cut)?;
        let length = u64::from_le_bytes(take(8).ok_or_else(cut)?.try_into().expect("eight bytes"));
        let expected = u32::from_le_bytes(take(4).ok_or_else(cut)?.try_into().expect("four bytes"));
        if rest.len() as u64 != length {
            return Err(format!(
                "has {} bytes of state where {length} were written: cut short or damaged; \
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
                shorten(&String::from_utf8_lossy(program))
            ));
        }
        Ok(Self { physics, grains, state: rest })
    }
}

/// CRC-32 of header and state.
fn checksum(header: &[u8], state: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(header);
    hasher.update(state);
    hasher.finalize()
}

/// Encodes a part.
pub(crate) fn encode(part: &impl Serialize) -> Result<Vec<u8>, bincode::error::EncodeError> {
    bincode::serde::encode_to_vec(part, bincode::config::standard())
}

/// Decodes a part from its bytes.
///
/// A limit on the memory makes it an error when a damaged text or list claims to be far longer than the whole
/// part. bincode needs a limit that is known at compile time, so there are four of them.
pub(crate) fn decode<T: DeserializeOwned>(part: &[u8]) -> Result<T, bincode::error::DecodeError> {
    const KILO: usize = 1 << 10;
    const MEGA: usize = 1 << 20;
    const GIGA: usize = 1 << 30;
    let plain = bincode::config::standard();
    // The factor 16: a small integer takes one byte of the file but counts as eight.
    let state = match part.len() {
        0..KILO => bincode::serde::decode_from_slice(part, plain.with_limit::<{ 16 * KILO }>()),
        KILO..MEGA => bincode::serde::decode_from_slice(part, plain.with_limit::<{ 16 * MEGA }>()),
        MEGA..GIGA => bincode::serde::decode_from_slice(part, plain.with_limit::<{ 16 * GIGA }>()),
        _ => bincode::serde::decode_from_slice(part, plain.with_limit::<{ KILO * GIGA }>()),
    };
    state.map(|(state, _)| state)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARTS: Parts<'_> = Parts { physics: &[0, 0], grains: &[7; 5], state: &[1, 2, 3] };

    fn file(program: &str) -> Vec<u8> {
        let mut bytes = PARTS.header(program);
        bytes.extend(checksum(&bytes, PARTS.state).to_le_bytes());
        bytes.extend(PARTS.state);
        bytes
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_is_refused() {
        let bytes = file(PROGRAM);
        assert_eq!(Parts::of(&bytes), Ok(PARTS));
        for length in 0..bytes.len() {
            assert!(Parts::of(&bytes[..length]).is_err(), "{length}");
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert!(Parts::of(&flipped).is_err(), "{bit}");
        }
    }

    #[test]
    fn other_versions_are_named() {
        assert!(Parts::of(&file("0.0.9")).unwrap_err().contains("version 0.0.9"));
        let mut older = file(PROGRAM);
        older[MAGIC.len()] = 5;
        let said = format!("has format 5, this version reads {FORMAT}");
        assert!(Parts::of(&older).unwrap_err().contains(&said));
        assert!(Parts::of(b"# no checkpoint at all").unwrap_err().contains("not a checkpoint"));
    }
}
