//! Particle–particle particle–mesh with smooth splitting:
//!
//! 1/r = [1 − Φ(r/r_c)]/r + Φ(r/r_c)/r — pairs within r_c, and the internal grid with the box's faces; or,
//! over a field solver's mesh,
//!
//! 1/r = [1 − Φ(r/r_c)]/r + [Φ(r/r_c) − Φ(r/R)]/r + Φ(r/R)/r — pairs, a middle grid without faces, and the
//! far level's cells, to which R is matched.
//!
//! Φ is the Kaiser–Bessel cloud's of `amberfield_laws::kaiser_bessel_cloud`: nothing is left of the pairs
//! beyond r_c and of the middle grid beyond R.

use crate::error::FieldError;
use crate::geometry::inputs::{check_charges_in_box, check_finite};
use crate::levels::far::{FarLevel, FarMesh, FarSolver, Medium};
use crate::levels::grid::level::GridLevel;
use crate::levels::near::NearLevel;
use crate::methods::method::{FieldMethod, TwoSplittings};
use crate::methods::p3m_parameters::P3mParameters;
use crate::numerics::stopwatch::Stopwatch;
use crate::sum::{Levels, OwnClouds, Part, Sum};
use crate::values::{FieldAt, FieldValues, Wanted};
use amberfield_core::{Domain, FieldSettings, Permittivity};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// The levels and their buffers.
#[derive(Debug)]
pub(crate) struct P3m {
    domain: Domain,
    parameters: P3mParameters,
    permittivity: Permittivity,
    neutralising_background: bool,
    near: NearLevel,
    grid: GridLevel,
    far: Option<FarLevel>,
    /// The grains; with a far level then places at its walls without charge, then images.
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    /// Field of each level, at the grains and the places at the walls.
    near_field: Vec<FieldAt>,
    grid_field: Vec<FieldAt>,
    far_field: Vec<FieldAt>,
    stopwatch: Stopwatch,
}

impl P3m {
    pub(crate) fn new(domain: &Domain, settings: &FieldSettings, parameters: P3mParameters) -> Self {
        let near = NearLevel::new(domain, parameters.near());
        let grid = GridLevel::new(domain, parameters.grid());
        Self::with_levels(domain, Medium::of(settings), parameters, near, grid)
    }

    /// Makes p3m of three levels, the last one a field solver's.
    pub(crate) fn over(far: FarLevel, parameters: P3mParameters) -> Self {
        let near = NearLevel::new(&far.domain_of_pairs(), parameters.near());
        let wider = far.cloud_as_returned();
        let grid = GridLevel::between(&far.domain_of_grid(), parameters.grid(), wider);
        let domain = far.mesh().domain().clone();
        let medium = far.medium();
        Self { far: Some(far), ..Self::with_levels(&domain, medium, parameters, near, grid) }
    }

    /// Cells of a far level.
    pub(crate) fn mesh(&self) -> Option<&FarMesh> {
        self.far.as_ref().map(FarLevel::mesh)
    }

    /// The far level, for other parameters of the rest.
    pub(crate) fn into_far(self) -> Option<FarLevel> {
        self.far
    }

    fn with_levels(
        domain: &Domain,
        medium: Medium,
        parameters: P3mParameters,
        near: NearLevel,
        grid: GridLevel,
    ) -> Self {
        Self {
            domain: domain.clone(),
            parameters,
            permittivity: medium.permittivity,
            neutralising_background: medium.neutralising_background,
            near,
            grid,
            far: None,
            positions: Vec::new(),
            charges: Vec::new(),
            near_field: Vec::new(),
            grid_field: Vec::new(),
            far_field: Vec::new(),
            stopwatch: Stopwatch::default(),
        }
    }

    /// E of the charges alone at a sample of the particles.
    pub(crate) fn sample(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        sample: &[usize],
    ) -> Vec<Vector3<f64>> {
        self.load(positions, charges);
        self.near.sort(&self.positions, &self.charges, positions.len());
        self.grid.solve(&self.positions, &self.charges);
        let places: Vec<_> = sample.iter().map(|&particle| self.positions[particle]).collect();
        let mut far = vec![FieldAt::default(); sample.len()];
        self.grid.gather(&places, &mut far);
        e_of_charges(self.permittivity, &self.near.at(sample), &far, &places)
    }

