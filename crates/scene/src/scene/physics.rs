//! Part of a scene that decides its physics: a run goes on from a checkpoint where that is the same.

use crate::source::SceneSource;
use crate::tree::Entries;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Keys that decide nothing of the physics: outputs, the end of a run, how a solver is run, what chooses
/// parameters that a checkpoint has.
const TECHNICAL: [&str; 13] = [
    "output",
    "time.end_s",
    "time.allow_unstable",
    "electric_field.tuning",
    "electric_field.far_tolerance",
    "solver.application",
    "solver.hosts",
    "solver.on_solver_loss",
    "solver.ranks",
    "solver.start",
    "solver.timeout_s",
    "solver.wait_s",
    "solver.openfoam_case",
];
/// Flow of a gas that a solver computes, and the key of how many ranks this has.
const OF_SOLVER: &str = "solver";
const RANKS: &str = "solver.ranks";
/// Keys whose values are names of files: their contents count instead.
const FILES: [&str; 6] = [
    "particles.file",
    "particles.from",
    "particles.generate.charge_C.from_file",
    "electric_field.external_field_V_m.table",
    "stl",
    "table",
];
/// Section of where grains come from, and its key that decides more than that.
const PARTICLES: &str = "particles.";
const FIXED_GROUPS: &str = "particles.fixed_groups";
/// Section of grains that come later, by a clock that begins anew.
const FEEDS: &str = "feeds[";
/// Ends of the keys of what changes by a clock.
const CLOCKS: [&str; 2] = ["frequency_Hz", "table"];
/// Differences that a message names at most.
const MOST_NAMED: usize = 5;

/// Part of a scene that decides its physics: keys with their values, and fingerprints of the files that they
/// name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Physics {
    keys: BTreeMap<String, String>,
    files: Vec<(String, u64)>,
}

impl Physics {
    /// Physics of a scene's keys and of the files that were read.
    pub(super) fn new(entries: &Entries, source: &SceneSource) -> Self {
        let mut keys = BTreeMap::new();
        for (section, node) in entries {
            flatten(section.clone(), &node.to_toml(), &mut keys);
        }
        // The state of a flow is known rank by rank.
        let flows = keys.get("gas.flow").is_some_and(|flow| flow.contains(OF_SOLVER));
        keys.retain(|key, _| (!is_technical(key) || (flows && key == RANKS)) && !names_a_file(key));
        Self { keys, files: source.fingerprints().to_vec() }
    }

    /// Differences from the physics of an earlier scene, each with both values; empty where there are none.
    #[must_use]
    pub fn changes_since(&self, earlier: &Self) -> Vec<String> {
        let mut changes: Vec<String> = Vec::new();
        for (key, value) in &self.keys {
            match earlier.keys.get(key) {
                Some(before) if before == value => {}
                Some(before) => changes.push(format!("{key} is {value} and was {before}")),
                None => changes.push(format!("{key} is {value} and was not given")),
            }
        }
        let gone = earlier.keys.iter().filter(|(key, _)| !self.keys.contains_key(*key));
        changes.extend(gone.map(|(key, before)| format!("{key} is not given and was {before}")));
        if self.files.len() != earlier.files.len() {
            changes.push(format!("{} files are read and were {}", self.files.len(), earlier.files.len()));
        }
        let pairs = self.files.iter().zip(&earlier.files);
        let other = pairs.filter(|((_, now), (_, before))| now != before);
        changes.extend(other.map(|((name, _), _)| format!("{name} has other contents")));
        changes
    }
}

impl Physics {
    /// Whether a run of an earlier scene that begins anew here goes on as it did: the scenes differ in
    /// nothing but where grains come from, which is here the file of a fingerprint, and nothing but the
    /// grains has a clock.
    pub(super) fn goes_on_from(&self, earlier: &Self, print: u64) -> bool {
        let rest = |physics: &Self| {
            let keys = physics.keys.iter();
            let of_grains = |key: &str| key.starts_with(PARTICLES) && key != FIXED_GROUPS;
            let rest = keys.filter(|(key, _)| !of_grains(key));
            rest.map(|(key, value)| (key.clone(), value.clone())).collect::<Vec<_>>()
        };
        let known = |of: u64| of == print || earlier.files.iter().any(|(_, before)| *before == of);
        let has_clock = |key: &String| {
            key.starts_with(FEEDS)
                || key.contains("].motion")
                || CLOCKS.iter().any(|clock| key.ends_with(clock))
        };
        rest(self) == rest(earlier)
            && self.files.iter().all(|(_, of)| known(*of))
            && !self.keys.keys().any(has_clock)
    }
}

/// Text that names changes, and what may change.
pub(crate) fn told(changes: &[String]) -> String {
    let named = &changes[..changes.len().min(MOST_NAMED)];
    let more = match changes.len() - named.len() {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    format!(
        "{}{more}; restore that, or start a new run ([output], time.end_s, how a solver is run may change)",
        named.join("; ")
    )
}

/// Adds the values below a key, each with a key of its own.
fn flatten(key: String, value: &toml::Value, keys: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => {
            table.iter().for_each(|(inner, value)| flatten(format!("{key}.{inner}"), value, keys));
        }
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            let numbered = items.iter().enumerate();
            numbered.for_each(|(index, value)| flatten(format!("{key}[{index}]"), value, keys));
        }
        value => drop(keys.insert(key, value.to_string())),
    }
}

fn is_technical(key: &str) -> bool {
    let is_below = |rest: &str| rest.is_empty() || rest.starts_with(['.', '[']);
    TECHNICAL.iter().any(|technical| key.strip_prefix(technical).is_some_and(is_below))
}

fn names_a_file(key: &str) -> bool {
    let is_wall = |file: &str| key.starts_with("walls[") && key.ends_with(&format!("].{file}"));
    let is_face = key.starts_with("feeds[") && key.ends_with("].region.stl");
    let is_potential = key.starts_with("domain.boundary.") && key.ends_with(".potential_V.table");
    is_face || is_potential || FILES.iter().any(|file| key == *file || is_wall(file))
}
