//! The flow of a gas in another process.

use super::shared::{Shared, locked, read_vectors, write_vectors};
use crate::CouplingError;
use amberfield_core::{GasModel, Vector3};
use amberfield_field::far::FarMesh;
use amberfield_gas::{CellShapes, FlowRequest, FlowSolver, FlowValues, GasError};
use amberfield_wire::payloads::{FlowAnswer, FlowQuestion};
use amberfield_wire::{Layout, MessageKind, Section, Sections, WireError};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Asks the process that also solves for the far field, if the scene has one.
#[derive(Debug)]
pub struct RemoteFlow {
    mesh: Arc<FarMesh>,
    shapes: Arc<CellShapes>,
    shared: Arc<Mutex<Shared>>,
}

impl RemoteFlow {
    pub(super) fn new(mesh: Arc<FarMesh>, shapes: Arc<CellShapes>, shared: Arc<Mutex<Shared>>) -> Self {
        Self { mesh, shapes, shared }
    }

    fn fetch(&self) -> Result<Vec<Vec<f64>>, CouplingError> {
        let shared = &mut *locked(&self.shared);
        shared.clear_the_way()?;
        shared.remote.ask(MessageKind::Checkpoint, |layout| layout, |_, _| Ok(()))?;
        let mut state = vec![Vec::new(); shared.remote.settings.ranks as usize];
        shared.remote.collect(MessageKind::State, |_, rank, sections| {
            state[rank] = sections.get::<f64>(Section::FlowState)?.to_vec();
            Ok(())
        })?;
        Ok(state)
    }

    fn send_back(&self, state: &[Vec<f64>]) -> Result<(), CouplingError> {
        let shared = &mut *locked(&self.shared);
        shared.clear_the_way()?;
        let sizes: Vec<u64> = state.iter().map(|part| part.len() as u64).collect();
        let all = state.concat();
        let layout = |layout: Layout| {
            layout
                .with::<u64>(Section::FlowStateSizes, sizes.len())
                .with::<f64>(Section::FlowState, all.len())
        };
        shared.remote.ask(MessageKind::Restore, layout, |layout, payload| {
            layout.section_mut::<u64>(payload, Section::FlowStateSizes)?.copy_from_slice(&sizes);
            layout.section_mut::<f64>(payload, Section::FlowState)?.copy_from_slice(&all);
            Ok(())
        })?;
        shared.remote.collect(MessageKind::State, |_, _, _| Ok(()))
    }
}

impl Shared {
    /// Asks for the flow without waiting.
    fn send_flow(&mut self, request: &FlowRequest<'_>) -> Result<(), CouplingError> {
        self.clear_the_way()?;
        let question = FlowQuestion {
            interval_s: request.interval_s,
            time_s: request.time_s,
            density_kg_m3: request.gas.density_kg_m3,
            viscosity_pa_s: request.gas.viscosity_pa_s,
            model_b: u64::from(request.flow.model == GasModel::B),
            viscous_force: u64::from(request.flow.viscous_force),
            vorticity: u64::from(request.flow.saffman_lift),
        };
        let cells = request.void_fraction.len();
        let layout = |layout: Layout| {
            layout
                .with::<FlowQuestion>(Section::FlowQuestion, 1)
                .with::<f64>(Section::VoidFraction, cells)
                .with::<f64>(Section::DragCoefficient, cells)
                .with::<[f64; 3]>(Section::MomentumSource, cells)
        };
        self.remote.ask(MessageKind::Grains, layout, |layout, payload| {
            layout.section_mut::<FlowQuestion>(payload, Section::FlowQuestion)?.fill(question);
            let void_fraction = layout.section_mut::<f64>(payload, Section::VoidFraction)?;
            void_fraction.copy_from_slice(request.void_fraction);
            layout.section_mut::<f64>(payload, Section::DragCoefficient)?.copy_from_slice(request.drag);
            write_vectors(layout.section_mut(payload, Section::MomentumSource)?, request.source);
            Ok(())
        })?;
        self.flow.asked = Some(question);
        Ok(())
    }

