//! Nodes of a mesh, to which grains are given first: centres of cells, centres of faces, and corners.
//!
//! Every cell is cut into tetrahedra of its centre, a face's centre and two corners that follow each other
//! around the face. A grain has the four nodes of its tetrahedron, weighted by its barycentric coordinates λ:
//! they change without a jump wherever it goes. A node k gives what it has to the cells around it, by the
//! share θ_kc of the volume of its tetrahedra that lies in each:
//!
//! w_c(x) = Σ_k λ_k(x) θ_kc,   ∫ w_c dx = Σ_k θ_kc ∫ λ_k dx = V_c
//!
//! Grains that fill space evenly thus fill every cell evenly, whatever its shape and next to walls too.

use super::numbering::Numbering;
use super::sparse::Rows;
use crate::shapes::CellShapes;
use amberfield_core::Vector3;
use amberfield_field::far::{CellFace, FarMesh, Neighbour};

/// Least volume of a tetrahedron over its cell's: a flatter one holds no grain.
const FLAT: f64 = 1e-9;
/// Distance beyond a face at which a point is still on it, over the face's distance from the cell's centre.
const ON_FACE: f64 = 1e-9;
/// Cells of a walk at most.
const LONGEST_WALK: usize = 20;

/// A grain's nodes and their weights, which add up to one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AtNodes {
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
}

/// Nodes of a mesh. The first are the cells' centres.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    shapes: CellShapes,
    /// Number of the first face of each cell; one more than there are cells.
    first_face: Vec<u32>,
    centres: Vec<Vector3<f64>>,
    volumes: Vec<f64>,
    /// Node of each face, as each of its cells sees it.
    of_face: Vec<u32>,
    /// Centre of each face, as each of its cells sees it [m].
    face_centres: Vec<Vector3<f64>>,
    /// Node of each corner of each face.
    of_corner: Vec<u32>,
    /// Inverse distance of each face from its cell's centre, along its normal [1/m].
    per_reach: Vec<f64>,
    /// Volume of each node, a quarter of that of its tetrahedra [m³].
    pub(super) volumes_of_nodes: Vec<f64>,
    /// Share θ of each node that each cell has.
    pub(super) to_cells: Rows,
}

impl Nodes {
    pub(super) fn new(mesh: &FarMesh, shapes: &CellShapes) -> Self {
        let cells = mesh.cell_count();
        let Numbering { first_face, face_centres, of_face, of_corner, count } = Numbering::new(mesh, shapes);
        let per_reach = |cell: usize| {
            let reach = move |face: &CellFace| face.offset - face.normal.dot(&mesh.centres()[cell]);
            mesh.faces_of(cell).iter().map(move |face| 1.0 / reach(face))
        };
        let mut nodes = Self {
            shapes: shapes.clone(),
            first_face,
            centres: mesh.centres().to_vec(),
            volumes: mesh.volumes().to_vec(),
            of_face,
            face_centres,
            of_corner,
            per_reach: (0..cells).flat_map(per_reach).collect(),
            volumes_of_nodes: Vec::new(),
            to_cells: Rows::default(),
        };
        let mut entries = Vec::new();
        for cell in 0..cells {
            for face in nodes.faces(cell) {
                for corner in 0..shapes.corners(face).len() {
                    let volume = nodes.tetrahedron(cell, face, corner).volume();
                    for node in nodes.nodes_of(cell, face, corner) {
                        entries.push((node, cell as u32, 0.25 * volume));
                    }
                }
            }
        }
        let shares = Rows::new(count as usize, entries);
        nodes.volumes_of_nodes = (0..shares.len()).map(|node| shares.sum(node)).collect();
        nodes.to_cells = shares.with(|node, _, volume| volume / nodes.volumes_of_nodes[node]);
        nodes
    }

    /// Number of nodes.
    pub(super) fn count(&self) -> usize {
        self.volumes_of_nodes.len()
    }

