//! STL surfaces, text or binary.
//!
//! The library `stl_io` reads facets and numbers. This module adds what files from elsewhere need: it
//! compares the file's length with the number of triangles in its header, tells the place of a mistake,
//! scales coordinates and merges vertices.

use crate::SceneError;
use crate::error::shorten;
use amberfield_core::TriangleMesh;
use nalgebra::Vector3;
use std::cell::Cell;
use std::collections::HashMap;
use std::io::{self, Read, Seek, SeekFrom};

/// Length of the text at the beginning of a binary file [bytes].
const HEADER_TEXT: usize = 80;
/// Length of what stands before the triangles of a binary file, text and a count [bytes].
const BINARY_HEADER: usize = HEADER_TEXT + 4;
/// Length of a binary triangle: normal and three vertices in f32, two bytes of attributes [bytes].
const BINARY_TRIANGLE: usize = 50;
/// Longest line of text [bytes]. The library keeps each word of a line, and no vertex needs so many.
const LONGEST_LINE: usize = 1000;
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
/// Vertices are merged where they are bitwise equal, and triangles without area are left out.
///
/// # Errors
/// Files that are no STL, cut short, or hold values that are not finite; files without a triangle.
pub(crate) fn read_stl(file: &str, bytes: &[u8], scale: f64) -> Result<Surface, SceneError> {
    let corners = if is_binary(bytes) { read_binary(file, bytes)? } else { read_text(file, bytes)? };
    let mut mesh = TriangleMesh::default();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::new();
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
        let mut triangle = [0_u32; 3];
        for (slot, point) in triangle.iter_mut().zip(&points) {
            // −0 and 0 differ in their bits; adding zero makes them the same vertex.
            let key = [point.x + 0.0, point.y + 0.0, point.z + 0.0].map(f64::to_bits);
            let next = u32::try_from(mesh.vertices.len())
                .map_err(|_| SceneError::file(file, "more than 2^32 vertices; coarsen the surface"))?;
            *slot = *index_of.entry(key).or_insert_with(|| {
                mesh.vertices.push(*point);
                next
            });
        }
        mesh.triangles.push(triangle);
    }
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
            let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            !text.trim_ascii_start().starts_with(b"solid")
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
/// The library is given one line at a time, so that the line of a mistake is known. Names of solids are left
/// out, since there may be several in a file and the library ends at the first. Normals are left out too,
/// since they are not used and some exporters write NaN.
fn read_text(file: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, SceneError> {
    let text = crate::source::decode(file, bytes)?;
    let number = Cell::new(0_usize);
    let facets = text.split_inclusive('\n').enumerate().filter_map(|(index, line)| {
        number.set(index + 1);
        match line.split_ascii_whitespace().next() {
            Some("solid" | "endsolid") | None => None,
            Some("facet") => Some("facet normal 0 0 0\n"),
            Some(_) if line.len() > LONGEST_LINE => Some("a line too long\n"),
            Some(_) => Some(line),
        }
    });
    let end = std::iter::once("endsolid\n").inspect(|_| number.set(0));
    let pieces = ["solid \n"].into_iter().chain(facets).chain(["\n"]).chain(end).map(str::as_bytes);
    corners(Pieces::new(pieces)).map_err(|BadTriangle { number: triangle, reason }| {
        // Line 0 stands for the end that was added to the file.
        let Some(index) = number.get().checked_sub(1) else {
            return SceneError::file(
                file,
                format!("triangle {triangle} does not end; the file is cut short, export it again"),
            );
        };
        let line = text.lines().nth(index).unwrap_or_default().trim();
        SceneError::data(
            file,
            index as u64 + 1,
            format!("\"{}\" in triangle {triangle}: {}; repair the file", shorten(line), shorten(&reason)),
        )
    })
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
    fn text_may_hold_several_solids_and_normals_that_are_no_numbers() {
        let other =
            FACET.replace("normal 0 0 1", "normal nan nan nan").replace("vertex 0 0 0", "vertex 0 0 5");
        let both = format!("\u{feff}{FACET}endsolid a\n\n{other}endsolid\n");
        let Surface { mesh, .. } = read_stl("w.stl", both.as_bytes(), 1.0).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (4, 2));
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