    /// Waits for the flow that was asked for last.
    fn take_flow(&mut self, values: &mut FlowValues) -> Result<(), CouplingError> {
        if let Some(answer) = self.flow.answer.take() {
            *values = answer;
            return Ok(());
        }
        let asked = self.flow.asked.take();
        let cells = self.remote.cell_count();
        let count_if = |wanted: fn(&FlowQuestion) -> u64| match &asked {
            Some(question) if wanted(question) != 0 => cells,
            _ => 0,
        };
        values.velocity.resize(cells, Vector3::zeros());
        values.pressure_gradient.resize(cells, Vector3::zeros());
        values.viscous_force.resize(count_if(|question| question.viscous_force), Vector3::zeros());
        values.vorticity.resize(count_if(|question| question.vorticity), Vector3::zeros());
        (values.iterations, values.residual, values.seconds) = (0, 0.0, 0.0);
        (values.steps, values.courant) = (0, 0.0);
        self.remote.collect(MessageKind::Flow, |cells, _, sections| read(cells, sections, values))?;
        let outcome = sound(values);
        self.remote.noted(outcome)
    }

    /// Takes the flow that is open, before somebody else asks.
    pub(super) fn take_flow_early(&mut self) -> Result<(), CouplingError> {
        if self.flow.asked.is_some() {
            let mut values = FlowValues::default();
            self.take_flow(&mut values)?;
            self.flow.answer = Some(values);
        }
        Ok(())
    }
}

impl FlowSolver for RemoteFlow {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn shapes(&self) -> &CellShapes {
        &self.shapes
    }

    fn ask(&mut self, request: &FlowRequest<'_>) -> Result<(), GasError> {
        locked(&self.shared).send_flow(request).map_err(of_gas)
    }

    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError> {
        locked(&self.shared).take_flow(values).map_err(of_gas)
    }

    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError> {
        self.fetch().map_err(of_gas)
    }

    fn restore(&mut self, state: &[Vec<f64>]) -> Result<(), GasError> {
        self.send_back(state).map_err(of_gas)
    }
}

fn of_gas(error: CouplingError) -> GasError {
    match error {
        CouplingError::Refused(_) | CouplingError::Case(_) => GasError::Refused(error.to_string()),
        error => GasError::Solver(error.to_string()),
    }
}

/// Takes one rank's answer.
fn read(of_rank: Range<usize>, sections: &Sections<'_>, values: &mut FlowValues) -> Result<(), WireError> {
    let arrays = [
        (Section::Velocity, &mut values.velocity),
        (Section::PressureGradient, &mut values.pressure_gradient),
        (Section::ViscousForce, &mut values.viscous_force),
        (Section::Vorticity, &mut values.vorticity),
    ];
    for (section, array) in arrays {
        if !array.is_empty() {
            let theirs = sections.exactly::<[f64; 3]>(section, of_rank.len())?;
            read_vectors(&mut array[of_rank.clone()], theirs);
        }
    }
    let answer = sections.one::<FlowAnswer>(Section::FlowAnswer)?;
    values.iterations = values.iterations.max(answer.iterations);
    values.residual = values.residual.max(answer.residual);
    values.seconds = values.seconds.max(answer.seconds);
    values.steps = values.steps.max(answer.steps);
    values.courant = values.courant.max(answer.courant);
    let advice = sections.text();
    if !advice.is_empty() {
        tracing::warn!("gas: {}", advice.trim_end());
    }
    Ok(())
}

/// Refuses a flow that is no number somewhere.
fn sound(values: &FlowValues) -> Result<(), CouplingError> {
    let arrays =
        [&values.velocity, &values.pressure_gradient, &values.viscous_force, &values.vorticity].into_iter();
    for (name, array) in ["u", "∇p", "∇·τ", "∇ × u"].into_iter().zip(arrays) {
        if let Some(cell) = array.iter().position(|value| !value.sum().is_finite()) {
            return Err(CouplingError::Flow(format!(
                "the flow's {name} in cell {cell} is {:?}; make gas.interval_s shorter, and look at the \
                 solver's log",
                array[cell].as_slice()
            )));
        }
    }
    Ok(())
}
