//! Shares of grains in cells.
//!
//! A grain is given to nodes of the mesh (`nodes.rs`), diffusion among the nodes spreads it as far as is
//! asked for (`smoothing.rs`), and the nodes give it to the cells around them. Each of the three takes
//! grains to cells by sums in fixed order, and the flow to grains by the transposed sums: the one gets what
//! the other gives, to round-off.
//!
//! w_ic = Σ_k λ_ik Σ_k' P_kk' θ_k'c,   Σ_c w_ic = 1

mod nodes;
mod numbering;
mod smoothing;
mod sparse;

use crate::GasError;
use crate::shapes::CellShapes;
use amberfield_core::Vector3;
use amberfield_field::far::FarMesh;
use nodes::{AtNodes, Nodes};
use rayon::prelude::*;
use smoothing::Smoothing;
use sparse::{Rows, add};

/// Least smoothing length over the largest diameter. Gas laws know many grains, not one: a grain in cells
/// smaller than itself is spread over some eighty times its volume.
const OVER_DIAMETER: f64 = 3.3;
/// Least spread σ_f over the distance of two cells' centres. The nodes spread a grain over some 0.4 already.
const OVER_CELL: f64 = 0.6;
/// Variance along an axis, over the square of a cell's size, of where the cells are that the nodes give a
/// grain to: that of linear functions.
const OF_NODES: f64 = 1.0 / 6.0;
/// Spread σ along an axis over the smoothing length: that of (1 − s²)³ over a ball.
const SPREAD: f64 = 0.301_511_344_577_763_6;
/// Places at which a grain is looked for, over its diameter from its centre: its centre, and four corners of
/// a cube. Along every axis these are three in a row, so that layers of grains that lie as far apart as in a
/// bed make no waves in cells of about their distance.
const BESIDE: f64 = 0.42;
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Share of a grain at its centre; the corners have the rest.
const AT_CENTRE: f64 = 1.0 / 3.0;
/// Least size of all cells over the largest diameter at which a grain's centre is enough.
const LARGE: f64 = 8.0;
/// Grains that one thread takes at a time.
pub(crate) const CHUNK: usize = 1024;
/// Most parts in which grains are summed side by side.
const MOST_PARTS: usize = 8;

/// Shares of grains in the cells of a mesh.
#[derive(Clone, Debug)]
pub struct Mapping {
    length: f64,
    /// Whether all cells are large beside grains.
    is_coarse: bool,
    volumes: Vec<f64>,
    nodes: Nodes,
    /// Volume of each node that is a cell's, by cell [m³].
    of_cells: Rows,
    smoothing: Smoothing,
}

/// Places of many grains among the nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    /// Number of the first node of each grain; one more than there are grains.
    first: Vec<u32>,
    nodes: Vec<u32>,
    /// Weights of the nodes; those of a grain add up to one.
    weights: Vec<f64>,
}

impl Places {
    /// Number of grains.
    fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Nodes and weights of a grain.
    fn of(&self, grain: usize) -> impl Iterator<Item = (usize, f64)> {
        let entries = self.first[grain] as usize..self.first[grain + 1] as usize;
        self.nodes[entries.clone()]
            .iter()
            .map(|&node| node as usize)
            .zip(self.weights[entries].iter().copied())
    }
}

/// Grain to be placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// Centre, inside the mesh [m].
    pub(crate) centre: Vector3<f64>,
    pub(crate) diameter: f64,
    /// Cell that the centre is in.
    pub(crate) cell: u32,
}

impl Mapping {
    /// Mapping with a smoothing length [m], or with one that suits the grains up to a diameter [m]; nowhere
    /// less than suits grains and cells.
    ///
    /// # Errors
    /// A length that is no positive number.
    pub fn new(
        mesh: &FarMesh,
        shapes: &CellShapes,
        length: Option<f64>,
        largest_diameter: f64,
    ) -> Result<Self, GasError> {
        let least = OVER_DIAMETER * largest_diameter;
        let asked = length.unwrap_or(least);
        if !(asked.is_finite() && asked > 0.0) {
            return Err(GasError::Settings(format!(
                "the smoothing length is {asked} m; give a positive one"
            )));
        }
        let length = asked.max(least);
        let nodes = Nodes::new(mesh, shapes);
        let of_node = |_: usize, node: usize, share: f64| share * nodes.volumes_of_nodes[node];
        let of_cells = nodes.to_cells.transposed(mesh.cell_count()).with(of_node);
        let volumes = mesh.volumes().to_vec();
        let smallest = volumes.iter().copied().fold(f64::INFINITY, f64::min).cbrt();
        let is_coarse = smallest > LARGE * largest_diameter;
        let conductances = nodes.conductances(SPREAD * length, OVER_CELL);
        let smoothing = Smoothing::new(&nodes.volumes_of_nodes, conductances);
        Ok(Self { length, is_coarse, smoothing, volumes, nodes, of_cells })
    }

    /// Length over which grains are smoothed where cells are small [m].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Standard deviations [m] along an axis over which a lone grain of a diameter [m] in a cell is spread:
    /// that of the void fraction which it finds where it is, and that of its force and of the flow which it
    /// feels, both together. They hold far from walls; in cells of several sizes they are estimates.
    pub(crate) fn spreads_of_one(&self, cell: u32, diameter: f64) -> [f64; 2] {
        let size = self.volumes[cell as usize].cbrt();
        let beside = if self.is_coarse { 0.0 } else { BESIDE * diameter };
        // Of the places beside the centre, and of linear functions between nodes half a cell apart.
        let mut placed = (1.0 - AT_CENTRE) * beside * beside + OF_NODES * size * size;
        let smoothed = (SPREAD * self.length).max(OVER_CELL * size).powi(2);
        let void = smoothed + 2.0 * placed;
        placed += smoothed;
        [void.sqrt(), (2.0 * placed).sqrt()]
    }

