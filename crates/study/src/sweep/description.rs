//! Description of a study: STUDY.toml.

use crate::StudyError;
use amberfield_scene::check_keys;
use amberfield_scene::keys::STUDY;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A study.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Name of the page, the pictures and the rows.
    pub name: String,
    /// Headline of the page.
    pub title: String,
    /// Number of times that every point is timed; all points of a problem take turns.
    #[serde(default = "three")]
    pub passes: usize,
    /// Evaluations of one turn go on for so long [s].
    #[serde(default = "tenth")]
    pub least_s: f64,
    /// Grains up to which the truth is the direct sum.
    #[serde(default = "ten_thousand")]
    pub direct_up_to: usize,
    /// Problems that are computed.
    #[serde(default)]
    pub problems: Vec<Problem>,
    /// Methods that compute them.
    #[serde(default)]
    pub methods: Vec<Method>,
    /// Whole runs.
    #[serde(default)]
    pub motions: Vec<Motion>,
    /// Scenes pushed to an end.
    #[serde(default)]
    pub extremes: Vec<Extreme>,
    /// Goals: results that should come out.
    #[serde(default)]
    pub goals: Vec<Goal>,
}

/// Charges in a box, or a cavity.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Problem {
    /// Name in the report.
    pub name: String,
    /// Scene file, beside the study.
    pub scene: PathBuf,
    /// Overrides of the scene, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// One key with several values: a problem for each.
    pub sweep: Option<Sweep>,
    /// Source of the truth.
    #[serde(default)]
    pub truth: Truth,
}

/// Source of a problem's exact field.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Truth {
    /// The direct sum, or for many grains a much tighter p3m, in the scene's own box without a field solver.
    #[default]
    Box,
    /// Charges in a grounded sphere: Kelvin's images.
    GroundedSphere {
        /// Centre [m].
        centre_m: [f64; 3],
        /// Radius [m].
        radius_m: f64,
    },
    /// Grains in grounded boxes that do not see each other, such as both sides of a plate: as for `box`, in
    /// the box that each grain is in.
    GroundedBoxes(Vec<GroundedBox>),
    /// Field of the scene with more overrides, `KEY=VALUE`: a finer mesh and a smaller tolerance.
    Finer(Vec<String>),
}

/// Grounded box.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct GroundedBox {
    /// Lower corner [m].
    pub min_m: [f64; 3],
    /// Upper corner [m].
    pub max_m: [f64; 3],
}

/// A method with its parameters.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Name in the report.
    pub name: String,
    /// Overrides of the scene, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// One key with several values: a point for each.
    pub sweep: Option<Sweep>,
    /// Another program, by the name that the laboratory knows it by; the sweep's values are tolerances then.
    pub program: Option<String>,
    /// Problems that it is used on; all if it is absent.
    pub problems: Option<Vec<String>>,
    /// Grains beyond which it is left out.
    pub most_grains: Option<usize>,
    /// Relative RMS error above which the study fails. Methods that promise a tolerance must keep it anyway.
    pub most_error: Option<f64>,
}

/// A run with settings that are compared with much finer ones.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Name in the report.
    pub name: String,
    /// Scene file, beside the study.
    pub scene: PathBuf,
    /// Overrides of the scene, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// More overrides, which make the reference.
    pub reference: Vec<String>,
    /// A key, such as the seed, whose values give replicas of the reference.
    pub replicas: Option<Sweep>,
    /// Overrides on top of the reference's, each a run or several.
    pub variants: Vec<Method>,
}

/// A scene pushed to an end, and what should become of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extreme {
    /// Name of what is pushed to its end.
    pub name: String,
    /// Expectation in words.
    pub expect: String,
    /// Scene file, beside the study.
    pub scene: PathBuf,
    /// Overrides of the scene, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// One key with several values: a run for each.
    pub sweep: Option<Sweep>,
    /// End of the command that is expected.
    #[serde(default)]
    pub ends: Ends,
    /// Words that the command's last message should contain.
    pub says: Option<String>,
    /// Most that the energy rises above that at the start, over the largest that is turned over.
    pub most_gain: Option<f64>,
    /// Most that it falls below, likewise.
    pub most_loss: Option<f64>,
    /// Most kinetic energy per grain at the end [J].
    pub most_kinetic_j: Option<f64>,
    /// Most relative RMS error of E at the grains against the direct sum; the field of the scene is
    /// evaluated then, and nothing moves.
    pub most_error: Option<f64>,
    /// Most change of the charge of grains and walls over the sizes of all charges; round-off unless grains
    /// may leave.
    #[serde(default = "round_off")]
    pub most_charge: f64,
    /// Whether forces should be limited.
    pub limited: Option<bool>,
    /// Longest time that it may take [s].
    #[serde(default = "two_minutes")]
    pub most_s: f64,
}

