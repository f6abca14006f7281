//! Particle–particle particle–mesh with smooth splitting, shared by ranks:
//!
//! 1/r = [1 − Φ(r/r_c)]/r + Φ(r/r_c)/r — pairs within r_c of a rank's own grains, with those of other ranks
//! that are near; and the internal grid with the box's faces, which the ranks share.
//!
//! E comes out as in one process, but for the order in which numbers are added.

use crate::error::FieldError;
use crate::geometry::images::BoundingBox;
use crate::geometry::inputs::{ChargeSums, check_finite, check_in_box, check_net_charge};
use crate::geometry::uncut::uncut;
use crate::levels::grid::over_ranks::GridOverRanks;
use crate::levels::near::NearLevel;
use crate::levels::near::ghosts::Ghosts;
use crate::methods::method::FieldMethod;
use crate::methods::p3m::{background_potential, e_of_charges};
use crate::methods::p3m_parameters::P3mParameters;
use crate::numerics::stopwatch::Stopwatch;
use crate::ranks::{Parcels, Ranks};
use crate::sum::{Levels, OwnClouds, Part};
use crate::values::{FieldAt, Wanted};
use amberfield_core::{Domain, FieldSettings};
use nalgebra::Vector3;
use std::sync::Arc;

/// Numbers that every rank tells all others before an evaluation.
const TOLD: usize = 10;

/// The levels of one rank's grains, and their buffers.
#[derive(Debug)]
pub(crate) struct P3mOverRanks {
    ranks: Arc<dyn Ranks>,
    domain: Domain,
    settings: FieldSettings,
    parameters: P3mParameters,
    ghosts: Ghosts,
    near: NearLevel,
    grid: GridOverRanks,
    /// Grains of this rank; in the near level then others that are near.
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    near_field: Vec<FieldAt>,
    grid_field: Vec<FieldAt>,
    stopwatch: Stopwatch,
}

/// Knowledge of all ranks about all grains.
struct Census {
    /// Boxes around the grains of each rank.
    boxes: Vec<Option<BoundingBox>>,
    sums: ChargeSums,
}

impl P3mOverRanks {
    pub(crate) fn new(
        ranks: &Arc<dyn Ranks>,
        domain: &Domain,
        settings: &FieldSettings,
        parameters: P3mParameters,
    ) -> Self {
        Self {
            ranks: Arc::clone(ranks),
            domain: domain.clone(),
            settings: settings.clone(),
            parameters,
            ghosts: Ghosts::new(domain, parameters.cutoff_m),
            near: NearLevel::new(domain, parameters.near()),
            grid: GridOverRanks::new(domain, parameters.grid(), ranks.as_ref()),
            positions: Vec::new(),
            charges: Vec::new(),
            near_field: Vec::new(),
            grid_field: Vec::new(),
            stopwatch: Stopwatch::default(),
        }
    }

    /// E of the charges alone at a sample of this rank's grains.
    pub(crate) fn sample(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        sample: &[usize],
    ) -> Result<Vec<Vector3<f64>>, FieldError> {
        self.prepare(positions, charges)?;
        let places: Vec<_> = sample.iter().map(|&particle| self.positions[particle]).collect();
        let mut far = vec![FieldAt::default(); sample.len()];
        self.grid.gather(&places, &mut far);
        Ok(e_of_charges(self.settings.permittivity, &self.near.at(sample), &far, &places))
    }