    /// Takes the grains, and what a far level adds to them; how many places the field is asked for at.
    fn load(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> usize {
        self.positions.clear();
        self.positions.extend(positions.iter().map(|&position| self.domain.wrap(position)));
        self.charges.clear();
        self.charges.extend(charges);
        let targets = match &mut self.far {
            Some(far) => far.extend(&mut self.positions, &mut self.charges),
            None => positions.len(),
        };
        for (field, length) in [
            (&mut self.near_field, targets),
            (&mut self.grid_field, targets),
            (&mut self.far_field, if self.far.is_some() { positions.len() } else { 0 }),
        ] {
            field.clear();
            field.resize(length, FieldAt::default());
        }
        targets
    }
}

/// E of the charges alone [V/m] at places [m], from the near level and the grid there.
pub(crate) fn e_of_charges(
    permittivity: Permittivity,
    near: &[FieldAt],
    far: &[FieldAt],
    places: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let levels = Levels {
        coulomb: permittivity.coulomb(),
        near: Part::new(near),
        far_of_charges: Part::new(far),
        ..Levels::default()
    };
    let sum = Sum::of_charges(levels, places);
    (0..places.len()).map(|number| sum.at(number).e).collect()
}

/// Mean potential over Coulomb's constant [C/m] of the pairs of a net charge [C], in a box without conductor,
/// where the mean must vanish; zero in others.
pub(crate) fn background_potential(domain: &Domain, cloud: Cloud, net: f64) -> f64 {
    if domain.needs_neutrality() { 2.0 * PI * cloud.mean_square() * net / domain.volume() } else { 0.0 }
}

impl FieldMethod for P3m {
    fn levels<'a>(
        &'a mut self,
        time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        wanted: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        let permittivity = self.permittivity;
        let background = self.neutralising_background;
        match &self.far {
            None => check_charges_in_box(&self.domain, permittivity, background, positions, charges)?,
            Some(_) => check_finite(positions, charges)?,
        }
        self.stopwatch.restart();
        let targets = self.load(positions, charges);
        if let Some(far) = &mut self.far {
            far.locate(&self.positions[..positions.len()])?;
            far.check_net_charge(charges)?;
        }
        self.near.sort(&self.positions, &self.charges, targets);
        self.stopwatch.lap("sort");
        let potential = wanted.potential || self.far.is_some();
        self.near.add_all(potential, &mut self.near_field);
        if let Some(far) = &self.far {
            far.add_ghosts(&self.positions[..positions.len()], &mut self.near_field);
        }
        self.stopwatch.lap("near");
        self.grid.solve(&self.positions, &self.charges);
        self.stopwatch.lap("grid");
        self.grid.gather(&self.positions[..targets], &mut self.grid_field);
        self.stopwatch.lap("gather");

        let count = positions.len();
        if let Some(far) = &mut self.far {
            let coulomb = self.permittivity.coulomb();
            let at_walls = self.near_field[count..].iter().zip(&self.grid_field[count..]);
            let short = at_walls.map(|(near, middle)| coulomb * (*near + *middle));
            far.solve(time_s, &self.positions[..count], charges, short)?;
            self.stopwatch.lap("far");
            far.gather(&self.positions[..count], &mut self.far_field);
            self.stopwatch.lap("far gather");
        }
        let grid = Part::new(&self.grid_field);
        let (middle, far_of_charges) = match self.far {
            Some(_) => (grid, Part::default()),
            None => (Part::default(), grid),
        };
        Ok(Levels {
            coulomb: self.permittivity.coulomb(),
            near: Part::new(&self.near_field),
            middle,
            far_of_charges,
            far_of_cells: Part::new(&self.far_field),
            own_clouds: OwnClouds { charges, at_centre: self.parameters.cloud().potential(0.0) },
            background: background_potential(&self.domain, self.parameters.cloud(), charges.iter().sum()),
            ..Levels::default()
        })
    }

    fn by_two_splittings(
        &mut self,
        second: P3mParameters,
        positions: &[Vector3<f64>],
        charges: &[f64],
        sample: &[usize],
    ) -> Result<Option<TwoSplittings>, FieldError> {
        let Some(far) = self.far.as_ref().filter(|far| !far.solver().is_at_work()) else { return Ok(None) };
        let state = far.solver().state();
        let mut field = FieldValues::default();
        let pick = |e: &[Vector3<f64>]| sample.iter().map(|&particle| e[particle]).collect::<Vec<_>>();
        self.evaluate(positions, charges, Wanted::default(), &mut field)?;
        let squares: f64 = field.e.iter().map(Vector3::norm_squared).sum();
        let first = pick(&field.e);
        let jumps = self.far.as_ref().map_or_else(Vec::new, |far| far.jumps(&self.positions, sample));

        let mut far = self.far.take().expect("there is one");
        let before = far.change_for_a_check();
        let mut other = Self::over(far, second);
        let outcome = other.evaluate(positions, charges, Wanted::default(), &mut field);
        let mut far = other.far.take().expect("given");
        far.change_back(before);
        let started = far.solver_mut().start_from(&state);
        let floor = self.permittivity.coulomb() * far.field_of_spacing(charges);
        self.far = Some(far);
        outcome?;
        started?;
        let scale = (squares / positions.len() as f64).sqrt().max(floor);
        Ok(Some(TwoSplittings { first, second: pick(&field.e), jumps, scale }))
    }

    fn far_solver(&self) -> Option<&FarSolver> {
        self.far.as_ref().map(FarLevel::solver)
    }

    fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        self.far.as_mut().map(FarLevel::solver_mut)
    }

    fn pairs_per_particle(&self) -> f64 {
        self.near.pairs_per_particle()
    }

    fn grid_cells(&self) -> Option<[usize; 3]> {
        Some(self.grid.cells())
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        let per_place = size_of::<FieldAt>();
        let fields = [&self.near_field, &self.grid_field, &self.far_field];
        let fields: usize = fields.iter().map(|field| field.capacity() * per_place).sum();
        let far = self.far.as_ref().map_or(0, FarLevel::memory_bytes);
        let places = (self.positions.capacity() + self.charges.capacity() / 3) * size_of::<Vector3<f64>>();
        self.near.memory_bytes() + self.grid.memory_bytes() + far + places + fields
    }
}
