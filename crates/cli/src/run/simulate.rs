//! Simulation of a scene from its set-up to its results.

use super::begin::begin;
use super::folder::{Existing, RunFolder};
use super::histogram;
use super::name::name_of;
use super::observer::Observer;
use super::picture::draw;
use super::record::Clock;
use super::session::{EarlierPart, Saved, Session};
use super::setup::{CaseContents, SolverConnections, setup_of};
use super::solver::{case_contents, clear_solver_folder, connect_solver, read_input};
use super::solver_folder::SolverFolder;
use super::summary::Ending;
use crate::failure::Failure;
use crate::logging::Log;
use crate::{limits, plan_text};
use amberfield_core::Tuning;
use amberfield_dem::{FeedAccount, Simulation};
use amberfield_scene::{
    Physics, Purpose, Scene, SceneInput, checkpoints, read_checkpoint, write_json, write_text,
};
use std::path::{Path, PathBuf};

/// Share of the steps with limited grains above which a run ends with a warning.
const LIMITED_SHARE: f64 = 0.1;

/// Scene that is to be run, and how.
#[derive(Clone, Debug)]
pub struct RunRequest {
    /// Scene.
    pub scene: SceneInput,
    /// Folder of the results; `None` for one that is named after the scene, or that of the checkpoint.
    pub out: Option<PathBuf>,
    /// Number of steps after which to stop.
    pub steps: Option<u64>,
    /// Checkpoint from which to continue.
    pub resume: Option<PathBuf>,
    /// Whether to continue though the `OpenFOAM` case has changed since the checkpoint.
    pub accept_changed_case: bool,
    /// Whether to replace the results in the folder.
    pub overwrite: bool,
    /// Overrides of keys, `KEY=VALUE`.
    pub set: Vec<String>,
}

/// Run whose results are written.
#[derive(Debug)]
pub struct Outcome {
    /// Folder of the results.
    pub folder: PathBuf,
    /// Lines that tell its user what was done.
    pub lines: Vec<String>,
    /// Failure of a run whose results are outside of its tolerance.
    pub verdict: Result<(), Failure>,
}

/// Runs a simulation, which an observer watches.
///
/// # Errors
/// Input that is bad, a peer that is lost, an answer that cannot be trusted: see [`Failure`].
pub fn simulate(request: &RunRequest, observer: &mut dyn Observer, log: &Log) -> Result<Outcome, Failure> {
    let existing = match (&request.resume, request.overwrite) {
        (Some(_), _) => Existing::Resume,
        (None, true) => Existing::Overwrite,
        (None, false) => Existing::Refuse,
    };
    let out = out_folder(request)?;
    RunFolder::check(&out, existing, request.scene.path())?;
    let solver_folder = SolverFolder::of_run(&out);
    if existing != Existing::Resume {
        clear_solver_folder(&solver_folder)?;
    }
    let mut scene = read_input(&request.scene, &request.set, Purpose::Run, &solver_folder)?;
    if let Some(filled) = &scene.filled {
        RunFolder::spare(&out, existing, &filled.checkpoint)?;
    }
    scene.title = name_of(&request.scene);
    for warning in &scene.warnings {
        tracing::warn!("{warning}");
    }
    let saved =
        request.resume.as_ref().map(|checkpoint| read_saved(checkpoint, scene.physics())).transpose()?;
    let contents = case_contents(&scene)?;
    if let Some(saved) = &saved {
        check_case(contents.as_ref(), saved.case.as_ref(), request.accept_changed_case)?;
    }
    let solver = match &saved {
        Some(saved) if scene.solver.is_some() && saved.state.has_lost_solver() => {
            tracing::warn!(
                "the field solver was lost before this checkpoint; the run continues with the internal grid"
            );
            SolverConnections::default()
        }
        _ => connect_solver(&mut scene, &solver_folder)?,
    };
    for warning in &solver.warnings {
        tracing::warn!("{warning}");
    }
    let setup = setup_of(&mut scene, None, solver)?;

    let (simulation, earlier) = match saved {
        Some(Saved { state, history, wall_s, stage_s, health, .. }) => {
            let earlier = EarlierPart { history, clock: Clock { wall_s, stages: stage_s }, health };
            let resumed = Simulation::resume(setup, state);
            let resumed = resumed.map_err(|error| Failure::of_scene(&scene, &error))?;
            (resumed, Some(earlier))
        }
        None => (begin(&scene, setup)?, None),
    };

    // The folder is opened only now, so that a scene that cannot start leaves no files behind.
    let folder = RunFolder::open(&out, existing)?;
    log.open(&folder.file("log.jsonl"))
        .map_err(|error| Failure::bad_input(format!("{}: {error}", folder.file("log.jsonl").display())))?;
    write_text(&folder.file("scene.toml"), scene.resolved())?;
    if let (Some(field), None) = (simulation.field(), &earlier) {
        write_json(&folder.file("tuning.json"), field.choice())?;
    }
    announce(&scene, &simulation);

    let mut session = match earlier {
        Some(earlier) => Session::resume(&folder, &scene, simulation, earlier, contents)?,
        None => Session::start(&folder, &scene, simulation, contents)?,
    };
    let first = session.simulation.step_index();
    observer.begin(first, session.schedule.total);
    let ending = session.go(request.steps, observer)?;
    Ok(finish(&session, first, ending))
}

