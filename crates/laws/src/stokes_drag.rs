//! Drag in creeping flow: F = β (u − v), β = 3πμd.
//!
//! F force on one grain [N]; β coefficient [kg/s]; u velocity of the fluid, v of the grain [m/s]; d diameter
//! of the grain [m]; μ viscosity of the fluid [Pa·s].
//! Range: Re ≪ 1, a single grain.
//! Source: Stokes, Trans. Cambridge Philos. Soc. 9, 8 (1851); Crowe et al., *Multiphase Flows with Droplets
//! and Particles*, 2nd ed., §4.
//!
//! ```
//! use amberfield_laws::stokes_drag::coefficient;
//! assert!((coefficient(1e-3, 1.8e-5) - 1.6965e-7).abs() < 1e-11);
//! ```

use std::f64::consts::PI;

/// Drag coefficient β [kg/s] of a grain of diameter d [m] in a fluid of viscosity μ [Pa·s].
#[must_use]
pub fn coefficient(diameter: f64, viscosity: f64) -> f64 {
    3.0 * PI * viscosity * diameter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_point_and_proportions() {
        assert!((coefficient(1.0 / (3.0 * PI), 7.0) - 7.0).abs() < 1e-14);
        assert_eq!(coefficient(2.0, 3.0), coefficient(3.0, 2.0));
    }

    #[test]
    fn settling_speed_is_stokes() {
        // (ρ_p − ρ) g V = β v gives v = (ρ_p − ρ) g d²/(18 μ).
        let (d, excess, g, mu) = (1e-4_f64, 1500.0, 9.81, 1e-3);
        let speed = excess * g * PI * d.powi(3) / 6.0 / coefficient(d, mu);
        assert!((speed / (excess * g * d * d / (18.0 * mu)) - 1.0).abs() < 1e-14);
    }
}
