//! Nodes of a mesh, to which grains are given first: corners of cells.
//!
//! Every cell is cut into tetrahedra of its centre, a face's centre and two corners that follow each other
//! around the face. A grain is given to the four places of its tetrahedron by its barycentric coordinates.
//! What a centre gets goes to the corners around it, each alike. The weights λ change without a jump wherever
//! a grain goes. A node k gives what it has to the cells around it, by the share θ_kc of ∫ λ_k dx that lies
//! in each:
//!
//! w_c(x) = Σ_k λ_k(x) θ_kc,   ∫ w_c dx = Σ_k θ_kc ∫ λ_k dx = V_c
//!
//! Grains that fill space evenly thus fill every cell evenly, whatever its shape and next to walls too.

use super::numbering::Numbering;
use super::sparse::Rows;
use crate::shapes::CellShapes;
use amberfield_core::Vector3;
use amberfield_field::far::{CellFace, FarMesh, Neighbour};
use nalgebra::Matrix3;

/// Least volume of a tetrahedron over its cell's: a flatter one holds no grain.
const FLAT: f64 = 1e-9;
/// Distance beyond a face at which a point is still on it, over the face's distance from the cell's centre.
const ON_FACE: f64 = 1e-9;
/// Part of the wanted spread that the nodes' functions make, and least that diffusion adds: variances along
/// an axis over the square of a cell's edge.
const BY_NODES: f64 = 0.2;
const LEAST: f64 = 0.1;
/// Cells of a walk at most.
const LONGEST_WALK: usize = 20;

/// Tetrahedron that a place is in, and its barycentric coordinates: of the cell's centre, the face's, the
/// corner and the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    face: usize,
    corner: usize,
    weights: [f64; 4],
}

/// Weights of a cell's nodes, in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct OfNodes {
    /// Weight of the cell's centre, which is for all of them.
    centre: f64,
    weights: Vec<f64>,
}

/// Nodes of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    centres: Vec<Vector3<f64>>,
    volumes: Vec<f64>,
    /// Number of the first face of each cell; one more than there are cells.
    first_face: Vec<u32>,
    /// Normal of each face over its distance from its cell's centre [1/m].
    outwards: Vec<Vector3<f64>>,
    /// Centre of each face, from its cell's [m].
    to_face: Vec<Vector3<f64>>,
    /// Number of the first of each cell's corners; one more than there are cells.
    first_of_cell: Vec<u32>,
    /// Node of each cell's corners.
    of_cell: Vec<u32>,
    /// Places of each cell's corners, from its centre [m].
    to_corner: Vec<Vector3<f64>>,
    /// Number of the first corner of each face; one more than there are faces.
    first_corner: Vec<u32>,
    /// Place of each corner of each face among those of its cell; in order around the normal outwards.
    of_face: Vec<u16>,
    /// Volume of each node, ∫ λ dx [m³].
    pub(super) volumes_of_nodes: Vec<f64>,
    /// Share θ of each node that each cell has.
    pub(super) to_cells: Rows,
    /// Variance by cell of where the cells are that the nodes give a grain to [m²].
    pub(super) variances: Vec<Matrix3<f64>>,
}

