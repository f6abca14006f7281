//! Work of adhesion of two solids, w = γ₁ + γ₂ − γ₁₂ = 2√(γ₁γ₂).
//!
//! w energy to part a unit of area [J/m²]; γ surface energies of the solids, γ₁₂ that of their interface
//! [J/m²]. The geometric mean γ₁₂ = (√γ₁ − √γ₂)² holds for dispersion forces; equal solids have w = 2γ.
//! Source: Good & Girifalco, J. Phys. Chem. 64, 561 (1960); Israelachvili, *Intermolecular and Surface
//! Forces* (2011), ch. 17.
//!
//! ```
//! use amberfield_laws::work_of_adhesion::mixed;
//! assert_eq!(mixed(0.05, 0.05), 0.1);
//! ```

/// Work of adhesion w [J/m²] of solids with surface energies γ [J/m²].
#[must_use]
pub fn mixed(surface_energy_i: f64, surface_energy_j: f64) -> f64 {
    // The root of a square may be off by one rounding; equal solids have exactly 2γ.
    if surface_energy_i == surface_energy_j {
        2.0 * surface_energy_i
    } else {
        2.0 * (surface_energy_i * surface_energy_j).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetric_and_zero_with_a_solid_that_does_not_stick() {
        assert_eq!(mixed(0.02, 0.08), mixed(0.08, 0.02));
        assert!((mixed(0.02, 0.08) - 0.08).abs() < 1e-15);
        assert_eq!(mixed(0.0, 0.08), 0.0);
    }

    #[test]
    fn interface_has_the_geometric_mean() {
        let (a, b) = (0.03_f64, 0.07_f64);
        let interface = (a.sqrt() - b.sqrt()).powi(2);
        assert!((mixed(a, b) - (a + b - interface)).abs() < 1e-15);
    }
}
