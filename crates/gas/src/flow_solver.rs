//! The solver that computes the flow of the gas.

use crate::{CellShapes, GasError};
use amberfield_core::{Gas, GasFlow, Vector3};
use amberfield_field::far::FarMesh;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Question to a solver: the flow at the end of an interval, with grains that stay as they are at its start.
///
/// ε ρ (∂u/∂t + u·∇u) = −a ∇p + ∇·(ε τ) − K u + S with ∂ε/∂t + ∇·(ε u) = 0
///
/// The pressure p is without the gas's own weight; a = ε in model A and 1 in model B.
#[derive(Clone, Copy, Debug)]
pub struct FlowRequest<'a> {
    /// Length of the interval [s]; 0 asks for the flow as it is.
    pub interval_s: f64,
    /// Start of the interval [s].
    pub time_s: f64,
    /// Gas, with its density and viscosity.
    pub gas: &'a Gas,
    /// Settings of the flow: the model, and which parts of the answer are wanted.
    pub flow: &'a GasFlow,
    /// Void fraction ε by cell.
    pub void_fraction: &'a [f64],
    /// Drag coefficient K by cell [kg/(m³ s)].
    pub drag: &'a [f64],
    /// Source of momentum S by cell [N/m³].
    pub source: &'a [Vector3<f64>],
}

/// The flow at cell centres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlowValues {
    /// Velocity u [m/s].
    pub velocity: Vec<Vector3<f64>>,
    /// Pressure gradient ∇p [Pa/m], without the gas's own weight.
    pub pressure_gradient: Vec<Vector3<f64>>,
    /// Viscous force ∇·τ [N/m³].
    pub viscous_force: Vec<Vector3<f64>>,
    /// Vorticity ∇ × u [1/s].
    pub vorticity: Vec<Vector3<f64>>,
    /// Iterations of the linear solver for p.
    pub iterations: u64,
    /// Error of continuity: RMS over the cells of ∂ε/∂t + ∇·(ε u), times the interval.
    pub residual: f64,
    /// Time that the solver took, without the way there and back [s].
    pub seconds: f64,
    /// Steps of the flow in the interval.
    pub steps: u64,
    /// Largest Courant number of a step.
    pub courant: f64,
}

/// Solver of the flow.
pub trait FlowSolver: fmt::Debug + Send + Sync {
    /// Mesh of the cells on which the flow is computed.
    fn mesh(&self) -> &FarMesh;

    /// Corners of the mesh's faces.
    fn shapes(&self) -> &CellShapes;

    /// Asks for the flow after an interval, without waiting.
    ///
    /// # Errors
    /// A solver that is lost.
    fn ask(&mut self, request: &FlowRequest<'_>) -> Result<(), GasError>;

    /// Waits for the answer to what was asked last.
    ///
    /// # Errors
    /// A solver that is lost or does not converge.
    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError>;

    /// State that the solver needs to go on bit for bit: numbers of its own, by process.
    ///
    /// # Errors
    /// A solver that is lost.
    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError>;

    /// Goes on from a state.
    ///
    /// # Errors
    /// A solver that is lost, a state that is not one of its own.
    fn restore(&mut self, state: &[Vec<f64>]) -> Result<(), GasError>;
}

/// Way to reach a solver of the flow.
#[derive(Clone)]
pub struct ConnectFlow(Arc<dyn Fn() -> Result<Box<dyn FlowSolver>, GasError> + Send + Sync>);

impl ConnectFlow {
    /// Reaches the solver by calling `connect`.
    #[must_use]
    pub fn new(connect: impl Fn() -> Result<Box<dyn FlowSolver>, GasError> + Send + Sync + 'static) -> Self {
        Self(Arc::new(connect))
    }

    /// Hands out this solver once; a second call finds that it is lost.
    #[must_use]
    pub fn once(solver: impl FlowSolver + 'static) -> Self {
        let waiting = Mutex::new(Some(Box::new(solver) as Box<dyn FlowSolver>));
        Self::new(move || {
            let solver = waiting.lock().unwrap_or_else(PoisonError::into_inner).take();
            solver.ok_or_else(|| GasError::Solver("the solver of the flow was lost".to_owned()))
        })
    }

    /// Reaches the solver.
    ///
    /// # Errors
    /// No solver is there.
    pub fn connect(&self) -> Result<Box<dyn FlowSolver>, GasError> {
        (self.0)()
    }
}

impl fmt::Debug for ConnectFlow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ConnectFlow")
    }
}
