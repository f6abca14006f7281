//! Limits on the time step: Rayleigh, Hertz, stiffness (Δt = 2√(m*/k)), plasma (Δt_c < 0.2/ω_p).
//!
//! * Rayleigh: Δt = π r √(ρ/G)/(0.1631 ν + 0.8766), the time in which a surface wave crosses a grain. r
//!   radius [m], ρ density [kg/m³], G shear modulus [Pa], ν Poisson ratio.
//! * Hertz: duration of the elastic contact at the largest relative speed (`hertz_mindlin::contact_time`).
//! * Stiffness: Δt = 2√(m*/k), the stability limit of velocity Verlet. Electric pair k = |q_i q_j|/(2πεr³),
//!   wall image k = q²/(8πεd³) [N/m].
//! * Plasma: ω_p = √(n q²/(m ε)) of the charged grains [rad/s], n number density [1/m³]. An interval between
//!   field evaluations Δt_c < 0.2/ω_p is accurate.
//!
//! A field on the line through its last two values lags behind. To leading order x″ = −ω²x + ω⁴Δt_c³ x′/3, so
//! that an oscillation grows by the part π(ωΔt_c)³/3 in a period. At 0.3/ω_p this is 3 %, which the losses in
//! contacts make up for; at 1/ω_p the oscillation doubles. (A field held constant between impulses would be
//! stable up to 2/ω_p.)
//!
//! All limits are in [s] and positive; they are `f64::INFINITY` where there is no charge.
//! Sources: Ning & Ghadiri, Chem. Eng. Sci. 61, 5991 (2006); Hairer, Lubich & Wanner, *Geometric Numerical
//! Integration*, §I.1.4; Birdsall & Langdon, *Plasma Physics via Computer Simulation*, ch. 4.
//!
//! ```
//! use amberfield_laws::time_step_limits::{rayleigh, stiffness_limit};
//! assert!((stiffness_limit(4.0, 1.0) - 4.0).abs() < 1e-15);
//! assert!(rayleigh(1e-3, 2500.0, 1e7, 0.25) > 1e-5);
//! ```

use std::f64::consts::PI;

/// Product Δt_c ω_p below which the extrapolated field is accurate.
pub const PLASMA_ACCURATE: f64 = 0.2;
/// Product Δt_c ω_p below which the extrapolated field makes oscillations grow by less than 3 % in a period.
pub const PLASMA_STABLE: f64 = 0.3;

/// Rayleigh time [s] for a radius [m], a density [kg/m³], a shear modulus [Pa] and a Poisson ratio.
#[must_use]
pub fn rayleigh(radius: f64, density: f64, shear_modulus: f64, poisson: f64) -> f64 {
    PI * radius * (density / shear_modulus).sqrt() / (0.1631 * poisson + 0.8766)
}

/// Stability limit 2√(m/k) [s] for a mass [kg] and a stiffness [N/m].
#[must_use]
pub fn stiffness_limit(mass: f64, stiffness: f64) -> f64 {
    2.0 * (mass / stiffness).sqrt()
}

/// Stiffness k = |q_i q_j|/(2πεr³) [N/m] of a pair: the derivative of Coulomb's force at a distance r [m].
#[must_use]
pub fn pair_stiffness(charge_i: f64, charge_j: f64, permittivity: f64, distance: f64) -> f64 {
    (charge_i * charge_j).abs() / (2.0 * PI * permittivity * distance.powi(3))
}

/// Stiffness k = q²/(8πεd³) [N/m] of a wall's image: the derivative of the image force at a distance d [m]
/// from a plane conductor.
#[must_use]
pub fn wall_image_stiffness(charge: f64, permittivity: f64, distance: f64) -> f64 {
    charge * charge / (8.0 * PI * permittivity * distance.powi(3))
}

/// Plasma frequency ω_p = √(Σ(q²/m)/(V ε)) [rad/s], for equal grains √(n q²/(mε)).
///
/// `charge_squared_over_mass` = Σ q²/m [C²/kg] over the grains in the volume V [m³].
#[must_use]
pub fn plasma_frequency(charge_squared_over_mass: f64, volume: f64, permittivity: f64) -> f64 {
    (charge_squared_over_mass / (volume * permittivity)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-13;
    /// Error of a central difference.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn exact_points() {
        let t = rayleigh(1.0, 4.0, 1.0, 0.0);
        assert!((t - 2.0 * PI / 0.8766).abs() < ROUND_OFF);
        assert!((plasma_frequency(8.0, 2.0, 1.0) - 2.0).abs() < ROUND_OFF);
        assert_eq!(stiffness_limit(1.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn stiffnesses_are_derivatives_of_the_forces() {
        let (r, h) = (0.5_f64, 1e-6);
        let k = 1.0 / (4.0 * PI);
        let slope = (k / (r + h).powi(2) - k / (r - h).powi(2)) / (2.0 * h);
        assert!((pair_stiffness(1.0, -1.0, 1.0, r) / slope.abs() - 1.0).abs() < DIFFERENCE);
        let image = |d: f64| 1.0 / (16.0 * PI * d * d);
        let slope = (image(r + h) - image(r - h)) / (2.0 * h);
        assert!((wall_image_stiffness(1.0, 1.0, r) / slope.abs() - 1.0).abs() < DIFFERENCE);
    }

    #[test]
    fn symmetric_and_vanishing() {
        assert_eq!(pair_stiffness(1.0, 2.0, 1.0, 1.0), pair_stiffness(-2.0, 1.0, 1.0, 1.0));
        assert!(pair_stiffness(1.0, 1.0, 1.0, 1e9) < 1e-26);
        assert_eq!(wall_image_stiffness(0.0, 1.0, 1.0), 0.0);
    }
}