    /// Sorts the near level, and solves on the grid.
    fn prepare(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<Census, FieldError> {
        self.stopwatch.restart();
        let loaded = self.load(positions, charges);
        let census = self.take_census(loaded)?;
        let ranks = self.ranks.as_ref();
        self.ghosts.append(ranks, &census.boxes, &mut self.positions, &mut self.charges)?;
        self.stopwatch.lap("ghosts");
        self.near.sort(&self.positions, &self.charges, positions.len());
        self.stopwatch.lap("sort");
        self.grid.solve(ranks, &census.boxes, &self.positions[..positions.len()], charges)?;
        self.stopwatch.lap("grid");
        Ok(census)
    }

    /// Takes this rank's grains, each where it lies near the others.
    fn load(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<(), FieldError> {
        check_finite(positions, charges)?;
        check_in_box(&self.domain, positions)?;
        self.positions.clear();
        self.positions.extend(positions.iter().map(|&position| self.domain.wrap(position)));
        uncut(&self.domain, &mut self.positions);
        self.charges.clear();
        self.charges.extend(charges);
        for field in [&mut self.near_field, &mut self.grid_field] {
            field.clear();
            field.resize(positions.len(), FieldAt::default());
        }
        Ok(())
    }

    /// Tells all ranks where this rank's grains are, and refuses what one of the ranks refuses.
    fn take_census(&self, own: Result<(), FieldError>) -> Result<Census, FieldError> {
        let ranks = self.ranks.as_ref();
        let sums = ChargeSums::of(&self.charges);
        let grains = BoundingBox::around(&self.positions);
        let BoundingBox { min, max } =
            grains.unwrap_or(BoundingBox { min: Vector3::zeros(), max: Vector3::zeros() });
        let flags = [f64::from(u8::from(own.is_err())), f64::from(u8::from(grains.is_some()))];
        let own_numbers = [&flags[..], &[sums.net, sums.absolute], min.as_slice(), max.as_slice()].concat();
        let (told, mut heard) = (Parcels::for_all(&own_numbers, ranks.count()), Parcels::default());
        heard.resize(told.sizes());
        ranks.exchange(&told, &mut heard)?;
        let (mut boxes, mut sums, mut is_good) = (Vec::new(), ChargeSums::default(), true);
        for numbers in heard.values.as_chunks::<TOLD>().0 {
            let [has_failed, has_grains, net, absolute, corners @ ..] = numbers;
            let [min, max] = [0, 3].map(|at: usize| Vector3::from_row_slice(&corners[at..at + 3]));
            boxes.push((*has_grains > 0.0).then_some(BoundingBox { min, max }));
            sums = ChargeSums { net: sums.net + net, absolute: sums.absolute + absolute };
            is_good &= *has_failed == 0.0;
        }
        if !is_good {
            ranks.agreed(own)?;
        }
        // The same numbers on all ranks: all refuse or none.
        let FieldSettings { permittivity, neutralising_background, .. } = self.settings;
        check_net_charge(&self.domain, permittivity, neutralising_background, sums)?;
        Ok(Census { boxes, sums })
    }
}

impl FieldMethod for P3mOverRanks {
    fn levels<'a>(
        &'a mut self,
        _time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        wanted: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        let Census { sums, .. } = self.prepare(positions, charges)?;
        self.near.add_all(wanted.potential, &mut self.near_field);
        self.stopwatch.lap("near");
        self.grid.gather(&self.positions[..positions.len()], &mut self.grid_field);
        self.stopwatch.lap("gather");
        let cloud = self.parameters.cloud();
        Ok(Levels {
            coulomb: self.settings.permittivity.coulomb(),
            near: Part::new(&self.near_field),
            far_of_charges: Part::new(&self.grid_field),
            own_clouds: OwnClouds { charges, at_centre: cloud.potential(0.0) },
            background: background_potential(&self.domain, cloud, sums.net),
            ..Levels::default()
        })
    }

    fn agreed(&self, outcome: Result<(), FieldError>) -> Result<(), FieldError> {
        self.ranks.agreed(outcome)
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
        let fields = (self.near_field.capacity() + self.grid_field.capacity()) * size_of::<FieldAt>();
        let places = (self.positions.capacity() + self.charges.capacity() / 3) * size_of::<Vector3<f64>>();
        self.ghosts.memory_bytes() + self.near.memory_bytes() + self.grid.memory_bytes() + places + fields
    }
}
