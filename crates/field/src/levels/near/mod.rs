//! The near level: pairs and images within the cut-off radius.

mod candidates;
mod cells;
pub(crate) mod ghosts;
mod kernel;
mod target;

use crate::geometry::images::ImageLattice;
use crate::numerics::scratch::PerThread;
use crate::values::FieldAt;
use amberfield_core::Domain;
use candidates::NearSources;
use cells::{Charges, NearCells};
use kernel::{Group, NearKernel};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use target::NearSum;

/// Targets handled by one task.
const TASK: usize = 64;
/// Most targets that share their candidates.
const GROUP: usize = 8;
/// Largest extent of a group along x, over the cut-off radius.
const GROUP_LENGTH: f64 = 1.0;
/// Kernel accuracy above which single precision will do: its round-off at ordinary distances stays below a
/// tenth of the error.
const SINGLE_FROM: f64 = 3e-6;
/// Distance between two charges over r_c, times the kernel accuracy, below which the round-off of their
/// coordinates in single precision counts: such a target is summed again in double precision.
const SINGLE_ROUND_OFF: f64 = 2e-7;

/// Parameters of the near level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NearParameters {
    /// Cut-off radius r_c, where the clouds that the smooth level carries end [m].
    pub cutoff_m: f64,
    /// Shape β of the clouds.
    pub cloud_shape: f64,
    /// Error of the kernel's polynomials over the cloud's value at its centre.
    pub kernel_accuracy: f64,
}

impl NearParameters {
    /// Whether single precision is good enough.
    pub(crate) fn is_single(&self) -> bool {
        self.kernel_accuracy >= SINGLE_FROM
    }
}

/// Sum over real and image charges within the cut-off of a charge's field less its cloud's.
#[derive(Debug)]
pub(crate) struct NearLevel {
    parameters: NearParameters,
    /// `None` where the tolerance needs double precision.
    single: Option<NearKernel<f32>>,
    double: NearKernel<f64>,
    domain: Domain,
    lattice: ImageLattice,
    cells: NearCells,
    /// Largest charge [C].
    largest: f64,
    /// Sources that are particles, in cell order.
    targets: Vec<u32>,
    sums: Vec<NearSum>,
    scratch: PerThread<Scratch>,
}

#[derive(Debug, Default)]
struct Scratch {
    single: NearSources<f32>,
    double: NearSources<f64>,
}

impl NearLevel {
    pub(crate) fn new(domain: &Domain, parameters: NearParameters) -> Self {
        let NearParameters { cloud_shape, kernel_accuracy, .. } = parameters;
        Self {
            parameters,
            single: parameters.is_single().then(|| NearKernel::new(cloud_shape, kernel_accuracy)),
            double: NearKernel::new(cloud_shape, kernel_accuracy),
            domain: domain.clone(),
            lattice: ImageLattice::new(domain),
            cells: NearCells::default(),
            largest: 0.0,
            targets: Vec::new(),
            sums: Vec::new(),
            scratch: PerThread::new(Scratch::default),
        }
    }

    /// Sorts charges and their images into cells; the field will be asked for at the first `targets` of
    /// them. Positions lie inside the domain or within a period of it.
    pub(crate) fn sort(&mut self, positions: &[Vector3<f64>], charges: &[f64], targets: usize) {
        self.largest = charges.iter().fold(0.0, |largest, charge| charge.abs().max(largest));
        let per_charge = if self.largest > 0.0 { 1.0 / self.largest } else { 0.0 };
        let Self { domain, lattice, parameters, cells, .. } = self;
        let charges = Charges { positions, charges, targets };
        cells.build(domain, lattice, charges, parameters.cutoff_m, per_charge);
        self.targets.clear();
        // An image's index lies beyond any particle's.
        let real = self.cells.real.iter().enumerate().filter(|(_, particle)| (**particle as usize) < targets);
        self.targets.extend(real.map(|(source, _)| source as u32));
    }

