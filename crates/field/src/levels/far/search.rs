//! The cell in which a point lies: a walk from where it was, and a tree of all cells where that ends.
//!
//! A walk cannot pass a wall, and the faces of many meshes are not flat: near the edges of their cells a
//! point may be within the planes of two cells, or of none. The tree knows no walls, and gives the cell whose
//! planes the point is least beyond. It is asked wherever the walk's word could depend on its way, so that a
//! grain's cell follows from its place alone.

use super::mesh::{CellFace, FarMesh, Neighbour};
use super::tree::BestCell;
use crate::error::FieldError;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Distance beyond a face at which a point still counts as inside, over the cell's size.
const ON_FACE: f64 = 1e-9;
/// Distance from two faces within which a point may be in other cells too, over the cell's size.
const NEAR_EDGE: f64 = 0.05;
/// Farthest that a grain's centre may be outside the mesh, over the size of the cell there.
const MOST_BEYOND: f64 = 0.5;
/// Cells of a walk at most.
const LONGEST_WALK: usize = 30;

/// Place of a point with respect to a cell.
#[derive(Clone, Copy, Debug)]
struct Standing {
    /// Distance beyond the face that the point is farthest beyond [m]; negative inside.
    beyond: f64,
    /// Whether the mesh ends at that face.
    at_end: bool,
}

impl FarMesh {
    /// The cell that holds a point of the domain [m], and whether the point is inside the mesh (a point
    /// beyond the last face is given to the cell that it is least beyond). `last` is where it was before.
    #[must_use]
    pub fn locate(&self, point: &Vector3<f64>, last: Option<u32>) -> (u32, bool) {
        if let Some(cell) = last.and_then(|last| self.walk(point, last)) {
            return (cell, true);
        }
        let found = self.tree.best(point, |cell| self.standing(point, cell).beyond);
        let size = self.sizes[found.cell as usize];
        // What is beyond a face with a cell behind it is in that cell or between the two.
        let most = if self.standing(point, found.cell).at_end { ON_FACE } else { MOST_BEYOND };
        (found.cell, found.beyond <= most * size)
    }

    /// Refuses grains whose centre lies farther outside the mesh than half of the nearest wall's cell; what
    /// lies a hair beyond a faceted wall belongs to that wall's cell.
    pub(crate) fn check_inside(&self, positions: &[Vector3<f64>], cells: &[u32]) -> Result<(), FieldError> {
        let is_outside = |position: &Vector3<f64>, cell: u32| {
            self.standing(position, cell).beyond > MOST_BEYOND * self.sizes[cell as usize]
        };
        let pairs = positions.par_iter().zip(cells);
        match pairs.position_first(|(position, &cell)| is_outside(position, cell)) {
            None => Ok(()),
            Some(index) => Err(FieldError::Settings(format!(
                "grain at index {index} lies outside the field solver's mesh at {:?} m; enlarge the mesh, \
                 add a wall or move the grain",
                positions[index].as_slice()
            ))),
        }
    }

    /// Goes from cell to cell through the face that the point is farthest beyond. `None` where a wall stands
    /// in the way, or many other cells might hold the point as well.
    fn walk(&self, point: &Vector3<f64>, from: u32) -> Option<u32> {
        let mut cell = from;
        for _ in 0..LONGEST_WALK {
            if !self.reentrant.of(cell as usize).is_empty() {
                return None;
            }
            let size = self.sizes[cell as usize];
            let (on_face, margin) = (ON_FACE * size, NEAR_EDGE * size);
            let (mut next, mut farthest, mut near) = (None, on_face, 0);
            for face in self.faces_of(cell as usize) {
                let beyond = face.beyond(point);
                // A point on a face is as if near an edge: the cell behind may hold it too.
                near += u32::from(beyond > -margin) + u32::from(beyond >= -on_face);
                if beyond > farthest {
                    (next, farthest) = (Some(face.neighbour), beyond);
                }
            }
            match next {
                None if near < 2 => return Some(cell),
                None if near == 2 => return Some(self.best_around_edge(point, cell)),
                Some(Neighbour::Cell { cell: other, shift }) if shift == Vector3::zeros() => cell = other,
                _ => return None,
            }
        }
        None
    }

    /// The best of a cell and those beyond its faces near a point, and beyond theirs there: all that meet in
    /// an edge.
    fn best_around_edge(&self, point: &Vector3<f64>, cell: u32) -> u32 {
        let here = |cell: u32| BestCell { cell, beyond: self.standing(point, cell).beyond };
        let beyond_near_faces = |cell: u32| {
            let margin = NEAR_EDGE * self.sizes[cell as usize];
            let near = move |face: &&CellFace| face.beyond(point) > -margin;
            self.faces_of(cell as usize).iter().filter(near).filter_map(CellFace::leads_to)
        };
        let mut best = here(cell);
        for beside in beyond_near_faces(cell) {
            best =
                beyond_near_faces(beside).fold(best.or(here(beside)), |best, across| best.or(here(across)));
        }
        best.cell
    }

