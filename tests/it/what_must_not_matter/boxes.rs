//! Boxes of equal cells for the stand-in of a field solver, in any frame and in any order.

use super::scene::{Content, Frame, Scene, Solver};
use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_coupling::BoxSolver;
use amberfield_field::far::{CellFace, Condition, FarMeshParts, MeshPatch, Neighbour};

/// Sheet without thickness across x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheet {
    /// Place along x [mm].
    pub(super) x: f64,
    /// End along z [mm]; the sheet begins at 0.
    pub(super) to_z: f64,
    pub(super) condition: Condition,
}

/// Grains in a box of equal cells.
#[derive(Clone, Debug)]
pub(super) struct BoxScene {
    pub(super) content: Content,
    /// Edges [mm] of the box, one corner of which is the origin.
    pub(super) edges: [f64; 3],
    pub(super) cells: [usize; 3],
    pub(super) faces: [[Boundary; 2]; 3],
    pub(super) sheets: Vec<Sheet>,
    /// Changes of the cells before the frame is changed.
    pub(super) changes: Vec<fn(FarMeshParts) -> FarMeshParts>,
}

impl Scene for BoxScene {
    fn content(&self) -> &Content {
        &self.content
    }

    fn solver(&self) -> Solver {
        const CLOSE: f64 = 1e-9;
        let max = 1e-3 * Vector3::from(self.edges);
        let domain = Domain::new(Vector3::zeros(), max, self.faces).expect("a good box");
        let mut parts = FarMeshParts::of_box(&domain, self.cells).expect("a good box");
        for Sheet { x, to_z, condition } in &self.sheets {
            let is_sheet =
                |at: &Vector3<f64>| (at.x - 1e-3 * x).abs() < CLOSE && at.z < 1e-3 * to_z && at.z > 0.0;
            parts = parts.with_sheet(is_sheet, *condition);
        }
        let parts = self.changes.iter().fold(parts, |parts, change| change(parts));
        let solver = BoxSolver::over(in_frame(parts, &self.content.frame)).expect("a good mesh");
        Solver::new(Box::new(solver))
    }
}

/// Cells in another frame.
fn in_frame(mut parts: FarMeshParts, frame: &Frame) -> FarMeshParts {
    let Frame { turn, scale, sign, .. } = *frame;
    let moved = |vectors: &mut Vec<Vector3<f64>>| vectors.iter_mut().for_each(|x| *x = frame.place(x));
    parts.domain = domain_in_frame(&parts.domain, frame);
    moved(&mut parts.centres);
    moved(&mut parts.corners);
    parts.volumes.iter_mut().for_each(|volume| *volume *= scale.powi(3));
    for face in &mut parts.faces {
        face.normal = turn * face.normal;
        face.offset = scale * face.offset + face.normal.dot(&frame.shift);
        if let Neighbour::Cell { shift, .. } = &mut face.neighbour {
            *shift = scale * (turn * *shift);
        }
    }
    for (face, ends) in parts.boundary.iter_mut().zip(parts.first_corner.windows(2)) {
        face.centre = frame.place(&face.centre);
        face.normal = turn * face.normal;
        face.area *= scale * scale;
        face.spread = scale * scale * turn * face.spread * turn.transpose();
        face.condition = match face.condition {
            Condition::Potential(volts) => Condition::Potential(sign * scale * volts),
            Condition::Slope(slope) => Condition::Slope(sign * slope),
        };
        if turn.determinant() < 0.0 {
            parts.corners[ends[0] as usize..ends[1] as usize].reverse();
        }
    }
    parts
}

/// Bounding box in another frame. Axes that repeat must stay axes.
fn domain_in_frame(domain: &Domain, frame: &Frame) -> Domain {
    let ends = [domain.min(), domain.max()];
    let corners = (0..8).map(|corner: usize| {
        let corner = Vector3::from_fn(|axis, _| ends[corner >> axis & 1][axis]);
        frame.place(&corner)
    });
    let (mut min, mut max) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for corner in corners {
        (min, max) = (min.inf(&corner), max.sup(&corner));
    }
    let mut faces = [[Boundary::Open; 2]; 3];
    for (axis, pair) in domain.faces().iter().enumerate() {
        faces[frame.turn.column(axis).iamax()] = *pair;
    }
    Domain::new(min, max, faces).expect("as good as the one given")
}

