//! One conductor alone at a potential, from which its charge follows for any charges before it.
//!
//! With u_b the potential where conductor b has 1 V and all others and the electrodes 0, and σ_b the density
//! that makes it, Green's reciprocity gives the charge of b, before charges q_i at x_i, with conductors at
//! V_c and the potential φ_given of electrodes and of the external field (Jackson, Classical
//! Electrodynamics, 3rd ed., problem 1.12):
//!
//! Q_b = ∫ σ_b (V − φ_given) dA − Σ_i q_i u_b(x_i)   [C], with σ_b in C/m² for 1 V.

use super::Surfaces;

impl Surfaces {
    /// Gives one conductor a potential of 1 V, over Coulomb's constant [V m/C], and all others 0, floating
    /// ones too, until [`Self::release`].
    pub(crate) fn hold(&mut self, conductor: usize, coulomb: f64) {
        let mut potentials = vec![0.0; self.potentials.len()];
        potentials[conductor] = 1.0 / coulomb;
        self.held = Some(std::mem::replace(&mut self.potentials, potentials));
    }

    /// Gives the conductors their own potentials again.
    pub(crate) fn release(&mut self) {
        if let Some(potentials) = self.held.take() {
            self.potentials = potentials;
        }
    }

    /// The integral ∫ σ (V − φ_given) dA [C] over all conductors at potentials V [V] in a given potential at
    /// the facets [V], of the density σ that the last look at the equation found [C/m²].
    pub(crate) fn charge_by(&self, volts: &[f64], given: &[f64]) -> f64 {
        let of = self.elements.all.iter().zip(&self.corrected).zip(given);
        of.map(|((element, density), given)| {
            element.area * density * (volts[element.conductor as usize] - given)
        })
        .sum()
    }
}
