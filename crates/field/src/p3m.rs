//! Particle–particle particle–mesh with smooth splitting:
//!
//! 1/r = [1 − Φ(r/r_c)]/r + Φ(r/r_c)/r — pairs within r_c, and the internal grid with the box's faces.
//!
//! Φ is the Kaiser–Bessel cloud's of `amberfield_laws::kaiser_bessel_cloud`: nothing is left of the pairs beyond r_c.

use crate::grid::level::{GridLevel, GridParameters};
use crate::inputs::{check_charges_in_box, check_result};
use crate::near::{NearLevel, NearParameters};
use crate::stopwatch::Stopwatch;
use crate::{FieldError, FieldMethod, FieldValues, Wanted};
use amberfield_core::constants::coulomb_constant;
use amberfield_core::{Domain, FieldSettings};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Parameters of the splitting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct P3mParameters {
    /// Near cut-off radius r_c, where the clouds end [m].
    pub cutoff_m: f64,
    /// Shape β of the clouds.
    pub cloud_shape: f64,
    /// Largest node spacing of the grid [m].
    pub spacing_m: f64,
    /// Order of the window between charges and nodes, 4 to 8.
    pub order: usize,
    /// Shape β of the window.
    pub window_shape: f64,
    /// Error of the near kernel's polynomials over the cloud's value at its centre.
    pub kernel_accuracy: f64,
}

impl P3mParameters {
    pub(crate) fn near(&self) -> NearParameters {
        NearParameters {
            cutoff_m: self.cutoff_m,
            cloud_shape: self.cloud_shape,
            kernel_accuracy: self.kernel_accuracy,
        }
    }

    pub(crate) fn grid(&self) -> GridParameters {
        GridParameters {
            spacing_m: self.spacing_m,
            order: self.order,
            window_shape: self.window_shape,
            cloud: self.cloud(),
        }
    }

    pub(crate) fn cloud(&self) -> Cloud {
        Cloud { radius: self.cutoff_m, shape: self.cloud_shape }
    }
}

/// Both levels and their buffers.
#[derive(Debug)]
pub(crate) struct P3m {
    domain: Domain,
    parameters: P3mParameters,
    coulomb: f64,
    neutralising_background: bool,
    near: NearLevel,
    grid: GridLevel,
    positions: Vec<Vector3<f64>>,
    near_field: Vec<(Vector3<f64>, f64)>,
    grid_field: Vec<(Vector3<f64>, f64)>,
    stopwatch: Stopwatch,
}

impl P3m {
    pub(crate) fn new(domain: &Domain, settings: &FieldSettings, parameters: P3mParameters) -> Self {
        Self {
            domain: domain.clone(),
            parameters,
            coulomb: coulomb_constant(settings.relative_permittivity),
            neutralising_background: settings.neutralising_background,
            near: NearLevel::new(domain, parameters.near()),
            grid: GridLevel::new(domain, parameters.grid()),
            positions: Vec::new(),
            near_field: Vec::new(),
            grid_field: Vec::new(),
            stopwatch: Stopwatch::default(),
        }
    }

    /// E of the charges alone at a sample of the particles.
    pub(crate) fn sample(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        sample: &[usize],
    ) -> Vec<Vector3<f64>> {
        self.load(positions);
        self.near.sort(&self.positions, charges);
        self.grid.solve(&self.positions, charges);
        let places: Vec<_> = sample.iter().map(|&particle| self.positions[particle]).collect();
        let mut far = vec![(Vector3::zeros(), 0.0); sample.len()];
        self.grid.gather(&places, &mut far);
        let near = self.near.at(sample);
        near.iter().zip(&far).map(|(near, far)| self.coulomb * (near + far.0)).collect()
    }

    fn load(&mut self, positions: &[Vector3<f64>]) {
        let nothing = (Vector3::zeros(), 0.0);
        self.positions.clear();
        self.positions.extend(positions.iter().map(|&position| self.domain.wrap(position)));
        for field in [&mut self.near_field, &mut self.grid_field] {
            field.clear();
            field.resize(positions.len(), nothing);
        }
    }

    /// Mean potential of the near level in a box without conductor, where the mean must vanish.
    fn background_potential(&self, charges: &[f64]) -> f64 {
        if !self.domain.needs_neutrality() {
            return 0.0;
        }
        let net: f64 = charges.iter().sum();
        2.0 * PI * self.parameters.cloud().mean_square() * net / self.domain.volume()
    }
}

impl FieldMethod for P3m {
    fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        let permittivity = 1.0 / (4.0 * PI * self.coulomb);
        let background = self.neutralising_background;
        check_charges_in_box(&self.domain, permittivity, background, positions, charges)?;
        self.stopwatch.restart();
        self.load(positions);
        self.near.sort(&self.positions, charges);
        self.stopwatch.lap("sort");
        self.near.add_all(wanted.potential, &mut self.near_field);
        self.stopwatch.lap("near");
        self.grid.solve(&self.positions, charges);
        self.stopwatch.lap("grid");
        self.grid.gather(&self.positions, &mut self.grid_field);
        self.stopwatch.lap("gather");

        let k = self.coulomb;
        let levels = || self.near_field.iter().zip(&self.grid_field);
        out.clear();
        out.e.extend(levels().map(|(near, far)| k * (near.0 + far.0)));
        if wanted.potential {
            let own_cloud = self.parameters.cloud().potential(0.0);
            let background = self.background_potential(charges);
            out.potential.extend(
                levels()
                    .zip(charges)
                    .map(|((near, far), charge)| k * (near.1 + far.1 - charge * own_cloud - background)),
            );
        }
        if wanted.components {
            out.components.near.extend(self.near_field.iter().map(|near| k * near.0));
            out.components.far.extend(self.grid_field.iter().map(|far| k * far.0));
        }
        out.complete(positions.len(), wanted);
        self.stopwatch.lap("sum");
        check_result(&out.e)
    }

    fn pairs_per_particle(&self) -> f64 {
        self.near.pairs_per_particle()
    }

    fn grid_cells(&self) -> Option<[usize; 3]> {
        Some(self.grid.cells())
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        let per_particle = size_of::<Vector3<f64>>() + 2 * size_of::<(Vector3<f64>, f64)>();
        self.near.memory_bytes() + self.grid.memory_bytes() + self.positions.capacity() * per_particle
    }
}
