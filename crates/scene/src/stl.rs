//! STL surfaces, text or binary.
//!
//! The library `stl_io` reads facets and numbers. This module adds what files from elsewhere need: it
//! compares the file's length with the number of triangles in its header, tells the place of a mistake,
//! scales coordinates and merges vertices.

use crate::SceneError;
use crate::error::shorten;
use crate::weld::Weld;
use amberfield_core::TriangleMesh;
use nalgebra::Vector3;
use std::cell::Cell;
use std::io::{self, Read, Seek, SeekFrom};

/// Length of the text at the beginning of a binary file [bytes].
const HEADER_TEXT: usize = 80;
/// Length of what stands before the triangles of a binary file, text and a count [bytes].
const BINARY_HEADER: usize = HEADER_TEXT + 4;
/// Length of a binary triangle: normal and three vertices in f32, two bytes of attributes [bytes].
const BINARY_TRIANGLE: usize = 50;
/// Longest line of text [bytes]. The library keeps each word of a line, and no vertex needs so many.
const LONGEST_LINE: usize = 1000;
/// First bytes of a file that gzip has compressed.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// Length of the beginning of a file in which text has no zero byte [bytes].
const BEGINNING: usize = 1000;
/// Largest coordinate [m], as elsewhere in a scene.
const LARGEST_COORDINATE: f64 = 1e6;
/// Sine of the smallest angle of a triangle that counts as having an area.
const DEGENERATE_SINE: f64 = 1e-9;

/// Surface read from an STL file.
#[derive(Debug)]
pub(crate) struct Surface {
    /// Triangles, vertices in [m].
    pub(crate) mesh: TriangleMesh,
    /// Number of triangles without area, which were left out.
    pub(crate) dropped: usize,
}

/// Problem in a triangle, as the library reports it.
struct BadTriangle {
    /// Number of the triangle, from 1.
    number: usize,
    /// Message of the library.
    reason: String,
}

/// Reads a surface and multiplies its coordinates by `scale` to have metres.
///
/// Numbers in text keep all their digits. Vertices are merged where they are one place, and triangles
/// without area are left out.
///
/// # Errors
/// Files that are no STL, cut short, or hold values that are not finite; files without a triangle.
pub(crate) fn read_stl(file: &str, bytes: &[u8], scale: f64) -> Result<Surface, SceneError> {
    if bytes.starts_with(&GZIP) {
        let problem = "is compressed with gzip; unpack it (gunzip) and name the STL file";
        return Err(SceneError::file(file, problem));
    }
    let corners = if is_binary(bytes) { read_binary(file, bytes)? } else { read_text(file, bytes)? };
    let largest = corners.iter().map(Vector3::amax).fold(0.0, f64::max);
    let (mut weld, mut triangles) = (Weld::new(largest * scale), Vec::new());
    let mut dropped = 0;
    for (number, triangle) in corners.chunks_exact(3).enumerate() {
        let points = [triangle[0] * scale, triangle[1] * scale, triangle[2] * scale];
        if let Some(point) =
            points.iter().find(|point| !point.iter().all(|number| number.abs() <= LARGEST_COORDINATE))
        {
            return Err(SceneError::file(
                file,
                format!(
                    "triangle {} has the vertex {:?}, not finite or beyond {LARGEST_COORDINATE:e} m after \
                     scaling; repair the file or give another scale",
                    number + 1,
                    point.as_slice()
                ),
            ));
        }
        if is_degenerate(&points) {
            dropped += 1;
            continue;
        }
        triangles.push(points.map(|point| weld.number(point)));
    }
    if weld.vertices.len() > u32::MAX as usize {
        return Err(SceneError::file(file, "more than 2^32 vertices; coarsen the surface"));
    }
    let flat = |[a, b, c]: [u32; 3]| a == b || b == c || a == c;
    dropped += triangles.extract_if(.., |triangle| flat(*triangle)).count();
    let mesh = TriangleMesh { vertices: weld.vertices, triangles };
    if mesh.triangles.is_empty() {
        return Err(SceneError::file(
            file,
            format!("no triangle with an area ({dropped} without); check that this is an STL surface"),
        ));
    }
    Ok(Surface { mesh, dropped })
}

/// Tells whether a triangle has no area, compared with its longest edge.
fn is_degenerate(points: &[Vector3<f64>; 3]) -> bool {
    let (a, b, c) = (points[1] - points[0], points[2] - points[1], points[0] - points[2]);
    let longest = a.norm().max(b.norm()).max(c.norm());
    a.cross(&b).norm() <= DEGENERATE_SINE * longest * longest
}

