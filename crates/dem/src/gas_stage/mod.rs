//! Forces of a gas on the grains.
//!
//! [`UniformGas`] is the same everywhere and undisturbed. [`FlowingGas`] is computed by a flow solver of
//! another process, and grains act on it too.

mod flowing;
mod uniform;

pub(crate) use flowing::{FlowLimits, FlowingGas};
pub(crate) use uniform::UniformGas;

use crate::error::DemError;
use crate::motion::grains::Grains;
use crate::setup::GasSetup;
use amberfield_core::{Particles, Vector3};
use amberfield_gas::ExchangeState;

/// The gas of a scene.
#[derive(Debug)]
pub(crate) enum GasStage {
    Uniform(UniformGas),
    Flowing(Box<FlowingGas>),
}

impl GasStage {
    /// Builds the stage, afresh or from a checkpoint.
    pub(crate) fn new(
        setup: GasSetup,
        gravity: Vector3<f64>,
        particles: &Particles,
        saved: Option<&ExchangeState>,
    ) -> Result<Self, DemError> {
        let GasSetup { gas, solver } = setup;
        let Some(flow) = gas.flow else {
            return Ok(Self::Uniform(UniformGas::new(gas, gravity, particles)));
        };
        let solver = solver.ok_or_else(|| DemError::Setup("a gas that flows needs a solver".to_owned()))?;
        let gas = FlowingGas::new(gas, flow, &solver, gravity, particles, saved)?;
        Ok(Self::Flowing(Box::new(gas)))
    }

    /// Description for the plan.
    pub(crate) fn about(&self) -> String {
        match self {
            Self::Uniform(gas) => format!("drag ({}) and buoyancy of every grain alone", gas.drag()),
            Self::Flowing(gas) => gas.about(),
        }
    }

    /// The gas that is the same everywhere, if it is one.
    pub(crate) fn uniform(&self) -> Option<UniformGas> {
        match self {
            Self::Uniform(gas) => Some(*gas),
            Self::Flowing(_) => None,
        }
    }

    /// The gas whose flow is computed, if it is one.
    pub(crate) fn flowing(&self) -> Option<&FlowingGas> {
        match self {
            Self::Uniform(_) => None,
            Self::Flowing(gas) => Some(gas),
        }
    }

    /// See [`Self::flowing`].
    pub(crate) fn flowing_mut(&mut self) -> Option<&mut FlowingGas> {
        match self {
            Self::Uniform(_) => None,
            Self::Flowing(gas) => Some(gas),
        }
    }

    /// Adds the forces on the grains at the velocities forecast for the end of the step [N], for a step [s].
    pub(crate) fn add_forces(&mut self, grains: &Grains, step: f64, total: &mut [Vector3<f64>]) {
        match self {
            Self::Uniform(gas) => gas.add_forces(grains, total),
            Self::Flowing(gas) => gas.add_forces(grains, step, total),
        }
    }
}
