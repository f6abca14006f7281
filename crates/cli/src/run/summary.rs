//! File `summary.json`.

use super::session::Session;
use super::setup::parameters;
use crate::failure::Failure;
use crate::machine;
use amberfield_dem::{Book, Energies, Tally};
use amberfield_scene::write_json;
use serde_json::{Map, Value, json};

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// End at `end_s`.
    Complete,
    /// End after the number of steps that was asked for.
    Steps,
    /// Stop by the user.
    Interrupted,
    /// Stop by an error.
    Failed,
}

impl Ending {
    fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Steps => "steps",
            Self::Interrupted => "interrupted",
            Self::Failed => "failed",
        }
    }
}

/// Energies as JSON.
fn energies(energies: &Energies) -> Value {
    json!({
        "kinetic_J": energies.kinetic,
        "contact_J": energies.contact,
        "gravity_J": energies.gravity,
        "electric_J": energies.electric,
    })
}

/// Books as JSON: of all grains, by material, by feed and by outlet.
fn books(session: &Session<'_>, books: &[Book]) -> Value {
    let tally = |tally: &Tally| json!({ "grains": tally.grains, "kg": tally.mass, "C": tally.charge });
    let book = |book: &Book| {
        json!({
            "start": tally(&book.start),
            "fed": tally(&book.fed),
            "left": tally(&book.left),
            "inside": tally(&book.inside),
            "gained_C": book.gained,
        })
    };
    let materials = session.scene.materials.iter().zip(books);
    let materials: Map<String, Value> =
        materials.map(|(material, of)| (material.name.clone(), book(of))).collect();
    let feeds = session.simulation.feeds().into_iter();
    let feeds: Map<String, Value> = feeds
        .map(|feed| (feed.name, json!({ "fed": tally(&feed.fed), "owed": tally(&feed.owed) })))
        .collect();
    let mut all = json!({ "all": book(&Book::sum(books)), "materials": materials });
    if !feeds.is_empty() {
        all["feeds"] = Value::Object(feeds);
    }
    let outlets = session.scene.outlets.iter().zip(session.simulation.outlets());
    let outlets: Map<String, Value> = outlets
        .map(|(outlet, tallies)| {
            let names = session.scene.materials.iter().map(|material| material.name.clone());
            let mut of = tally(&Tally::sum(tallies));
            of["materials"] = names.zip(tallies.iter().map(tally)).collect();
            (outlet.name.clone(), of)
        })
        .collect();
    if !outlets.is_empty() {
        all["outlets"] = Value::Object(outlets);
    }
    all
}

/// Writes the summary of a run that began at step `first` with energies `before`.
pub(crate) fn write_summary(
    session: &mut Session<'_>,
    first: u64,
    before: &Energies,
    ending: Ending,
    error: Option<&str>,
) -> Result<(), Failure> {
    let after = if ending == Ending::Failed { None } else { Some(session.energies()?) };
    let clock = session.clock();
    let simulation = &session.simulation;
    let steps = simulation.step_index() - first;
    // The rate is that of this part of the run, without earlier ones.
    let seconds = clock.wall_s - session.earlier.wall_s;

    let stages: Map<String, Value> = simulation
        .stage_seconds()
        .iter()
        .zip(&clock.stages)
        .map(|((name, _), seconds)| ((*name).to_owned(), json!(seconds)))
        .collect();
    let field = simulation.field().map(|field| {
        json!({
            "parameters": parameters(field.choice()),
            "error_estimated": field.error_estimated(),
            "error_measured": field.error_measured().map(|measured| measured.relative_rms),
            "memory_bytes": field.memory_bytes(),
        })
    });
    let guards: Map<String, Value> =
        simulation.guards().iter().map(|guard| (guard.name.to_owned(), json!(guard.limit_s))).collect();
    #[expect(clippy::cast_precision_loss, reason = "a rate for the eye")]
    let summary = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "ending": ending.name(),
        "error": error,
        "grains": simulation.len(),
        "step": simulation.step_index(),
        "steps_of_the_run": session.schedule.total,
        "step_s": simulation.step_s(),
        "time_s": simulation.time_s(),
        "skin_m": simulation.skin_m(),
        "wall_s": clock.wall_s,
        "wall_s_stages": stages,
        "steps_per_s": if seconds > 0.0 { steps as f64 / seconds } else { 0.0 },
        "contacts": simulation.contacts(),
        "energies_at_start": energies(before),
        "energies_at_end": after.as_ref().map(energies),
        "books": simulation.books().map(|books| self::books(session, &books)),
        "field": field,
        "field_intervals": simulation.intervals().map(|intervals| json!({
            "evaluations": intervals.evaluations,
            "steps_now": intervals.steps_now,
            "error_measured": intervals.error(),
            "largest_error_measured": intervals.largest_error,
        })),
        "limited": simulation.limited().map(|limited| json!({
            "grains_now": limited.grains,
            "steps": limited.steps,
            "grain_steps": limited.grain_steps,
            "largest_force_N": limited.largest_force_n,
        })),
        "step_limits_s": guards,
        "threads": rayon::current_num_threads(),
        "cpu": machine::cpu_name(),
    });
    Ok(write_json(&session.folder.file("summary.json"), &summary)?)
}