/// Tells whether a file is a binary STL file.
fn is_binary(bytes: &[u8]) -> bool {
    // Binary files may begin with the word `solid` too, so their length decides first.
    match promised(bytes) {
        Some(count) if BINARY_HEADER + count * BINARY_TRIANGLE == bytes.len() => true,
        _ => {
            let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
            let is_solid = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
            // Bytes may follow the triangles; counts and normals of a binary file have zero bytes.
            !is_solid || bytes[..bytes.len().min(BEGINNING)].contains(&0)
        }
    }
}

/// Number of triangles in the header of a binary file.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER_TEXT..BINARY_HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

/// Reads the corners of all triangles of a binary file, three for each triangle [unit of the file].
fn read_binary(file: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, SceneError> {
    let count = promised(bytes).ok_or_else(|| {
        SceneError::file(
            file,
            format!("{} bytes are too few for an STL file; check that this is one", bytes.len()),
        )
    })?;
    // A damaged count must not make the library reserve memory for triangles that are not there.
    let needed = BINARY_HEADER + count * BINARY_TRIANGLE;
    if bytes.len() < needed {
        return Err(SceneError::file(
            file,
            format!(
                "not a text STL, and as a binary one cut short: {count} triangles need {needed} bytes, \
                 there are {}; export it again",
                bytes.len()
            ),
        ));
    }
    // The library would take a header that begins with "solid" for text, so it is given an empty one.
    let pieces = [&[b'\n'; HEADER_TEXT][..], &bytes[HEADER_TEXT..needed]];
    corners(Pieces::new(pieces.into_iter())).map_err(|BadTriangle { number, reason }| {
        SceneError::file(file, format!("triangle {number}: {}; export it again", shorten(&reason)))
    })
}

/// Reads the corners of all triangles of a text file, three for each triangle [unit of the file].
///
/// The library is given one statement at a time, so that the line of a mistake is known. Names of solids are
/// left out, since there may be several in a file and the library ends at the first, and since they may be in
/// any encoding. Normals are left out too, since they are not used and some exporters write NaN.
fn read_text(file: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, SceneError> {
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    let Statements { text, lines } = statements(&text);
    let number = Cell::new(0_usize);
    let facets = text.split_inclusive('\n').enumerate().map(|(index, line)| {
        number.set(index + 1);
        if line.len() > LONGEST_LINE { "a line too long\n" } else { line }
    });
    let end = std::iter::once("endsolid\n").inspect(|_| number.set(0));
    let pieces = ["solid \n"].into_iter().chain(facets).chain(["\n"]).chain(end).map(str::as_bytes);
    let rounded = corners(Pieces::new(pieces)).map_err(|BadTriangle { number: triangle, reason }| {
        // Line 0 stands for the end that was added to the file.
        let Some(index) = number.get().checked_sub(1) else {
            return SceneError::file(
                file,
                format!("triangle {triangle} does not end; the file is cut short, export it again"),
            );
        };
        let line = text.lines().nth(index).unwrap_or_default();
        SceneError::data(
            file,
            lines.get(index).copied().unwrap_or_default(),
            format!("\"{}\" in triangle {triangle}: {}; repair the file", shorten(line), shorten(&reason)),
        )
    })?;
    // The library has found every number good, and has rounded it.
    let vertices = text.lines().filter_map(|line| line.strip_prefix("vertex "));
    let exact = |line: &str| {
        let mut numbers = line.split(' ').filter_map(|word| word.parse().ok());
        Some(Vector3::new(numbers.next()?, numbers.next()?, numbers.next()?))
    };
    Ok(rounded.iter().zip(vertices).map(|(rounded, line)| exact(line).unwrap_or(*rounded)).collect())
}

/// Statements of a text file, one a line.
struct Statements {
    /// Statements with keywords in lower case, without names and normals.
    text: String,
    /// Line of the file in which each begins, from 1.
    lines: Vec<u64>,
}

/// Words that begin a statement.
const KEYWORDS: [&str; 7] = ["facet", "outer", "vertex", "endloop", "endfacet", "solid", "endsolid"];

/// Puts each statement on a line of its own: exporters write keywords in any case, end lines in any way, or
/// put all into one line.
fn statements(text: &str) -> Statements {
    let mut found = Statements { text: String::with_capacity(text.len()), lines: Vec::new() };
    let keyword = |word: &str| KEYWORDS.into_iter().find(|known| word.eq_ignore_ascii_case(known));
    let mut words = words(text).peekable();
    while let Some((line, word)) = words.next() {
        let known = keyword(word);
        if matches!(known, Some("solid" | "endsolid")) {
            // A name ends with its line, or where a facet begins.
            while let Some((other, word)) = words.peek()
                && (*other == line || keyword(word).is_none())
                && !word.eq_ignore_ascii_case("facet")
            {
                words.next();
            }
            continue;
        }
        found.lines.push(line);
        found.text.push_str(known.unwrap_or(word));
        if known == Some("facet") {
            found.text.push_str(" normal 0 0 0");
        }
        // A statement ends with its line, unless that cuts it.
        let (mut taken, whole) = (0, words_after(known));
        let belongs = |other: u64, word: &str, taken: usize| {
            keyword(word).is_none() && (other == line || taken < whole)
        };
        while let Some((_, word)) = words.next_if(|(other, word)| belongs(*other, word, taken)) {
            taken += 1;
            if known == Some("outer") {
                found.text.push(' ');
                found.text.push_str(&word.to_ascii_lowercase());
            } else if known != Some("facet") {
                found.text.push(' ');
                found.text.push_str(word);
            }
        }
        found.text.push('\n');
    }
    found
}

/// Number of words after a keyword.
fn words_after(keyword: Option<&str>) -> usize {
    match keyword {
        Some("facet") => 4,
        Some("vertex") => 3,
        Some("outer") => 1,
        _ => 0,
    }
}

/// Words of a text with their lines, from 1; lines end with LF, CR or both.
fn words(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let lines = text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    (1..).zip(lines).flat_map(|(number, line)| line.split_ascii_whitespace().map(move |word| (number, word)))
}

/// Reads the corners of all triangles, three for each.
fn corners<'b>(
    mut pieces: Pieces<'b, impl Iterator<Item = &'b [u8]> + Clone>,
) -> Result<Vec<Vector3<f64>>, BadTriangle> {
    let mut corners = Vec::new();
    let triangles = stl_io::create_stl_reader(&mut pieces)
        .map_err(|error| BadTriangle { number: 1, reason: error.to_string() })?;
    for (index, triangle) in triangles.enumerate() {
        let triangle =
            triangle.map_err(|error| BadTriangle { number: index + 1, reason: error.to_string() })?;
        corners.extend(triangle.vertices.map(|vertex| Vector3::from(vertex.0.map(f64::from))));
    }
    Ok(corners)
}

/// Reader of a file in pieces, which gives at most one piece at each call.
///
/// A library that reads line by line has therefore not taken the next piece, and the last piece taken holds
/// the mistake.
struct Pieces<'b, I> {
    /// All pieces, for a new start.
    all: I,
    /// Pieces that are not yet taken.
    ahead: I,
    /// Rest of the piece that is being read.
    rest: &'b [u8],
}

