//! Velocity that a grain's own drag gives the gas around it: w = F/(μ s) · 0.0423/(1 + 0.53 ρ|u|s/μ).
//!
//! w velocity in the direction of the force [m/s]; F force on the gas [N]; μ viscosity [Pa·s]; ρ density
//! [kg/m³]; u velocity of the gas against the grain [m/s]; s spread [m]. The force is spread over the gas,
//! and its velocity is gathered, by Gaussians of a standard deviation s/√2 along each axis. In cells not much
//! larger than itself a grain would feel this wind of its own, and fall too fast: laws of drag are about the
//! gas that it does not disturb.
//!
//! The formula fits Oseen's steady flow to 3.2 % at any Reynolds number,
//!
//! ```text
//! w = F/(4π² μ s) ∫ exp(−q²/2) J(ρ|u|s/(μ q)) dq,   J(x) = 2 (1 + x²) arctan(x)/x³ − 2/x²
//! ```
//!
//! which follows from Stokes's and Oseen's equations by Fourier transform, with a force along u.
//! Range: a grain far from others and from walls, in a flow that had the time s/|u| or ρs²/μ to settle.
//! Source: Lamb, Hydrodynamics, 6th ed., §340 (Oseen's equations); for spread forces, Balachandar, Liu &
//! Lakhote, J. Comput. Phys. 376, 160 (2019).
//!
//! ```
//! use amberfield_laws::self_disturbance::per_force;
//! // Stokes: sixteen times farther spread, sixteen times slower.
//! let near = per_force(1e-6, 1e-3, 1.2, 1.8e-5);
//! assert!((near / per_force(1e-6, 16e-3, 1.2, 1.8e-5) / 16.0 - 1.0).abs() < 1e-3);
//! ```

/// w/F of a steady Stokes flow, times μ s: √(π/2)/(3π²).
const STOKES: f64 = 0.042_329_083_757_236_06;
/// Factor of the Reynolds number: that of both limits, 1/(4π Re) for large ones, meets it to 0.5 %.
const OSEEN: f64 = 0.53;

/// Velocity over force w/F [m/(s·N)].
///
/// `speed` = |u| [m/s], `spread` = s [m], density [kg/m³], viscosity [Pa·s].
#[must_use]
pub fn per_force(speed: f64, spread: f64, density: f64, viscosity: f64) -> f64 {
    let reynolds = density * speed * spread / viscosity;
    STOKES / (viscosity * spread * (1.0 + OSEEN * reynolds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Value of the integral, by the midpoint rule.
    fn exact(reynolds: f64) -> f64 {
        let j = |x: f64| {
            if x < 1e-3 { 4.0 / 3.0 } else { 2.0 * (1.0 + x * x) * x.atan() / x.powi(3) - 2.0 / (x * x) }
        };
        let step = 2e-3;
        let at = |i: usize| {
            let q = (i as f64 + 0.5) * step;
            (-0.5 * q * q).exp() * j(reynolds / q)
        };
        (0..4000).map(at).sum::<f64>() * step / (4.0 * PI * PI)
    }

    #[test]
    fn it_is_oseens_flow_at_any_reynolds_number() {
        for reynolds in [0.0, 0.1, 1.0, 3.0, 10.0, 100.0, 1000.0] {
            // Unit viscosity, spread and density.
            let off = per_force(reynolds, 1.0, 1.0, 1.0) / exact(reynolds) - 1.0;
            assert!(off.abs() < 0.033, "{reynolds}: {off}");
        }
    }
}
