//! Corners of a mesh's faces, which say where cells meet.

use crate::GasError;
use amberfield_core::Vector3;
use amberfield_field::far::FarMesh;

/// Distance beyond a plane within which a corner is on it, over the cell's size.
const ON_PLANE: f64 = 1e-9;

/// Corners of all faces of a mesh, in the order of its faces by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellShapes {
    points: Vec<Vector3<f64>>,
    /// Place of the first corner of each face, and at last the number of corners.
    first: Vec<u32>,
    /// Corners, as places among the points.
    corners: Vec<u32>,
}

impl CellShapes {
    /// Shapes of the faces of `mesh`, from points [m], the place of each face's first corner in `corners`
    /// (and at last their number), and corners in order around each face as places among the points.
    ///
    /// # Errors
    /// Numbers that do not belong to the mesh.
    pub fn new(
        mesh: &FarMesh,
        points: Vec<Vector3<f64>>,
        first: Vec<u32>,
        corners: Vec<u32>,
    ) -> Result<Self, GasError> {
        let faces: usize = (0..mesh.cell_count()).map(|cell| mesh.faces_of(cell).len()).sum();
        let bad = |what: String| Err(GasError::Settings(format!("the mesh's {what}; the mesh is broken")));
        if first.len() != faces + 1 || first[0] != 0 || first[faces] as usize != corners.len() {
            return bad(format!("{faces} faces have {} counts of corners", first.len().saturating_sub(1)));
        }
        if let Some(face) = first.windows(2).position(|pair| i64::from(pair[1]) - i64::from(pair[0]) < 3) {
            return bad(format!("face {face} has fewer than 3 corners"));
        }
        if let Some(place) = corners.iter().position(|&corner| corner as usize >= points.len()) {
            return bad(format!("corner {place} is point {} of {}", corners[place], points.len()));
        }
        if let Some(place) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            return bad(format!("point {place} is {:?}", points[place].as_slice()));
        }
        Ok(Self { points, first, corners })
    }

    /// Shapes that follow from the planes of the faces alone: of convex cells that meet face to face, as
    /// those of a box do.
    ///
    /// # Errors
    /// Cells that are none.
    pub fn of_planes(mesh: &FarMesh) -> Result<Self, GasError> {
        let (mut points, mut first, mut corners) = (Vec::new(), vec![0], Vec::new());
        for cell in 0..mesh.cell_count() {
            let size = mesh.volumes()[cell].cbrt();
            let begin = points.len();
            for face in 0..mesh.faces_of(cell).len() {
                for corner in polygon(mesh, cell, face) {
                    let known =
                        points[begin..].iter().position(|p: &Vector3<f64>| (p - corner).norm() < 1e-6 * size);
                    let place = begin + known.unwrap_or(points.len() - begin);
                    if known.is_none() {
                        points.push(corner);
                    }
                    corners.push(place as u32);
                }
                first.push(corners.len() as u32);
            }
        }
        Self::new(mesh, points, first, corners)
    }

    /// Shapes of the same faces, the corners of each in order around the normal away from its cell.
    pub(crate) fn turned_outwards(&self, mesh: &FarMesh) -> Self {
        let mut turned = self.clone();
        let cells =
            (0..mesh.cell_count()).flat_map(|cell| vec![mesh.centres()[cell]; mesh.faces_of(cell).len()]);
        for (face, cell) in cells.enumerate() {
            let (corners, centre) = (self.corners(face), self.centre(face));
            let to = |corner: u32| self.points[corner as usize] - centre;
            let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
            let area: Vector3<f64> = pairs.map(|(&one, &next)| to(one).cross(&to(next))).sum();
            if area.dot(&(centre - cell)) < 0.0 {
                turned.corners[self.first(face)..self.first(face + 1)].reverse();
            }
        }
        turned
    }

    /// Points [m]; corners are places among them.
    pub(crate) fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Corners of a face, as places among the points, in order around it.
    pub(crate) fn corners(&self, face: usize) -> &[u32] {
        &self.corners[self.first[face] as usize..self.first[face + 1] as usize]
    }

    /// Number of the first corner of a face among all.
    pub(crate) fn first(&self, face: usize) -> usize {
        self.first[face] as usize
    }

    /// Centre of a face: the mean of its corners [m].
    pub(crate) fn centre(&self, face: usize) -> Vector3<f64> {
        let corners = self.corners(face);
        corners.iter().map(|&corner| self.points[corner as usize]).sum::<Vector3<f64>>()
            / corners.len() as f64
    }
}

/// Corners of a face of a convex cell: a square in its plane, cut by the planes of the other faces [m].
fn polygon(mesh: &FarMesh, cell: usize, face: usize) -> Vec<Vector3<f64>> {
    let (faces, centre) = (mesh.faces_of(cell), mesh.centres()[cell]);
    let reach = |face: &amberfield_field::far::CellFace| face.offset - face.normal.dot(&centre);
    // A cell reaches no farther from its centre than the diagonal of what its faces reach, in each direction.
    let far = 4.0 * faces.iter().map(reach).fold(0.0, f64::max);
    let normal = faces[face].normal;
    let along =
        normal.cross(&if normal.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize() * far;
    let across = normal.cross(&along);
    let foot = centre + normal * reach(&faces[face]);
    let mut around = vec![foot + along, foot + across, foot - along, foot - across];
    let tolerance = ON_PLANE * mesh.volumes()[cell].cbrt();
    for (other, cut) in faces.iter().enumerate().filter(|(other, _)| *other != face) {
        let beyond = |point: &Vector3<f64>| cut.normal.dot(point) - cut.offset;
        if cut.normal.dot(&normal) > 1.0 - 1e-9 && other != face {
            continue;
        }
        let mut kept = Vec::new();
        for (i, from) in around.iter().enumerate() {
            let to = &around[(i + 1) % around.len()];
            let (a, b) = (beyond(from), beyond(to));
            if a <= tolerance {
                kept.push(*from);
            }
            if (a < -tolerance && b > tolerance) || (a > tolerance && b < -tolerance) {
                kept.push(from + (to - from) * (a / (a - b)));
            }
        }
        around = kept;
    }
    around
}
