//! Reader of OpenFOAM's files of a mesh: a header, then lists of numbers, as text or as they lie in memory.
//!
//! What OpenFOAM 1912 and later write is read: text or binary, little endian, labels and scalars of 32 or 64
//! bits. A file without an entry `arch` has labels of 32 bits and scalars of 64.

use crate::SceneError;
use crate::error::shorten;
use nalgebra::Vector3;
use std::fmt::Display;

/// Largest coordinate [m], as elsewhere in a scene.
const LARGEST_COORDINATE: f64 = 1e6;
/// Bytes that end a word.
const ENDS_OF_WORDS: &[u8] = b"(){};\"";

/// Form of the numbers in a file's lists.
#[derive(Clone, Copy, Debug)]
enum Form {
    Text,
    Binary {
        /// Size of a label [bytes].
        label: usize,
        /// Size of a scalar [bytes].
        scalar: usize,
    },
}

/// Corners of faces, as labels of points.
#[derive(Debug)]
pub(super) struct Faces {
    /// Begin of each face's corners in `corners`; one more than there are faces.
    pub(super) first: Vec<u32>,
    /// Corners, face by face.
    pub(super) corners: Vec<u32>,
}

/// File that is read from its beginning on.
#[derive(Debug)]
pub(super) struct FoamFile<'b> {
    /// Name in messages.
    name: &'b str,
    bytes: &'b [u8],
    /// Place of the next byte to read.
    at: usize,
    /// Class of the content: `faceCompactList`, for example.
    class: &'b str,
    form: Form,
}

impl<'b> FoamFile<'b> {
    /// Reads the header of a file with a name for messages.
    pub(super) fn open(name: &'b str, bytes: &'b [u8]) -> Result<Self, SceneError> {
        let mut file = Self { name, bytes, at: 0, class: "", form: Form::Text };
        let head = file.word()?;
        if head != "FoamFile" {
            return Err(file.bad(format!("\"{}\" stands where FoamFile should", shorten(head))));
        }
        file.expect(b'{')?;
        let (mut format, mut arch) = ("ascii", "LSB;label=32;scalar=64");
        while !file.comes(b'}') {
            match (file.word()?, file.value()?) {
                ("format", value) => format = value,
                ("arch", value) => arch = value.trim_matches('"'),
                ("class", value) => file.class = value,
                _ => {}
            }
        }
        file.expect(b'}')?;
        file.form = match format {
            "ascii" => Form::Text,
            "binary" => file.binary(arch)?,
            other => return Err(file.bad(format!("the format {} is not known", shorten(other)))),
        };
        Ok(file)
    }

    /// Form of binary numbers that an entry `arch` describes.
    fn binary(&self, arch: &str) -> Result<Form, SceneError> {
        let size = |name: &str| match arch.split(';').find_map(|word| word.trim().strip_prefix(name)) {
            Some("32") => Some(4),
            Some("64") => Some(8),
            _ => None,
        };
        match (size("label="), size("scalar=")) {
            (Some(label), Some(scalar)) if arch.contains("LSB") => Ok(Form::Binary { label, scalar }),
            _ => Err(self.bad(format!(
                "binary numbers of the kind {} cannot be read; convert the mesh to text with \
                 foamFormatConvert",
                shorten(arch)
            ))),
        }
    }

    /// Error at the place that is read.
    pub(super) fn bad(&self, problem: impl Display) -> SceneError {
        let read = &self.bytes[..self.at.min(self.bytes.len())];
        let line = 1 + read.iter().filter(|byte| **byte == b'\n').count() as u64;
        SceneError::data(self.name, line, format!("{problem}; check the mesh with checkMesh"))
    }

    /// Skips blanks and comments.
    fn skip_blanks(&mut self) {
        loop {
            let rest = &self.bytes[self.at..];
            let blanks = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            let rest = &rest[blanks..];
            let end_of = |end: &[u8]| rest.windows(end.len()).position(|bytes| bytes == end);
            let comment = if rest.starts_with(b"//") {
                end_of(b"\n").unwrap_or(rest.len())
            } else if rest.starts_with(b"/*") {
                end_of(b"*/").map_or(rest.len(), |end| end + 2)
            } else {
                0
            };
            self.at += blanks + comment;
            if comment == 0 {
                return;
            }
        }
    }

    /// Whether a byte comes next after blanks.
    pub(super) fn comes(&mut self, byte: u8) -> bool {
        self.skip_blanks();
        self.bytes.get(self.at) == Some(&byte)
    }

    /// Reads a byte that must come next after blanks.
    pub(super) fn expect(&mut self, byte: u8) -> Result<(), SceneError> {
        if self.comes(byte) {
            self.at += 1;
            return Ok(());
        }
        let found = match self.bytes.get(self.at) {
            Some(found) => format!("'{}' stands", found.escape_ascii()),
            None => "the file ends".to_owned(),
        };
        Err(self.bad(format!("{found} where '{}' should stand", byte.escape_ascii())))
    }