/// Cells, their faces and the faces at the end of the mesh in another order.
pub(super) fn in_another_order(parts: FarMeshParts) -> FarMeshParts {
    /// Steps through the old order that have no factor in common with the counts.
    const STEP: usize = 101;
    let (cells, ends) = (parts.centres.len(), parts.boundary.len());
    assert!(!cells.is_multiple_of(STEP) && !ends.is_multiple_of(STEP), "the step visits all");
    let old_cell = |new: usize| (new * STEP + 5) % cells;
    let old_end = |new: usize| (new * STEP + 7) % ends;
    let inverse = |count: usize, old: &dyn Fn(usize) -> usize| {
        let mut new = vec![0; count];
        (0..count).for_each(|place| new[old(place)] = place as u32);
        new
    };
    let (new_cell, new_end) = (inverse(cells, &old_cell), inverse(ends, &old_end));

    let mut other = FarMeshParts { first_face: vec![0], first_corner: vec![0], ..parts.clone() };
    other.faces.clear();
    other.boundary.clear();
    other.corners.clear();
    for new in 0..cells {
        let old = old_cell(new);
        other.centres[new] = parts.centres[old];
        other.volumes[new] = parts.volumes[old];
        let faces = &parts.faces[parts.first_face[old] as usize..parts.first_face[old + 1] as usize];
        other.faces.extend(faces.iter().rev().map(|face| {
            let neighbour = match face.neighbour {
                Neighbour::Cell { cell, shift } => Neighbour::Cell { cell: new_cell[cell as usize], shift },
                Neighbour::Boundary(end) => Neighbour::Boundary(new_end[end as usize]),
            };
            CellFace { neighbour, ..*face }
        }));
        other.first_face.push(other.faces.len() as u32);
    }
    for new in 0..ends {
        let old = old_end(new);
        let mut face = parts.boundary[old];
        face.cell = new_cell[face.cell as usize];
        other.boundary.push(face);
        let corners = parts.first_corner[old] as usize..parts.first_corner[old + 1] as usize;
        let mut corners = parts.corners[corners].to_vec();
        // A polygon has no first corner.
        corners.rotate_left(1);
        other.corners.extend(corners);
        other.first_corner.push(other.corners.len() as u32);
    }
    other
}

/// Patches in the reverse order.
pub(super) fn with_patches_reversed(mut parts: FarMeshParts) -> FarMeshParts {
    let last = parts.patches.len() as u32 - 1;
    parts.patches.reverse();
    parts.boundary.iter_mut().for_each(|face| face.patch = last - face.patch);
    parts
}

/// Each patch cut in two, in stripes across y.
pub(super) fn with_patches_split(mut parts: FarMeshParts) -> FarMeshParts {
    let count = parts.patches.len() as u32;
    let more: Vec<_> = parts.patches.iter().map(|patch| renamed(patch, "Second")).collect();
    parts.patches.extend(more);
    let stripes = 5e-4;
    for face in &mut parts.boundary {
        if (face.centre.y / stripes).rem_euclid(2.0) < 1.0 {
            face.patch += count;
        }
    }
    parts
}

/// All patches joined to one.
pub(super) fn with_patches_joined(mut parts: FarMeshParts) -> FarMeshParts {
    parts.patches = vec![renamed(&parts.patches[0], "AndAllOthers")];
    parts.boundary.iter_mut().for_each(|face| face.patch = 0);
    parts
}

fn renamed(patch: &MeshPatch, ending: &str) -> MeshPatch {
    MeshPatch { name: patch.name.clone() + ending, kind: patch.kind.clone() }
}
