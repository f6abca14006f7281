//! The way from a tolerance and a cloud of charges to the parameters of p3m: error model, candidates,
//! timing, check.

use crate::choosing::candidates::Candidate;
use crate::choosing::charge_statistics::ChargeStatistics;
use crate::choosing::choice::{Choice, Measured};
use crate::choosing::cost;
use crate::choosing::error_model::{error_squared, smooth_error_squared};
use crate::choosing::splittings::{second_splitting, with_best_shapes};
use crate::choosing::trials::Trials;
use crate::error::FieldError;
use crate::levels::grid::level::{grid_sizes, widest_spacing};
use crate::levels::grid::shapes::{ORDERS, Shapes, cutoff_over_spacing_for};
use crate::methods::p3m_parameters::P3mParameters;
use amberfield_core::{Domain, FieldSettings, Tuning};

/// Share of the tolerance that the model aims at: a sample knows the true error to some ten per cent only.
const AIM: f64 = 0.75;
/// Share of the tolerance that is aimed at over a field solver's mesh: what the far level adds is not in
/// the model; up to 1.4 times the estimate were measured (docs/reports/error-vs-runtime.md).
const AIM_OVER_MESH: f64 = 0.69;
/// Share of the tolerance that a measured error may reach.
const ACCEPT: f64 = 0.9;
/// Rounds of tightening before a tolerance counts as out of reach.
const ROUNDS: usize = 6;
/// Nodes of the largest grid considered: 5 GiB.
const MOST_NODES: f64 = 2e8;
/// Candidates that are timed.
const TIMED: usize = 4;
/// Tolerance of the first look at E_rms.
const FIRST_LOOK: f64 = 0.05;

/// Choice of the tuner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen {
    pub(crate) parameters: P3mParameters,
    /// Error by the model.
    pub(crate) estimated: Option<f64>,
    /// Error on a sample; `None` while no grain is charged.
    pub(crate) measured: Option<Measured>,
    /// Error on the sample as a field [V/m].
    pub(crate) error_v_m: Option<f64>,
}

/// Fields that errors are compared with [V/m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Scale that errors are relative to: the larger of E_rms and q_rms n^{2/3}/(4πε).
    pub(crate) all: f64,
    /// RMS of the grid's part of E.
    smooth: f64,
}

/// The tuner of one scene.
pub(crate) struct Tuner<'a> {
    domain: &'a Domain,
    settings: &'a FieldSettings,
    grains: &'a dyn Trials,
    cloud: ChargeStatistics,
    /// Largest cut-off radius [m].
    longest: f64,
}

impl<'a> Tuner<'a> {
    pub(crate) fn new(
        domain: &'a Domain,
        settings: &'a FieldSettings,
        cloud: ChargeStatistics,
        grains: &'a dyn Trials,
    ) -> Self {
        Self { domain, settings, grains, cloud, longest: f64::INFINITY }
    }

    /// Share of the tolerance that the model aims at.
    fn aim(&self) -> f64 {
        if self.longest.is_finite() { AIM_OVER_MESH } else { AIM }
    }

    /// Parameters that meet the tolerance, with their measured error.
    pub(crate) fn choose(&self) -> Result<Chosen, FieldError> {
        if self.cloud.charge == 0.0 {
            // No charge yet: what a unit charge per grain would need.
            let cloud = ChargeStatistics {
                charge: 1.0,
                density: self.cloud.count.max(1.0) / self.domain.volume(),
                ..self.cloud
            };
            let scale = self.settings.permittivity.coulomb() * cloud.density.powf(2.0 / 3.0);
            let bound = self.aim() * self.settings.tolerance * scale;
            let parameters = self.best_by_model(&cloud, bound, 0.0)?;
            return Ok(Chosen { parameters, estimated: None, measured: None, error_v_m: None });
        }
        let scale = self.scale()?;
        let asked = self.settings.tolerance;
        let mut aim = self.aim() * asked;
        let mut best: Option<f64> = None;
        for _ in 0..ROUNDS {
            let candidates = self.candidates(&self.cloud, aim * scale.all, scale.smooth);
            let timed = self.fastest(&candidates, aim * scale.all, scale.smooth)?;
            let Some(timed) = self.grains.shared(timed)? else { break };
            let measured = self.measure(timed, scale)?;
            tracing::debug!(?timed, aim, measured = measured.relative_rms, "p3m candidate");
            if measured.relative_rms <= ACCEPT * asked {
                return Ok(Chosen {
                    parameters: timed,
                    estimated: Some(self.estimate(&timed, scale)),
                    measured: Some(measured),
                    error_v_m: Some(measured.relative_rms * scale.all),
                });
            }
            best = Some(best.unwrap_or(f64::INFINITY).min(measured.relative_rms));
            aim *= (self.aim() * asked / measured.relative_rms).clamp(0.05, 0.8);
        }
        Err(match best {
            Some(reached) => FieldError::Tolerance {
                asked,
                reached,
                advice: format!(
                    "raise electric_field.tolerance{}, or use method = \"direct\"",
                    self.fixed_keys()
                ),
            },
            None => self.no_parameters(aim * scale.all),
        })
    }