/// Reads a checkpoint. If it cannot be used, the message names an older one that can.
fn read_saved(checkpoint: &Path, physics: &Physics) -> Result<Saved, Failure> {
    read_checkpoint(checkpoint, physics).map_err(|error| {
        let folder = checkpoint.parent().unwrap_or_else(|| Path::new(""));
        let mut older = checkpoints(folder).into_iter().rev().filter(|other| other.as_path() < checkpoint);
        match older.find(|older| read_checkpoint::<Saved>(older, physics).is_ok()) {
            Some(older) => {
                Failure::from(error).with(&format!("; continue with --resume {}", older.display()))
            }
            None => error.into(),
        }
    })
}

/// Refuses a case that is another than that of a checkpoint, or tells of it where that is accepted.
fn check_case(
    now: Option<&CaseContents>,
    before: Option<&CaseContents>,
    accept: bool,
) -> Result<(), Failure> {
    /// Files that a message names at most.
    const MOST: usize = 5;
    let (Some(now), Some(before)) = (now, before) else { return Ok(()) };
    let changes = now.changes_since(before);
    if changes.is_empty() {
        return Ok(());
    }
    let mut named = changes[..changes.len().min(MOST)].join(", ");
    if changes.len() > MOST {
        named += &format!(" and {} more", changes.len() - MOST);
    }
    if accept {
        tracing::warn!("the case of [solver] has changed since the checkpoint: {named}");
        return Ok(());
    }
    Err(Failure::bad_input(format!(
        "the case of [solver] has changed since the checkpoint: {named}; restore it, or go on with \
         --accept-changed-case"
    )))
}

/// Path of the run folder: the one that was given, that of the checkpoint, or one named after the scene.
fn out_folder(request: &RunRequest) -> Result<PathBuf, Failure> {
    if let Some(out) = &request.out {
        return Ok(out.clone());
    }
    let Some(checkpoint) = &request.resume else {
        return Ok(PathBuf::from(format!("{}-run", name_of(&request.scene))));
    };
    let folder =
        std::path::absolute(checkpoint).ok().and_then(|path| Some(path.parent()?.parent()?.to_path_buf()));
    folder.ok_or_else(|| {
        Failure::bad_input(format!("{}: not in a run folder; name one with --out", checkpoint.display()))
    })
}

/// Logs the size of the run and the errors of its field.
fn announce(scene: &Scene, simulation: &Simulation) {
    for wall in plan_text::walls(scene) {
        tracing::info!("wall {wall}");
    }
    for line in plan_text::lines(simulation.plan()) {
        tracing::debug!("{line}");
    }
    tracing::info!(
        "{} grains, step {:e} s, neighbour skin {:e} m, {} threads",
        simulation.len(),
        simulation.step_s(),
        simulation.skin_m(),
        rayon::current_num_threads()
    );
    let end_s = scene.time.as_ref().map_or(0.0, |time| time.end_s);
    if let Some(text) = plan_text::duration(simulation.len(), (end_s / simulation.step_s()).ceil()) {
        tracing::warn!("{text}");
    }
    if let Some(text) = limits::of_step(scene) {
        tracing::info!("{text}");
    }
    if let Some(field) = simulation.field() {
        match (field.error_estimated(), field.error_measured()) {
            (Some(estimated), Some(measured)) => tracing::info!(
                "electric field: relative error estimated {estimated:.2e}, measured {:.2e}",
                measured.relative_rms
            ),
            // The method is exact or states no error, or the parameters come from a checkpoint.
            _ => tracing::info!("electric field: {}", field.choice()),
        }
        if scene.electric_field.as_ref().is_some_and(|settings| settings.field.tuning == Tuning::Timed) {
            tracing::info!(
                "electric field: its parameters were timed, so that another fresh run may choose others and \
                 differ within the tolerance; tuning = \"model\" repeats"
            );
        }
    }
}

/// Logs the results of a run, draws its pictures and judges it.
fn finish(session: &Session<'_>, first: u64, ending: Ending) -> Outcome {
    let simulation = &session.simulation;
    warn_about_limits(session, first);
    draw(&session.folder.file("picture.png"), session.scene, simulation);
    if simulation.ledger().is_some() {
        histogram::plot(session.folder);
    }
    tell_feeds(simulation);
    tell_charges(simulation);
    tell_gas(simulation);

    let seconds = session.begun.elapsed().as_secs_f64();
    #[expect(clippy::cast_precision_loss, reason = "a rate for the eye")]
    let rate = (simulation.step_index() - first) as f64 / seconds;
    let mut lines = vec![
        format!(
            "{}: {} grains, step {} of {}, t = {:.6e} s, {seconds:.1} s ({rate:.0} steps/s)",
            session.scene.title,
            simulation.len(),
            simulation.step_index(),
            session.schedule.total,
            simulation.time_s(),
        ),
        format!("results: {}", session.folder.path().display()),
    ];
    if ending != Ending::Complete {
        lines.push(format!(
            "stopped before the end; continue with --resume {}",
            session.checkpoint_path().display()
        ));
    }
    let verdict = tell_intervals(session, ending);
    Outcome { folder: session.folder.path().to_path_buf(), lines, verdict }
}

