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
        let squares = charges.iter().map(|q| q * q).sum();
        Self::from_sums(domain, permittivity, count, squares, |total| {
            let bins = Bins::new(domain, count);
            let mut sums = vec![0.0; bins.count()];
            for (position, charge) in positions.iter().zip(charges) {
                sums[bins.of(domain, position)] += charge * charge;
            }
            bins.density(sums.iter().map(|sum| sum * sum).sum(), total, count)
        })
    }

    /// Statistics from the number of charges and Σq² [C²]; `local_density` [1/m³] is asked for with Σq².
    pub(crate) fn from_sums(
        domain: &Domain,
        permittivity: Permittivity,
        count: f64,
        squares: f64,
        local_density: impl FnOnce(f64) -> f64,
    ) -> Self {
        let charge = (squares / count.max(1.0)).sqrt();
        let mean_density = count / domain.volume();
        let floor = permittivity.coulomb() * charge * mean_density.powf(2.0 / 3.0);
        let density = if squares > 0.0 { local_density(squares) } else { 0.0 };
        Self { count, charge, density: density.max(mean_density), floor }
    }

    /// Squared error [V²/m²] for a coefficient in 1/m.
    pub(crate) fn squared_error(&self, permittivity: Permittivity, coefficient: f64) -> f64 {
        (permittivity.coulomb() * self.charge).powi(2) * self.density * coefficient
    }
}

/// Bins of a domain, in which squared charges are summed for the mean density around a charge, weighted with
/// q²: clouds need not fill the domain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bins {
    counts: Vector3<usize>,
    /// Volume of one [m³].
    volume: f64,
}

impl Bins {
    /// Bins for so many charges.
    pub(crate) fn new(domain: &Domain, charges: f64) -> Self {
        const PER_BIN: f64 = 8.0;
        let bins = (charges / PER_BIN).cbrt().max(1.0);
        let mean = domain.volume().cbrt();
        let counts = domain.extent().map(|length| (bins * length / mean).round().clamp(1.0, 512.0) as usize);
        Self { counts, volume: domain.volume() / counts.product() as f64 }
    }

    /// Number of bins.
    pub(crate) fn count(&self) -> usize {
        self.counts.product()
    }

    /// The bin that a position [m] lies in.
    pub(crate) fn of(&self, domain: &Domain, position: &Vector3<f64>) -> usize {
        let offset = domain.wrap(*position) - domain.min();
        (0..3).fold(0, |index, axis| {
            let bin = (offset[axis] / domain.extent()[axis] * self.counts[axis] as f64).max(0.0) as usize;
            index * self.counts[axis] + bin.min(self.counts[axis] - 1)
        })
    }

    /// Mean density [1/m³] around a charge, from the sum over the bins of the squares of their sums of q²
    /// [C⁴], from Σq² [C²] and the number of charges.
    pub(crate) fn density(&self, squared_sums: f64, squares: f64, charges: f64) -> f64 {
        squared_sums / (squares * (squares / charges) * self.volume)
    }
}
