//! The field solver with its state: what it found last, and where its next solve starts.
//!
//! With overlap the solver works while the grains move on: an evaluation takes the answer to what the one
//! before asked, asks for its own, and goes on with a forecast, the potential on the line through the last
//! two answers. The far field is smooth in space and slow in time; what the forecast misses is measured
//! when the answer comes.

use super::potentials::{Look, Potentials};
use super::{FarField, FarMesh, FarRequest, FarValues};
use crate::error::FieldError;
use amberfield_core::{FarQuestion, SourceCloud};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A far field with its state.
#[derive(Debug)]
pub struct FarSolver {
    solver: Box<dyn FarField>,
    /// Answer that was found last.
    pub(crate) values: FarValues,
    /// Potential from which the next solve is to start [V]; empty: from where the solver is.
    guess: Vec<f64>,
    /// `None`: every evaluation waits for its own answer.
    overlap: Option<Box<Overlap>>,
    /// Potentials of patches that change; `None`: none does.
    potentials: Option<Box<Potentials>>,
}

/// State of a far field: what a run needs to go on bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FarState {
    /// Potential at the cells' centres [V]; empty without a field solver.
    potential: Vec<f64>,
    /// E there [V/m], with overlap.
    e: Vec<Vector3<f64>>,
    overlap: Option<Box<Overlap>>,
}

impl FarState {
    /// Potential at the cells' centres of the last answer [V]; empty without a field solver.
    #[must_use]
    pub fn potential(&self) -> &[f64] {
        &self.potential
    }
}

/// State that is known while the solver works.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Overlap {
    /// Time of the last answer [s].
    latest_s: f64,
    /// The answer before, and its time [s].
    earlier: Option<(f64, Answer)>,
    /// Forecast that counts now.
    forecast: Answer,
    /// RMS over the cells of what the last forecast missed of E [V/m].
    missed: f64,
    /// Question that is being solved.
    pending: Option<OpenQuestion>,
    /// Whether anything was solved yet.
    begun: bool,
}

/// Potential [V] and E [V/m] at the cells' centres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Answer {
    potential: Vec<f64>,
    e: Vec<Vector3<f64>>,
}

impl Answer {
    fn of(values: &FarValues) -> Self {
        Self { potential: values.potential.clone(), e: values.e.clone() }
    }
}

/// Question that is open, as a checkpoint has it: after a resume it is asked again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct OpenQuestion {
    /// Radius [m] and shape of the clouds; `None`: charges are spread over their cells.
    cloud: Option<(f64, f64)>,
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    image_positions: Vec<Vector3<f64>>,
    image_charges: Vec<f64>,
    density: Vec<f64>,
    boundary: Vec<f64>,
    /// Absolute permittivity [F/m].
    permittivity: f64,
    neutralising_background: bool,
    time_s: f64,
}

impl OpenQuestion {
    fn of(request: &FarRequest<'_>) -> Self {
        let FarQuestion { cloud, permittivity_f_m, neutralising_background, time_s, .. } = request.question;
        Self {
            cloud: (!cloud.is_nearest_cell()).then_some((cloud.radius_m, cloud.shape)),
            positions: request.positions.to_vec(),
            charges: request.charges.to_vec(),
            image_positions: request.image_positions.to_vec(),
            image_charges: request.image_charges.to_vec(),
            density: request.density.to_vec(),
            boundary: request.boundary.to_vec(),
            permittivity: permittivity_f_m,
            neutralising_background: neutralising_background != 0,
            time_s,
        }
    }

    fn request<'a>(&'a self, guess: &'a [f64]) -> FarRequest<'a> {
        let cloud = self.cloud.map(|(radius_m, shape)| SourceCloud { radius_m, shape });
        FarRequest {
            question: FarQuestion {
                cloud: cloud.unwrap_or(SourceCloud::nearest_cell()),
                permittivity_f_m: self.permittivity,
                neutralising_background: u64::from(self.neutralising_background),
                time_s: self.time_s,
                tolerance: 0.0,
                wants_e: 1,
            },
            positions: &self.positions,
            charges: &self.charges,
            image_positions: &self.image_positions,
            image_charges: &self.image_charges,
            density: &self.density,
            boundary: &self.boundary,
            guess,
        }
    }
}