    /// Conductances between nodes [m³], (node, other, G) from both sides: of diffusion that spreads by σ
    /// along an axis, nowhere by less than a share `least` of a cell.
    ///
    /// An edge of length d of a tetrahedron of volume V has G = σ² V/(4 d²): over the six edges of a regular
    /// one that is diffusion the same in all directions, and no G is negative, as some of linear finite
    /// elements are.
    pub(super) fn conductances(&self, spread: f64, least: f64) -> Vec<(u32, u32, f64)> {
        let mut all = Vec::new();
        let mut of_cell: Vec<(u32, u32, f64)> = Vec::new();
        for cell in 0..self.centres.len() {
            of_cell.clear();
            for face in self.faces(cell) {
                for corner in 0..self.shapes.corners(face).len() {
                    let tetrahedron = self.tetrahedron(cell, face, corner);
                    let quarter = 0.25 * tetrahedron.volume();
                    let nodes = self.nodes_of(cell, face, corner);
                    for (a, b, of_cell_squared, squared) in tetrahedron.sides() {
                        let floor = least * least * of_cell_squared;
                        let conductance = quarter * (spread * spread / squared).max(floor);
                        let (a, b) = (nodes[a], nodes[b]);
                        if a != b && conductance.is_finite() {
                            of_cell.push((a.min(b), a.max(b), conductance));
                        }
                    }
                }
            }
            of_cell.sort_unstable_by_key(|&(a, b, _)| (a, b));
            of_cell.dedup_by(|next, kept| {
                let same = (next.0, next.1) == (kept.0, kept.1);
                if same {
                    kept.2 += next.2;
                }
                same
            });
            all.extend(
                of_cell.iter().flat_map(|&(a, b, conductance)| [(a, b, conductance), (b, a, conductance)]),
            );
        }
        all
    }

    fn faces(&self, cell: usize) -> std::ops::Range<usize> {
        self.first_face[cell] as usize..self.first_face[cell + 1] as usize
    }

    /// Nodes of the tetrahedron at a corner of a face: centre, face, corner, next corner.
    fn nodes_of(&self, cell: usize, face: usize, corner: usize) -> [u32; 4] {
        let (begin, count) = (self.shapes.first(face), self.shapes.corners(face).len());
        let corners = &self.of_corner[begin..begin + count];
        [cell as u32, self.of_face[face], corners[corner], corners[(corner + 1) % count]]
    }

    fn tetrahedron(&self, cell: usize, face: usize, corner: usize) -> Tetrahedron {
        let corners = self.shapes.corners(face);
        let centre = self.centres[cell];
        // A choice instead of `%`, which divides.
        let next = if corner + 1 == corners.len() { 0 } else { corner + 1 };
        let to = |corner: usize| self.shapes.points()[corners[corner] as usize] - centre;
        let edges = [self.face_centres[face] - centre, to(corner), to(next)];
        Tetrahedron { edges }
    }

    /// Nodes and weights of a grain at a point [m] that is in a cell or near it.
    ///
    /// Beyond a wall they are those of a point on it.
    pub(super) fn at(&self, mesh: &FarMesh, point: &Vector3<f64>, cell: u32) -> AtNodes {
        let (mut cell, mut point) = (cell as usize, *point);
        let mut face = self.ahead(mesh, cell, &point);
        for _ in 0..LONGEST_WALK {
            let crossed = &mesh.faces_of(cell)[face.number];
            let Neighbour::Cell { cell: other, shift } = crossed.neighbour else { break };
            if face.ahead <= 1.0 + ON_FACE {
                break;
            }
            (cell, point) = (other as usize, point - shift);
            face = self.ahead(mesh, cell, &point);
        }
        let from = point - self.centres[cell];
        let first = self.first_face[cell] as usize;
        self.quick(cell, first + face.number, &from).unwrap_or_else(|| self.best(cell, &from))
    }

    /// Face through which the ray from a cell's centre through a point [m] leaves a convex cell.
    fn ahead(&self, mesh: &FarMesh, cell: usize, point: &Vector3<f64>) -> Ahead {
        let from = point - self.centres[cell];
        let mut face = Ahead { ahead: f64::NEG_INFINITY, number: 0 };
        for (number, plane) in mesh.faces_of(cell).iter().enumerate() {
            let ahead = plane.normal.dot(&from) * self.per_reach[self.first_face[cell] as usize + number];
            if ahead > face.ahead {
                face = Ahead { ahead, number };
            }
        }
        face
    }

