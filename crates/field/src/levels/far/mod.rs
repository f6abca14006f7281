//! The far level: a smooth field that a field solver computes, on cells of any shape with boundary
//! conditions of its own.
//!
//! Another process with OpenFOAM does, or a solver in this one: whoever implements [`FarField`].

mod boundary;
mod box_mesh;
mod connected;
mod density;
mod end_of_mesh;
mod level;
mod local_fit;
mod mesh;
mod potentials;
mod radii;
mod reach;
mod reentrant;
mod search;
mod solver;
mod tree;

pub use crate::levels::walls::{BoundaryFace, Condition};
pub use boundary::MeshPatch;
pub(crate) use connected::check_net_charge;
pub use density::SmoothDensity;
pub(crate) use level::{FarLevel, Medium};
pub use mesh::{CellFace, FarMesh, FarMeshParts, Neighbour};
pub use potentials::Look;
pub use radii::FarRadii;
pub use reach::CloudReach;
pub use solver::{FarSolver, FarState};

use crate::error::FieldError;
use amberfield_core::FarQuestion;
use nalgebra::Vector3;
use std::fmt;
use std::sync::Arc;

/// Question for the far part of a field: scalars, and the arrays beside them.
#[derive(Clone, Copy, Debug)]
pub struct FarRequest<'a> {
    /// Scalars: clouds, permittivity, background, time, tolerance.
    pub question: FarQuestion,
    /// Positions of the charges inside the mesh [m].
    pub positions: &'a [Vector3<f64>],
    /// Charges inside the mesh [C].
    pub charges: &'a [f64],
    /// Positions of image charges outside the mesh [m].
    pub image_positions: &'a [Vector3<f64>],
    /// Image charges [C]; their clouds may reach inside.
    pub image_charges: &'a [f64],
    /// Density of the source by cell, besides the clouds of the charges above [C/m³]; empty: none.
    pub density: &'a [f64],
    /// Values by boundary face: φ [V] where the potential is prescribed, ∂φ/∂n outwards [V/m] where the
    /// normal field is.
    pub boundary: &'a [f64],
    /// φ at the cells' centres to start from [V], so that a run that is resumed goes on bit for bit; empty:
    /// the solver starts where it is.
    pub guess: &'a [f64],
}

/// Answer with the far part of a field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FarValues {
    /// φ at the cells' centres [V].
    pub potential: Vec<f64>,
    /// E = −∇φ at the cells' centres [V/m], by the solver's own gradient; empty where it was not wanted.
    pub e: Vec<Vector3<f64>>,
    /// Cell of every charge inside the mesh.
    pub cells: Vec<u32>,
    /// Charges that lay outside the mesh and were given to the nearest cell.
    pub outside: u64,
    /// Iterations of the linear solver.
    pub iterations: u64,
    /// Final residual of the linear solver, relative.
    pub residual: f64,
    /// Time that the linear solver took, without the mapping of charges and the way there and back [s].
    pub seconds: f64,
}

/// Way in which a far level is reached when a field is built, and again after it was lost.
#[derive(Clone)]
pub struct Connect(Arc<dyn Fn() -> Result<Box<dyn FarField>, FieldError> + Send + Sync>);

impl Connect {
    /// Makes a way that calls `connect`.
    #[must_use]
    pub fn new(connect: impl Fn() -> Result<Box<dyn FarField>, FieldError> + Send + Sync + 'static) -> Self {
        Self(Arc::new(connect))
    }

    /// Reaches it.
    ///
    /// # Errors
    /// Nobody there.
    pub fn connect(&self) -> Result<Box<dyn FarField>, FieldError> {
        (self.0)()
    }
}

impl fmt::Debug for Connect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Connect")
    }
}

/// A field solver: it computes the far level's potential.
pub trait FarField: fmt::Debug + Send + Sync {
    /// The cells.
    fn mesh(&self) -> &FarMesh;

    /// Solves for φ.
    ///
    /// # Errors
    /// A peer that is lost, a request that does not fit the mesh, an answer that makes no sense.
    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError>;

    /// Gives the potentials [V] of the patches that change, at some times [s]: patch by patch in the order of
    /// [`FarMesh::changing`], all times of each. One that is not known, because a table ends, is no number.
    ///
    /// # Errors
    /// A peer that is lost.
    fn potentials(&mut self, _times_s: &[f64], values: &mut Vec<f64>) -> Result<(), FieldError> {
        values.clear();
        Ok(())
    }

    /// Asks without waiting for the answer, which [`Self::take`] gives.
    ///
    /// # Errors
    /// As [`Self::solve`]; whoever works in this process cannot work beside it.
    fn ask(&mut self, _request: &FarRequest<'_>) -> Result<(), FieldError> {
        Err(FieldError::Settings(
            "electric_field.overlap needs a field solver that is not waited for when it is lost; set it to \
             false, or solver.on_solver_loss to \"stop\""
                .into(),
        ))
    }

    /// Waits for the answer to what was asked last.
    ///
    /// # Errors
    /// As [`Self::solve`].
    fn take(&mut self, _values: &mut FarValues) -> Result<(), FieldError> {
        Err(FieldError::Settings("nothing was asked".into()))
    }
}