    /// The best of each order, cheapest by the cost model first, with errors and times.
    pub(crate) fn table(&self) -> Result<Vec<Candidate>, FieldError> {
        let charged = self.cloud.charge > 0.0;
        let scale = if charged { self.scale()? } else { Scale { all: self.cloud.floor, smooth: 0.0 } };
        let error = self.aim() * self.settings.tolerance * scale.all;
        let one = |(_, parameters): &(f64, P3mParameters)| {
            let measured = charged.then(|| self.measure(*parameters, scale)).transpose()?;
            Ok(Candidate {
                choice: Choice::P3m(*parameters),
                estimated: charged.then(|| self.estimate(parameters, scale)),
                measured,
                seconds: self.grains.seconds(*parameters)?,
            })
        };
        self.candidates(&self.cloud, error, scale.smooth).iter().map(one).collect()
    }

    /// A first look at the field.
    pub(crate) fn scale(&self) -> Result<Scale, FieldError> {
        let first = self.best_by_model(&self.cloud, FIRST_LOOK * self.cloud.floor, 0.0)?;
        let [of_all, of_grid] = self.grains.squares(first)?;
        let rms = |sum: f64| (sum / self.cloud.count).sqrt();
        // Over a field solver's mesh the grid carries what lies between two clouds, and no mean field.
        let smooth = if self.longest.is_finite() { 0.0 } else { rms(of_grid) };
        Ok(Scale { all: rms(of_all).max(self.cloud.floor), smooth })
    }

    /// Measures the error of parameters; `None` where no grain is charged.
    pub(crate) fn measured(&self, parameters: P3mParameters) -> Result<Option<Measured>, FieldError> {
        if self.cloud.charge == 0.0 {
            return Ok(None);
        }
        self.measure(parameters, self.scale()?).map(Some)
    }

    /// Measures the error of parameters against a second, wider and more exact splitting.
    pub(crate) fn measure(&self, parameters: P3mParameters, scale: Scale) -> Result<Measured, FieldError> {
        let (sum, sample) = self.grains.difference(parameters, second_splitting(parameters))?;
        let relative_rms = (sum / sample.max(1) as f64).sqrt() / scale.all;
        Ok(Measured { relative_rms, sample })
    }

    /// A-priori relative error of parameters.
    pub(crate) fn estimate(&self, parameters: &P3mParameters, scale: Scale) -> f64 {
        self.modelled(&self.cloud, parameters, scale.smooth) / scale.all
    }

    /// Error of parameters by the model [V/m], where the grid's part of E is `smooth` [V/m].
    fn modelled(&self, cloud: &ChargeStatistics, parameters: &P3mParameters, smooth: f64) -> f64 {
        let spacing = widest_spacing(self.domain, parameters.spacing_m);
        let shapes = Shapes { cloud: parameters.cloud_shape, window: parameters.window_shape };
        let coefficient = error_squared(parameters.order, parameters.cutoff_m / spacing, shapes) / spacing;
        let random = cloud.squared_error(self.settings.permittivity, coefficient);
        (random + smooth * smooth * smooth_error_squared(parameters.order, parameters.window_shape)).sqrt()
    }

