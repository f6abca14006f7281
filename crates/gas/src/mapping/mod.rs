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
use nalgebra::Matrix3;
use nodes::{FromCrossing, Nodes, OfNodes};
use rayon::prelude::*;
use smoothing::Smoothing;
use sparse::{Rows, add};

/// Least smoothing length over the largest diameter. Gas laws know many grains, not one: a grain in cells
/// smaller than itself is spread over some eighty times its volume.
const OVER_DIAMETER: f64 = 3.3;
/// Spread σ along an axis over the smoothing length: that of (1 − s²)³ over a ball.
const SPREAD: f64 = 0.301_511_344_577_763_6;
/// Places at which a grain is looked for, over its diameter from its centre: its centre, and four corners of
/// a cube. Along every axis these are three in a row, so that layers of grains that lie as far apart as in a
/// bed make no waves in cells of about their distance.
const BESIDE: f64 = 0.42;
const PLACES: [[f64; 3]; 5] =
    [[0.0; 3], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Shares of a grain at these places.
const SHARES: [f64; 5] = [1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0];
/// Variance of the places along an axis, over the square of the diameter.
const OF_PLACES: f64 = 2.0 / 3.0 * BESIDE * BESIDE;
/// Variance of a Gaussian that is as dense in its middle as what diffusion makes, over the variance of this,
/// whose polynomials are flatter.
const FLATTER: f64 = 1.07;
/// Least size of all cells over the largest diameter at which a grain's centre is enough.
const LARGE: f64 = 8.0;
/// Grains that one thread takes at a time.
pub(crate) const CHUNK: usize = 1024;
/// Grains whose places are found and kept together.
const PART: usize = 256;
/// Most sums of grains at nodes side by side, and how many of them there are over grains for a node.
const MOST_SUMS: usize = 8;
const OVER_NODES: usize = 3;

/// Shares of grains in the cells of a mesh.
#[derive(Clone, Debug)]
pub struct Mapping {
    length: f64,
    /// Whether all cells are large beside grains.
    is_coarse: bool,
    /// Variance by cell that diffusion adds [m²].
    diffused: Vec<Matrix3<f64>>,
    nodes: Nodes,
    /// Share of each cell that is a node's, by cell.
    of_cells: Rows,
    smoothing: Smoothing,
}

/// Places of many grains among the nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    /// Grains in order, [`PART`] at a time.
    parts: Vec<Part>,
}

/// Places of some grains among the nodes.
#[derive(Clone, Debug, Default)]
struct Part {
    /// Number of entries up to the end of each grain's.
    ends: Vec<u32>,
    /// Nodes and their weights; those of a grain add up to one.
    entries: Vec<(u32, f64)>,
}

impl Places {
    /// Number of grains.
    fn len(&self) -> usize {
        self.parts.iter().map(|part| part.ends.len()).sum()
    }
}

impl Part {
    /// Nodes and weights of its grains, one after the other.
    fn grains(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let mut begin = 0;
        self.ends
            .iter()
            .map(move |&end| &self.entries[std::mem::replace(&mut begin, end as usize)..end as usize])
    }

    /// Finds the places of grains anew.
    fn fill(&mut self, mapping: &Mapping, mesh: &FarMesh, grains: &[Placed]) {
        let Self { ends, entries } = self;
        ends.clear();
        entries.clear();
        // Entries of nodes that were given something last, by the last bits of their numbers.
        let mut known = [0; 256];
        let mut of_nodes = OfNodes::default();
        for grain in grains {
            let begin = entries.len();
            if let Some(crossing) = mapping.crossing(grain) {
                crossing.give(mapping.places(grain), |node, weight| entries.push((node, weight)));
                ends.push(entries.len() as u32);
                continue;
            }
            mapping.place_one(mesh, grain, &mut of_nodes, &mut |node, weight| {
                let known: &mut usize = &mut known[node as usize % 256];
                match entries[begin..].get_mut(known.wrapping_sub(begin)) {
                    Some(entry) if entry.0 == node => entry.1 += weight,
                    _ => {
                        *known = entries.len();
                        entries.push((node, weight));
                    }
                }
            });
            ends.push(entries.len() as u32);
        }
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
        let of_node = |cell: usize, node: usize, share: f64| {
            share * nodes.volumes_of_nodes[node] / mesh.volumes()[cell]
        };
        let of_cells = nodes.to_cells.transposed(mesh.cell_count()).with(of_node);
        let smallest = mesh.volumes().iter().copied().fold(f64::INFINITY, f64::min).cbrt();
        let is_coarse = smallest > LARGE * largest_diameter;
        let conductances = nodes.conductances(SPREAD * length);
        let diffused = nodes.diffused(SPREAD * length);
        let smoothing = Smoothing::new(&nodes.volumes_of_nodes, conductances);
        Ok(Self { length, is_coarse, smoothing, diffused, nodes, of_cells })
    }

    /// Length over which grains are smoothed where cells are small [m].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Variances [m²] of a lone grain of a diameter [m] in a cell: that of the void fraction which it finds
    /// where it is, and that of its force and of the flow which it feels, both together.
    ///
    /// They hold far from walls; in cells of several sizes they are estimates.
    pub(crate) fn variances_of_one(&self, cell: u32, diameter: f64) -> [Matrix3<f64>; 2] {
        let of_places = if self.is_coarse { 0.0 } else { OF_PLACES * diameter * diameter };
        let placed = Matrix3::from_diagonal_element(of_places) + self.nodes.variances[cell as usize];
        let diffused = self.diffused[cell as usize] * FLATTER;
        [placed * 2.0 + diffused, (placed + diffused) * 2.0]
    }

