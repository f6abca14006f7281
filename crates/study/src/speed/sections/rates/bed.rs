//! The settling bed with and without its charges.

use super::Rows;
use crate::timing::{median, on_threads};
use amberfield_core::{CouplingInterval, FieldSettings, Step};
use amberfield_dem::{FieldStageSetup, Setup, Simulation};
use amberfield_scene::{Purpose, read_scene};
use anyhow::{Context as _, Result};
use std::path::Path;
use std::time::Instant;

pub(super) const STUDY: &str = "cost";
const ROUNDS: usize = 3;

/// The case's bed, with its field settings apart.
pub(super) struct Bed {
    plain: Setup,
    settings: FieldSettings,
    pub(super) end_s: f64,
}

impl Bed {
    pub(super) fn read(path: &Path, overrides: &[String]) -> Result<Self> {
        let scene = read_scene(path, overrides, Purpose::Run)?;
        let settings = scene.electric_field.context("the case has a field")?.field;
        let time = scene.time.context("the case has a time")?;
        let plain = Setup {
            domain: scene.domain.context("the case has a domain")?,
            materials: scene.materials,
            rolling_model: scene.rolling_model,
            cohesion: scene.cohesion,
            pairs: scene.pairs.clone(),
            particles: scene.particles,
            walls: scene.walls,
            time: time.clone(),
            gas: None,
            field: None,
            feeds: Default::default(),
            outlets: Vec::new(),
        };
        Ok(Self { plain, settings, end_s: time.end_s })
    }

    /// Copy of the bed without the charges.
    pub(super) fn uncharged(&self) -> Setup {
        self.plain.clone()
    }

    pub(super) fn charged(&self, tolerance: f64, interval: CouplingInterval) -> Setup {
        let settings = FieldSettings { tolerance, coupling_interval: interval, ..self.settings.clone() };
        let member = vec![true; self.plain.particles.len()];
        Setup { field: Some(FieldStageSetup::new(settings, member)), ..self.plain.clone() }
    }

    /// Bed that starts from where a run has come to, at a fixed step.
    ///
    /// Contacts are forgotten; the field is chosen by the cost model.
    pub(super) fn from(&self, run: &Simulation) -> Self {
        let mut plain = Setup { particles: run.particles(), ..self.plain.clone() };
        for x in &mut plain.particles.position {
            *x = plain.domain.wrap(*x);
        }
        plain.time.step = Step::Seconds(run.step_s());
        plain.time.allow_overlap = true;
        let settings = FieldSettings { tuning: amberfield_core::Tuning::Model, ..self.settings.clone() };
        Self { plain, settings, end_s: self.end_s }
    }

    /// Moves the grains by random parts of `size` [m].
    pub(super) fn perturb(&mut self, size: f64) {
        use rand::{RngExt as _, SeedableRng as _};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        for x in &mut self.plain.particles.position {
            x.x += size * random.random_range(-1.0..1.0);
        }
    }
}

pub(super) fn measure(path: &Path, quick: bool, rows: &mut Rows) -> Result<()> {
    let bed = Bed::read(path, &[])?;
    let rounds = if quick { 1 } else { ROUNDS };
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for round in 0..rounds {
        without.push(run(bed.uncharged(), bed.end_s, quick)?.0);
        let (seconds, charged) =
            run(bed.charged(bed.settings.tolerance, CouplingInterval::Auto), bed.end_s, quick)?;
        with.push(seconds);
        if round == 0 {
            let intervals = charged.intervals().context("a charged bed")?;
            let stages = charged.stage_seconds();
            let field = stages.iter().find(|(name, _)| *name == "field").map_or(0.0, |(_, seconds)| *seconds);
            rows.add(STUDY, "charged", "steps", charged.step_index() as f64);
            rows.add(STUDY, "charged", "evaluations", intervals.evaluations as f64);
            rows.add(STUDY, "charged", "forecast error", intervals.error());
            rows.add(STUDY, "charged", "field seconds", field);
        }
    }
    rows.add(STUDY, "uncharged", "seconds", median(&mut without));
    rows.add(STUDY, "charged", "seconds", median(&mut with));
    Ok(())
}

/// Seconds to the end, and the simulation there.
fn run(setup: Setup, end_s: f64, quick: bool) -> Result<(f64, Simulation)> {
    on_threads(1, || {
        let mut simulation = Simulation::new(setup)?;
        let start = Instant::now();
        while simulation.time_s() < end_s && !(quick && simulation.step_index() >= 50) {
            simulation.step()?;
        }
        Ok((start.elapsed().as_secs_f64(), simulation))
    })
}