impl Nodes {
    pub(super) fn new(mesh: &FarMesh, shapes: &CellShapes) -> Self {
        let cells = mesh.cell_count();
        let shapes = shapes.turned_outwards(mesh);
        let Numbering { first_face, of_corner, count } = Numbering::new(mesh, &shapes);
        let outwards = |cell: usize| {
            let reach = move |face: &CellFace| face.offset - face.normal.dot(&mesh.centres()[cell]);
            mesh.faces_of(cell).iter().map(move |face| face.normal / reach(face))
        };
        let mut nodes = Self {
            centres: mesh.centres().to_vec(),
            volumes: mesh.volumes().to_vec(),
            first_face,
            outwards: (0..cells).flat_map(outwards).collect(),
            to_face: Vec::new(),
            first_of_cell: vec![0],
            of_cell: Vec::new(),
            to_corner: Vec::new(),
            first_corner: vec![0],
            of_face: Vec::new(),
            volumes_of_nodes: Vec::new(),
            to_cells: Rows::default(),
            variances: Vec::new(),
        };
        let (mut entries, mut of_nodes) = (Vec::new(), OfNodes::default());
        // Sums of squared distances: of nodes from places in a cell, and of cells from a node.
        let none = Matrix3::zeros();
        let (mut from_places, mut from_nodes) = (vec![none; cells], vec![none; count as usize]);
        for (cell, from_places) in from_places.iter_mut().enumerate() {
            nodes.add_cell(cell, &shapes, &of_corner);
            nodes.begin(cell, &mut of_nodes);
            for face in nodes.faces(cell) {
                for corner in 0..nodes.corners(face).len() {
                    let tetrahedron = nodes.tetrahedron(cell, face, corner);
                    let volume = tetrahedron.volume();
                    nodes.add(&Inside { face, corner, weights: [0.25; 4] }, volume, &mut of_nodes);
                    *from_places -= tetrahedron.mean_square() * volume;
                }
            }
            let corners = nodes.weights(cell, &of_nodes).zip(&nodes.to_corner[nodes.of_cell(cell)]);
            for ((node, volume), to_corner) in corners {
                entries.push((node, cell as u32, volume));
                let square = to_corner * to_corner.transpose() * volume;
                *from_places += square;
                from_nodes[node as usize] += square;
            }
        }
        let shares = Rows::new(count as usize, entries);
        nodes.volumes_of_nodes = (0..shares.len()).map(|node| shares.sum(node)).collect();
        nodes.to_cells = shares.with(|node, _, volume| volume / nodes.volumes_of_nodes[node]);
        for (node, from_node) in from_nodes.into_iter().enumerate() {
            nodes.to_cells.of(node).for_each(|(cell, share)| from_places[cell] += from_node * share);
        }
        nodes.variances = from_places.iter().zip(&nodes.volumes).map(|(sum, volume)| sum / *volume).collect();
        nodes
    }

    /// Adds the corners and faces of the next cell, from the nodes of all corners.
    fn add_cell(&mut self, cell: usize, shapes: &CellShapes, of_corner: &[u32]) {
        let (faces, centre) = (self.faces(cell), self.centres[cell]);
        let all = faces.clone().flat_map(|face| {
            shapes
                .corners(face)
                .iter()
                .zip(&of_corner[shapes.first(face)..])
                .map(|(&point, &node)| (point, node))
        });
        let mut own: Vec<(u32, u32)> = all.collect();
        own.sort_unstable();
        own.dedup();
        for face in faces {
            let place = |point: &u32| own.partition_point(|(other, _)| other < point) as u16;
            self.of_face.extend(shapes.corners(face).iter().map(place));
            self.first_corner.push(self.of_face.len() as u32);
            self.to_face.push(shapes.centre(face) - centre);
        }
        self.of_cell.extend(own.iter().map(|&(_, node)| node));
        self.to_corner.extend(own.iter().map(|&(point, _)| shapes.points()[point as usize] - centre));
        self.first_of_cell.push(self.of_cell.len() as u32);
    }

    /// Number of nodes.
    pub(super) fn count(&self) -> usize {
        self.volumes_of_nodes.len()
    }

    /// Variance by cell that diffusion to a spread [m] adds [m²].
    pub(super) fn diffused(&self, spread: f64) -> Vec<Matrix3<f64>> {
        let of_cell = |cell: usize| {
            let mut sum = Matrix3::zeros();
            for face in self.faces(cell) {
                for corner in 0..self.corners(face).len() {
                    let tetrahedron = self.tetrahedron(cell, face, corner);
                    let edge = tetrahedron.edge();
                    let of_edge = of_diffusion(spread, edge.norm_squared());
                    if of_edge.is_finite() {
                        sum += edge * edge.transpose() * (3.0 * tetrahedron.volume() * of_edge);
                    }
                }
            }
            sum / self.volumes[cell]
        };
        (0..self.centres.len()).map(of_cell).collect()
    }

