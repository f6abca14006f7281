//! The evaluator: one scene's field, with the parameters chosen for it.

mod before_surfaces;
mod building;
mod changing;
mod of_conductors;

use crate::choosing::choice::{Choice, Measured};
use crate::choosing::over_mesh;
use crate::choosing::over_ranks::OverRanks;
use crate::choosing::trials::OneProcess;
use crate::choosing::tuner::Tuner;
use crate::error::FieldError;
use crate::geometry::inputs::{check_result, check_scene};
use crate::levels::external::ExternalField;
use crate::levels::faces::FacesLevel;
use crate::levels::far::FarSolver;
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::plan;
use crate::ranks::Ranks;
use crate::sum::{Part, Sum};
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Domain, FieldSettings, Plan};
use nalgebra::Vector3;
use std::sync::Arc;

pub use changing::GivenField;
pub use of_conductors::ConductorValues;

/// Cost of the last evaluation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Mean number of partners within the cut-off per particle (images included, full list).
    pub pairs_per_particle: f64,
    /// Nodes of the internal grid per axis; `None` when no grid was built.
    pub grid_cells: Option<[usize; 3]>,
    /// Stage name and seconds, in the order in which they ran.
    pub seconds: Vec<(&'static str, f64)>,
}

/// The field of one scene.
#[derive(Debug)]
pub struct ElectricField {
    domain: Domain,
    settings: FieldSettings,
    choice: Choice,
    method: Box<dyn FieldMethod>,
    faces: FacesLevel,
    external: ExternalField,
    stopwatch: Stopwatch,
    /// Cells of the field solver's mesh; `None` without one.
    mesh_cells: Option<usize>,
    /// Ranks that share the field; `None` where this process has all particles.
    ranks: Option<Arc<dyn Ranks>>,
    error_estimated: Option<f64>,
    error_measured: Option<Measured>,
}

impl ElectricField {
    /// E (and what else is wanted) at every particle, positions in m, charges in C:
    ///
    /// E = near + middle + far + correction + faces + external
    ///
    /// Near, middle, far and correction come from the charges and their images, faces from potentials and
    /// normal fields that are given on faces. Those that change with time are those of the time that was set
    /// by [`Self::set_time`], and of t = 0 before.
    ///
    /// Allocates nothing once `out` has its size and the number of particles stays, but before conductors.
    ///
    /// # Errors
    /// Values that are not finite; a net charge that no longer vanishes where it must; grains outside the
    /// box.
    pub fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        self.evaluate_at(0.0, positions, charges, wanted, out)
    }

    /// Computes E as [`Self::evaluate`] does, at a time [s]. The time is for a field solver of another
    /// process, which works beside the motion and has to know of when the charges are. Potentials that
    /// change follow [`Self::set_time`].
    ///
    /// # Errors
    /// The errors of [`Self::evaluate`].
    pub fn evaluate_at(
        &mut self,
        time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        self.give_potentials();
        let levels = self.method.levels(time_s, positions, charges, wanted)?;
        self.stopwatch.restart();
        let faces = Part::new(self.faces.evaluate(positions));
        self.stopwatch.lap("faces");
        Sum { levels, faces, external: self.external, positions }.write(wanted, out);
        self.stopwatch.lap("sum");
        self.method.agreed(check_result(&out.e))
    }

    /// Tells the method the potential of electrodes and of the external field.
    fn give_potentials(&mut self) {
        let given = |place: &Vector3<f64>| (self.external.at(place) + self.faces.at(place)).potential;
        self.method.give_potentials(&given);
    }

    /// Measures the error of E on a sample by a second, more exact splitting; `None` for methods that make no
    /// promise (`cutoff`, `kolehmainen`) and for sums that are exact.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn measure_error(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Option<Measured>, FieldError> {
        if !self.settings.conductors.is_empty() {
            return self.measure_before_surfaces(positions, charges);
        }
        let Choice::P3m(parameters) = self.choice else { return Ok(None) };
        if self.mesh_cells.is_some() {
            let measured = over_mesh::measure(self.method.as_mut(), parameters, positions, charges)?;
            let measured = measured.map(|error| error.relative(positions.len()));
            self.error_measured = measured.or(self.error_measured);
            return Ok(measured);
        }
        let (domain, settings) = (&self.domain, &self.settings);
        let measured = if let Some(ranks) = &self.ranks {
            let grains = OverRanks { ranks, domain, settings, positions, charges };
            Tuner::new(domain, settings, grains.statistics()?, &grains).measured(parameters)?
        } else {
            check_scene(domain, settings, positions, charges)?;
            let grains = OneProcess { domain, settings, positions, charges };
            Tuner::new(domain, settings, grains.statistics(), &grains).measured(parameters)?
        };
        self.error_measured = measured.or(self.error_measured);
        Ok(measured)
    }

    /// E that is there without charges, external and from the faces' values, at a place of the domain [V/m]
    /// and the time that was set.
    ///
    /// A field solver and `kolehmainen` have the faces' values on cells: there it is the external field.
    #[must_use]
    pub fn without_charges(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let given = self.given(place);
        given.external.e + given.faces.e
    }

    /// Field that is there without charges, by its sources, as [`Self::without_charges`] has it.
    #[must_use]
    pub fn given(&self, place: &Vector3<f64>) -> GivenField {
        GivenField { external: self.external.at(place), faces: self.faces.at(place) }
    }

    /// The field solver of another process that has a part in it, and its state.
    #[must_use]
    pub fn far_solver(&self) -> Option<&FarSolver> {
        self.method.far_solver()
    }

    /// Field solver of another process, to tell it where its next solve starts.
    pub fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        self.method.far_solver_mut()
    }

    /// Potential of each of the settings' conductors [V], as the last evaluation left it; empty without any.
    #[must_use]
    pub fn potentials_of_conductors(&self) -> Vec<f64> {
        self.method.potentials_of_conductors()
    }

    /// Parameters in force.
    #[must_use]
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// A-priori estimate of the relative RMS error; `None` for methods that make no promise.
    #[must_use]
    pub fn error_estimated(&self) -> Option<f64> {
        self.error_estimated
    }

    /// Error measured last, when parameters were chosen or by [`Self::measure_error`].
    #[must_use]
    pub fn error_measured(&self) -> Option<Measured> {
        self.error_measured
    }

    /// Cost of the last evaluation.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics {
            pairs_per_particle: self.method.pairs_per_particle(),
            grid_cells: self.method.grid_cells(),
            seconds: [self.method.seconds(), self.stopwatch.laps()].concat(),
        }
    }

    /// Memory held [bytes].
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.method.memory_bytes()
    }

    /// Lists the field stages that are built and those that are left out, with reasons.
    #[must_use]
    pub fn plan(&self) -> Plan {
        let over_mesh = self.method.far_solver().is_some_and(FarSolver::changes);
        let potentials = match (self.faces.changing_uniform(), self.faces.changing_otherwise()) {
            _ if over_mesh => plan::Potentials::OfPatches,
            (Some(_), _) => plan::Potentials::Uniform,
            (None, Some(_)) => plan::Potentials::Varied,
            (None, None) => plan::Potentials::Stay,
        };
        plan::plan(&self.domain, &self.settings, &self.choice, self.mesh_cells, potentials)
    }
}