impl FarSolver {
    pub(crate) fn new(solver: Box<dyn FarField>, overlap: bool) -> Self {
        let overlap = overlap.then(Box::default);
        let potentials = Potentials::new(solver.mesh());
        Self { solver, values: FarValues::default(), guess: Vec::new(), overlap, potentials }
    }

    /// Whether potentials of patches change with time.
    #[must_use]
    pub fn changes(&self) -> bool {
        self.potentials.is_some()
    }

    /// Takes the potentials of a time [s] from now on.
    pub(crate) fn set_time(&mut self, time_s: f64) {
        if let Some(potentials) = &mut self.potentials {
            potentials.time_s = time_s;
        }
    }

    /// Looks ahead at potentials that change when the next solve asks for them.
    pub fn look_ahead(&mut self, look: Look) {
        if let Some(potentials) = &mut self.potentials {
            potentials.look_ahead(look);
        }
    }

    /// Steps for which the potentials that change may be taken as going along a straight line, by the last
    /// look; `None` where nothing changes, or nobody has looked.
    #[must_use]
    pub fn followed(&self) -> Option<u64> {
        self.potentials.as_ref()?.followed()
    }

    /// Adds the potentials that change [V] to the values of their faces.
    pub(crate) fn add_changing(&mut self, boundary: &mut [f64]) -> Result<(), FieldError> {
        let Some(potentials) = &mut self.potentials else { return Ok(()) };
        let answers = self.overlap.as_ref().map_or_else(Vec::new, |overlap| overlap.times());
        potentials.ask(&mut *self.solver, &answers)?;
        potentials.add(self.solver.mesh(), boundary);
        Ok(())
    }

    /// Takes the potentials that change from the present to a forecast, whose cells know those of its answers
    /// only.
    pub(crate) fn forecast_changing(&self, boundary: &mut [f64]) {
        if let (Some(potentials), Some(overlap)) = (&self.potentials, &self.overlap)
            && overlap.pending.is_some()
        {
            let answers = overlap.times_of_answers();
            potentials.add_forecast(self.solver.mesh(), &answers, boundary);
        }
    }

    pub(crate) fn mesh(&self) -> &FarMesh {
        self.solver.mesh()
    }

    /// Solves, from where it is to start; the request's own guess does not count.
    pub(crate) fn solve(&mut self, request: &FarRequest<'_>) -> Result<(), FieldError> {
        let time_s = request.question.time_s;
        // What a forecast misses is measured by E.
        let wants_e = request.question.wants_e | u64::from(self.overlap.is_some());
        let question = FarQuestion { wants_e, ..request.question };
        let request = FarRequest { question, guess: &self.guess, ..*request };
        match &mut self.overlap {
            Some(overlap) if overlap.begun => {
                if let Some(asked) = overlap.pending.take() {
                    let before = Answer::of(&self.values);
                    if let Err(error) = self.solver.take(&mut self.values) {
                        // Nothing has happened: a state of now asks again.
                        (self.values.potential, self.values.e) = (before.potential, before.e);
                        overlap.pending = Some(asked);
                        return Err(error);
                    }
                    overlap.missed = rms_difference(&self.values.e, &overlap.forecast.e);
                    overlap.earlier = Some((overlap.latest_s, before));
                    overlap.latest_s = asked.time_s;
                }
                self.solver.ask(&request)?;
                overlap.pending = Some(OpenQuestion::of(&request));
                overlap.foresee(&self.values, time_s);
            }
            Some(overlap) => {
                self.solver.solve(&request, &mut self.values)?;
                overlap.begun = true;
                overlap.latest_s = time_s;
                overlap.forecast = Answer::of(&self.values);
            }
            None => self.solver.solve(&request, &mut self.values)?,
        }
        self.guess.clear();
        Ok(())
    }

