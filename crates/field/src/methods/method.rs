//! What every way to compute the field of charges offers.

use crate::error::FieldError;
use crate::levels::far::FarSolver;
use crate::values::{FieldValues, Wanted};
use nalgebra::Vector3;
use std::fmt;

/// A way to compute the field of charges and their images. Potentials and normal fields of the faces and an
/// external field are not its business, except where a method has them in its own boundary conditions.
pub trait FieldMethod: fmt::Debug + Send + Sync {
    /// E [V/m] (and what else is wanted) at every particle, positions in m, charges in C.
    ///
    /// # Errors
    /// Values that are not finite, grains where the method has no field, two charges in one place, a net charge
    /// that no face takes.
    fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError>;

    /// The field solver of another process that has a part in it, and its state.
    fn far_solver(&self) -> Option<&FarSolver> {
        None
    }

    /// The same, to tell it where and when its next solve is.
    fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        None
    }

    /// Mean number of partners that were summed for a particle in the last evaluation, images included.
    fn pairs_per_particle(&self) -> f64;

    /// Nodes or cells of the grid per axis; `None` where there is no grid.
    fn grid_cells(&self) -> Option<[usize; 3]> {
        None
    }

    /// Stages of the last evaluation and their time [s].
    fn seconds(&self) -> &[(&'static str, f64)];

    /// Memory kept between evaluations [bytes].
    fn memory_bytes(&self) -> usize;
}