    /// Whether summing every pair with `images` images each costs less than the cheapest grid.
    pub(crate) fn all_pairs_are_cheaper(&self, images: usize) -> bool {
        let error = self.aim() * self.settings.tolerance * self.cloud.floor;
        let grid = self.candidates(&self.cloud, error, 0.0).first().map_or(f64::INFINITY, |(cost, _)| *cost);
        let free = self.settings.cutoff_radius_m.is_none() && self.settings.grid_cells.is_none();
        free && cost::ALL_PAIRS * images as f64 * self.cloud.count * self.cloud.count < grid
    }

    fn best_by_model(
        &self,
        cloud: &ChargeStatistics,
        error: f64,
        smooth: f64,
    ) -> Result<P3mParameters, FieldError> {
        let candidates = self.candidates(cloud, error, smooth);
        let best = self.grains.shared(candidates.first().map(|(_, parameters)| *parameters))?;
        best.ok_or_else(|| self.no_parameters(error))
    }

    /// Says that no parameters have an error of at most `error` [V/m].
    fn no_parameters(&self, error: f64) -> FieldError {
        FieldError::Settings(format!(
            "no p3m parameters within {MOST_NODES:e} grid nodes meet tolerance {:e} (an error of \
             {error:.1e} V/m); raise electric_field.tolerance{}, or use method = \"direct\"",
            self.settings.tolerance,
            self.fixed_keys()
        ))
    }

    /// Limits the cut-off radii to at most `longest` [m].
    pub(crate) fn up_to(self, longest: f64) -> Self {
        Self { longest, ..self }
    }

