//! The question for the flow of a gas after an interval, arrays apart.

use super::require;
use crate::{Element, Section, WireError};
use std::mem::{offset_of, size_of};

/// Scalars of the question for the flow of a gas at the end of an interval.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowQuestion {
    /// Length of the interval [s]; 0: the flow as it is, nothing moves.
    pub interval_s: f64,
    /// Time at which the interval begins [s].
    pub time_s: f64,
    /// Density of the gas [kg/m^3].
    pub density_kg_m3: f64,
    /// Viscosity of the gas [Pa s].
    pub viscosity_pa_s: f64,
    /// 1: the pressure acts on the gas alone (model B); 0: on gas and grains (model A).
    pub model_b: u64,
    /// 1: the divergence of the viscous stress is wanted.
    pub viscous_force: u64,
    /// 1: the vorticity is wanted.
    pub vorticity: u64,
}

// SAFETY: seven numbers without padding, see below.
unsafe impl Element for FlowQuestion {}

const _: () = {
    assert!(size_of::<FlowQuestion>() == 56);
    assert!(offset_of!(FlowQuestion, interval_s) == 0);
    assert!(offset_of!(FlowQuestion, time_s) == 8);
    assert!(offset_of!(FlowQuestion, density_kg_m3) == 16);
    assert!(offset_of!(FlowQuestion, viscosity_pa_s) == 24);
    assert!(offset_of!(FlowQuestion, model_b) == 32);
    assert!(offset_of!(FlowQuestion, viscous_force) == 40);
    assert!(offset_of!(FlowQuestion, vorticity) == 48);
};

impl FlowQuestion {
    /// Refuses a question with numbers that cannot be used.
    ///
    /// # Errors
    /// Numbers that are not finite, a negative interval, a density or a viscosity that is not positive.
    pub fn check(&self) -> Result<(), WireError> {
        let require = |sound, name, value| require(sound, Section::FlowQuestion, name, value);
        let positive = |value: f64| value.is_finite() && value > 0.0;

        require(self.interval_s.is_finite() && self.interval_s >= 0.0, "interval_s", self.interval_s)?;
        require(self.time_s.is_finite(), "time_s", self.time_s)?;
        require(positive(self.density_kg_m3), "density_kg_m3", self.density_kg_m3)?;
        require(positive(self.viscosity_pa_s), "viscosity_pa_s", self.viscosity_pa_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: FlowQuestion = FlowQuestion {
        interval_s: 0.0,
        time_s: 0.5,
        density_kg_m3: 1.2,
        viscosity_pa_s: 1.8e-5,
        model_b: 0,
        viscous_force: 1,
        vorticity: 0,
    };

    #[test]
    fn a_number_that_cannot_be_used_is_named() {
        assert_eq!(GOOD.check(), Ok(()));
        let said = FlowQuestion { viscosity_pa_s: -1.0, ..GOOD }.check().unwrap_err().to_string();
        assert!(said.contains("viscosity_pa_s") && said.contains("FlowQuestion"), "{said}");
        assert!(FlowQuestion { interval_s: -1e-3, ..GOOD }.check().is_err());
        assert!(FlowQuestion { density_kg_m3: 0.0, ..GOOD }.check().is_err());
        assert!(FlowQuestion { time_s: f64::INFINITY, ..GOOD }.check().is_err());
    }
}