    /// Nodes and weights in the tetrahedron of a face that holds a place seen from the cell's centre [m].
    fn quick(&self, cell: usize, face: usize, from: &Vector3<f64>) -> Option<AtNodes> {
        for corner in 0..self.shapes.corners(face).len() {
            let [a, b, c] = self.tetrahedron(cell, face, corner).edges;
            let across = b.cross(&c);
            let volume = a.dot(&across);
            let first = from.dot(&across) / volume;
            let second = from.dot(&c.cross(&a)) / volume;
            let third = from.dot(&a.cross(&b)) / volume;
            let rest = 1.0 - first - second - third;
            // Of a flat one these are no numbers, or large ones of either sign.
            if first >= 0.0 && second >= 0.0 && third >= 0.0 && rest >= 0.0 {
                let nodes = self.nodes_of(cell, face, corner);
                return Some(AtNodes { nodes, weights: [rest, first, second, third] });
            }
        }
        None
    }

    /// Nodes and weights in the tetrahedron of a cell that a place is least outside of.
    fn best(&self, cell: usize, from: &Vector3<f64>) -> AtNodes {
        let mut best =
            (f64::NEG_INFINITY, AtNodes { nodes: [cell as u32; 4], weights: [1.0, 0.0, 0.0, 0.0] });
        for face in self.faces(cell) {
            for corner in 0..self.shapes.corners(face).len() {
                let tetrahedron = self.tetrahedron(cell, face, corner);
                if tetrahedron.volume() < FLAT * self.volumes[cell] {
                    continue;
                }
                let weights = tetrahedron.coordinates(from);
                let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
                if least > best.0 {
                    best = (least, AtNodes { nodes: self.nodes_of(cell, face, corner), weights });
                }
            }
        }
        let AtNodes { nodes, weights } = best.1;
        let inside = weights.map(|weight| weight.max(0.0));
        let sum: f64 = inside.iter().sum();
        AtNodes { nodes, weights: inside.map(|weight| weight / sum) }
    }
}

/// Face ahead of a point as a cell's centre sees it.
#[derive(Clone, Copy)]
struct Ahead {
    /// Distance of the point along the face's normal over that of the face; above 1 the point is beyond it.
    ahead: f64,
    /// Number of the face among the cell's.
    number: usize,
}

/// A tetrahedron of a cell's centre and three more places.
struct Tetrahedron {
    /// Vectors from the centre to the others [m].
    edges: [Vector3<f64>; 3],
}

impl Tetrahedron {
    /// Volume [m³], of either sign for either order of the corners.
    fn signed(&self) -> f64 {
        self.edges[0].dot(&self.edges[1].cross(&self.edges[2])) / 6.0
    }

    /// Volume [m³].
    fn volume(&self) -> f64 {
        self.signed().abs()
    }

    /// Sides: the numbers of two corners (0 the cell's centre, 1 the face's), the square of a cell's size
    /// over the side's length in a cube, and the squared length [m²].
    fn sides(&self) -> [(usize, usize, f64, f64); 6] {
        let [a, b, c] = &self.edges;
        [
            (0, 1, 4.0, a.norm_squared()),
            (0, 2, 4.0 / 3.0, b.norm_squared()),
            (0, 3, 4.0 / 3.0, c.norm_squared()),
            (1, 2, 2.0, (b - a).norm_squared()),
            (1, 3, 2.0, (c - a).norm_squared()),
            (2, 3, 1.0, (c - b).norm_squared()),
        ]
    }

    /// Barycentric coordinates of a place seen from the centre [m].
    fn coordinates(&self, place: &Vector3<f64>) -> [f64; 4] {
        let [a, b, c] = &self.edges;
        let per_volume = 1.0 / a.dot(&b.cross(c));
        let first = place.dot(&b.cross(c)) * per_volume;
        let second = place.dot(&c.cross(a)) * per_volume;
        let third = place.dot(&a.cross(b)) * per_volume;
        [1.0 - first - second - third, first, second, third]
    }
}
