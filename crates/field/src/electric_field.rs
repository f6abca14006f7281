//! The evaluator: one scene's field, with the parameters chosen for it.

use crate::choosing::tuner::Tuner;
use crate::geometry::images::{Geometry, ImageLattice};
use crate::geometry::inputs::{check_charges_in_box, check_finite};
use crate::levels::far::{FarField, FarLevel, FarSolver};
use crate::levels::outside::Outside;
use crate::methods::cutoff::Cutoff;
use crate::methods::direct::Direct;
use crate::methods::kolehmainen::Kolehmainen;
use crate::methods::p3m::{P3m, P3mParameters};
use crate::{FieldError, FieldMethod, FieldValues, Wanted};
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{Domain, FieldSettings, Method, Plan};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Parameters chosen for a scene. Written to the run folder and reused on resume, so that results never
/// depend on a stopwatch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Choice {
    /// The truncated sum.
    Cutoff {
        /// Cut-off radius r_c [m].
        cutoff_m: f64,
    },
    /// The direct sum.
    Direct,
    /// The published hybrid.
    Kolehmainen {
        /// Cut-off radius r_c [m].
        cutoff_m: f64,
    },
    /// p3m in open space with so few grains that every pair is summed: no grid is built.
    AllPairs,
    /// p3m on the internal grid.
    P3m(P3mParameters),
}

/// Error found by comparing with a more exact evaluation on a sample of grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// RMS error of E over the larger of E_rms and q_rms n^{2/3}/(4πε).
    pub relative_rms: f64,
    /// Grains in the sample.
    pub sample: usize,
}

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
    outside: Option<Outside>,
    /// Cells of the field solver's mesh; `None` without one.
    mesh_cells: Option<usize>,
    error_estimated: Option<f64>,
    error_measured: Option<Measured>,
}

