//! Potential that even densities of all facets make at all centroids.

use super::elements::Elements;
use amberfield_core::Domain;
use amberfield_laws::charged_triangle::integrals;
use rayon::prelude::*;

/// A[f][g]: potential at the centroid of facet f of a unit density on facet g, over Coulomb's constant [m];
/// of g's nearest copy where the box has periods.
#[derive(Debug)]
pub(super) struct Matrix {
    /// Row by row. Single precision: what it is off by is corrected with the next residual.
    values: Vec<f32>,
    elements: usize,
}

impl Matrix {
    /// Computes all entries.
    pub(super) fn new(elements: &Elements, domain: &Domain) -> Self {
        let count = elements.len();
        let mut values = vec![0.0; count * count];
        values.par_chunks_mut(count.max(1)).zip(&elements.all).for_each(|(row, at)| {
            for (value, of) in row.iter_mut().zip(&elements.all) {
                let place = of.centre + domain.shortest(at.centre - of.centre);
                #[expect(clippy::cast_possible_truncation, reason = "single precision is enough")]
                let entry = integrals(&place, &of.corners).0 as f32;
                *value = entry;
            }
        });
        Self { values, elements: count }
    }

    /// One entry [m].
    pub(super) fn entry(&self, at: usize, of: usize) -> f64 {
        f64::from(self.values[at * self.elements + of])
    }

    /// Potentials [C/m] of densities [C/m²].
    pub(super) fn product(&self, density: &[f64], out: &mut Vec<f64>) {
        let row = |row: &[f32]| row.iter().zip(density).map(|(a, x)| f64::from(*a) * x).sum::<f64>();
        self.values.par_chunks(self.elements.max(1)).map(row).collect_into_vec(out);
    }

    /// Memory [bytes].
    pub(super) fn memory_bytes(&self) -> usize {
        4 * self.values.capacity()
    }
}