    /// The potential at the cells' centres that counts now [V]: found, or forecast.
    pub(crate) fn potential(&self) -> &[f64] {
        self.overlap.as_ref().map_or(&self.values.potential, |overlap| &overlap.forecast.potential)
    }

    /// State for a checkpoint: with what the next solve starts.
    #[must_use]
    pub fn state(&self) -> FarState {
        let potential = if self.guess.is_empty() { &self.values.potential } else { &self.guess };
        let e = self.overlap.as_ref().map_or_else(Vec::new, |_| self.values.e.clone());
        FarState { potential: potential.clone(), e, overlap: self.overlap.clone() }
    }

    /// Iterations of the last solve.
    #[must_use]
    pub fn iterations(&self) -> u64 {
        self.values.iterations
    }

    /// Time that the last solve took [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.values.seconds
    }

    /// RMS over the cells of what the last forecast missed of E [V/m]; 0 without overlap.
    #[must_use]
    pub fn missed(&self) -> f64 {
        self.overlap.as_ref().map_or(0.0, |overlap| overlap.missed)
    }

    /// Whether the solver works beside the steps.
    #[must_use]
    pub fn overlaps(&self) -> bool {
        self.overlap.is_some()
    }

    /// Whether the solver works beside the motion, or has begun to.
    pub(crate) fn is_at_work(&self) -> bool {
        self.overlap.as_ref().is_some_and(|overlap| overlap.begun)
    }

    /// Waits for answers from now on; whether it did not.
    pub(crate) fn without_overlap(&mut self) -> bool {
        self.overlap.take().is_some()
    }

    /// Works beside the motion from now on, if it is to.
    pub(crate) fn with_overlap(&mut self, overlap: bool) {
        self.overlap = overlap.then(Box::default);
    }

    /// Goes on from a state of an earlier run.
    ///
    /// # Errors
    /// What was being solved then cannot be asked for again.
    pub fn start_from(&mut self, state: &FarState) -> Result<(), FieldError> {
        if state.potential.len() != self.mesh().cell_count() {
            return Ok(());
        }
        self.guess.clone_from(&state.potential);
        if let (Some(overlap), Some(known)) = (&mut self.overlap, &state.overlap) {
            overlap.clone_from(known);
            if overlap.begun {
                self.values.potential = std::mem::take(&mut self.guess);
                self.values.e.clone_from(&state.e);
            }
            if let Some(asked) = &overlap.pending {
                self.solver.ask(&asked.request(&self.values.potential))?;
            }
        }
        Ok(())
    }
}

impl Overlap {
    /// Times of the answers from which the next evaluation forecasts [s], the later first.
    fn times(&self) -> Vec<f64> {
        match &self.pending {
            Some(asked) => vec![asked.time_s, self.latest_s],
            None if self.begun => self.times_of_answers(),
            None => Vec::new(),
        }
    }

    /// Times of the answers that are known [s], the later first.
    fn times_of_answers(&self) -> Vec<f64> {
        let earlier = self.earlier.as_ref().map(|(time_s, _)| *time_s);
        std::iter::once(self.latest_s).chain(earlier).collect()
    }

    /// Forecasts the answer at a time [s] from the last one and the one before.
    fn foresee(&mut self, latest: &FarValues, time_s: f64) {
        self.forecast = Answer::of(latest);
        let Some((earlier_s, earlier)) = &self.earlier else { return };
        let interval = self.latest_s - earlier_s;
        if interval > 0.0 {
            let ahead = (time_s - self.latest_s) / interval;
            for (potential, before) in self.forecast.potential.iter_mut().zip(&earlier.potential) {
                *potential += ahead * (*potential - before);
            }
            for (e, before) in self.forecast.e.iter_mut().zip(&earlier.e) {
                *e += ahead * (*e - before);
            }
        }
    }
}

fn rms_difference(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()).sum();
    (squares / a.len().max(1) as f64).sqrt()
}