    /// Finds the places of grains among the cells of `mesh`, into what held others.
    pub(crate) fn place(&self, mesh: &FarMesh, grains: &[Placed], places: &mut Places) {
        places.parts.resize_with(grains.len().div_ceil(PART), Part::default);
        let parts = places.parts.par_iter_mut().zip(grains.par_chunks(PART));
        parts.for_each(|(part, grains)| part.fill(self, mesh, grains));
    }

    /// Gives a grain's nodes and weights, some more than once.
    fn place_one(
        &self,
        mesh: &FarMesh,
        grain: &Placed,
        of_nodes: &mut OfNodes,
        give: &mut impl FnMut(u32, f64),
    ) {
        let mut places = [None; PLACES.len()];
        for (found, (beside, share)) in places.iter_mut().zip(self.places(grain)) {
            let (cell, inside) = self.nodes.at(mesh, &(grain.centre + beside), grain.cell);
            *found = Some((cell, inside, share));
        }
        // Cell by cell, each as often as a place is in it.
        for first in 0..places.len() {
            let Some((cell, ..)) = places[first] else { continue };
            let here =
                places[first..].iter_mut().filter_map(|place| place.take_if(|(other, ..)| *other == cell));
            self.nodes.give(cell, here.map(|(_, inside, share)| (inside, share)), of_nodes, give);
        }
    }

    /// Places at which a grain is looked for, as seen from its centre [m], and their shares.
    fn places(&self, grain: &Placed) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        let reach = BESIDE * grain.diameter;
        let all = PLACES.into_iter().map(move |place| Vector3::from(place) * reach).zip(SHARES);
        let count = if self.is_coarse { 1 } else { PLACES.len() };
        all.take(count).map(move |(place, share)| (place, if count == 1 { 1.0 } else { share }))
    }

    /// Crossing of cuboids that all places of a grain are in.
    fn crossing(&self, grain: &Placed) -> Option<FromCrossing<'_>> {
        let reach = if self.is_coarse { 0.0 } else { BESIDE * grain.diameter };
        self.nodes.crossing(grain.cell, &grain.centre, reach)
    }

    /// Sums of numbers of grains at the nodes; their order depends on counts alone.
    pub(crate) fn at_nodes<const N: usize>(&self, places: &Places, numbers: &[[f64; N]]) -> Vec<[f64; N]> {
        let nodes = self.nodes.count();
        // As many sums side by side as are worth adding up.
        let sums = (OVER_NODES * numbers.len() / nodes.max(1)).clamp(1, MOST_SUMS);
        let of_sum = places.parts.len().div_ceil(sums).max(1);
        let sum = |(parts, numbers): (&[Part], &[[f64; N]])| {
            let mut sums = vec![[0.0; N]; nodes];
            for (entries, numbers) in parts.iter().flat_map(Part::grains).zip(numbers) {
                entries.iter().for_each(|&(node, weight)| add(&mut sums[node as usize], weight, numbers));
            }
            sums
        };
        let parts = places.parts.par_chunks(of_sum).zip(numbers.par_chunks(of_sum * PART));
        let mut sums: Vec<_> = parts.map(sum).collect();
        let Some((total, others)) = sums.split_first_mut() else { return vec![[0.0; N]; nodes] };
        if !others.is_empty() {
            total.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(node, total)| {
                others.iter().for_each(|other| add(total, 1.0, &other[node]));
            });
        }
        sums.swap_remove(0)
    }

    /// Numbers per volume of each cell, from sums at the nodes.
    pub(crate) fn to_cells<const N: usize>(&self, sums: &[[f64; N]]) -> Vec<[f64; N]> {
        let per_volume = sums.par_iter().zip(&self.nodes.volumes_of_nodes).with_min_len(CHUNK);
        let per_volume = per_volume.map(|(sum, volume)| sum.map(|x| x / volume)).collect();
        self.of_cells.times(&self.smoothing.apply(per_volume))
    }

    /// Numbers of grains per volume of each cell.
    pub(crate) fn spread<const N: usize>(&self, places: &Places, numbers: &[[f64; N]]) -> Vec<[f64; N]> {
        self.to_cells(&self.at_nodes(places, numbers))
    }

    /// Smooth numbers of cells at the nodes, from which grains take their means.
    pub(crate) fn smooth<const N: usize>(&self, cells: &[[f64; N]]) -> Vec<[f64; N]> {
        self.smoothing.apply(self.near(cells))
    }

    /// Numbers of cells at the nodes, without smoothing: of what is smooth already.
    pub(crate) fn near<const N: usize>(&self, cells: &[[f64; N]]) -> Vec<[f64; N]> {
        self.nodes.to_cells.times(cells)
    }

    /// Means of nodes' numbers at grains.
    pub(crate) fn of_grains<const N: usize>(&self, places: &Places, nodes: &[[f64; N]]) -> Vec<[f64; N]> {
        let mut means = vec![[0.0; N]; places.len()];
        means.par_chunks_mut(PART).zip(&places.parts).for_each(|(means, part)| {
            for (mean, entries) in means.iter_mut().zip(part.grains()) {
                entries.iter().for_each(|&(node, weight)| add(mean, weight, &nodes[node as usize]));
            }
        });
        means
    }
}

#[cfg(test)]
mod tests;