impl<'b, I: Iterator<Item = &'b [u8]> + Clone> Pieces<'b, I> {
    fn new(all: I) -> Self {
        Self { ahead: all.clone(), all, rest: &[] }
    }
}

impl<'b, I: Iterator<Item = &'b [u8]>> Read for Pieces<'b, I> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.rest.is_empty() {
            self.rest = self.ahead.next().unwrap_or_default();
        }
        self.rest.read(buffer)
    }
}

impl<'b, I: Iterator<Item = &'b [u8]> + Clone> Seek for Pieces<'b, I> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        if to != SeekFrom::Start(0) {
            return Err(io::ErrorKind::Unsupported.into());
        }
        (self.ahead, self.rest) = (self.all.clone(), &[]);
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "solid a\nfacet normal 0 0 1\nouter loop\n\
        vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

    fn binary(triangles: &[[f32; 9]]) -> Vec<u8> {
        let mut bytes = vec![b's'; 80];
        bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
        for triangle in triangles {
            bytes.extend([0_u8; 12]);
            bytes.extend(triangle.iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend([0_u8; 2]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_agree_and_vertices_are_merged() {
        let two = format!(
            "{FACET}facet normal 0 0 1\nouter loop\n\
             vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 -0\nendloop\nendfacet\nendsolid\n"
        );
        let Surface { mesh, dropped } = read_stl("w.stl", two.as_bytes(), 1e-3).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), dropped), (4, 2, 0));
        let other = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.], [1., 0., 0., 1., 1., 0., 0., 1., 0.]]);
        assert_eq!(read_stl("w.stl", &other, 1e-3).unwrap().mesh, mesh);
    }

    #[test]
    fn text_keeps_all_digits() {
        let text = FACET.replace("0 0 0", "0.1 0.2 0.3").replace("1 0 0", "1 0.1000000001 0");
        let vertices = read_stl("w.stl", text.as_bytes(), 1.0).unwrap().mesh.vertices;
        assert_eq!(vertices[0], Vector3::new(0.1, 0.2, 0.3));
        assert_eq!(vertices[1].y, 0.100_000_000_1);
    }

    #[test]
    fn text_may_hold_several_solids_and_normals_that_are_no_numbers() {
        let other =
            FACET.replace("normal 0 0 1", "normal nan nan nan").replace("vertex 0 0 0", "vertex 0 0 5");
        let both = format!("\u{feff}{FACET}endsolid a\n\n{other}endsolid\n");
        let Surface { mesh, .. } = read_stl("w.stl", both.as_bytes(), 1.0).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (4, 2));
    }

    #[test]
    fn dialects_of_text_agree() {
        let plain = format!("{FACET}endsolid a\n");
        let known = read_stl("w.stl", plain.as_bytes(), 1.0).unwrap().mesh;
        let named = |name: &[u8]| {
            let mut bytes = plain.clone().into_bytes();
            bytes.splice(6..7, name.iter().copied());
            bytes
        };
        for (dialect, bytes) in [
            ("upper case", plain.to_uppercase().into_bytes()),
            ("one line", plain.replace('\n', " ").into_bytes()),
            ("CR", plain.replace('\n', "\r").into_bytes()),
            ("CR LF", plain.replace('\n', "\r\n").into_bytes()),
            ("tabs and blank lines", plain.replace('\n', "\n\n\t").into_bytes()),
            ("a Latin-1 name", named(b"Beh\xe4lter")),
            ("a name of several words", named(b"a solid b 1 2 3")),
            ("no name", plain.replace(" a\n", "\n").into_bytes()),
            ("two in one line", format!("{plain}{plain}").replace('\n', " ").into_bytes()),
        ] {
            let found = read_stl("w.stl", &bytes, 1.0).unwrap_or_else(|error| panic!("{dialect}: {error}"));
            assert_eq!(found.mesh.vertices, known.vertices, "{dialect}");
        }
    }

    #[test]
    fn binary_that_begins_with_solid_may_end_late() {
        let mut bytes = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.]]);
        bytes[..10].copy_from_slice(b"solid part");
        bytes.extend(b"made by a program");
        assert_eq!(read_stl("w.stl", &bytes, 1.0).unwrap().mesh.triangles.len(), 1);
    }

    #[test]
    fn compressed_files_are_named() {
        let message = read_stl("w.stl.gz", &[0x1f, 0x8b, 8, 0], 1.0).unwrap_err().to_string();
        assert!(message.contains("w.stl.gz") && message.contains("gunzip"), "{message}");
    }

    #[test]
    fn binary_files_may_begin_as_text_and_end_late() {
        let mut bytes = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.]]);
        bytes[..6].copy_from_slice(b"solid ");
        assert_eq!(read_stl("w.stl", &bytes, 1.0).unwrap().mesh.triangles.len(), 1);
        bytes[..6].copy_from_slice(b"colour");
        bytes.extend([1, 2, 3]);
        assert_eq!(read_stl("w.stl", &bytes, 1.0).unwrap().mesh.triangles.len(), 1);
    }

    #[test]
    fn mistakes_in_text_have_a_line() {
        for (good, bad, line, word) in [
            ("vertex 0 1 0", "vertex 0 x 0", 6, "float"),
            ("vertex 1 0 0", "vertex 1 inf 0", 5, "finite"),
            ("vertex 1 0 0", "vertex 1 0 0 0", 5, "vertex"),
            ("outer loop\n", "", 3, "outer"),
            ("endloop\nendfacet\n", "endloop\nhello", 8, "endfacet"),
            ("vertex 0 1 0", &format!("vertex {}", "1 ".repeat(1_000_000)), 6, "too"),
        ] {
            let text = FACET.replace(good, bad);
            let message = read_stl("w.stl", text.as_bytes(), 1.0).unwrap_err().to_string();
            assert!(message.starts_with(&format!("w.stl:{line}: ")) && message.contains(word), "{message}");
        }
        let cut = FACET.replace("endfacet\n", "");
        assert!(
            read_stl("w.stl", cut.as_bytes(), 1.0)
                .unwrap_err()
                .to_string()
                .contains("triangle 1 does not end")
        );
    }

    #[test]
    fn degenerate_triangles_are_dropped_and_counted() {
        let bytes = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.], [0., 0., 0., 1., 0., 0., 2., 0., 0.]]);
        let Surface { mesh, dropped } = read_stl("w.stl", &bytes, 1.0).unwrap();
        assert_eq!((mesh.triangles.len(), dropped), (1, 1));
    }

    #[test]
    fn bad_files_are_refused() {
        let promise = {
            let mut bytes = vec![0; 80];
            bytes.extend(u32::MAX.to_le_bytes());
            bytes
        };
        let nan = binary(&[[0., f32::NAN, 0., 1., 0., 0., 0., 1., 0.]]);
        let huge = binary(&[[0., 1e30, 0., 1., 0., 0., 0., 1., 0.]]);
        let text_nan = FACET.replace("vertex 1", "vertex nan").into_bytes();
        let text_two = FACET.replace("vertex 1 0 0\n", "").into_bytes();
        for bytes in [b"x".to_vec(), b"solid\nendsolid\n".to_vec(), promise, nan, huge, text_nan, text_two] {
            assert!(read_stl("w.stl", &bytes, 1.0).is_err());
        }
    }
}
