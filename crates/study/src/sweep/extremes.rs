//! Scenes pushed to an end, each with what should become of it: whether that is so, by a rule.

use super::description::{Ends, Extreme, Study, Sweep};
use super::laboratory::{Endured, Laboratory, Look, Provenance};
use super::points::command;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Looks at the energy that are kept of a run.
const LOOKS: usize = 200;

/// Outcome of a scene, as it stands in the CSV.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ExtremeRow {
    /// Day of the run.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// Processor.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// Name of what is pushed to its end.
    pub extreme: String,
    /// Value of the swept key.
    pub value: String,
    /// End of the command: `well`, `refused`, `unsound`, or another code.
    pub ended: String,
    /// Last message of the command, if it did not end well.
    pub said: String,
    /// Wall-clock time [s].
    pub seconds: f64,
    /// Largest rise of the energy above that at the start, over the largest that was turned over.
    pub gain: Option<f64>,
    /// Largest loss likewise.
    pub loss: Option<f64>,
    /// Largest change of the charge of grains and walls over the sizes of all charges.
    pub charge_drift: Option<f64>,
    /// Kinetic energy per grain at the end [J].
    pub kinetic_j: Option<f64>,
    /// Grains whose force was limited.
    pub limited: Option<u64>,
    /// Relative RMS error of E against the direct sum.
    pub error: Option<f64>,
    /// Expectations that were not met; empty if all were.
    pub broken: String,
    /// Command that repeats it.
    pub command: String,
}

/// A look at the energy of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRow {
    /// Name of what is pushed to its end.
    pub extreme: String,
    /// Value of the swept key.
    pub value: String,
    /// Time [s].
    pub time_s: f64,
    /// Change of the energy since the start, over the largest that was turned over.
    pub change: f64,
}

/// Sends every extreme of a study through the commands; `done` hears of each.
pub fn run_extremes<L: Laboratory>(
    study: &Study,
    folder: &Path,
    laboratory: &mut L,
    mut done: impl FnMut(&ExtremeRow, &[EnergyRow]),
) {
    let provenance = laboratory.provenance();
    for extreme in &study.extremes {
        let scene = folder.join(&extreme.scene);
        for (swept, value) in Sweep::overrides(extreme.sweep.as_ref()) {
            let set = [&extreme.set[..], &swept].concat();
            let endured = laboratory.endure(&scene, &set, extreme);
            let row = judged(extreme, &endured, row(&provenance, extreme, &scene, &set, value));
            done(&row, &energies(&row, &endured.looks));
        }
    }
}

fn row(
    provenance: &Provenance,
    extreme: &Extreme,
    scene: &Path,
    set: &[String],
    value: String,
) -> ExtremeRow {
    ExtremeRow {
        date: provenance.date.clone(),
        version: provenance.version.clone(),
        processor: provenance.processor.clone(),
        threads: provenance.threads,
        extreme: extreme.name.clone(),
        value,
        command: command(extreme.command(), scene, set),
        ..ExtremeRow::default()
    }
}

/// The largest energy that was turned over [J]: kinetic, and what left or entered the rest.
fn turned_over(looks: &[Look]) -> f64 {
    let first = looks.first().map_or(0.0, |look| look.potential_j);
    let one = |look: &Look| look.kinetic_j.max((look.potential_j - first).abs());
    looks.iter().map(one).fold(0.0, f64::max)
}

fn change(look: &Look, looks: &[Look]) -> f64 {
    let scale = turned_over(looks);
    if scale == 0.0 { 0.0 } else { (look.total_j() - looks[0].total_j()) / scale }
}

fn energies(row: &ExtremeRow, looks: &[Look]) -> Vec<EnergyRow> {
    let every = looks.len().div_ceil(LOOKS).max(1);
    let one = |look: &Look| EnergyRow {
        extreme: row.extreme.clone(),
        value: row.value.clone(),
        time_s: look.time_s,
        change: change(look, looks),
    };
    looks.iter().step_by(every).map(one).collect()
}