    /// Conductances between nodes [m³], (node, other, G) from both sides: of diffusion that together with the
    /// nodes' own functions spreads by σ along an axis, or by some 0.7 of a cell where that is more.
    ///
    /// All of the diffusion is along the cells' edges. One of length d, in tetrahedra of volume V, has
    /// G = 3 σ² V/(2 d²): in cuboids that is the same in all directions, and no G is negative, as some of
    /// linear finite elements are.
    pub(super) fn conductances(&self, spread: f64) -> Vec<(u32, u32, f64)> {
        let mut all = Vec::new();
        for cell in 0..self.centres.len() {
            for face in self.faces(cell) {
                for corner in 0..self.corners(face).len() {
                    let tetrahedron = self.tetrahedron(cell, face, corner);
                    let of_edge = of_diffusion(spread, tetrahedron.edge().norm_squared());
                    let conductance = 1.5 * tetrahedron.volume() * of_edge;
                    let [a, b] = self.side(cell, face, corner);
                    if a != b && conductance.is_finite() {
                        all.extend([(a, b, conductance), (b, a, conductance)]);
                    }
                }
            }
        }
        all
    }

    fn faces(&self, cell: usize) -> std::ops::Range<usize> {
        self.first_face[cell] as usize..self.first_face[cell + 1] as usize
    }

    /// Corners of a cell, as places among those of all cells.
    fn of_cell(&self, cell: usize) -> std::ops::Range<usize> {
        self.first_of_cell[cell] as usize..self.first_of_cell[cell + 1] as usize
    }

    /// Corners of a face, as places among those of its cell.
    fn corners(&self, face: usize) -> &[u16] {
        &self.of_face[self.first_corner[face] as usize..self.first_corner[face + 1] as usize]
    }

    /// Nodes of the side between a corner of a face and the next.
    fn side(&self, cell: usize, face: usize, corner: usize) -> [u32; 2] {
        let (corners, nodes) = (self.corners(face), &self.of_cell[self.of_cell(cell)]);
        [corner, (corner + 1) % corners.len()].map(|corner| nodes[corners[corner] as usize])
    }

    #[inline(always)]
    fn tetrahedron(&self, cell: usize, face: usize, corner: usize) -> Tetrahedron {
        let (corners, to_corner) = (self.corners(face), &self.to_corner[self.of_cell(cell)]);
        // A choice instead of `%`, which divides.
        let next = if corner + 1 == corners.len() { 0 } else { corner + 1 };
        let [one, two] = [corner, next].map(|corner| to_corner[corners[corner] as usize]);
        Tetrahedron { edges: [self.to_face[face], one, two] }
    }

    /// Cell and tetrahedron of a point [m] that is in a cell or near it.
    ///
    /// Beyond a wall it is that of a point on it.
    pub(super) fn at(&self, mesh: &FarMesh, point: &Vector3<f64>, cell: u32) -> (usize, Inside) {
        let (mut cell, mut point) = (cell as usize, *point);
        let mut from = point - self.centres[cell];
        let mut face = self.ahead(cell, &from);
        for _ in 0..LONGEST_WALK {
            if face.ahead <= 1.0 + ON_FACE {
                break;
            }
            let crossed = &mesh.faces_of(cell)[face.number];
            let Neighbour::Cell { cell: other, shift } = crossed.neighbour else { break };
            (cell, point) = (other as usize, point - shift);
            from = point - self.centres[cell];
            face = self.ahead(cell, &from);
        }
        let first = self.first_face[cell] as usize;
        let face = first + face.number;
        let inside = self.quick(cell, face, &from).or_else(|| self.best(cell, &from));
        (cell, inside.unwrap_or(Inside { face, corner: 0, weights: [1.0, 0.0, 0.0, 0.0] }))
    }

    /// Begins with no weights of a cell's nodes.
    pub(super) fn begin(&self, cell: usize, of_nodes: &mut OfNodes) {
        of_nodes.centre = 0.0;
        of_nodes.weights.clear();
        of_nodes.weights.resize(self.of_cell(cell).len(), 0.0);
    }

    /// Adds the weights of a tetrahedron's places, times a share.
    pub(super) fn add(&self, inside: &Inside, share: f64, of_nodes: &mut OfNodes) {
        let Inside { face, corner, weights: [centre, of_face, one, two] } = *inside;
        let places = self.corners(face);
        let weights = &mut of_nodes.weights;
        of_nodes.centre += share * centre;
        let each = share * of_face / places.len() as f64;
        places.iter().for_each(|&place| weights[place as usize] += each);
        weights[places[corner] as usize] += share * one;
        let next = if corner + 1 == places.len() { 0 } else { corner + 1 };
        weights[places[next] as usize] += share * two;
    }