/// Logs how often the field was evaluated, and the error of the forces between evaluations: as a warning
/// where an interval exceeds the tolerance, as a failure where the whole run does. Part of a run may still
/// become a good one.
fn tell_intervals(session: &Session<'_>, ending: Ending) -> Result<(), Failure> {
    let intervals = session.simulation.intervals().filter(|intervals| intervals.checked_steps > 0);
    let Some((intervals, field)) = intervals.zip(session.scene.electric_field.as_ref()) else {
        return Ok(());
    };
    let (error, worst, tolerance) = (intervals.error(), intervals.largest_error, field.field.tolerance);
    let text = format!(
        "electric field: evaluated {} times in {} steps; relative error of the forces by the forecasts \
         between {error:.2e}, over the worst interval {worst:.2e}",
        intervals.evaluations,
        session.simulation.step_index(),
    );
    if worst <= tolerance {
        tracing::info!("{text}");
        return Ok(());
    }
    tracing::warn!("{text}, above the tolerance {tolerance:e}");
    if error <= tolerance || ending != Ending::Complete {
        return Ok(());
    }
    Err(Failure::outside_tolerance(format!(
        "the forecasts of the electric field made an error of {error:.2e} of the forces, above the tolerance \
         {tolerance:e}; the results are written; set electric_field.coupling_interval to \"auto\" or to \
         fewer steps, or allow for it with electric_field.tolerance"
    )))
}

/// Logs the momentum that gas and grains have exchanged, and the time of the exchanges.
fn tell_gas(simulation: &Simulation) {
    if let Some(exchange) = simulation.gas_exchange() {
        let (seconds, given) = (exchange.seconds(), exchange.booked());
        tracing::info!(
            "gas: gave the grains {:.3e} N s of momentum by drag and lift; exchanges took {:.1} s for the \
             flow, {:.1} s for the mapping, {:.1} s for sending and receiving",
            given.norm(),
            seconds.solver,
            seconds.mapping,
            seconds.wire
        );
        let extremes = exchange.extremes();
        tracing::info!(
            "gas: {} exchanges in {} steps of the flow, up to {} for one, Courant number up to {:.2}; void \
             fraction of cells down to {:.3}, drag up to {:.3e} kg/(m3 s)",
            extremes.exchanges,
            extremes.steps,
            extremes.most_steps,
            extremes.courant,
            extremes.least_void,
            extremes.most_drag
        );
    }
}

/// Logs what feeds have brought, as a warning where they owe some.
fn tell_feeds(simulation: &Simulation) {
    for FeedAccount { name, fed, owed } in simulation.feeds() {
        let text = format!(
            "feed \"{name}\": {} grains came, {:.4e} kg with {:.3e} C",
            fed.grains, fed.mass, fed.charge
        );
        if owed.grains > 0 {
            tracing::warn!(
                "{text}; {} grains, {:.4e} kg, were due and found no place: make its region larger, its rate \
                 smaller or its grains faster",
                owed.grains,
                owed.mass
            );
        } else {
            tracing::info!("{text}");
        }
    }
}

/// Logs the charge that was moved by charge transfer.
fn tell_charges(simulation: &Simulation) {
    if let Some(ledger) = simulation.ledger() {
        let walls: f64 = ledger.walls.iter().sum();
        tracing::info!(
            "charge transfer: {:.3e} C moved at contacts, {walls:.3e} C given to walls",
            ledger.moved
        );
    }
}

/// Logs how often the electric force was limited, as a warning where that changes the physics.
fn warn_about_limits(session: &Session<'_>, first: u64) {
    let simulation = &session.simulation;
    let steps = simulation.step_index();
    let Some(limited) = simulation.limited().filter(|limited| limited.steps > 0 && steps > first) else {
        return;
    };
    #[expect(clippy::cast_precision_loss, reason = "a share for the eye")]
    let share = limited.steps as f64 / steps as f64;
    let text = format!(
        "the electric force was limited in {} of {steps} steps ({} grains at the end, \
         largest force {:e} N before the limit)",
        limited.steps, limited.grains, limited.largest_force_n
    );
    if share > LIMITED_SHARE {
        tracing::warn!(
            "{text}: the limiter changes the physics of this run; use a smaller step_s or a larger factor"
        );
    } else {
        tracing::info!("{text}");
    }
}