/// Fills in what was seen, and what of it is not as expected.
fn judged(extreme: &Extreme, endured: &Endured, row: ExtremeRow) -> ExtremeRow {
    let looks = &endured.looks[..];
    let changes = || looks.iter().map(|look| change(look, looks));
    let of_looks = |value: f64| (!looks.is_empty()).then_some(value);
    let charges = looks.iter().map(|look| (look.charge_c - looks[0].charge_c).abs()).fold(0.0, f64::max);
    let row = ExtremeRow {
        ended: Ends::told(endured.code),
        said: endured.said.clone(),
        seconds: endured.seconds,
        gain: of_looks(changes().fold(0.0, f64::max)),
        loss: of_looks(changes().map(|change| -change).fold(0.0, f64::max)),
        charge_drift: (endured.charges_c > 0.0).then(|| of_looks(charges / endured.charges_c)).flatten(),
        kinetic_j: looks.last().map(|look| look.kinetic_j / endured.grains.max(1) as f64),
        limited: looks.iter().filter_map(|look| look.limited).max(),
        error: endured.error,
        ..row
    };
    ExtremeRow { broken: broken(extreme, endured, &row).join("; "), ..row }
}

fn broken(extreme: &Extreme, endured: &Endured, row: &ExtremeRow) -> Vec<String> {
    let mut broken = Vec::new();
    if endured.code != Some(extreme.ends.code()) {
        broken.push(format!("ended {}, not {}: {}", row.ended, extreme.ends.word(), row.said));
    }
    if let Some(words) = extreme.says.as_ref().filter(|words| !endured.said.contains(words.as_str())) {
        broken.push(format!("does not say {words:?} but {:?}", endured.said));
    }
    let bounds = [
        ("gain of energy", row.gain, extreme.most_gain),
        ("loss of energy", row.loss, extreme.most_loss),
        ("kinetic energy per grain [J]", row.kinetic_j, extreme.most_kinetic_j),
        ("error of the field", row.error, extreme.most_error),
        ("change of the charge", row.charge_drift, Some(extreme.most_charge)),
        ("seconds", Some(row.seconds), Some(extreme.most_s)),
    ];
    for (what, found, most) in bounds {
        match (found, most) {
            (Some(found), Some(most)) if found.is_nan() || found > most => {
                broken.push(format!("{what} {found:.2e} above {most:e}"));
            }
            (None, Some(_)) if what != "change of the charge" && extreme.ends == Ends::Well => {
                broken.push(format!("{what}: nothing was written"));
            }
            _ => (),
        }
    }
    let limited = row.limited.unwrap_or(0);
    if extreme.limited.is_some_and(|wanted| wanted != (limited > 0)) {
        broken.push(format!("{limited} grains were limited"));
    }
    broken
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(time_s: f64, kinetic_j: f64, potential_j: f64, charge_c: f64) -> Look {
        Look { time_s, kinetic_j, potential_j, charge_c, limited: None }
    }

    fn verdict(extreme: &str, endured: &Endured) -> String {
        let extreme: Extreme =
            toml::from_str(&format!("name = 'n'\nexpect = 'e'\nscene = 's'\n{extreme}")).unwrap();
        judged(&extreme, endured, ExtremeRow::default()).broken
    }

    #[test]
    fn what_is_not_as_expected_is_named() {
        let swing = Endured {
            code: Some(0),
            grains: 1,
            charges_c: 1.0,
            looks: vec![look(0.0, 0.0, 5.0, 1.0), look(1.0, 2.0, 3.02, 1.0), look(2.0, 0.5, 4.4, 1.0 + 1e-9)],
            ..Endured::default()
        };
        let calm = Endured { looks: swing.looks[..2].to_vec(), ..swing.clone() };
        assert_eq!(verdict("most_gain = 0.011", &calm), "");
        assert!(verdict("most_gain = 0.009", &calm).starts_with("gain of energy 1.0"));
        assert!(verdict("", &swing).starts_with("change of the charge"));
        assert!(verdict("ends = 'refused'", &calm).starts_with("ended well, not refused"));
        assert!(verdict("limited = true", &calm).starts_with("0 grains"));
        assert!(verdict("most_error = 0.1", &calm).contains("nothing was written"));
        let refused = Endured { code: Some(2), said: "no grains".to_owned(), ..Endured::default() };
        assert_eq!(verdict("ends = 'refused'\nsays = 'grains'\nmost_gain = 1", &refused), "");
        assert!(verdict("ends = 'refused'\nsays = 'walls'", &refused).contains("does not say"));
        assert!(verdict("", &Endured { code: None, ..calm }).contains("did not end"));
    }
}
