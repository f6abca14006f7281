//! A mesh of equal cells in a box.

use super::{BoundaryFace, CellFace, Condition, FarMeshParts, MeshPatch, Neighbour};
use crate::error::FieldError;
use amberfield_core::{Axis, Boundary, Domain};
use nalgebra::{Matrix3, Vector3};

/// Names of a box's patches: both sides of each axis.
const PATCHES: [&str; 6] = ["xMin", "xMax", "yMin", "yMax", "zMin", "zMax"];

impl FarMeshParts {
    /// A box of `counts` equal cells with the domain's faces; a mesh for tests and comparisons.
    ///
    /// # Errors
    /// Open faces: a mesh ends somewhere.
    pub fn of_box(domain: &Domain, counts: [usize; 3]) -> Result<Self, FieldError> {
        let size = Vector3::from_fn(|axis, _| domain.extent()[axis] / counts[axis] as f64);
        let mut faces = Vec::new();
        let (mut boundary, mut first_face, mut centres) = (Vec::new(), vec![0], Vec::new());
        let (mut first_corner, mut corners) = (vec![0], Vec::new());
        let index = |at: [usize; 3]| ((at[2] * counts[1] + at[1]) * counts[0] + at[0]) as u32;
        for cell in 0..counts.iter().product::<usize>() {
            let at = [cell % counts[0], cell / counts[0] % counts[1], cell / counts[0] / counts[1]];
            let centre = domain.min() + Vector3::from_fn(|axis, _| (at[axis] as f64 + 0.5) * size[axis]);
            centres.push(centre);
            for axis in Axis::ALL {
                let a = axis.index();
                for (side, sign) in [(0, -1.0), (1, 1.0)] {
                    let mut normal = Vector3::zeros();
                    normal[a] = sign;
                    let mut face_centre = centre;
                    face_centre[a] += 0.5 * sign * size[a];
                    let last = if side == 0 { at[a] == 0 } else { at[a] + 1 == counts[a] };
                    let mut next = at;
                    next[a] = (at[a] + if side == 0 { counts[a] - 1 } else { 1 }) % counts[a];
                    let condition = condition_of(domain.faces()[a][side])?;
                    let neighbour = if !last {
                        Neighbour::Cell { cell: index(next), shift: Vector3::zeros() }
                    } else if domain.is_periodic(axis) {
                        let shift = normal * domain.extent()[a];
                        Neighbour::Cell { cell: index(next), shift }
                    } else {
                        let area = size.product() / size[a];
                        let cell = cell as u32;
                        let mut half = 0.5 * size;
                        half[a] = 0.0;
                        boundary.push(BoundaryFace {
                            centre: face_centre,
                            normal,
                            area,
                            spread: Matrix3::from_diagonal(&half.component_mul(&half)),
                            cell,
                            patch: (2 * a + side) as u32,
                            condition,
                        });
                        corners.extend(corners_of(face_centre, half, a, sign));
                        first_corner.push(corners.len() as u32);
                        Neighbour::Boundary(boundary.len() as u32 - 1)
                    };
                    faces.push(CellFace { normal, offset: normal.dot(&face_centre), neighbour });
                }
            }
            first_face.push(faces.len() as u32);
        }
        let ends = domain.faces().map(|pair| {
            pair.map(|face| if face == Boundary::Periodic { Boundary::Periodic } else { Boundary::Open })
        });
        let domain = Domain::new(domain.min(), domain.max(), ends).expect("as good as the domain given");
        let volumes = vec![size.product(); centres.len()];
        let wall = |name: &str| MeshPatch { name: name.to_owned(), kind: "wall".to_owned() };
        let patches = PATCHES.map(wall).to_vec();
        let changing = Vec::new();
        Ok(Self {
            domain,
            centres,
            volumes,
            first_face,
            faces,
            boundary,
            first_corner,
            corners,
            patches,
            changing,
        })
    }

    /// Puts a sheet without thickness into a box of equal cells: at every face between cells whose centre [m]
    /// `is_sheet`, both sides end with a condition.
    #[must_use]
    pub fn with_sheet(mut self, is_sheet: impl Fn(&Vector3<f64>) -> bool, condition: Condition) -> Self {
        let name = "sheet".to_owned();
        self.patches.push(MeshPatch { name, kind: "wall".to_owned() });
        for cell in 0..self.centres.len() {
            let faces = self.first_face[cell] as usize..self.first_face[cell + 1] as usize;
            let here = self.centres[cell];
            // Faces come in pairs, one pair an axis.
            let half = Vector3::from_fn(|axis, _| {
                let upper = &self.faces[faces.start + 2 * axis + 1];
                upper.offset - upper.normal.dot(&here)
            });
            for face in faces {
                let CellFace { normal, offset, neighbour } = self.faces[face];
                let centre = here + normal * (offset - normal.dot(&here));
                if !matches!(neighbour, Neighbour::Cell { .. }) || !is_sheet(&centre) {
                    continue;
                }
                let axis = normal.iamax();
                let mut along = half;
                along[axis] = 0.0;
                self.faces[face].neighbour = Neighbour::Boundary(self.boundary.len() as u32);
                self.boundary.push(BoundaryFace {
                    centre,
                    normal,
                    area: 4.0 * half.product() / half[axis],
                    spread: Matrix3::from_diagonal(&along.component_mul(&along)),
                    cell: cell as u32,
                    patch: self.patches.len() as u32 - 1,
                    condition,
                });
                self.corners.extend(corners_of(centre, along, axis, normal[axis].signum()));
                self.first_corner.push(self.corners.len() as u32);
            }
        }
        self
    }
}

/// Condition of a face of a box.
fn condition_of(face: Boundary) -> Result<Condition, FieldError> {
    match face {
        Boundary::Grounded => Ok(Condition::Potential(0.0)),
        Boundary::Potential(volts) => Ok(Condition::Potential(volts)),
        Boundary::Insulating { normal_field_v_m } => Ok(Condition::Slope(-normal_field_v_m)),
        Boundary::Periodic => Ok(Condition::Slope(0.0)),
        _ => Err(FieldError::Settings("a mesh has no open faces; close the domain".into())),
    }
}

/// Corners of a rectangle across an axis, right-handed about its normal, which points along the axis or, with
/// a negative sign, against it.
fn corners_of(centre: Vector3<f64>, half: Vector3<f64>, axis: usize, sign: f64) -> [Vector3<f64>; 4] {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[u, v]| {
        let mut corner = centre;
        corner[next] += sign * u * half[next];
        corner[last] += v * half[last];
        corner
    })
}
