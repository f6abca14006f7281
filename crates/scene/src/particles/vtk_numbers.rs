//! Numbers of VTK files: their types, and lists of them in text or as bytes.

use super::vtk_points::VtkValues;

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberType {
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

impl NumberType {
    /// Type of a name in XML files or in legacy files.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "float32" | "float" => Self::F32,
            "float64" | "double" => Self::F64,
            "int8" | "char" | "signed_char" => Self::I8,
            "int16" | "short" => Self::I16,
            "int32" | "int" => Self::I32,
            "int64" | "long" | "vtktypeint64" | "vtkidtype" => Self::I64,
            "uint8" | "unsigned_char" => Self::U8,
            "uint16" | "unsigned_short" => Self::U16,
            "uint32" | "unsigned_int" => Self::U32,
            "uint64" | "unsigned_long" | "vtktypeuint64" => Self::U64,
            _ => return None,
        })
    }

    /// Length of a number [bytes].
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// Numbers of a list of bytes, whose length is a multiple of the type's.
    pub(super) fn of_bytes(self, bytes: &[u8], is_big_endian: bool) -> VtkValues {
        fn each<T, const N: usize>(bytes: &[u8], is_big_endian: bool, number: fn([u8; N]) -> T) -> Vec<T> {
            let chunks = bytes.as_chunks::<N>().0.iter();
            let turned = chunks.map(|chunk| {
                let mut chunk = *chunk;
                if is_big_endian {
                    chunk.reverse();
                }
                number(chunk)
            });
            turned.collect()
        }
        let big = is_big_endian;
        match self {
            Self::F32 => VtkValues::Floats(each(bytes, big, |b| f64::from(f32::from_le_bytes(b)))),
            Self::F64 => VtkValues::Floats(each(bytes, big, f64::from_le_bytes)),
            Self::I8 => VtkValues::Signed(each(bytes, big, |b| i8::from_le_bytes(b).into())),
            Self::I16 => VtkValues::Signed(each(bytes, big, |b| i16::from_le_bytes(b).into())),
            Self::I32 => VtkValues::Signed(each(bytes, big, |b| i32::from_le_bytes(b).into())),
            Self::I64 => VtkValues::Signed(each(bytes, big, i64::from_le_bytes)),
            Self::U8 => VtkValues::Unsigned(each(bytes, big, |b: [u8; 1]| b[0].into())),
            Self::U16 => VtkValues::Unsigned(each(bytes, big, |b| u16::from_le_bytes(b).into())),
            Self::U32 => VtkValues::Unsigned(each(bytes, big, |b| u32::from_le_bytes(b).into())),
            Self::U64 => VtkValues::Unsigned(each(bytes, big, u64::from_le_bytes)),
        }
    }

    /// Numbers of words; the first word that is none is the error.
    pub(super) fn of_words<'w>(self, words: impl Iterator<Item = &'w str>) -> Result<VtkValues, &'w str> {
        fn each<'w, T: std::str::FromStr>(words: impl Iterator<Item = &'w str>) -> Result<Vec<T>, &'w str> {
            words.map(|word| word.parse().map_err(|_| word)).collect()
        }
        Ok(match self {
            Self::F32 | Self::F64 => VtkValues::Floats(each(words)?),
            Self::I8 | Self::I16 | Self::I32 | Self::I64 => VtkValues::Signed(each(words)?),
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => VtkValues::Unsigned(each(words)?),
        })
    }
}
