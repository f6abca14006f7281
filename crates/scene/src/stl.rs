//! STL surfaces, text or binary.
//!
//! Read here rather than by a library so that a bad file is refused with line and value, and a binary
//! header that promises more triangles than the file holds allocates nothing.

use crate::SceneError;
use crate::error::shorten;
use amberfield_core::TriangleMesh;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Bytes before the triangles of a binary file: 80 of text and a count.
const BINARY_HEADER: usize = 84;
/// Bytes of a binary triangle: normal and three vertices in f32, two bytes of attributes.
const BINARY_TRIANGLE: usize = 50;
/// Largest coordinate [m], as elsewhere in a scene.
const LARGEST_COORDINATE: f64 = 1e6;
/// Sine of the smallest angle of a triangle that counts as having an area.
const DEGENERATE_SINE: f64 = 1e-9;

/// Reads a surface: vertices merged where they are bitwise equal, triangles without area dropped. Returns the
/// surface in metres and the number of dropped triangles.
///
/// # Errors
/// Files that are no STL, cut short, or hold values that are not finite; files without a triangle.
pub(crate) fn read_stl(file: &str, bytes: &[u8], scale: f64) -> Result<(TriangleMesh, usize), SceneError> {
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
                    "triangle {} has the vertex {:?}, not finite or beyond {LARGEST_COORDINATE:e} m after scaling; repair the file or give another scale",
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
            // Adding zero makes −0 and 0 the same vertex.
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
    Ok((mesh, dropped))
}

fn is_degenerate(points: &[Vector3<f64>; 3]) -> bool {
    let (a, b, c) = (points[1] - points[0], points[2] - points[1], points[0] - points[2]);
    let longest = a.norm().max(b.norm()).max(c.norm());
    a.cross(&b).norm() <= DEGENERATE_SINE * longest * longest
}

/// Binary files may begin with the word `solid` too; their length decides.
fn is_binary(bytes: &[u8]) -> bool {
    match promised(bytes) {
        Some(count) if BINARY_HEADER + count * BINARY_TRIANGLE == bytes.len() => true,
        _ => !bytes.trim_ascii_start().starts_with(b"solid"),
    }
}

fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..BINARY_HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

fn read_binary(file: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, SceneError> {
    let count = promised(bytes).ok_or_else(|| {
        SceneError::file(
            file,
            format!("{} bytes are too few for an STL file; check that this is one", bytes.len()),
        )
    })?;
    let needed = BINARY_HEADER + count * BINARY_TRIANGLE;
    if bytes.len() < needed {
        return Err(SceneError::file(
            file,
            format!(
                "not a text STL, and as a binary one cut short: {count} triangles need {needed} bytes, there are {}; export it again",
                bytes.len()
            ),
        ));
    }
    let mut corners = Vec::with_capacity(3 * count);
    for (number, triangle) in bytes[BINARY_HEADER..needed].chunks_exact(BINARY_TRIANGLE).enumerate() {
        for vertex in triangle[12..48].chunks_exact(12) {
            let mut point = Vector3::zeros();
            for (axis, number) in vertex.chunks_exact(4).enumerate() {
                point[axis] =
                    f64::from(f32::from_le_bytes(number.try_into().expect("chunks have four bytes")));
            }
            if !point.iter().all(|number| number.is_finite()) {
                return Err(SceneError::file(
                    file,
                    format!(
                        "triangle {} has the vertex {:?}, not finite; repair the file",
                        number + 1,
                        point.as_slice()
                    ),
                ));
            }
            corners.push(point);
        }
    }
    Ok(corners)
}

fn read_text(file: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, SceneError> {
    let text = crate::scene::source::decode(file, bytes)?;
    let mut corners = Vec::new();
    let mut corners_of_facet = 0;
    for (index, line) in text.lines().enumerate() {
        let number = index as u64 + 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => {
                corners.push(read_vertex(file, number, words)?);
                corners_of_facet += 1;
            }
            Some("endfacet") => {
                if corners_of_facet != 3 {
                    return Err(SceneError::data(
                        file,
                        number,
                        format!("a facet with {corners_of_facet} vertices; facets have three"),
                    ));
                }
                corners_of_facet = 0;
            }
            Some("solid" | "facet" | "outer" | "endloop" | "endsolid") | None => {}
            Some(other) => {
                return Err(SceneError::data(
                    file,
                    number,
                    format!("unexpected word \"{}\"; expected facet, vertex or endsolid", shorten(other)),
                ));
            }
        }
    }
    if corners_of_facet != 0 {
        return Err(SceneError::file(
            file,
            "the last facet does not end; the file is cut short, export it again",
        ));
    }
    Ok(corners)
}

fn read_vertex<'w>(
    file: &str,
    line: u64,
    mut words: impl Iterator<Item = &'w str>,
) -> Result<Vector3<f64>, SceneError> {
    let mut point = Vector3::zeros();
    for axis in 0..3 {
        let word = words.next().unwrap_or_default();
        point[axis] = word.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            SceneError::data(
                file,
                line,
                format!("vertex coordinate \"{}\" is not a finite number", shorten(word)),
            )
        })?;
    }
    match words.next() {
        None => Ok(point),
        Some(word) => Err(SceneError::data(
            file,
            line,
            format!("a fourth vertex coordinate \"{}\"; give three", shorten(word)),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

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
            "{FACET}facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 -0\nendloop\nendfacet\nendsolid\n"
        );
        let (mesh, dropped) = read_stl("w.stl", two.as_bytes(), 1e-3).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), dropped), (4, 2, 0));
        let other = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.], [1., 0., 0., 1., 1., 0., 0., 1., 0.]]);
        assert_eq!(read_stl("w.stl", &other, 1e-3).unwrap().0, mesh);
    }

    #[test]
    fn degenerate_triangles_are_dropped_and_counted() {
        let bytes = binary(&[[0., 0., 0., 1., 0., 0., 0., 1., 0.], [0., 0., 0., 1., 0., 0., 2., 0., 0.]]);
        let (mesh, dropped) = read_stl("w.stl", &bytes, 1.0).unwrap();
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
        let text_nan = FACET.replace("vertex 1", "vertex nan").into_bytes();
        let text_two = FACET.replace("vertex 1 0 0\n", "").into_bytes();
        for bytes in [b"x".to_vec(), b"solid\nendsolid\n".to_vec(), promise, nan, text_nan, text_two] {
            assert!(read_stl("w.stl", &bytes, 1.0).is_err());
        }
    }
}
