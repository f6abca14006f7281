//! Statistics of a cloud of charges that decide the error of a field.

use amberfield_core::{Domain, Permittivity};
use nalgebra::Vector3;

/// Statistics of a cloud of charges that decide the error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChargeStatistics {
    pub(crate) count: f64,
    /// q_rms [C].
    pub(crate) charge: f64,
    /// Number density where the charges are [1/m³].
    pub(crate) density: f64,
    /// Scale to which errors are relative, before E_rms is known: q_rms n^{2/3} k_e [V/m].
    pub(crate) floor: f64,
}

impl ChargeStatistics {
    pub(crate) fn new(
        domain: &Domain,
        permittivity: Permittivity,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Self {
        let count = positions.len() as f64;
        let charge = (charges.iter().map(|q| q * q).sum::<f64>() / count.max(1.0)).sqrt();
        let mean_density = count / domain.volume();
        let floor = permittivity.coulomb() * charge * mean_density.powf(2.0 / 3.0);
        let density = local_density(domain, positions, charges).max(mean_density);
        Self { count, charge, density, floor }
    }

    /// Squared error [V²/m²] for a coefficient in 1/m.
    pub(crate) fn squared_error(&self, permittivity: Permittivity, coefficient: f64) -> f64 {
        (permittivity.coulomb() * self.charge).powi(2) * self.density * coefficient
    }
}

/// Mean density around a charge, weighted with q²: clouds need not fill the domain.
fn local_density(domain: &Domain, positions: &[Vector3<f64>], charges: &[f64]) -> f64 {
    const PER_CELL: f64 = 8.0;
    let cells = (positions.len() as f64 / PER_CELL).cbrt().max(1.0);
    let mean = domain.volume().cbrt();
    let counts = domain.extent().map(|length| (cells * length / mean).round().clamp(1.0, 512.0) as usize);
    let cell_of = |position: &Vector3<f64>| {
        let offset = domain.wrap(*position) - domain.min();
        (0..3).fold(0, |index, axis| {
            let cell = (offset[axis] / domain.extent()[axis] * counts[axis] as f64).max(0.0) as usize;
            index * counts[axis] + cell.min(counts[axis] - 1)
        })
    };
    let mut square_sums = vec![0.0; counts.product()];
    for (position, charge) in positions.iter().zip(charges) {
        square_sums[cell_of(position)] += charge * charge;
    }
    let total: f64 = square_sums.iter().sum();
    if total == 0.0 {
        return 0.0;
    }
    let mean_square = total / positions.len() as f64;
    let cell_volume = domain.volume() / square_sums.len() as f64;
    square_sums.iter().map(|sum| sum * sum).sum::<f64>() / (total * mean_square * cell_volume)
}