impl Extreme {
    /// The command that it is about.
    #[must_use]
    pub fn command(&self) -> &'static str {
        if self.most_error.is_some() { "field" } else { "run" }
    }
}

/// End of a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// The command did all that was asked for.
    #[default]
    Well,
    /// The scene was refused as bad input before anything ran.
    Refused,
    /// The answer was outside its tolerance, or the motion was no longer sound.
    Unsound,
}

impl Ends {
    /// The exit code.
    pub(super) fn code(self) -> i32 {
        match self {
            Self::Well => 0,
            Self::Refused => 2,
            Self::Unsound => 4,
        }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Well => "well",
            Self::Refused => "refused",
            Self::Unsound => "unsound",
        }
    }

    /// An exit code in words.
    pub(super) fn told(code: Option<i32>) -> String {
        let known = [Self::Well, Self::Refused, Self::Unsound];
        match known.into_iter().find(|ends| Some(ends.code()) == code) {
            Some(ends) => ends.word().to_owned(),
            None => code.map_or_else(|| "did not end".to_owned(), |code| format!("code {code}")),
        }
    }
}

/// Goal of a study. Exactly one of `times_less`, `times_as_fast` and `at_most` says what should come out.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// The goal in words.
    pub text: String,
    /// Method that it is about.
    pub method: String,
    /// One value of its sweep; all if it is absent.
    pub value: Option<String>,
    /// Problems; all if it is absent.
    pub problems: Option<Vec<String>>,
    /// Factor by which the best error with a promise is smaller in the method's time.
    pub times_less: Option<f64>,
    /// Factor by which the fastest with a promise is faster at the method's error.
    pub times_as_fast: Option<f64>,
    /// The method's time on the first problem is at most `at_most` times that on the second.
    pub price: Option<[String; 2]>,
    /// See `price`.
    pub at_most: Option<f64>,
    /// Attempts so far, and what would be next; the page says so where the goal is missed.
    pub tried: Option<String>,
}

impl Goal {
    /// Whether it is about a problem.
    pub(super) fn is_about(&self, problem: &String) -> bool {
        self.problems.as_ref().is_none_or(|problems| problems.contains(problem))
    }
}

/// A key and its values.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Key of the scene, as in `--set`.
    pub key: String,
    /// Values of the key.
    pub values: Vec<toml::Value>,
    /// Factor of the numbers among the values: a diameter, a cell.
    pub times: Option<f64>,
}

fn three() -> usize {
    3
}

fn tenth() -> f64 {
    0.1
}

fn round_off() -> f64 {
    1e-12
}

fn two_minutes() -> f64 {
    120.0
}

fn ten_thousand() -> usize {
    10_000
}