    fn standing(&self, point: &Vector3<f64>, cell: u32) -> Standing {
        let faces = self.faces_of(cell as usize);
        let pairs = self.reentrant.of(cell as usize);
        let mut standing = Standing { beyond: f64::NEG_INFINITY, at_end: false };
        for (number, face) in faces.iter().enumerate() {
            let beside = pairs.iter().filter_map(|pair| pair.beside(number));
            let beyond =
                beside.fold(face.beyond(point), |beyond, other| beyond.min(faces[other].beyond(point)));
            if beyond > standing.beyond {
                let at_end = matches!(face.neighbour, Neighbour::Boundary(_));
                standing = Standing { beyond, at_end };
            }
        }
        standing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::far::{Condition, FarMeshParts};
    use amberfield_core::{Boundary, Domain};

    fn parts(counts: [usize; 3]) -> FarMeshParts {
        let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
        let high = Vector3::from(counts.map(|count| count as f64));
        FarMeshParts::of_box(&Domain::new(Vector3::zeros(), high, faces).unwrap(), counts).unwrap()
    }

    #[test]
    fn points_are_found_from_anywhere_and_strays_belong_to_the_wall() {
        let mesh = FarMesh::new(parts([3, 4, 5])).unwrap();
        for (index, centre) in mesh.centres().iter().enumerate() {
            let near = centre + Vector3::new(0.4, -0.4, 0.3);
            for last in [None, Some(0), Some(59)] {
                assert_eq!(mesh.locate(&near, last), (index as u32, true));
            }
        }
        assert_eq!(mesh.locate(&Vector3::new(0.5, -0.1, 0.5), None), (0, false));
        assert_eq!(mesh.locate(&Vector3::new(0.5, 0.5, 5.1), Some(3)), (48, false));
        assert_eq!(mesh.boundary().len(), 2 * (3 * 5 + 3 * 4));
        let check = |y: f64| {
            let point = Vector3::new(0.5, y, 0.5);
            mesh.check_inside(&[point], &[mesh.locate(&point, None).0])
        };
        assert!(check(-0.4).is_ok() && check(4.4).is_ok());
        assert!(check(-0.6).unwrap_err().to_string().contains("index 0 lies outside"));
        assert!(check(-3.0).is_err() && check(40.0).is_err());
    }

    /// A point has one cell, wherever it was before, also where it lies on a face or an edge.
    #[test]
    fn the_cell_of_a_point_does_not_depend_on_its_way() {
        let mesh = FarMesh::new(parts([3, 4, 5])).unwrap();
        for point in [[1.0, 1.5, 1.5], [1.0, 2.0, 1.5], [2.0, 2.0, 2.0], [1.0 + 1e-11, 1.5, 3.0]] {
            let point = Vector3::from(point);
            let (cell, inside) = mesh.locate(&point, None);
            assert!(inside);
            for last in 0..mesh.cell_count() as u32 {
                assert_eq!(mesh.locate(&point, Some(last)), (cell, true), "{point}");
            }
        }
    }

    #[test]
    fn a_search_does_not_stop_at_dividers() {
        // A labyrinth: walls without thickness from the floor and from the ceiling, one behind the other.
        let mut parts = parts([12, 10, 2]);
        for cell in 0..parts.centres.len() {
            let at = parts.centres[cell];
            for number in parts.first_face[cell] as usize..parts.first_face[cell + 1] as usize {
                let face = parts.faces[number];
                let stands = match (face.offset * face.normal.x).round() as usize {
                    3 | 9 => at.y < 9.0,
                    6 => at.y > 1.0,
                    _ => false,
                };
                if face.normal.x != 0.0 && stands {
                    parts.end_at(cell, number, 1.0, Condition::Potential(0.0));
                }
            }
        }
        let mesh = FarMesh::new(parts).unwrap();
        for (index, centre) in mesh.centres().iter().enumerate() {
            for last in (0..mesh.cell_count() as u32).step_by(7) {
                let near = centre + Vector3::new(-0.4, 0.3, 0.4);
                assert_eq!(mesh.locate(&near, Some(last)), (index as u32, true));
            }
        }
    }

    /// A cube with a notch, as a wing's trailing edge cuts it into a cell.
    #[test]
    fn a_point_beside_a_trailing_edge_is_inside_its_cell() {
        let profile = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.3, 0.5], [1.0, 0.6], [1.0, 1.0], [0.0, 1.0]];
        let mut sides =
            vec![(Vector3::new(0.5, 0.5, 0.0), -Vector3::z()), (Vector3::new(0.5, 0.5, 1.0), Vector3::z())];
        for (place, from) in profile.iter().enumerate() {
            let to = profile[(place + 1) % profile.len()];
            let along = Vector3::new(to[0] - from[0], to[1] - from[1], 0.0);
            let middle = Vector3::new(0.5 * (to[0] + from[0]), 0.5 * (to[1] + from[1]), 0.5);
            sides.push((middle, along.cross(&Vector3::z()).normalize()));
        }
        let mut parts = parts([1, 1, 1]);
        parts.centres = vec![Vector3::new(0.4, 0.5, 0.5)];
        parts.faces.clear();
        parts.boundary.clear();
        parts.corners.clear();
        parts.first_corner.truncate(1);
        for (number, (centre, normal)) in sides.into_iter().enumerate() {
            let neighbour = Neighbour::Boundary(0);
            parts.faces.push(CellFace { normal, offset: normal.dot(&centre), neighbour });
            parts.end_at(0, number, 1.0, Condition::Potential(0.0));
            parts.boundary[number].centre = centre;
        }
        parts.first_face = vec![0, parts.faces.len() as u32];
        let mesh = FarMesh::new(parts).unwrap();
        for [x, y] in [[0.1, 0.5], [0.6, 0.1], [0.6, 0.8], [0.95, 0.35], [0.95, 0.65]] {
            assert_eq!(mesh.locate(&Vector3::new(x, y, 0.5), Some(0)), (0, true), "{x} {y}");
        }
        for [x, y] in [[0.9, 0.5], [1.1, 0.2], [0.5, -0.1]] {
            assert!(!mesh.locate(&Vector3::new(x, y, 0.5), None).1, "{x} {y}");
        }
    }
}
