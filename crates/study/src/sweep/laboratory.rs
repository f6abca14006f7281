//! Interface to the program that computes fields for a study.

use super::description::{Extreme, GroundedBox};
use amberfield_core::Vector3;
use std::path::Path;

/// The exact field of a problem.
#[derive(Clone, Debug)]
pub struct Exact {
    /// E at the grains [V/m].
    pub e: Vec<Vector3<f64>>,
    /// Field to which errors are relative [V/m].
    pub scale: f64,
    /// Way in which the truth was found, in words.
    pub by: String,
}

/// One evaluation.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// Seconds in all.
    pub seconds: f64,
    /// Stages and their seconds.
    pub stages: Vec<(String, f64)>,
    /// Memory held [bytes].
    pub memory_bytes: usize,
    /// Parameters, in words.
    pub parameters: String,
    /// Relative RMS error by the a-priori model, if there is one.
    pub estimated: Option<f64>,
    /// Tolerance that the method promises to keep, if it promises any.
    pub promised: Option<f64>,
    /// Mean number of partners within the cut-off.
    pub pairs_per_grain: f64,
}

/// Input that another program needs.
#[derive(Clone, Debug, Default)]
pub struct Peer {
    /// Relative RMS error of E, against the same truth.
    pub error: f64,
    /// Seconds of an evaluation.
    pub seconds: f64,
    /// Parameters, in words.
    pub parameters: String,
}

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Moved {
    /// Positions [m] at the start and at every look.
    pub positions: Vec<Vec<Vector3<f64>>>,
    /// Charges [C] likewise.
    pub charges: Vec<Vec<f64>>,
    /// Time at the end [s].
    pub end_s: f64,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Steps.
    pub steps: u64,
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Kinetic energy at the end [J].
    pub kinetic_j: f64,
    /// Contacts per grain at the end.
    pub contacts_per_grain: f64,
}

impl Moved {
    /// Mean height [m], kinetic energy [J] and contacts per grain at the end.
    pub(super) fn statistics(&self) -> [f64; 3] {
        let last = self.positions.last().map_or(&[][..], |last| last);
        let height = last.iter().map(|position| position.z).sum::<f64>() / last.len().max(1) as f64;
        [height, self.kinetic_j, self.contacts_per_grain]
    }
}

/// Outcome of a command.
#[derive(Clone, Debug, Default)]
pub struct Endured {
    /// Exit code of the command; none if it did not end in time or was killed.
    pub code: Option<i32>,
    /// Last message of the command, if it did not end well.
    pub said: String,
    /// Wall-clock time [s].
    pub seconds: f64,
    /// Grains.
    pub grains: usize,
    /// Sum of the sizes of all charges [C], those that contacts have moved among them.
    pub charges_c: f64,
    /// Looks at the run, in time.
    pub looks: Vec<Look>,
    /// Relative RMS error of E against the direct sum.
    pub error: Option<f64>,
}

/// A look at a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Time [s].
    pub time_s: f64,
    /// Kinetic energy [J].
    pub kinetic_j: f64,
    /// Energy of gravity, contacts and field [J].
    pub potential_j: f64,
    /// Charge of grains and walls [C].
    pub charge_c: f64,
    /// Grains whose force was limited.
    pub limited: Option<u64>,
}

impl Look {
    /// All energy [J].
    pub(super) fn total_j(&self) -> f64 {
        self.kinetic_j + self.potential_j
    }
}

/// Origin of a row: where, when and with which program it was measured.
#[derive(Clone, Debug, Default)]
pub struct Provenance {
    /// Processor.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// Version of the program, and of what it was made from.
    pub version: String,
    /// Date, as 2026-01-31.
    pub date: String,
}

/// Computes fields for a study. Errors are sentences for the report: a point that fails is listed, and the
/// study goes on.
pub trait Laboratory {
    /// A scene, read.
    type Problem;
    /// A method with its parameters chosen.
    type Method;

    /// Origin of the rows.
    fn provenance(&self) -> Provenance;

    /// Reads a scene with overrides.
    ///
    /// # Errors
    /// What is wrong with the scene.
    fn problem(&mut self, scene: &Path, set: &[String]) -> Result<Self::Problem, String>;

    /// Grains of a problem that take part in the field.
    fn grains(&self, problem: &Self::Problem) -> usize;

    /// Exact field in the scene's own box, without a field solver; the direct sum for at most so many grains.
    ///
    /// # Errors
    /// Why there is none.
    fn exact(&mut self, problem: &Self::Problem, direct_up_to: usize) -> Result<Exact, String>;

    /// Exact field in grounded boxes, each with the grains that are in it, as [`Self::exact`] finds it.
    ///
    /// # Errors
    /// A grain that is in none of them; why there is no field.
    fn exact_in_boxes(
        &mut self,
        problem: &Self::Problem,
        boxes: &[GroundedBox],
        direct_up_to: usize,
    ) -> Result<Exact, String>;

    /// Positions [m], charges [C] and Coulomb's constant of the medium [V·m/C], for truths that the study
    /// knows itself.
    fn charges(&self, problem: &Self::Problem) -> (Vec<Vector3<f64>>, Vec<f64>, f64);

    /// Chooses a method's parameters.
    ///
    /// # Errors
    /// Why it cannot be used.
    fn method(&mut self, problem: &mut Self::Problem) -> Result<Self::Method, String>;

    /// Another program's fastest parameters whose error is at most a tolerance.
    ///
    /// # Errors
    /// That it is missing or cannot compute this, and what to do.
    fn peer(
        &mut self,
        program: &str,
        problem: &Self::Problem,
        exact: &Exact,
        tolerance: f64,
    ) -> Result<Peer, String>;

    /// Runs a scene to its end, its grains displaced by so many radii before it starts, and looks at it so
    /// many times, evenly in time, and at the start.
    ///
    /// # Errors
    /// Why it cannot be run.
    fn simulate(&mut self, scene: &Path, set: &[String], nudge: f64, looks: usize) -> Result<Moved, String>;

    /// Sends a scene through the command that an extreme is about, as a user would.
    fn endure(&mut self, scene: &Path, set: &[String], extreme: &Extreme) -> Endured;

    /// E at the grains of the last evaluation [V/m].
    fn e<'m>(&self, method: &'m Self::Method) -> &'m [Vector3<f64>];

    /// Evaluates the field once.
    ///
    /// # Errors
    /// Why it failed.
    fn evaluate(&mut self, problem: &Self::Problem, method: &mut Self::Method) -> Result<Evaluation, String>;
}