    /// Finds the places of grains among the cells of `mesh`.
    pub(crate) fn place(&self, mesh: &FarMesh, grains: &[Placed]) -> Places {
        let parts: Vec<(Vec<u32>, Vec<u32>, Vec<f64>)> = grains
            .par_chunks(CHUNK / 4)
            .map(|grains| {
                let (mut counts, mut nodes, mut weights) = (Vec::new(), Vec::new(), Vec::new());
                for grain in grains {
                    let begin = nodes.len();
                    self.place_one(mesh, grain, &mut |node, weight| match nodes[begin..]
                        .iter()
                        .position(|&known| known == node)
                    {
                        Some(place) => weights[begin + place] += weight,
                        None => {
                            nodes.push(node);
                            weights.push(weight);
                        }
                    });
                    counts.push((nodes.len() - begin) as u32);
                }
                (counts, nodes, weights)
            })
            .collect();
        let mut places = Places { first: vec![0], ..Places::default() };
        for (counts, nodes, weights) in parts {
            for count in counts {
                places.first.push(places.first[places.first.len() - 1] + count);
            }
            places.nodes.extend(nodes);
            places.weights.extend(weights);
        }
        places
    }

    /// Gives a grain's nodes and weights, some more than once.
    fn place_one(&self, mesh: &FarMesh, grain: &Placed, give: &mut impl FnMut(u32, f64)) {
        let mut add = |AtNodes { nodes, weights }: AtNodes, share: f64| {
            nodes.into_iter().zip(weights).for_each(|(node, weight)| give(node, share * weight));
        };
        if self.is_coarse {
            return add(self.nodes.at(mesh, &grain.centre, grain.cell), 1.0);
        }
        add(self.nodes.at(mesh, &grain.centre, grain.cell), AT_CENTRE);
        let share = (1.0 - AT_CENTRE) / CORNERS.len() as f64;
        for corner in CORNERS {
            let beside = grain.centre + Vector3::from(corner) * (BESIDE * grain.diameter);
            add(self.nodes.at(mesh, &beside, grain.cell), share);
        }
    }

    /// Sums of numbers of grains at the nodes; their order depends on counts alone.
    pub(crate) fn at_nodes<const N: usize>(&self, places: &Places, numbers: &[[f64; N]]) -> Vec<[f64; N]> {
        let nodes = self.nodes.count();
        let parts = (4 * numbers.len() / nodes.max(1)).clamp(1, MOST_PARTS);
        let sum = |grains: std::ops::Range<usize>| {
            let mut sums = vec![[0.0; N]; nodes];
            for grain in grains {
                places.of(grain).for_each(|(node, weight)| add(&mut sums[node], weight, &numbers[grain]));
            }
            sums
        };
        if parts == 1 {
            return sum(0..numbers.len());
        }
        let bounds = |part: usize| part * numbers.len() / parts..(part + 1) * numbers.len() / parts;
        let of_parts: Vec<_> = (0..parts).into_par_iter().map(|part| sum(bounds(part))).collect();
        let total = |node: usize| {
            let mut sum = [0.0; N];
            of_parts.iter().for_each(|part| add(&mut sum, 1.0, &part[node]));
            sum
        };
        (0..nodes).into_par_iter().with_min_len(CHUNK).map(total).collect()
    }

    /// Numbers per volume of each cell, from sums at the nodes.
    pub(crate) fn to_cells<const N: usize>(&self, sums: &[[f64; N]]) -> Vec<[f64; N]> {
        let per_volume = sums.iter().zip(&self.nodes.volumes_of_nodes);
        let smooth = self.smoothing.apply(per_volume.map(|(sum, volume)| sum.map(|x| x / volume)).collect());
        let mut cells = self.of_cells.times(&smooth);
        for (cell, volume) in cells.iter_mut().zip(&self.volumes) {
            cell.iter_mut().for_each(|number| *number /= volume);
        }
        cells
    }

    /// Numbers of grains per volume of each cell.
    pub(crate) fn spread<const N: usize>(&self, places: &Places, numbers: &[[f64; N]]) -> Vec<[f64; N]> {
        self.to_cells(&self.at_nodes(places, numbers))
    }

    /// Smooth numbers of cells at the nodes, from which grains take their means.
    pub(crate) fn smooth<const N: usize>(&self, cells: &[[f64; N]]) -> Vec<[f64; N]> {
        self.smoothing.apply(self.nodes.to_cells.times(cells))
    }

    /// Means of cells' numbers at grains, without smoothing: of numbers that are smooth already.
    pub(crate) fn gather_near<const N: usize>(&self, places: &Places, cells: &[[f64; N]]) -> Vec<[f64; N]> {
        self.of_grains(places, &self.nodes.to_cells.times(cells))
    }

    /// Means of nodes' numbers at grains.
    pub(crate) fn of_grains<const N: usize>(&self, places: &Places, nodes: &[[f64; N]]) -> Vec<[f64; N]> {
        let one = |grain: usize| {
            let mut sum = [0.0; N];
            places.of(grain).for_each(|(node, weight)| add(&mut sum, weight, &nodes[node]));
            sum
        };
        (0..places.len()).into_par_iter().with_min_len(CHUNK).map(one).collect()
    }
}

#[cfg(test)]
mod tests;
