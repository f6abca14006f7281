//! Blocks of bytes in XML files of VTK: behind the text or in it, in base64 or not, compressed or not.

use super::xml_tags::Tag;
use crate::error::shorten;
use flate2::read::ZlibDecoder;
use std::io::Read as _;

/// Blocks of bytes of a file.
pub(super) struct Blocks<'b> {
    /// Bytes behind the mark `_` of the appended data; `None` in a file without.
    appended: Option<&'b [u8]>,
    /// Whether appended data are in base64.
    is_base64: bool,
    /// Length of a number in a block's header [bytes].
    header: usize,
    is_big_endian: bool,
    is_compressed: bool,
}

impl<'b> Blocks<'b> {
    /// Splits a file into its text and the data that are appended.
    pub(super) fn split(bytes: &'b [u8]) -> (&'b [u8], Self) {
        const MARK: &[u8] = b"<AppendedData";
        let blocks =
            Self { appended: None, is_base64: false, header: 4, is_big_endian: false, is_compressed: false };
        let Some(start) = bytes.windows(MARK.len()).position(|window| window == MARK) else {
            return (bytes, blocks);
        };
        let (text, data) = bytes.split_at(start);
        let Some(end) = data.iter().position(|byte| *byte == b'>') else { return (text, blocks) };
        let is_base64 = data[..end].windows(6).any(|window| window == b"base64");
        let data = data[end + 1..].trim_ascii_start();
        (text, Self { appended: data.strip_prefix(b"_"), is_base64, ..blocks })
    }

    /// Takes over what the tag of the file says of its blocks.
    pub(super) fn configure(&mut self, tag: &Tag<'_>) -> Result<(), String> {
        self.is_big_endian = tag.attribute("byte_order") == Some("BigEndian");
        self.header = if tag.attribute("header_type") == Some("UInt64") { 8 } else { 4 };
        self.is_compressed = match tag.attribute("compressor") {
            None => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(format!(
                    "compressed by \"{}\"; write it uncompressed or with zlib",
                    shorten(other)
                ));
            }
        };
        Ok(())
    }

    /// Whether the most significant byte of a number is the first.
    pub(super) fn is_big_endian(&self) -> bool {
        self.is_big_endian
    }

    /// Bytes of a block at an offset in the appended data.
    pub(super) fn appended(&self, offset: usize) -> Result<Vec<u8>, String> {
        let data = self.appended.and_then(|data| data.get(offset..));
        let data =
            data.ok_or_else(|| format!("there are no appended data at its offset {offset}; cut short"))?;
        if self.is_base64 { self.unpacked(Source::Base64(data)) } else { self.unpacked(Source::Plain(data)) }
    }

    /// Bytes of a block in base64 in the text.
    pub(super) fn inline(&self, text: &str) -> Result<Vec<u8>, String> {
        self.unpacked(Source::Base64(text.trim_ascii().as_bytes()))
    }

    /// Bytes of a block, behind its header.
    fn unpacked(&self, source: Source<'_>) -> Result<Vec<u8>, String> {
        if !self.is_compressed {
            let length = self.numbers(&source, 1)?[0];
            let end = length.checked_add(self.header).ok_or_else(cut)?;
            return Ok(source.bytes(end)?.split_off(self.header));
        }
        let blocks = self.numbers(&source, 1)?[0];
        let header = self.numbers(&source, blocks.checked_add(3).ok_or_else(cut)?)?;
        let lengths = &header[3..];
        let packed =
            lengths.iter().try_fold(0_usize, |sum, length| sum.checked_add(*length)).ok_or_else(cut)?;
        let start = self.header * header.len();
        let bytes = source.behind(start, packed)?;
        let mut rest = &bytes[..];
        let mut unpacked = Vec::new();
        for length in lengths {
            let (block, behind) = rest.split_at(*length);
            let read = ZlibDecoder::new(block).read_to_end(&mut unpacked);
            read.map_err(|error| format!("its compressed data are damaged: {error}"))?;
            rest = behind;
        }
        Ok(unpacked)
    }

    /// Numbers at the beginning of a block's header.
    fn numbers(&self, source: &Source<'_>, count: usize) -> Result<Vec<usize>, String> {
        let bytes = source.bytes(count.checked_mul(self.header).ok_or_else(cut)?)?;
        let number = |chunk: &[u8]| {
            let fold = |number: u64, byte: &u8| (number << 8) | u64::from(*byte);
            let number = if self.is_big_endian {
                chunk.iter().fold(0, fold)
            } else {
                chunk.iter().rev().fold(0, fold)
            };
            usize::try_from(number).map_err(|_| cut())
        };
        bytes.chunks_exact(self.header).map(number).collect()
    }
}

fn cut() -> String {
    "its data are cut short".to_owned()
}

/// Bytes as they stand in a file.
enum Source<'b> {
    Plain(&'b [u8]),
    Base64(&'b [u8]),
}

impl Source<'_> {
    /// First bytes.
    fn bytes(&self, count: usize) -> Result<Vec<u8>, String> {
        match self {
            Self::Plain(bytes) => bytes.get(..count).map(<[u8]>::to_vec).ok_or_else(cut),
            Self::Base64(text) => decoded(text, count),
        }
    }

    /// Bytes behind the first ones.
    fn behind(&self, start: usize, count: usize) -> Result<Vec<u8>, String> {
        Ok(self.bytes(start.checked_add(count).ok_or_else(cut)?)?.split_off(start))
    }
}

/// First bytes of a text in base64, of which several may follow each other, each with its padding.
fn decoded(text: &[u8], count: usize) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(count.min(text.len()));
    for quad in text.chunks(4) {
        if bytes.len() >= count {
            break;
        }
        let mut number = 0_u32;
        let mut digits = 0;
        for byte in quad {
            let digit = match byte {
                b'A'..=b'Z' => byte - b'A',
                b'a'..=b'z' => byte - b'a' + 26,
                b'0'..=b'9' => byte - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' => continue,
                _ => return Err(cut()),
            };
            number |= u32::from(digit) << (18 - 6 * digits);
            digits += 1;
        }
        let whole = number.to_be_bytes();
        bytes.extend_from_slice(&whole[1..1 + (digits * 3) / 4]);
    }
    if bytes.len() < count {
        return Err(cut());
    }
    bytes.truncate(count);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_rfc_4648() {
        for (text, bytes) in
            [("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob"), ("Zg==Zm8=", "ffo")]
        {
            assert_eq!(decoded(text.as_bytes(), bytes.len()).unwrap(), bytes.as_bytes(), "{text}");
        }
        assert!(decoded(b"Zg==", 2).is_err());
        assert!(decoded(b"Z!==", 1).is_err());
    }
}