    /// Reads a word or a number.
    pub(super) fn word(&mut self) -> Result<&'b str, SceneError> {
        self.skip_blanks();
        let rest = &self.bytes[self.at..];
        let ends = |byte: &u8| byte.is_ascii_whitespace() || ENDS_OF_WORDS.contains(byte);
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        match std::str::from_utf8(&rest[..length]) {
            Ok(word) if !word.is_empty() => {
                self.at += length;
                Ok(word)
            }
            _ => Err(self.bad("a word or a number is missing")),
        }
    }

    /// Reads the value of an entry: up to its semicolon, or a dictionary in braces.
    pub(super) fn value(&mut self) -> Result<&'b str, SceneError> {
        self.skip_blanks();
        let rest = &self.bytes[self.at..];
        let (mut depth, mut quoted) = (0_usize, false);
        for (place, byte) in rest.iter().enumerate() {
            match byte {
                b'"' => quoted = !quoted,
                _ if quoted => {}
                b'(' | b'{' => depth += 1,
                b')' | b'}' if depth == 0 => break,
                b')' | b'}' => depth -= 1,
                _ => {}
            }
            let is_dictionary = rest.starts_with(b"{") && depth == 0;
            if is_dictionary || (*byte == b';' && depth == 0 && !quoted) {
                self.at += place + 1;
                let value = std::str::from_utf8(&rest[..place]).unwrap_or_default();
                return Ok(value.trim());
            }
        }
        Err(self.bad("an entry has no end"))
    }

    /// Reads a number that is not negative.
    pub(super) fn count(&mut self) -> Result<usize, SceneError> {
        let word = self.word()?;
        match word.parse::<u32>() {
            Ok(count) => Ok(count as usize),
            Err(_) => Err(self.bad(format!("\"{}\" is no count", shorten(word)))),
        }
    }

    /// Reads the length of a list, whose elements take so many bytes at least.
    fn length(&mut self, fewest_bytes: usize) -> Result<usize, SceneError> {
        let count = self.count()?;
        let left = self.bytes.len() - self.at;
        if count.saturating_mul(fewest_bytes) > left {
            return Err(
                self.bad(format!("a list of {count} entries does not fit the {left} bytes that follow"))
            );
        }
        Ok(count)
    }

    /// Reads so many bytes as they are, after the bracket that opens a list.
    fn raw(&mut self, length: usize) -> Result<&'b [u8], SceneError> {
        match self.bytes.get(self.at..self.at + length) {
            Some(raw) => {
                self.at += length;
                Ok(raw)
            }
            None => Err(self.bad("a binary list is cut short")),
        }
    }

    /// Reads a list of labels behind those that are there already.
    fn labels(&mut self, labels: &mut Vec<u32>) -> Result<(), SceneError> {
        let count = self.length(1)?;
        if count == 0 && !self.comes(b'(') {
            return Ok(());
        }
        self.expect(b'(')?;
        match self.form {
            Form::Text => {
                for _ in 0..count {
                    labels.push(self.count()? as u32);
                }
            }
            Form::Binary { label, .. } => {
                for bytes in self.raw(count * label)?.chunks_exact(label) {
                    let number = bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte));
                    let label = u32::try_from(number);
                    labels.push(label.map_err(|_| self.bad(format!("{number} is no label")))?);
                }
            }
        }
        self.expect(b')')
    }

    /// Reads a list of points [m].
    pub(super) fn points(&mut self) -> Result<Vec<Vector3<f64>>, SceneError> {
        let count = self.length(3)?;
        self.expect(b'(')?;
        let mut points = Vec::with_capacity(count);
        match self.form {
            Form::Text => {
                for _ in 0..count {
                    self.expect(b'(')?;
                    let point = [self.scalar()?, self.scalar()?, self.scalar()?];
                    self.expect(b')')?;
                    points.push(Vector3::from(point));
                }
            }
            Form::Binary { scalar, .. } => {
                let mut numbers = self.raw(count * 3 * scalar)?.chunks_exact(scalar).map(scalar_of);
                let mut next = || numbers.next().expect("three for each point");
                points.extend((0..count).map(|_| Vector3::from_fn(|_, _| next())));
            }
        }
        self.expect(b')')?;
        let is_good = |point: &Vector3<f64>| point.iter().all(|x| x.abs() <= LARGEST_COORDINATE);
        match points.iter().position(|point| !is_good(point)) {
            None => Ok(points),
            Some(label) => Err(self.bad(format!(
                "point {label} is at {:?} m, not finite or beyond {LARGEST_COORDINATE:e} m",
                points[label].as_slice()
            ))),
        }
    }

    fn scalar(&mut self) -> Result<f64, SceneError> {
        let word = self.word()?;
        word.parse().map_err(|_| self.bad(format!("\"{}\" is no number", shorten(word))))
    }

    /// Reads a list of faces.
    pub(super) fn faces(&mut self) -> Result<Faces, SceneError> {
        let mut faces = Faces { first: Vec::new(), corners: Vec::new() };
        if self.class == "faceCompactList" {
            self.labels(&mut faces.first)?;
            self.labels(&mut faces.corners)?;
        } else {
            let count = self.length(3)?;
            faces.first.push(0);
            self.expect(b'(')?;
            for _ in 0..count {
                self.labels(&mut faces.corners)?;
                faces.first.push(faces.corners.len() as u32);
            }
            self.expect(b')')?;
        }
        let ascending = faces.first.windows(2).all(|pair| pair[0] <= pair[1]);
        let (first, last) = (faces.first.first(), faces.first.last());
        if first != Some(&0) || !ascending || last.map(|last| *last as usize) != Some(faces.corners.len()) {
            return Err(self.bad("the numbers of the faces' corners do not fit together"));
        }
        Ok(faces)
    }
}

/// Number of four or eight bytes.
fn scalar_of(bytes: &[u8]) -> f64 {
    match *bytes {
        [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => bytes.try_into().map_or(f64::NAN, f64::from_le_bytes),
    }
}