    /// Adds E and potential (4πε = 1) at every particle to `field`, after [`Self::sort`].
    pub(crate) fn add_all(&mut self, potential: bool, field: &mut [FieldAt]) {
        let mut sums = std::mem::take(&mut self.sums);
        self.evaluate(&self.targets, potential, &mut sums);
        for (&target, sum) in self.targets.iter().zip(&sums) {
            field[self.particle(target)] += sum.field_at();
        }
        self.sums = sums;
    }

    /// E (4πε = 1) at the given particles, after [`Self::sort`].
    pub(crate) fn at(&self, particles: &[usize]) -> Vec<FieldAt> {
        let mut target_of = vec![0; self.targets.len()];
        for &target in &self.targets {
            target_of[self.particle(target)] = target;
        }
        let targets: Vec<u32> = particles.iter().map(|&particle| target_of[particle]).collect();
        let mut sums = Vec::new();
        self.evaluate(&targets, false, &mut sums);
        sums.iter().map(NearSum::field_at).collect()
    }

    /// Mean number of sources within the cut-off of a sample of targets.
    pub(crate) fn pairs_per_particle(&self) -> f64 {
        const SAMPLE: usize = 500;
        let step = self.targets.len().div_ceil(SAMPLE).max(1);
        let (mut pairs, mut sampled) = (0_usize, 0_usize);
        for &target in self.targets.iter().step_by(step) {
            let place = |source| Vector3::from(self.cells.place(source));
            let (target, here) = (target as usize, place(target as usize));
            let run = |row| self.cells.run(row, self.cells.row_of(target), [here.x; 2]);
            let offered = self.cells.rows().iter().flat_map(run);
            pairs +=
                offered.filter(|&source| source != target && (place(source) - here).norm() < 1.0).count();
            sampled += 1;
        }
        if sampled == 0 { 0.0 } else { pairs as f64 / sampled as f64 }
    }

    fn particle(&self, target: u32) -> usize {
        self.cells.real[target as usize] as usize
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.cells.memory_bytes() + 4 * self.targets.capacity() + self.sums.capacity() * size_of::<NearSum>()
    }

    fn evaluate(&self, targets: &[u32], potential: bool, sums: &mut Vec<NearSum>) {
        sums.clear();
        sums.resize(targets.len(), NearSum::default());
        if self.largest == 0.0 {
            return;
        }
        sums.par_chunks_mut(TASK).zip(targets.par_chunks(TASK)).for_each(|(mut sums, mut targets)| {
            self.scratch.with(|scratch| {
                while let Some(&first) = targets.first() {
                    let (length, row) = self.group(first, targets);
                    let (group, others) = targets.split_at(length);
                    let (of_group, of_others) = sums.split_at_mut(length);
                    self.sum(Group { cells: &self.cells, targets: group, row }, potential, scratch, of_group);
                    (targets, sums) = (others, of_others);
                }
            });
        });
    }

    /// Counts the first targets that share a row of cells and lie close together, and the row.
    fn group(&self, first: u32, targets: &[u32]) -> (usize, [usize; 2]) {
        let (row, start) = (self.cells.row_of(first as usize), self.cells.place(first as usize)[0]);
        let together = |&&target: &&u32| {
            let x = self.cells.place(target as usize)[0];
            (x - start).abs() < GROUP_LENGTH && self.cells.row_of(target as usize) == row
        };
        (targets.iter().take(GROUP).take_while(together).count(), row)
    }

    /// Sums of one group, in m and C.
    fn sum(&self, group: Group<'_>, potential: bool, scratch: &mut Scratch, sums: &mut [NearSum]) {
        let Scratch { single, double } = scratch;
        if let Some(kernel) = &self.single {
            kernel.sum(group, potential, single, sums);
            let closest = SINGLE_ROUND_OFF / self.parameters.kernel_accuracy;
            if sums.iter().any(|sum| sum.nearest_squared < closest * closest) {
                self.double.sum(group, potential, double, sums);
            }
        } else {
            self.double.sum(group, potential, double, sums);
        }
        let per_length = 1.0 / self.parameters.cutoff_m;
        let (unit_potential, unit_field) =
            (self.largest * per_length, self.largest * per_length * per_length);
        for sum in sums {
            sum.field = sum.field.map(|value| value * unit_field);
            sum.potential *= unit_potential;
        }
    }
}
