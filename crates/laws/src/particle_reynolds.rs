//! Reynolds number of a grain in a fluid: Re = ρ d |w|/μ; with the superficial slip, ε Re.
//!
//! ρ density [kg/m³] and μ viscosity [Pa·s] of the fluid; d diameter of the grain [m]; w = u − v velocity of
//! the fluid less that of the grain [m/s]; ε void fraction, 0 < ε ≤ 1.
//! Source: Crowe, Schwarzkopf, Sommerfeld & Tsuji, *Multiphase Flows with Droplets and Particles*, 2nd ed.,
//! §2.
//!
//! ```
//! use amberfield_laws::particle_reynolds::Slip;
//! let slip = Slip { speed: 0.1, void_fraction: 0.5, diameter: 1e-3, density: 1.2, viscosity: 1.8e-5 };
//! assert!((slip.reynolds() - 6.667).abs() < 1e-3);
//! ```

/// State of the fluid at a grain, the input of the drag laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// Slip speed |w| = |u − v| [m/s].
    pub speed: f64,
    /// Void fraction ε, the fluid's share of the volume.
    pub void_fraction: f64,
    /// Diameter d of the grain [m].
    pub diameter: f64,
    /// Density ρ of the fluid [kg/m³].
    pub density: f64,
    /// Viscosity μ of the fluid [Pa·s].
    pub viscosity: f64,
}

impl Slip {
    /// Reynolds number Re = ρ d |w|/μ.
    #[must_use]
    pub fn reynolds(&self) -> f64 {
        self.density * self.diameter * self.speed / self.viscosity
    }

    /// Superficial Reynolds number ε Re = ρ d ε|w|/μ.
    #[must_use]
    pub fn superficial_reynolds(&self) -> f64 {
        self.void_fraction * self.reynolds()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_points() {
        let slip = Slip { speed: 2.0, void_fraction: 0.25, diameter: 3.0, density: 5.0, viscosity: 10.0 };
        assert_eq!((slip.reynolds(), slip.superficial_reynolds()), (3.0, 0.75));
    }
}
