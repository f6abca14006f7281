//! What stands for the field crate in a build without it (`--no-default-features`): types that have no values. To ask
//! for a field is an error there, and everything that would need one is left out by the compiler.

use amberfield_core::{Domain, FieldSettings, Plan, Vector3};
use serde::{Deserialize, Serialize};

/// Parameters of a field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Choice {}

/// Why there is no field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("this build has no electric field; build amberfield-dem with its feature `field`")]
pub struct FieldError;

impl FieldError {
    pub(crate) fn is_of_solver(&self) -> bool {
        false
    }
}

/// Fields over somebody else's mesh.
pub(crate) mod far {
    use super::FieldError;
    use serde::{Deserialize, Serialize};

    /// State of a far level.
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    pub(crate) struct FarState;

    /// A far level.
    #[derive(Debug)]
    pub(crate) enum FarSolver {}

    impl FarSolver {
        pub(crate) fn state(&self) -> FarState {
            match *self {}
        }

        pub(crate) fn start_from(&mut self, _: &FarState) -> Result<(), FieldError> {
            match *self {}
        }

        pub(crate) fn at_time(&mut self, _: f64) {
            match *self {}
        }

        pub(crate) fn iterations(&self) -> u64 {
            match *self {}
        }

        pub(crate) fn missed(&self) -> f64 {
            match *self {}
        }

        pub(crate) fn overlaps(&self) -> bool {
            match *self {}
        }
    }

    /// How a far level is reached.
    #[derive(Clone, Debug)]
    pub enum Connect {}

    impl Connect {
        pub(crate) fn connect(&self) -> Result<(), FieldError> {
            match *self {}
        }
    }
}

/// A gas that flows.
pub(crate) mod gas {
    use crate::error::DemError;
    use crate::motion::grains::Grains;
    use amberfield_core::{Domain, Gas, GasFlow, Particles, Vector3};
    use serde::{Deserialize, Serialize};

    /// Why there is no flow.
    #[derive(Clone, Debug, PartialEq, thiserror::Error)]
    #[error("this build has no gas that flows; build amberfield-dem with its feature `field`")]
    pub struct GasError;

    /// How a solver is reached.
    #[derive(Clone, Debug)]
    pub enum ConnectFlow {}

    /// State of an exchange.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub(crate) enum ExchangeState {}

    impl ExchangeState {
        pub(crate) fn fits(&self, _: usize) -> bool {
            match *self {}
        }
    }

    /// A gas that flows.
    #[derive(Debug)]
    pub(crate) enum FlowingGas {}

    impl FlowingGas {
        pub(crate) fn new(
            _: (Gas, GasFlow),
            solver: &ConnectFlow,
            _: Vector3<f64>,
            _: &Particles,
            _: Option<&ExchangeState>,
        ) -> Result<Self, DemError> {
            match *solver {}
        }

        pub(crate) fn set_step(&mut self, _: f64) {
            match *self {}
        }

        pub(crate) fn about(&self) -> String {
            match *self {}
        }

        pub(crate) fn limits(&self) -> (u64, f64) {
            match *self {}
        }

        pub(crate) fn is_due(&self, _: u64) -> bool {
            match *self {}
        }

        pub(crate) fn exchange(&mut self, _: &Domain, _: &Grains, _: (u64, f64)) -> Result<(), DemError> {
            match *self {}
        }

        pub(crate) fn add_forces(&mut self, _: &Grains, _: f64, _: &mut [Vector3<f64>]) {
            match *self {}
        }

        pub(crate) fn reorder(&mut self, _: &[u32]) {
            match *self {}
        }

        pub(crate) fn state(&mut self) -> Result<ExchangeState, DemError> {
            match *self {}
        }
    }
}

/// A field.
#[derive(Debug)]
pub enum ElectricField {}

/// An error of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub(crate) relative_rms: f64,
}

/// What an evaluation is asked for.
#[derive(Clone, Copy, Debug, Default)]
#[expect(dead_code, reason = "nothing evaluates it")]
pub(crate) struct Wanted {
    pub(crate) potential: bool,
    pub(crate) components: bool,
}

/// What an evaluation returns.
#[derive(Debug, Default)]
pub(crate) struct FieldValues {
    pub(crate) e: Vec<Vector3<f64>>,
    pub(crate) potential: Vec<f64>,
}

impl ElectricField {
    pub(crate) fn new(
        _: &Domain,
        _: &FieldSettings,
        _: &[Vector3<f64>],
        _: &[f64],
    ) -> Result<Self, FieldError> {
        Err(FieldError)
    }

    pub(crate) fn with_choice(_: &Domain, _: &FieldSettings, choice: &Choice) -> Result<Self, FieldError> {
        match *choice {}
    }

    pub(crate) fn over_mesh(
        (): (),
        _: &FieldSettings,
        _: &[Vector3<f64>],
        _: &[f64],
    ) -> Result<Self, FieldError> {
        Err(FieldError)
    }

    pub(crate) fn over_mesh_with_choice(
        (): (),
        _: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        match *choice {}
    }

    pub(crate) fn evaluate(
        &mut self,
        _: &[Vector3<f64>],
        _: &[f64],
        _: Wanted,
        _: &mut FieldValues,
    ) -> Result<(), FieldError> {
        match *self {}
    }

    pub(crate) fn measure_error(
        &mut self,
        _: &[Vector3<f64>],
        _: &[f64],
    ) -> Result<Option<Measured>, FieldError> {
        match *self {}
    }

    pub(crate) fn far_solver(&self) -> Option<&far::FarSolver> {
        match *self {}
    }

    pub(crate) fn far_solver_mut(&mut self) -> Option<&mut far::FarSolver> {
        match *self {}
    }

    pub(crate) fn choice(&self) -> &Choice {
        match *self {}
    }

    pub(crate) fn plan(&self) -> Plan {
        match *self {}
    }
}
