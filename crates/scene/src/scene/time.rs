//! Section `[time]`.

use crate::SceneError;
use crate::table::SceneTable;
use amberfield_core::{OnExit, Skin, Step, TimeSettings};
use nalgebra::Vector3;

/// Largest number of steps of a run, which a double holds exactly.
const MOST_STEPS: f64 = 9e15;
/// Gravity [m/s²] of a scene that gives none.
const NO_GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

/// Reads `[time]`. `on_exit` and `allow_overlap` come from `[particles]`.
pub(super) fn read_time(
    document: &SceneTable<'_>,
    on_exit: OnExit,
    allow_overlap: bool,
) -> Result<Option<TimeSettings>, SceneError> {
    let Some(table) = document.table("time")? else { return Ok(None) };
    let step = match table.number_or_auto("step_s")? {
        Some(Some(seconds)) => Step::Seconds(seconds),
        Some(None) => Step::Auto,
        None => return Err(table.missing("step_s", "give the step in seconds, or \"auto\"")),
    };
    let end_s = table.need_number("end_s")?;
    if let Step::Seconds(seconds) = step {
        if seconds > end_s {
            return Err(table.bad("step_s", format!("longer than the run of {end_s} s; give a smaller step")));
        }
        if end_s / seconds > MOST_STEPS {
            return Err(table
                .bad("step_s", format!("more than {MOST_STEPS:e} steps to {end_s} s; give a larger step")));
        }
    }
    Ok(Some(TimeSettings {
        step,
        end_s,
        gravity_m_s2: table.vector("gravity_m_s2")?.unwrap_or(NO_GRAVITY),
        skin: table.number_or_auto("skin_m")?.flatten().map_or(Skin::Auto, Skin::Metres),
        allow_unstable: table.boolean("allow_unstable")?.unwrap_or(false),
        on_exit,
        allow_overlap,
    }))
}
