//! Drag by the law that a scene names: F = β (u − v), beside the force of the pressure gradient (model A).
//!
//! F force on one grain [N]; β drag coefficient [kg/s]; u velocity of the fluid, v of the grain [m/s]. Range
//! and source stand in the file of each law.
//!
//! ```
//! use amberfield_core::DragLaw;
//! use amberfield_laws::{drag, particle_reynolds::Slip, stokes_drag};
//! let slip = Slip { speed: 0.1, void_fraction: 1.0, diameter: 1e-4, density: 1.2, viscosity: 1.8e-5 };
//! assert_eq!(drag::coefficient(DragLaw::Stokes, &slip), stokes_drag::coefficient(1e-4, 1.8e-5));
//! ```

use crate::particle_reynolds::Slip;
use crate::{beetstra_drag, di_felice_drag, gidaspow_drag, schiller_naumann_drag, stokes_drag};
use amberfield_core::DragLaw;

/// Drag coefficient β [kg/s] of one grain by the given law.
#[must_use]
pub fn coefficient(law: DragLaw, slip: &Slip) -> f64 {
    match law {
        DragLaw::Stokes => stokes_drag::coefficient(slip.diameter, slip.viscosity),
        DragLaw::SchillerNaumann => schiller_naumann_drag::coefficient(slip),
        DragLaw::DiFelice => di_felice_drag::coefficient(slip),
        DragLaw::Gidaspow => gidaspow_drag::coefficient(slip),
        DragLaw::Beetstra => beetstra_drag::coefficient(slip),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_its_law() {
        let slip = Slip { speed: 0.5, void_fraction: 0.6, diameter: 1e-3, density: 1.2, viscosity: 1.8e-5 };
        let found = DragLaw::ALL.map(|law| coefficient(law, &slip));
        let expected = [
            stokes_drag::coefficient(1e-3, 1.8e-5),
            schiller_naumann_drag::coefficient(&slip),
            di_felice_drag::coefficient(&slip),
            gidaspow_drag::coefficient(&slip),
            beetstra_drag::coefficient(&slip),
        ];
        assert_eq!(found, expected);
    }
}
