//! The way from settings and particles to a field: parameters are chosen, and what they need is built.

use super::{ElectricField, changing};
use crate::choosing::candidates::Candidate;
use crate::choosing::choice::Choice;
use crate::choosing::over_mesh::{self, OverMesh};
use crate::choosing::over_ranks::OverRanks;
use crate::choosing::trials::OneProcess;
use crate::choosing::tuner::Tuner;
use crate::error::FieldError;
use crate::geometry::images::{Geometry, images_per_charge};
use crate::geometry::inputs::{check_finite, check_in_box, check_scene};
use crate::levels::external::ExternalField;
use crate::levels::faces::FacesLevel;
use crate::levels::far::{FarField, FarLevel};
use crate::methods::cutoff::Cutoff;
use crate::methods::direct::Direct;
use crate::methods::kolehmainen::Kolehmainen;
use crate::methods::method::FieldMethod;
use crate::methods::p3m::P3m;
use crate::methods::p3m_over_ranks::P3mOverRanks;
use crate::methods::p3m_parameters::P3mParameters;
use crate::numerics::stopwatch::Stopwatch;
use crate::ranks::Ranks;
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Domain, FieldSettings, Method, Tuning};
use nalgebra::Vector3;
use std::sync::Arc;
use std::time::Instant;

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
        changing::check(domain, settings)?;
        if !settings.conductors.is_empty() {
            return Self::before_surfaces(domain, settings, positions, charges);
        }
        let (mut error_estimated, mut error_measured) = (None, None);
        let choice = match settings.method {
            Method::Cutoff => Choice::Cutoff { cutoff_m: cutoff_radius(settings)? },
            Method::Direct => Choice::Direct,
            Method::Kolehmainen => Choice::Kolehmainen { cutoff_m: cutoff_radius(settings)? },
            Method::P3m => {
                check_scene(domain, settings, positions, charges)?;
                let grains = OneProcess { domain, settings, positions, charges };
                let tuner = Tuner::new(domain, settings, grains.statistics(), &grains);
                if Geometry::of(domain) == Geometry::Open
                    && tuner.all_pairs_are_cheaper(images_per_charge(domain))
                {
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

    /// Chooses parameters for the particles of all ranks and builds what this one needs; each has its own
    /// particles (positions in m, charges in C), and every rank calls the same functions in the same order.
    /// Method p3m on the internal grid, parameters by the cost model.
    ///
    /// The field is that of one process with all particles, to round-off: numbers are added in another order.
    ///
    /// # Errors
    /// The errors of [`Self::new`], on all ranks where one has them.
    pub fn over_ranks(
        ranks: Arc<dyn Ranks>,
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Self, FieldError> {
        ranks.agreed(check_over_ranks(domain, settings, positions, charges))?;
        let settings = &FieldSettings { tuning: Tuning::Model, ..settings.clone() };
        let grains = OverRanks { ranks: &ranks, domain, settings, positions, charges };
        let chosen = Tuner::new(domain, settings, grains.statistics()?, &grains).choose()?;
        let field = Self::over_ranks_with_choice(ranks, domain, settings, &Choice::P3m(chosen.parameters))?;
        Ok(Self { error_estimated: chosen.estimated, error_measured: chosen.measured, ..field })
    }

    /// Builds a field as [`Self::over_ranks`] does, with parameters chosen earlier.
    ///
    /// # Errors
    /// A choice that is none of p3m's.
    pub fn over_ranks_with_choice(
        ranks: Arc<dyn Ranks>,
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        let Choice::P3m(parameters) = choice else {
            return Err(FieldError::Settings(format!(
                "ranks cannot share a field with the parameters {choice:?}; choose method p3m"
            )));
        };
        changing::check(domain, settings)?;
        let method = Box::new(P3mOverRanks::new(&ranks, domain, settings, *parameters));
        let field = Self::with_method(domain, settings, choice, method)?;
        Ok(Self { ranks: Some(ranks), ..field })
    }

    /// Makes the field over a field solver's mesh, whose boundary conditions take the place of a domain's:
    /// p3m with three levels.
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
        check_no_conductors(settings, "over a field solver's mesh, whose patches do")?;
        if settings.method == Method::Kolehmainen {
            let choice = Choice::Kolehmainen { cutoff_m: cutoff_radius(settings)? };
            return Self::over_mesh_with_choice(solver, settings, &choice);
        }
        check_method_over_mesh(settings)?;
        let OverMesh { p3m, parameters, estimated, measured } =
            over_mesh::choose(solver, settings, positions, charges)?;
        let field = Self::of_p3m_over_mesh(p3m, settings, parameters)?;
        Ok(Self { error_estimated: estimated, error_measured: measured, ..field })
    }

    /// Builds a field as [`Self::over_mesh`] does, with parameters chosen earlier.
    ///
    /// # Errors
    /// A choice that is none of p3m's.
    pub fn over_mesh_with_choice(
        solver: Box<dyn FarField>,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        match choice {
            Choice::P3m(parameters) => {
                check_method_over_mesh(settings)?;
                let mut far = FarLevel::new(solver, settings);
                if let Some(radii) = parameters.far {
                    far.set_radii(radii);
                }
                Self::of_p3m_over_mesh(P3m::over(far, *parameters), settings, *parameters)
            }
            Choice::Kolehmainen { cutoff_m } => {
                let (permittivity, background) = (settings.permittivity, settings.neutralising_background);
                let (domain, cells) = (solver.mesh().domain().clone(), solver.mesh().cell_count());
                let method = Box::new(Kolehmainen::over(solver, permittivity, background, *cutoff_m)?);
                let field = Self::with_method(&domain, settings, choice, method)?;
                Ok(Self { mesh_cells: Some(cells), ..field })
            }
            choice => Err(FieldError::Settings(format!(
                "a field solver's mesh cannot have the parameters {choice:?}; choose method p3m or \
                 kolehmainen"
            ))),
        }
    }

    fn of_p3m_over_mesh(
        p3m: P3m,
        settings: &FieldSettings,
        parameters: P3mParameters,
    ) -> Result<Self, FieldError> {
        let mesh = p3m.mesh().expect("it is over a mesh");
        let (domain, cells) = (mesh.domain().clone(), mesh.cell_count());
        let field = Self::with_method(&domain, settings, &Choice::P3m(parameters), Box::new(p3m))?;
        Ok(Self { mesh_cells: Some(cells), ..field })
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
        changing::check(domain, settings)?;
        if !settings.conductors.is_empty() {
            return Self::before_surfaces_with_choice(domain, settings, choice);
        }
        let permittivity = settings.permittivity;
        let background = settings.neutralising_background;
        let method: Box<dyn FieldMethod> = match choice {
            Choice::Cutoff { cutoff_m } => Box::new(Cutoff::new(domain, permittivity, *cutoff_m)?),
            Choice::Direct | Choice::AllPairs => Box::new(Direct::new(domain, permittivity, background)),
            Choice::Kolehmainen { cutoff_m } => {
                let cells = settings.grid_cells;
                Box::new(Kolehmainen::new(domain, permittivity, background, *cutoff_m, cells)?)
            }
            Choice::P3m(parameters) => Box::new(P3m::new(domain, settings, *parameters)),
        };
        Self::with_method(domain, settings, choice, method)
    }

    /// The field of a method for one process without a mesh, whose error is not known.
    pub(super) fn with_method(
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
        method: Box<dyn FieldMethod>,
    ) -> Result<Self, FieldError> {
        Ok(Self {
            domain: domain.clone(),
            settings: settings.clone(),
            choice: choice.clone(),
            method,
            faces: FacesLevel::new(domain, settings)?,
            external: ExternalField::new(domain, settings),
            stopwatch: Stopwatch::default(),
            mesh_cells: None,
            ranks: None,
            error_estimated: None,
            error_measured: None,
        })
    }

    /// Lists what p3m can choose from for the given particles (positions in m, charges in C): the best of
    /// each window's order by the cost model, cheapest first, and the sum over all pairs where few charges
    /// in open space make that worth a look; each with its errors and its time.
    ///
    /// # Errors
    /// As [`Self::new`]; a method without parameters to choose.
    pub fn candidates(
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Vec<Candidate>, FieldError> {
        check_finite(positions, charges)?;
        if settings.method != Method::P3m {
            return Err(FieldError::Settings(format!(
                "method {} has no parameters to choose; set electric_field.method = \"p3m\"",
                settings.method
            )));
        }
        check_no_conductors(settings, "whose parameters are compared")?;
        check_scene(domain, settings, positions, charges)?;
        let grains = OneProcess { domain, settings, positions, charges };
        let tuner = Tuner::new(domain, settings, grains.statistics(), &grains);
        let open = Geometry::of(domain) == Geometry::Open;
        let mut candidates = tuner.table()?;
        if open && tuner.all_pairs_are_cheaper(images_per_charge(domain)) {
            let (choice, mut values) = (Choice::AllPairs, FieldValues::default());
            let mut field = Self::with_choice(domain, settings, &choice)?;
            let start = Instant::now();
            field.evaluate(positions, charges, Wanted::default(), &mut values)?;
            let seconds = start.elapsed().as_secs_f64();
            candidates.push(Candidate { choice, estimated: None, measured: None, seconds });
        }
        Ok(candidates)
    }
}

/// Refuses what ranks cannot share, on one of them.
fn check_over_ranks(
    domain: &Domain,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<(), FieldError> {
    check_finite(positions, charges)?;
    check_in_box(domain, positions)?;
    check_no_conductors(settings, "that ranks share")?;
    if settings.method == Method::P3m {
        return Ok(());
    }
    Err(FieldError::Settings(format!(
        "method {} cannot be shared by ranks; choose method p3m",
        settings.method
    )))
}

/// Refuses conductors where nothing takes them into account.
fn check_no_conductors(settings: &FieldSettings, with: &str) -> Result<(), FieldError> {
    match settings.conductors.first() {
        None => Ok(()),
        Some(conductor) => Err(FieldError::Settings(format!(
            "conductor {} cannot bound a field {with}; let its wall have field = \"none\"",
            conductor.name
        ))),
    }
}

/// Refuses methods that have no far level.
fn check_method_over_mesh(settings: &FieldSettings) -> Result<(), FieldError> {
    if settings.method == Method::P3m {
        return Ok(());
    }
    Err(FieldError::Settings(format!(
        "method {} has no far level on a solver's mesh; choose method p3m or kolehmainen",
        settings.method
    )))
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
