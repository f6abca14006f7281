//! Parallel conducting plates with a uniform space charge between them.

/// Plates at z = 0 and z = L with potentials V₀ and V_L and a charge density ρ between them.
///
/// V = V₀ + (V_L − V₀) z/L + ρ z (L − z)/(2ε), E_z = −dV/dz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelPlates {
    /// Permittivity ε [F/m].
    pub permittivity: f64,
    /// Distance L of the plates [m].
    pub gap: f64,
    /// Potential V₀ of the plate z = 0 [V].
    pub lower_potential: f64,
    /// Potential V_L of the plate z = L [V].
    pub upper_potential: f64,
    /// Charge density ρ [C/m³].
    pub charge_density: f64,
}

impl ParallelPlates {
    /// Potential [V] at height z [m].
    #[must_use]
    pub fn potential(&self, z: f64) -> f64 {
        self.lower_potential
            + (self.upper_potential - self.lower_potential) * z / self.gap
            + self.charge_density * z * (self.gap - z) / (2.0 * self.permittivity)
    }

    /// Field E_z [V/m] at height z [m].
    #[must_use]
    pub fn field(&self, z: f64) -> f64 {
        -(self.upper_potential - self.lower_potential) / self.gap
            - self.charge_density * (self.gap - 2.0 * z) / (2.0 * self.permittivity)
    }

    /// Charge per area ε E_z(0) [C/m²] on the plate z = 0.
    #[must_use]
    pub fn lower_surface_charge(&self) -> f64 {
        self.permittivity * self.field(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATES: ParallelPlates = ParallelPlates {
        permittivity: 2.0,
        gap: 3.0,
        lower_potential: 5.0,
        upper_potential: -1.0,
        charge_density: 0.5,
    };

    #[test]
    fn plates_have_their_potentials() {
        assert_eq!(PLATES.potential(0.0), 5.0);
        assert_eq!(PLATES.potential(3.0), -1.0);
    }

    #[test]
    fn gauss_law_holds_between_the_plates() {
        // Exact in binary up to rounding of a few operations.
        let flux = PLATES.permittivity * (PLATES.field(3.0) - PLATES.field(0.0));
        assert!((flux - PLATES.charge_density * PLATES.gap).abs() < 1e-14);
    }

    #[test]
    fn field_is_minus_the_slope_of_the_potential() {
        let slope = (PLATES.potential(1.3 + 1e-5) - PLATES.potential(1.3 - 1e-5)) / 2e-5;
        assert!((slope + PLATES.field(1.3)).abs() < 1e-9);
    }
}
