//! The near level: pairs and images within the cut-off radius.

mod instructions;
mod kernel;
mod partners;

use crate::image_cells::{IMAGE, ImageCells};
use crate::images::ImageLattice;
use amberfield_core::Domain;
use instructions::Instructions;
use kernel::{NearKernel, Sum};
use nalgebra::Vector3;
use partners::{Gather, PADDING, Partners, Sources, Target};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Targets handled by one task.
const TASK: usize = 64;

/// What the near level is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NearParameters {
    /// Gaussian width σ of the clouds that the smooth level carries [m].
    pub sigma_m: f64,
    /// Cut-off radius r_c [m].
    pub cutoff_m: f64,
    /// Error of the kernel's polynomials over the cloud's value at its centre.
    pub kernel_accuracy: f64,
}

/// Sum over real and image charges within the cut-off of a charge's field less its cloud's.
#[derive(Debug)]
pub(crate) struct NearLevel {
    kernel: NearKernel,
    gather: Gather,
    parameters: NearParameters,
    lattice: ImageLattice,
    sources: ImageCells<()>,
    /// Sources that are particles, in cell order.
    targets: Vec<u32>,
    sums: Vec<Sum>,
}

impl NearLevel {
    pub(crate) fn new(domain: &Domain, parameters: NearParameters) -> Self {
        let NearParameters { sigma_m, cutoff_m, kernel_accuracy } = parameters;
        let kernel = NearKernel::new(sigma_m, cutoff_m, kernel_accuracy);
        Self {
            gather: Gather::new(kernel.cutoff_squared(), Instructions::detect()),
            kernel,
            parameters,
            lattice: ImageLattice::new(domain),
            sources: ImageCells::default(),
            targets: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// Sorts charges and their images into cells. Positions lie inside the domain.
    pub(crate) fn sort(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        self.sources.build(&self.lattice, positions, charges, self.parameters.cutoff_m, |_, _| ());
        self.sources.pad(PADDING);
        self.targets.clear();
        let real = self.sources.real.iter().enumerate().filter(|(_, particle)| **particle != IMAGE);
        self.targets.extend(real.map(|(source, _)| source as u32));
    }

    /// Adds E and potential (4πε = 1) at every particle to `field`, after [`Self::sort`].
    pub(crate) fn add_all(&mut self, potential: bool, field: &mut [(Vector3<f64>, f64)]) {
        let mut sums = std::mem::take(&mut self.sums);
        self.evaluate(&self.targets, potential, &mut sums);
        for (&target, sum) in self.targets.iter().zip(&sums) {
            let (e, value) = &mut field[self.particle(target)];
            *e += Vector3::from(sum.field());
            *value += sum.potential();
        }
        self.sums = sums;
    }

    /// E (4πε = 1) at the given particles, after [`Self::sort`].
    pub(crate) fn at(&self, particles: &[usize]) -> Vec<Vector3<f64>> {
        let mut target_of = vec![0; self.targets.len()];
        for &target in &self.targets {
            target_of[self.particle(target)] = target;
        }
        let targets: Vec<u32> = particles.iter().map(|&particle| target_of[particle]).collect();
        let mut sums = Vec::new();
        self.evaluate(&targets, false, &mut sums);
        sums.iter().map(|sum| Vector3::from(sum.field())).collect()
    }

    /// Mean number of sources within the cut-off of a sample of targets.
    pub(crate) fn pairs_per_particle(&self) -> f64 {
        const SAMPLE: usize = 500;
        let step = self.targets.len().div_ceil(SAMPLE).max(1);
        let (mut pairs, mut sampled) = (0_usize, 0_usize);
        for &target in self.targets.iter().step_by(step) {
            let here = self.position(target as usize);
            self.sources.for_each_range(&here, |run| {
                let within = run.filter(|&source| {
                    let distance = (self.position(source) - here).norm();
                    source != target as usize && distance < self.parameters.cutoff_m
                });
                pairs += within.count();
            });
            sampled += 1;
        }
        if sampled == 0 { 0.0 } else { pairs as f64 / sampled as f64 }
    }

    fn particle(&self, target: u32) -> usize {
        self.sources.real[target as usize] as usize
    }

    fn position(&self, source: usize) -> Vector3<f64> {
        Vector3::new(self.sources.x[source], self.sources.y[source], self.sources.z[source])
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.sources.memory_bytes() + 4 * self.targets.capacity() + self.sums.capacity() * size_of::<Sum>()
    }

    fn evaluate(&self, targets: &[u32], potential: bool, sums: &mut Vec<Sum>) {
        sums.clear();
        sums.resize(targets.len(), Sum::default());
        sums.par_chunks_mut(TASK).zip(targets.par_chunks(TASK)).for_each(|(sums, targets)| {
            let mut partners = Partners::default();
            for (sum, &target) in sums.iter_mut().zip(targets) {
                if potential {
                    self.sum::<true>(target, &mut partners, sum);
                } else {
                    self.sum::<false>(target, &mut partners, sum);
                }
            }
        });
    }

    fn sum<const POTENTIAL: bool>(&self, target: u32, partners: &mut Partners, sum: &mut Sum) {
        let place = self.position(target as usize);
        let target = Target { position: place.into(), own: target as usize };
        let ImageCells { x, y, z, charge, .. } = &self.sources;
        let sources = Sources { x, y, z, charge };
        self.sources.for_each_range(&place, |run| {
            self.gather
                .append(target, sources, run, partners, |full| self.kernel.add::<POTENTIAL>(full, sum));
        });
        self.kernel.add::<POTENTIAL>(partners, sum);
    }
}