impl ElectricField {
    /// Chooses parameters for the given particles (positions in m, charges in C) and builds what they need.
    ///
    /// # Errors
    /// Settings that the method or the boundaries do not allow, a net charge without a field, values that are
    /// not finite, a tolerance that cannot be met.
    pub fn new(
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Self, FieldError> {
        check_finite(positions, charges)?;
        let (mut error_estimated, mut error_measured) = (None, None);
        let choice = match settings.method {
            Method::Cutoff => Choice::Cutoff { cutoff_m: cutoff_radius(settings)? },
            Method::Direct => Choice::Direct,
            Method::Kolehmainen => Choice::Kolehmainen { cutoff_m: cutoff_radius(settings)? },
            Method::P3m => {
                check(domain, settings, positions, charges)?;
                let tuner = Tuner::new(domain, settings, positions, charges);
                if Geometry::of(domain)? == Geometry::Open && tuner.all_pairs_are_cheaper(images(domain)) {
                    Choice::AllPairs
                } else {
                    let chosen = tuner.choose()?;
                    (error_estimated, error_measured) = (chosen.estimated, chosen.measured);
                    Choice::P3m(chosen.parameters)
                }
            }
            method => {
                return Err(FieldError::Settings(format!("method {method} is newer than this field crate")));
            }
        };
        let field = Self::with_choice(domain, settings, &choice)?;
        Ok(Self { error_estimated, error_measured, ..field })
    }

    /// The field over somebody else's mesh, whose boundary conditions take the place of a domain's: p3m with three levels.
    ///
    /// # Errors
    /// As [`Self::new`]; a method that has no far level.
    pub fn over_mesh(
        solver: Box<dyn FarField>,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Self, FieldError> {
        check_finite(positions, charges)?;
        if settings.method == Method::Kolehmainen {
            let choice = Choice::Kolehmainen { cutoff_m: cutoff_radius(settings)? };
            return Self::over_mesh_with_choice(solver, settings, &choice);
        }
        let far = far_level(solver, settings);
        // Near level and middle grid are those of a periodic box as large as the middle grid's; no face of it takes charge.
        let domain = far.domain_of_grid();
        let alone = FieldSettings { neutralising_background: true, ..settings.clone() };
        let wrapped: Vec<_> = positions.iter().map(|position| far.mesh().domain().wrap(*position)).collect();
        // Beyond the far level's clouds there is nothing for pairs to do.
        let longest = far.cloud_as_returned().radius;
        if let Some(cutoff) = settings.cutoff_radius_m.filter(|cutoff| *cutoff > longest) {
            return Err(FieldError::Settings(format!(
                "field_cutoff_radius {cutoff:e} m is larger than the {longest:e} m from which on the field solver's mesh takes over; make it smaller or leave it out"
            )));
        }
        let chosen = Tuner::new(&domain, &alone, &wrapped, charges).up_to(longest).choose()?;
        let field = Self::over_far(far, settings, chosen.parameters)?;
        Ok(Self { error_estimated: chosen.estimated, error_measured: chosen.measured, ..field })
    }

    /// As [`Self::over_mesh`], with parameters chosen earlier.
    ///
    /// # Errors
    /// A choice that is none of p3m's.
    pub fn over_mesh_with_choice(
        solver: Box<dyn FarField>,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        match choice {
            Choice::P3m(parameters) => Self::over_far(far_level(solver, settings), settings, *parameters),
            Choice::Kolehmainen { cutoff_m } => {
                let (permittivity, background) =
                    (settings.relative_permittivity, settings.neutralising_background);
                let (domain, cells) = (solver.mesh().domain().clone(), solver.mesh().cell_count());
                Ok(Self {
                    outside: Outside::new(&domain, settings)?,
                    domain,
                    mesh_cells: Some(cells),
                    settings: settings.clone(),
                    choice: choice.clone(),
                    method: Box::new(Kolehmainen::over(solver, permittivity, background, *cutoff_m)?),
                    error_estimated: None,
                    error_measured: None,
                })
            }
            choice => Err(FieldError::Settings(format!(
                "a field solver's mesh cannot have the parameters {choice:?}; choose method p3m or kolehmainen"
            ))),
        }
    }

    fn over_far(
        far: FarLevel,
        settings: &FieldSettings,
        parameters: P3mParameters,
    ) -> Result<Self, FieldError> {
        if settings.method != Method::P3m {
            return Err(FieldError::Settings(format!(
                "method {} has no far level on a solver's mesh; choose method p3m or kolehmainen",
                settings.method
            )));
        }
        // What is measured later is measured as it was tuned.
        let domain = far.domain_of_grid();
        let alone = FieldSettings { neutralising_background: true, ..settings.clone() };
        Ok(Self {
            outside: Outside::new(far.mesh().domain(), settings)?,
            domain,
            mesh_cells: Some(far.mesh().cell_count()),
            settings: alone,
            choice: Choice::P3m(parameters),
            method: Box::new(P3m::over(far, settings, parameters)),
            error_estimated: None,
            error_measured: None,
        })
    }

    /// Builds a field with parameters chosen earlier.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_choice(
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        let permittivity = settings.relative_permittivity;
        let background = settings.neutralising_background;
        let method: Box<dyn FieldMethod> = match choice {
            Choice::Cutoff { cutoff_m } => Box::new(Cutoff::new(domain, permittivity, *cutoff_m)?),
            Choice::Direct | Choice::AllPairs => Box::new(Direct::new(domain, permittivity, background)?),
            Choice::Kolehmainen { cutoff_m } => {
                let cells = settings.grid_cells;
                Box::new(Kolehmainen::new(domain, permittivity, background, *cutoff_m, cells)?)
            }
            Choice::P3m(parameters) => {
                Geometry::of(domain)?;
                Box::new(P3m::new(domain, settings, *parameters))
            }
        };
        Ok(Self {
            domain: domain.clone(),
            settings: settings.clone(),
            choice: choice.clone(),
            method,
            outside: Outside::new(domain, settings)?,
            mesh_cells: None,
            error_estimated: None,
            error_measured: None,
        })
    }

    /// E (and what else is wanted) at every particle, positions in m, charges in C:
    ///
    /// E = near + middle + far + correction (the charges with their images) + boundary (potentials and normal
    /// fields of the faces) + external.
    ///
    /// Allocates nothing once `out` has its size and the number of particles stays.
    ///
    /// # Errors
    /// Values that are not finite; a net charge that no longer vanishes where it must; grains outside the box.
    pub fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        self.method.evaluate(positions, charges, wanted, out)?;
        if let Some(outside) = &mut self.outside {
            for (particle, (e, potential)) in outside.evaluate(positions).iter().enumerate() {
                out.e[particle] += e;
                if wanted.potential {
                    out.potential[particle] += potential;
                }
                if wanted.components {
                    out.components.far[particle] += e;
                }
            }
        }
        Ok(())
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
        let Choice::P3m(parameters) = self.choice else { return Ok(None) };
        check(&self.domain, &self.settings, positions, charges)?;
        if charges.iter().all(|charge| *charge == 0.0) {
            return Ok(None);
        }
        let tuner = Tuner::new(&self.domain, &self.settings, positions, charges);
        self.error_measured = Some(tuner.measure(parameters, tuner.scale()?));
        Ok(self.error_measured)
    }

    /// The field solver of another process that has a part in it, and its state.
    #[must_use]
    pub fn far_solver(&self) -> Option<&FarSolver> {
        self.method.far_solver()
    }

    /// The same, to tell it where and when its next solve is.
    pub fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        self.method.far_solver_mut()
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
            seconds: self.method.seconds().to_vec(),
        }
    }

    /// Memory held [bytes].
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.method.memory_bytes()
    }

    /// Which field stages are built and which are not, with reasons.
    #[must_use]
    pub fn plan(&self) -> Plan {
        crate::plan::plan(&self.domain, &self.settings, &self.choice, self.mesh_cells)
    }
}

fn far_level(solver: Box<dyn FarField>, settings: &FieldSettings) -> FarLevel {
    let permittivity = VACUUM_PERMITTIVITY * settings.relative_permittivity;
    FarLevel::new(solver, permittivity, settings)
}

/// As p3m checks at every evaluation, before anything is tuned.
pub(crate) fn check(
    domain: &Domain,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<(), FieldError> {
    let permittivity = VACUUM_PERMITTIVITY * settings.relative_permittivity;
    check_charges_in_box(domain, permittivity, settings.neutralising_background, positions, charges)
}

/// The cut-off radius of a method that cannot do without.
fn cutoff_radius(settings: &FieldSettings) -> Result<f64, FieldError> {
    settings.cutoff_radius_m.ok_or_else(|| {
        FieldError::Settings(format!(
            "method {} needs electric_field.field_cutoff_radius [m]; give one",
            settings.method
        ))
    })
}

/// Images per charge in a box without closed axes.
pub(crate) fn images(domain: &Domain) -> usize {
    ImageLattice::new(domain).axes.iter().map(|axis| axis.images.len()).product()
}
