//! Cells with a field that is constant in each, whoever solves for it.

use super::mesh::Mesh;
use crate::error::FieldError;
use crate::levels::far::{FarField, FarRequest, FarSolver, check_net_charge};
use amberfield_core::{FarQuestion, Permittivity, SourceCloud};
use nalgebra::Vector3;
use std::fmt::Debug;

/// Cells that take each charge whole and answer with a potential and a field.
pub(super) trait ChargeCells: Debug + Send + Sync {
    /// Finds each charge's cell and solves ∇²φ = −ρ/ε for the charges at a time [s].
    fn solve(
        &mut self,
        time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        permittivity: Permittivity,
        cells: &mut Vec<u32>,
    ) -> Result<(), FieldError>;

    /// Centre of a cell [m].
    fn centre(&self, cell: u32) -> Vector3<f64>;

    /// Potential of a cell [V].
    fn potential(&self, cell: u32) -> f64;

    /// E of a cell [V/m].
    fn field(&self, cell: u32) -> Vector3<f64>;

    /// The field solver of another process and its state; `None` where the cells are solved for here.
    fn solver(&self) -> Option<&FarSolver> {
        None
    }

    /// Gives the field solver away, to start from another state.
    fn solver_mut(&mut self) -> Option<&mut FarSolver> {
        None
    }

    /// Cells along each axis, where they are a box's.
    fn counts(&self) -> Option<[usize; 3]>;

    /// Memory held [bytes].
    fn memory_bytes(&self) -> usize;
}

impl ChargeCells for Mesh {
    fn solve(
        &mut self,
        _time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        permittivity: Permittivity,
        cells: &mut Vec<u32>,
    ) -> Result<(), FieldError> {
        cells.clear();
        cells.extend(positions.iter().map(|position| self.number(self.cell_of(position))));
        self.solve_for(cells, charges, permittivity.absolute());
        Ok(())
    }

    fn centre(&self, cell: u32) -> Vector3<f64> {
        self.centre_of(self.place(cell))
    }

    fn potential(&self, cell: u32) -> f64 {
        self.potential_of(self.place(cell))
    }

    fn field(&self, cell: u32) -> Vector3<f64> {
        self.field_of(self.place(cell))
    }

    fn counts(&self) -> Option<[usize; 3]> {
        Some(self.cells())
    }

    fn memory_bytes(&self) -> usize {
        self.bytes()
    }
}

/// The cells of a field solver's mesh, its own gradient and its own boundary conditions.
#[derive(Debug)]
pub(super) struct SolverCells {
    solver: FarSolver,
    neutralising_background: bool,
    boundary: Vec<f64>,
}

impl SolverCells {
    pub(super) fn new(solver: Box<dyn FarField>, neutralising_background: bool) -> Self {
        let boundary = solver.mesh().boundary().iter().map(|face| face.condition.value()).collect();
        Self { solver: FarSolver::new(solver, false), neutralising_background, boundary }
    }
}

impl ChargeCells for SolverCells {
    fn solve(
        &mut self,
        time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        permittivity: Permittivity,
        cells: &mut Vec<u32>,
    ) -> Result<(), FieldError> {
        let mesh = self.solver.mesh();
        // Where each was before; at first nobody knows.
        cells.resize(positions.len(), u32::MAX);
        for (position, cell) in positions.iter().zip(cells.iter_mut()) {
            *cell = mesh.locate(position, (*cell != u32::MAX).then_some(*cell)).0;
        }
        mesh.check_inside(positions, cells)?;
        check_net_charge(mesh, permittivity, self.neutralising_background, charges, cells)?;
        if self.solver.changes() {
            let conditions = self.solver.mesh().boundary().iter().map(|face| face.condition.value());
            self.boundary.clear();
            self.boundary.extend(conditions);
            self.solver.add_changing(&mut self.boundary)?;
        }
        let question = FarQuestion {
            cloud: SourceCloud::nearest_cell(),
            permittivity_f_m: permittivity.absolute(),
            neutralising_background: u64::from(self.neutralising_background),
            time_s,
            tolerance: 0.0,
            wants_e: 1,
        };
        let request = FarRequest {
            question,
            positions,
            charges,
            image_positions: &[],
            image_charges: &[],
            density: &[],
            boundary: &self.boundary,
            guess: &[],
        };
        self.solver.solve(&request)?;
        Ok(())
    }

    fn solver(&self) -> Option<&FarSolver> {
        Some(&self.solver)
    }

    fn solver_mut(&mut self) -> Option<&mut FarSolver> {
        Some(&mut self.solver)
    }

    fn centre(&self, cell: u32) -> Vector3<f64> {
        self.solver.mesh().centres()[cell as usize]
    }

    fn potential(&self, cell: u32) -> f64 {
        self.solver.values.potential[cell as usize]
    }

    fn field(&self, cell: u32) -> Vector3<f64> {
        self.solver.values.e[cell as usize]
    }

    fn counts(&self) -> Option<[usize; 3]> {
        None
    }

    fn memory_bytes(&self) -> usize {
        self.solver.values.potential.capacity() * size_of::<[f64; 4]>()
    }
}
