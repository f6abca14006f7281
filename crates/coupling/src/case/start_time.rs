//! Times of a case, and the one from which its solver starts, as OpenFOAM chooses it.

use super::dictionary::entry;
use super::unusable;
use crate::CouplingError;
use std::path::Path;

/// Folder whose name is a number: a time of a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TimeFolder {
    /// Time [s], in the unit of the case.
    pub(super) value: f64,
    /// Name of the folder.
    pub(super) name: String,
}

/// Folders of times in a case, in ascending order.
pub(super) fn times(case: &Path) -> Result<Vec<TimeFolder>, CouplingError> {
    let entries = std::fs::read_dir(case).map_err(|error| unusable(case, error))?;
    let names = entries.flatten().filter(|entry| entry.path().is_dir());
    let time = |name: String| {
        let begins = name.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let value = name.parse().ok().filter(|value: &f64| begins && value.is_finite())?;
        Some(TimeFolder { value, name })
    };
    let mut times: Vec<TimeFolder> =
        names.filter_map(|entry| time(entry.file_name().into_string().ok()?)).collect();
    times.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(times)
}

/// Times up to the one from which a case starts, which comes last: what is not there is looked for in those
/// before.
pub(super) fn times_up_to_start(case: &Path) -> Result<Vec<TimeFolder>, CouplingError> {
    let times = times(case)?;
    let start = match entry(case, "system/controlDict", "startFrom")?.as_deref() {
        Some("startTime") => {
            let said = entry(case, "system/controlDict", "startTime")?.unwrap_or_default();
            let value: f64 = said.parse().map_err(|_| {
                let problem = format!("startTime is \"{said}\", no number; give the time to start from");
                unusable(&case.join("system/controlDict"), problem)
            })?;
            Some(value)
        }
        Some("firstTime") => times.first().map(|time| time.value),
        None | Some("latestTime") => times.last().map(|time| time.value),
        Some(other) => {
            let problem = format!("startFrom is {other}; OpenFOAM knows startTime, firstTime and latestTime");
            return Err(unusable(&case.join("system/controlDict"), problem));
        }
    };
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-9);
    let start = start.and_then(|value| times.iter().rposition(|time| same(time.value, value)));
    if let Some(start) = start {
        return Ok(times[..=start].to_vec());
    }
    let there: Vec<&str> = times.iter().map(|time| time.name.as_str()).collect();
    let problem = match (there.is_empty(), case.join("0.orig").is_dir()) {
        (true, true) => "has no folder of the start time; copy 0.orig to 0".to_owned(),
        (true, false) => "has no folder of the start time, 0; its fields are missing".to_owned(),
        (false, _) => format!(
            "has no folder of the time that startFrom and startTime in system/controlDict ask for; it has {}",
            there.join(", ")
        ),
    };
    Err(unusable(case, problem))
}

/// Whether a case is known to lack a field of a name at the time from which its solver starts, and before.
/// A case whose start is not found, or not plain text, may have it: OpenFOAM's own programs say more of it.
#[must_use]
pub fn lacks_field(case: &Path, name: &str) -> bool {
    let Ok(times) = times_up_to_start(case) else { return false };
    let folders = times.iter().map(|time| time.name.as_str()).chain(["constant"]);
    let is_in =
        |folder: &str| ["", ".gz"].iter().any(|end| case.join(folder).join(format!("{name}{end}")).is_file());
    !folders.into_iter().any(is_in)
}