impl Study {
    /// Reads a study.
    ///
    /// # Errors
    /// A file that cannot be read or is no study: unknown or missing keys, empty sweeps, unknown problems'
    /// names.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| StudyError::Read { path: path.to_owned(), source })?;
        let bad = |reason: String| StudyError::Description { path: path.to_owned(), reason };
        check_keys(&path.display().to_string(), &text, STUDY).map_err(|error| bad(error.to_string()))?;
        let study: Self = toml::from_str(&text).map_err(|error| bad(error.to_string()))?;
        study.check().map_err(bad)?;
        Ok(study)
    }

    fn check(&self) -> Result<(), String> {
        if self.name.is_empty() || self.name.contains(['/', '\\', '.']) {
            return Err(format!("name = {:?}: files are named after it; give a word", self.name));
        }
        if self.passes == 0 {
            return Err("passes = 0: nothing would be timed; give 1 or more".to_owned());
        }
        if !(self.least_s >= 0.0 && self.least_s < 3600.0) {
            return Err(format!("least_s = {}: give seconds from 0 to 3600", self.least_s));
        }
        let points = !self.problems.is_empty() && !self.methods.is_empty();
        if !points && self.motions.is_empty() && self.extremes.is_empty() {
            return Err(
                "a study needs [[problems]] and [[methods]], or [[motions]], or [[extremes]]; add at least \
                 one of each"
                    .to_owned(),
            );
        }
        let of_problems = self.problems.iter().map(|problem| &problem.sweep);
        let of_methods = self.methods.iter().map(|method| &method.sweep);
        let sweeps = of_problems.chain(of_methods).chain(self.extremes.iter().map(|extreme| &extreme.sweep));
        let of_motion = |m: &'_ Motion| {
            std::iter::once(m.replicas.clone())
                .chain(m.variants.iter().map(|v| v.sweep.clone()))
                .collect::<Vec<_>>()
        };
        if self.motions.iter().flat_map(of_motion).flatten().any(|sweep| sweep.values.is_empty()) {
            return Err("a sweep of [[motions]] has no values; give some or remove it".to_owned());
        }
        if let Some(sweep) = sweeps.flatten().find(|sweep| sweep.values.is_empty()) {
            return Err(format!("sweep over {}: no values; give some or remove it", sweep.key));
        }
        let lost = |method: &&Method| method.program.is_some() && method.sweep.is_none();
        if let Some(method) = self.methods.iter().find(lost) {
            return Err(format!("method {}: another program needs a sweep over its tolerances", method.name));
        }
        let vague = |goal: &&Goal| {
            let wanted = [goal.times_less, goal.times_as_fast, goal.at_most];
            wanted.iter().flatten().count() != 1 || goal.at_most.is_some() != goal.price.is_some()
        };
        if let Some(goal) = self.goals.iter().find(vague) {
            return Err(format!(
                "goal {:?}: give one of times_less, times_as_fast, at_most, the last with price = \
                 [\"dear\", \"cheap\"]",
                goal.text
            ));
        }
        let known = |name: &String| self.problems.iter().any(|problem| problem.name == *name);
        for method in &self.methods {
            if let Some(name) = method.problems.iter().flatten().find(|name| !known(name)) {
                return Err(format!("method {}: there is no problem named {name:?}", method.name));
            }
        }
        Ok(())
    }
}

impl Sweep {
    /// The overrides of all values, and how the report shows each; one empty list without a sweep.
    pub(super) fn overrides(sweep: Option<&Self>) -> Vec<(Vec<String>, String)> {
        let Some(Self { key, values, times }) = sweep else { return vec![(Vec::new(), String::new())] };
        let shown = |value: &toml::Value| match value.as_float() {
            Some(number) if number != 0.0 && !(1e-2..1e4).contains(&number.abs()) => format!("{number:e}"),
            _ => value.to_string(),
        };
        let scaled = |value: &toml::Value| {
            let number = value.as_float().or_else(|| value.as_integer().map(|value| value as f64));
            number
                .zip(*times)
                .map_or_else(|| value.to_string(), |(number, times)| (number * times).to_string())
        };
        values.iter().map(|value| (vec![format!("{key}={}", scaled(value))], shown(value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<(), String> {
        toml::from_str::<Study>(text).map_err(|error| error.to_string())?.check()
    }

    #[test]
    fn bad_studies_are_refused_with_a_reason() {
        let problem = "[[problems]]\nname = 'a'\nscene = 'a.toml'\n";
        let method = "[[methods]]\nname = 'p3m'\n";
        assert_eq!(parsed(&format!("name = 'n'\ntitle = 't'\n{problem}{method}")), Ok(()));
        for (text, reason) in [
            (format!("title = 't'\npasses = 0\n{problem}{method}"), "passes = 0"),
            (format!("title = 't'\n{problem}{method}sweep = {{ key = 'x', values = [] }}\n"), "no values"),
            (format!("title = 't'\n{problem}{method}problems = ['b']\n"), "no problem named"),
            (format!("title = 't'\n{problem}{method}colour = 1\n"), "unknown field `colour`"),
            (format!("title = 't'\nmethods = []\n{problem}"), "[[methods]]"),
        ] {
            let error = parsed(&format!("name = 'n'\n{text}")).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
    }

    #[test]
    fn sweeps_are_overrides_of_the_scene() {
        let sweep: Sweep = toml::from_str("key = 'electric_field.tolerance'\nvalues = [1e-2, 3]").unwrap();
        let overrides: Vec<_> =
            Sweep::overrides(Some(&sweep)).into_iter().map(|(set, _)| set[0].clone()).collect();
        assert_eq!(overrides, ["electric_field.tolerance=0.01", "electric_field.tolerance=3"]);
    }
}