    /// Advice about the parameters that the scene fixes.
    fn fixed_keys(&self) -> &'static str {
        match (self.settings.cutoff_radius_m, self.settings.grid_cells) {
            (None, None) => "",
            (Some(_), None) => " or change field_cutoff_radius",
            (None, Some(_)) => " or change grid.cells",
            (Some(_), Some(_)) => ", or change field_cutoff_radius or grid.cells",
        }
    }

    /// Candidates with an error of `error` [V/m], cheapest first by the cost model: the best of each order.
    fn candidates(&self, cloud: &ChargeStatistics, error: f64, smooth: f64) -> Vec<(f64, P3mParameters)> {
        let mut best: Vec<(f64, P3mParameters)> = Vec::new();
        for order in ORDERS {
            let of_order = self
                .spacings(cloud)
                .into_iter()
                .filter_map(|spacing| self.candidate(cloud, order, spacing, error, smooth))
                .map(|parameters| (self.cost(cloud, &parameters), parameters))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            best.extend(of_order);
        }
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best
    }

    /// The least cut-off, or the fixed one where it is enough, for an error of `error` [V/m] on nodes at
    /// most `spacing` apart, where the grid's part of E is `smooth` [V/m].
    fn candidate(
        &self,
        cloud: &ChargeStatistics,
        order: usize,
        spacing: f64,
        error: f64,
        smooth: f64,
    ) -> Option<P3mParameters> {
        /// Rounds in which the random part makes room for the smooth one, and what is close enough.
        const MOST: usize = 8;
        const ENOUGH: f64 = 1.02;
        if smooth == 0.0 {
            return self.candidate_for(cloud, order, spacing, error);
        }
        let mut random = error;
        for _ in 0..MOST {
            let parameters = self.candidate_for(cloud, order, spacing, random)?;
            let modelled = self.modelled(cloud, &parameters, smooth);
            if modelled <= ENOUGH * error {
                return Some(parameters);
            }
            random *= (error / modelled).max(0.3);
        }
        None
    }

    /// Finds a candidate for the random part of the error alone.
    fn candidate_for(
        &self,
        cloud: &ChargeStatistics,
        order: usize,
        spacing: f64,
        error: f64,
    ) -> Option<P3mParameters> {
        /// A spacing that divides the box stays one when it is rounded.
        const ROUNDING: f64 = 1e-12;
        let coefficient = error * error / cloud.squared_error(self.settings.permittivity, 1.0);
        let spacing = widest_spacing(self.domain, spacing) * (1.0 + ROUNDING);
        let least = cutoff_over_spacing_for(order, coefficient * spacing)? * spacing;
        let cutoff = self.settings.cutoff_radius_m.unwrap_or(least);
        (least..=self.longest)
            .contains(&cutoff)
            .then(|| with_best_shapes(order, cutoff, spacing, self.kernel_accuracy(error)))
    }

    /// Polynomials a good deal better than the tolerance, never better than round-off.
    fn kernel_accuracy(&self, error: f64) -> f64 {
        (0.05 * error / self.cloud.floor.max(error)).clamp(1e-13, 1e-3)
    }

    /// Node spacings worth a look [m].
    fn spacings(&self, cloud: &ChargeStatistics) -> Vec<f64> {
        const FINEST: f64 = 0.25;
        const FINEST_OF_CUTOFF: f64 = 0.05;
        const COARSEST: f64 = 4.0;
        const STEP: f64 = 1.12;
        if let Some(cells) = self.settings.grid_cells {
            let extent = self.domain.extent();
            return vec![(0..3).map(|axis| extent[axis] / cells[axis] as f64).fold(0.0, f64::max)];
        }
        let distance = cloud.density.cbrt().recip();
        // A cut-off far below the distance of the grains needs clouds, and nodes, of its own size.
        let cutoff = self.settings.cutoff_radius_m.unwrap_or(self.longest);
        let least = (self.domain.volume() / MOST_NODES).cbrt();
        let finest = (FINEST * distance).min(FINEST_OF_CUTOFF * cutoff).max(least);
        let count = ((COARSEST * distance / finest).ln() / STEP.ln()).ceil() as i32;
        (0..=count).map(|i| finest * STEP.powi(i)).collect()
    }

    /// Modelled cost of one evaluation [ns].
    fn cost(&self, cloud: &ChargeStatistics, parameters: &P3mParameters) -> f64 {
        let pairs = 4.0 / 3.0 * std::f64::consts::PI * cloud.density * parameters.cutoff_m.powi(3);
        let nodes: f64 = grid_sizes(self.domain, parameters.spacing_m, parameters.cloud())
            .iter()
            .map(|size| size.padded as f64)
            .product();
        let pair = cost::PAIR[usize::from(!parameters.near().is_single())];
        let per_particle = cost::PARTICLE + pair * pairs + cost::NODE * (parameters.order as f64).powi(3);
        cloud.count * per_particle + cost::TRANSFORM * nodes * nodes.max(2.0).log2()
    }

    /// The candidate with the shortest evaluation, or the cheapest by the model when timing is off; `None`
    /// without candidates. Where near and grid level balance depends on the processor: around the winner,
    /// spacings are tried until none is faster.
    fn fastest(
        &self,
        candidates: &[(f64, P3mParameters)],
        error: f64,
        smooth: f64,
    ) -> Result<Option<P3mParameters>, FieldError> {
        const WORTH_TIMING: f64 = 2.5;
        const STEPS: [f64; 2] = [1.2, 1.0 / 1.2];
        const MOST_STEPS: usize = 4;
        let Some((cheapest, first)) = candidates.first().copied() else { return Ok(None) };
        if self.settings.tuning == Tuning::Model {
            return Ok(Some(first));
        }
        let worth = candidates.iter().take(TIMED).filter(|(cost, _)| *cost < WORTH_TIMING * cheapest);
        let mut best = (f64::INFINITY, first);
        for (_, parameters) in worth {
            best = faster(best, (self.grains.seconds(*parameters)?, *parameters));
        }
        for step in STEPS.into_iter().filter(|_| self.settings.grid_cells.is_none()) {
            for _ in 0..MOST_STEPS {
                let (seconds, P3mParameters { order, spacing_m, .. }) = best;
                let Some(next) = self.candidate(&self.cloud, order, spacing_m * step, error, smooth) else {
                    break;
                };
                best = faster(best, (self.grains.seconds(next)?, next));
                if best.0 >= seconds {
                    break;
                }
            }
        }
        Ok(Some(best.1))
    }
}

fn faster(a: (f64, P3mParameters), b: (f64, P3mParameters)) -> (f64, P3mParameters) {
    if b.0 < a.0 { b } else { a }
}
