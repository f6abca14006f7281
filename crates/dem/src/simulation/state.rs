//! The complete state of a run, for checkpoints.

use crate::charging::{Facets, Ledger};
use crate::contacts::memory::Memory;
use crate::field_crate::Choice;
use crate::field_crate::far::FarState;
use crate::gas_crate::ExchangeState;
use amberfield_core::Vector3;
use serde::{Deserialize, Serialize};

/// History of a touching pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PairHistory {
    /// Grain whose list holds the pair, in the sorted order.
    pub(crate) i: u32,
    /// Entry in that list.
    pub(crate) entry: u32,
    /// Partner, in the set-up's order.
    pub(crate) partner: u32,
    /// Tangential force [N] and contact radius [m].
    pub(crate) spring: [f64; 4],
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
}

/// History of a contact with a wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WallHistory {
    /// Grain, in the set-up's order.
    pub(crate) grain: u32,
    /// Wall.
    pub(crate) wall: u32,
    /// Direction from the grain to the wall.
    pub(crate) normal: [f64; 3],
    /// Overlap [m].
    pub(crate) overlap: f64,
    /// Of a mesh, where it is touched.
    pub(crate) triangle: u32,
    /// Tangential force [N] and contact radius [m].
    pub(crate) spring: [f64; 4],
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
    pub(crate) charging: Memory,
}

/// Charging of a listed pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PairGrowth {
    /// Chunk whose list holds the pair, and entry in it.
    pub(crate) slot: [u32; 2],
    pub(crate) memory: Memory,
}

/// State of charge transfer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChargingState {
    /// Charges now, and at the last evaluation of the field, by the set-up's order [C].
    pub(crate) charge: Vec<f64>,
    pub(crate) evaluated: Vec<f64>,
    pub(crate) pairs: Vec<PairGrowth>,
    pub(crate) facets: Facets,
    pub(crate) ledger: Ledger,
    pub(crate) backwards: bool,
    pub(crate) lag: f64,
}

/// State of the field stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FieldState {
    pub(crate) choice: Choice,
    /// The internal grid's parameters, should the field solver be lost.
    pub(crate) fallback: Option<Choice>,
    /// Whether a field solver has a part in it, and is not lost yet.
    pub(crate) has_solver: bool,
    /// Iterations of its last solve for the motion.
    pub(crate) solver_iterations: u64,
    /// Of a field solver in another process.
    pub(crate) far: FarState,
    pub(crate) forecast: crate::field_stage::Forecast,
    pub(crate) energy: crate::field_stage::EnergyForecast,
    pub(crate) control: crate::field_stage::IntervalControl,
    pub(crate) travel: f64,
    pub(crate) plasma_steps: u64,
    pub(crate) plasma_limit: f64,
    pub(crate) limited: crate::field_stage::Limited,
}

impl FieldState {
    /// Whether it is one of `count` grains.
    pub(crate) fn fits(&self, count: usize) -> bool {
        self.forecast.fits(count)
    }
}

/// Everything that a run needs to go on bit for bit, given the same [`crate::Setup`]. Opaque; serialise it
/// with serde.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub(crate) step_index: u64,
    pub(crate) step_s: f64,
    pub(crate) skin_m: f64,
    pub(crate) travel: f64,
    pub(crate) speed: f64,
    pub(crate) original: Vec<u32>,
    pub(crate) centre: Vec<Vector3<f64>>,
    pub(crate) velocity: Vec<Vector3<f64>>,
    pub(crate) angular: Vec<Vector3<f64>>,
    pub(crate) force: Vec<Vector3<f64>>,
    pub(crate) torque: Vec<Vector3<f64>>,
    pub(crate) reference: Vec<Vector3<f64>>,
    pub(crate) pairs: Vec<PairHistory>,
    pub(crate) walls: Vec<WallHistory>,
    pub(crate) field: Option<FieldState>,
    pub(crate) charging: Option<ChargingState>,
    /// Of a gas that flows; not in a [`crate::Simulation::state`].
    pub(crate) gas: Option<ExchangeState>,
}

impl State {
    /// Number of steps done.
    #[must_use]
    pub fn step_index(&self) -> u64 {
        self.step_index
    }

    /// Whether a field solver that the scene has was lost, and the internal grid goes on.
    #[must_use]
    pub fn has_lost_solver(&self) -> bool {
        self.field.as_ref().is_some_and(|field| !field.has_solver)
    }

    /// Parameters of the field in force; `None` without a field stage.
    #[must_use]
    pub fn choice(&self) -> Option<&Choice> {
        self.field.as_ref().map(|f| &f.choice)
    }
}
