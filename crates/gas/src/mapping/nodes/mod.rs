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

mod block;
mod crossing;
mod finding;
mod tetrahedron;

use super::numbering::Numbering;
use super::sparse::Rows;
use crate::shapes::CellShapes;
use amberfield_core::Vector3;
use amberfield_field::far::{CellFace, FarMesh};
use block::Block;
use crossing::Crossing;
pub(super) use crossing::FromCrossing;
use nalgebra::Matrix3;
use tetrahedron::Tetrahedron;

/// Part of the wanted spread that the nodes' functions make, and least that diffusion adds: variances along
/// an axis over the square of a cell's edge.
const BY_NODES: f64 = 0.2;
const LEAST: f64 = 0.1;
/// Position of a place in its cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Inside {
    /// Coordinates in a parallelepiped.
    Block(Vector3<f64>),
    /// Tetrahedron of another cell.
    Tetrahedron(InTetrahedron),
}

/// Tetrahedron that a place is in, and its barycentric coordinates: of the cell's centre, the face's, the
/// corner and the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct InTetrahedron {
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
    /// Cells that are parallelepipeds; their corners stand in the order of their numbers.
    blocks: Vec<Option<Block>>,
    /// Cuboids around each node, where there are no other cells.
    crossings: Vec<Option<Crossing>>,
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
            blocks: Vec::new(),
            crossings: Vec::new(),
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
                    let middle = InTetrahedron { face, corner, weights: [0.25; 4] };
                    nodes.add(&middle, volume, &mut of_nodes);
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
        nodes.crossings = Crossing::of_nodes(&nodes, count as usize);
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
        let seen = |&(point, _): &(u32, u32)| shapes.points()[point as usize] - centre;
        self.to_face.extend(faces.clone().map(|face| shapes.centre(face) - centre));
        let block = Block::new(&self.to_face[faces.clone()], &own.iter().map(seen).collect::<Vec<_>>());
        if let Some((_, numbers)) = &block {
            own = numbers.map(|place| own[place]).to_vec();
        }
        self.blocks.push(block.map(|(block, _)| block));
        for face in faces {
            let place = |corner: &u32| own.iter().position(|(point, _)| point == corner);
            let places = shapes.corners(face).iter().filter_map(place);
            self.of_face.extend(places.map(|place| place as u16));
            self.first_corner.push(self.of_face.len() as u32);
        }
        self.of_cell.extend(own.iter().map(|&(_, node)| node));
        self.to_corner.extend(own.iter().map(seen));
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

    /// Begins with no weights of a cell's nodes.
    fn begin(&self, cell: usize, of_nodes: &mut OfNodes) {
        of_nodes.centre = 0.0;
        of_nodes.weights.clear();
        of_nodes.weights.resize(self.of_cell(cell).len(), 0.0);
    }

    /// Gives the nodes of a cell and their weights for places in it, times their shares.
    #[inline(always)]
    pub(super) fn give(
        &self,
        cell: usize,
        places: impl Iterator<Item = (Inside, f64)>,
        of_nodes: &mut OfNodes,
        give: &mut impl FnMut(u32, f64),
    ) {
        if self.blocks[cell].is_some() {
            let mut weights = [0.0; 8];
            for (inside, share) in places {
                if let Inside::Block(at) = inside {
                    Block::add(&at, share, &mut weights);
                }
            }
            let nodes = &self.of_cell[self.of_cell(cell)];
            return nodes.iter().zip(weights).for_each(|(&node, weight)| give(node, weight));
        }
        self.begin(cell, of_nodes);
        for (inside, share) in places {
            if let Inside::Tetrahedron(inside) = inside {
                self.add(&inside, share, of_nodes);
            }
        }
        self.weights(cell, of_nodes).for_each(|(node, weight)| give(node, weight));
    }

    /// Adds the weights of a tetrahedron's places, times a share.
    fn add(&self, inside: &InTetrahedron, share: f64, of_nodes: &mut OfNodes) {
        let InTetrahedron { face, corner, weights: [centre, of_face, one, two] } = *inside;
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
    fn weights(&self, cell: usize, of_nodes: &OfNodes) -> impl Iterator<Item = (u32, f64)> {
        let nodes = &self.of_cell[self.of_cell(cell)];
        let each = of_nodes.centre / nodes.len() as f64;
        nodes.iter().zip(&of_nodes.weights).map(move |(&node, weight)| (node, weight + each))
    }
}

/// Variance along an axis that diffusion adds to reach a spread [m], over the squared length of a cell's edge
/// [m²].
fn of_diffusion(spread: f64, squared: f64) -> f64 {
    (spread * spread / squared - BY_NODES).max(LEAST)
}

#[cfg(test)]
mod tests;
