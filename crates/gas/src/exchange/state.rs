//! State from which an exchange goes on.

use super::ledger::Gone;
use super::{Exchange, Held, NEW};
use crate::mapping::Placed;
use crate::{FlowValues, GasError};
use amberfield_core::Vector3;
use serde::{Deserialize, Serialize};

/// State of an exchange that a run needs to go on bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ExchangeState {
    held: Vec<Held>,
    /// Places at the exchange, the cells there, and diameters [m].
    places: Vec<Vector3<f64>>,
    cells: Vec<u32>,
    diameters: Vec<f64>,
    owed: Vec<Vector3<f64>>,
    elapsed_s: f64,
    gone: Vec<Gone>,
    booked: Vector3<f64>,
    values: FlowValues,
    response_s: f64,
    /// Interval on which the solver works [s], and the answer that it gave.
    asked_s: Option<f64>,
    early: Option<FlowValues>,
    drag: Vec<f64>,
    source: Vec<Vector3<f64>>,
    /// State of the solver, by process.
    solver: Vec<Vec<f64>>,
}

impl ExchangeState {
    /// Whether this is a state of `count` grains.
    #[must_use]
    pub fn fits(&self, count: usize) -> bool {
        let known = |slot: u32| slot == NEW || (slot as usize) < self.places.len();
        self.held.len() == count
            && self.held.iter().all(|held| known(held.slot))
            && self.gone.iter().all(|gone| known(gone.slot))
    }
}

impl Exchange {
    /// State for a checkpoint.
    ///
    /// # Errors
    /// A solver that is lost.
    pub fn state(&mut self) -> Result<ExchangeState, GasError> {
        // Only a solver that has answered has a state.
        if self.asked_s.is_some() && self.early.is_none() {
            let mut early = FlowValues::default();
            self.solver.take(&mut early)?;
            self.early = Some(early);
        }
        Ok(ExchangeState {
            asked_s: self.asked_s,
            early: self.early.clone(),
            drag: self.drag.clone(),
            source: self.source.clone(),
            held: self.held.clone(),
            places: self.placed.iter().map(|grain| grain.centre).collect(),
            cells: self.placed.iter().map(|grain| grain.cell).collect(),
            diameters: self.placed.iter().map(|grain| grain.diameter).collect(),
            owed: self.owed.clone(),
            elapsed_s: self.elapsed_s,
            gone: self.gone.clone(),
            booked: self.booked,
            values: self.values.clone(),
            response_s: self.response_s,
            solver: self.solver.state()?,
        })
    }

    /// Goes on from a state.
    ///
    /// # Errors
    /// A solver that is lost, a state of another mesh.
    pub fn restore(&mut self, state: &ExchangeState) -> Result<(), GasError> {
        let (cells, theirs) = (self.owed.len(), state.owed.len());
        let by_cell = [state.drag.len(), state.source.len()];
        let in_mesh = by_cell == [cells; 2] && state.cells.iter().all(|&cell| (cell as usize) < cells);
        let counts = [state.cells.len(), state.diameters.len()];
        if cells != theirs || counts != [state.places.len(); 2] || !in_mesh {
            return Err(GasError::Settings(format!(
                "the checkpoint's gas is one of {theirs} cells, the mesh has {cells}; \
                 resume with the case that wrote it"
            )));
        }
        self.solver.restore(&state.solver)?;
        self.held.clone_from(&state.held);
        let grains = state.places.iter().zip(&state.cells).zip(&state.diameters);
        self.placed = grains.map(|((&centre, &cell), &diameter)| Placed { centre, diameter, cell }).collect();
        self.owed.clone_from(&state.owed);
        self.elapsed_s = state.elapsed_s;
        self.gone.clone_from(&state.gone);
        self.booked = state.booked;
        self.values.clone_from(&state.values);
        self.felt.clone_from(&state.values.velocity);
        self.smooth.clear();
        self.response_s = state.response_s;
        self.asked_s = state.asked_s;
        self.early.clone_from(&state.early);
        self.drag.clone_from(&state.drag);
        self.source.clone_from(&state.source);
        self.mapping.place(self.solver.mesh(), &self.placed, &mut self.shares);
        Ok(())
    }
}