    /// Nodes of a cell and their weights, with what its centre has.
    pub(super) fn weights(&self, cell: usize, of_nodes: &OfNodes) -> impl Iterator<Item = (u32, f64)> {
        let nodes = &self.of_cell[self.of_cell(cell)];
        let each = of_nodes.centre / nodes.len() as f64;
        nodes.iter().zip(&of_nodes.weights).map(move |(&node, weight)| (node, weight + each))
    }

    /// Face through which a ray from the centre of a convex cell leaves it.
    fn ahead(&self, cell: usize, from: &Vector3<f64>) -> Ahead {
        let mut face = Ahead { ahead: f64::NEG_INFINITY, number: 0 };
        for (number, outwards) in self.outwards[self.faces(cell)].iter().enumerate() {
            let ahead = outwards.dot(from);
            face.number = if ahead > face.ahead { number } else { face.number };
            face.ahead = ahead.max(face.ahead);
        }
        face
    }

    /// Tetrahedron of a face that holds a place seen from the cell's centre [m].
    fn quick(&self, cell: usize, face: usize, from: &Vector3<f64>) -> Option<Inside> {
        // The place is beside the plane of centre, face's centre and corner by as much as this says.
        let across = self.to_face[face].cross(from);
        let (corners, to_corner) = (self.corners(face), &self.to_corner[self.of_cell(cell)]);
        let beside = |&corner: &u16| across.dot(&to_corner[corner as usize]);
        // The place is where one corner is on its one side and the next on its other.
        let last = corners.len() - 1;
        let (mut corner, mut before, mut is_before) = (0, last, beside(&corners[last]) <= 0.0);
        for (number, point) in corners.iter().enumerate() {
            let here = beside(point);
            // A choice without a branch, which nothing could foretell.
            corner = if is_before & (here >= 0.0) { before } else { corner };
            (before, is_before) = (number, here <= 0.0);
        }
        let [a, b, c] = self.tetrahedron(cell, face, corner).edges;
        let normal = b.cross(&c);
        let per_volume = 1.0 / a.dot(&normal);
        let of_face = from.dot(&normal) * per_volume;
        let one = across.dot(&c) * per_volume;
        let two = -across.dot(&b) * per_volume;
        let weights = [1.0 - of_face - one - two, of_face, one, two];
        // Of a flat one these are no numbers, or large ones of either sign.
        weights.iter().all(|&weight| weight >= 0.0).then_some(Inside { face, corner, weights })
    }

    /// Tetrahedron of a cell that a place is least outside of.
    fn best(&self, cell: usize, from: &Vector3<f64>) -> Option<Inside> {
        let (mut nearest, mut best) = (f64::NEG_INFINITY, None);
        for face in self.faces(cell) {
            for corner in 0..self.corners(face).len() {
                let tetrahedron = self.tetrahedron(cell, face, corner);
                if tetrahedron.volume() < FLAT * self.volumes[cell] {
                    continue;
                }
                let weights = tetrahedron.coordinates(from);
                let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
                if least > nearest {
                    (nearest, best) = (least, Some(Inside { face, corner, weights }));
                }
            }
        }
        best.map(|inside| {
            let weights = inside.weights.map(|weight| weight.max(0.0));
            let sum: f64 = weights.iter().sum();
            Inside { weights: weights.map(|weight| weight / sum), ..inside }
        })
    }
}

/// Variance along an axis that diffusion adds to reach a spread [m], over the squared length of a cell's edge
/// [m²].
fn of_diffusion(spread: f64, squared: f64) -> f64 {
    (spread * spread / squared - BY_NODES).max(LEAST)
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

    /// Edge of the cell that is its side [m].
    fn edge(&self) -> Vector3<f64> {
        self.edges[2] - self.edges[1]
    }

    /// Mean square of the place from the cell's centre [m²].
    fn mean_square(&self) -> Matrix3<f64> {
        let sum: Vector3<f64> = self.edges.iter().sum();
        let squares: Matrix3<f64> = self.edges.iter().chain([&sum]).map(|edge| edge * edge.transpose()).sum();
        squares / 20.0
    }

    /// Volume [m³].
    fn volume(&self) -> f64 {
        self.signed().abs()
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
