//! The interface that every way to compute the field of charges offers.

use crate::error::FieldError;
use crate::geometry::inputs::check_result;
use crate::levels::far::FarSolver;
use crate::methods::p3m_parameters::P3mParameters;
use crate::sum::{Levels, Sum};
use crate::values::{FieldAt, FieldValues, Wanted};
use nalgebra::Vector3;
use std::fmt;

/// E at a sample of the particles, by two splittings.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoSplittings {
    /// E by the method's own parameters [V/m].
    pub first: Vec<Vector3<f64>>,
    /// E by others that err less [V/m].
    pub second: Vec<Vector3<f64>>,
    /// Differences of the cells' part of E on both sides of the faces nearest to the particles [V/m].
    pub jumps: Vec<Vector3<f64>>,
    /// Scale of errors: the larger of E_rms and q_rms n^{2/3}/(4πε) [V/m].
    pub scale: f64,
}

/// Potential where one conductor has 1 V, all others and the electrodes 0.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitPotential {
    /// Potential for 1 V, and E [1/m], at the places that were asked for.
    pub at: Vec<FieldAt>,
    /// Charge [C] that the conductors' own potentials and the given field make on this conductor.
    pub of_given: f64,
}

/// A way to compute the field of charges and their images. Potentials and normal fields of the faces and an
/// external field are not its business, except where a method has them in its own boundary conditions.
pub trait FieldMethod: fmt::Debug + Send + Sync {
    /// Computes the levels of the field at every particle at a time [s], positions in m, charges in C. The
    /// time is for a field solver that works beside the motion, and for what it forecasts.
    ///
    /// # Errors
    /// Values that are not finite, grains where the method has no field, a net charge that no face takes.
    fn levels<'a>(
        &'a mut self,
        time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        wanted: Wanted,
    ) -> Result<Levels<'a>, FieldError>;

    /// Computes E [V/m] (and what else is wanted) at every particle of charges that stand still, positions
    /// in m, charges in C.
    ///
    /// # Errors
    /// The errors of [`Self::levels`]; two charges in one place.
    fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        let levels = self.levels(0.0, positions, charges, wanted)?;
        Sum::of_charges(levels, positions).write(wanted, out);
        self.agreed(check_result(&out.e))
    }

    /// Returns an outcome of what follows the levels; where ranks share the field, the first bad one of all
    /// ranks.
    ///
    /// # Errors
    /// The outcome's.
    fn agreed(&self, outcome: Result<(), FieldError>) -> Result<(), FieldError> {
        outcome
    }

    /// Computes E at a sample of the particles twice, by the method's own parameters and by others that err
    /// less on every level, cells of a mesh included; `None` for methods without such cells, and while a
    /// field solver works beside the motion.
    ///
    /// # Errors
    /// The errors of [`Self::levels`].
    fn by_two_splittings(
        &mut self,
        _second: P3mParameters,
        _positions: &[Vector3<f64>],
        _charges: &[f64],
        _sample: &[usize],
    ) -> Result<Option<TwoSplittings>, FieldError> {
        Ok(None)
    }

    /// The field solver of another process that has a part in it, and its state.
    fn far_solver(&self) -> Option<&FarSolver> {
        None
    }

    /// Field solver of another process, to tell it where its next solve starts.
    fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        None
    }

    /// Potential of each conductor with a surface of triangles [V], as the last evaluation left it.
    fn potentials_of_conductors(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Potential of one conductor at 1 V, all others and the electrodes at 0, at places [m], and the charge
    /// that the conductors' potentials of the last evaluation and what was given by
    /// [`Self::give_potentials`] make on it.
    ///
    /// # Errors
    /// The errors of [`Self::levels`], and methods without conductors.
    fn unit_potential(
        &mut self,
        conductor: usize,
        _positions: &[Vector3<f64>],
    ) -> Result<UnitPotential, FieldError> {
        Err(FieldError::Settings(format!("there is no conductor {conductor}")))
    }

    /// Tells surfaces the potential [V] of electrodes and of the external field at any place [m].
    fn give_potentials(&mut self, _given: &dyn Fn(&Vector3<f64>) -> f64) {}

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
