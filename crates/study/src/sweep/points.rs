//! Runs a study: truth, error, then time.

use super::description::{Method, Study, Sweep, Truth};
use super::laboratory::{Exact, Laboratory, Peer, Provenance};
use super::row::Row;
use amberfield_core::Vector3;
use amberfield_oracle::{ErrorNorms, grounded_cavity, rms};
use std::path::Path;
use std::time::Instant;

/// Measures every point, in the study's order; `done` hears of each problem's rows as soon as they are
/// there. `folder` is the study's.
pub fn run<L: Laboratory>(study: &Study, folder: &Path, laboratory: &mut L, mut done: impl FnMut(&[Row])) {
    let provenance = laboratory.provenance();
    for problem in &study.problems {
        for (swept, value) in Sweep::overrides(problem.sweep.as_ref()) {
            let set = [problem.set.clone(), swept].concat();
            let name =
                if value.is_empty() { problem.name.clone() } else { format!("{}, {value}", problem.name) };
            let setting = Setting {
                study,
                scene: &folder.join(&problem.scene),
                set: &set,
                name: &name,
                truth: &problem.truth,
                provenance: &provenance,
            };
            let methods = study.methods.iter().filter(|method| {
                method.problems.as_ref().is_none_or(|problems| problems.contains(&problem.name))
            });
            done(&setting.measure(laboratory, methods));
        }
    }
}

/// One problem.
struct Setting<'a> {
    study: &'a Study,
    scene: &'a Path,
    set: &'a [String],
    name: &'a str,
    truth: &'a Truth,
    provenance: &'a Provenance,
}

/// A point between its turns.
struct Point<L: Laboratory> {
    row: Row,
    running: Option<(L::Problem, L::Method)>,
    /// Median of each turn [s].
    turns: Vec<f64>,
}

impl Setting<'_> {
    fn measure<'m, L: Laboratory>(
        &self,
        laboratory: &mut L,
        methods: impl Iterator<Item = &'m Method>,
    ) -> Vec<Row> {
        let truth = laboratory.problem(self.scene, self.set).and_then(|problem| {
            let exact = self.exact(laboratory, &problem)?;
            Ok((problem, exact))
        });
        let (problem, exact) = match truth {
            Ok(truth) => truth,
            Err(reason) => return vec![Row { failure: format!("no truth: {reason}"), ..self.row() }],
        };
        let grains = laboratory.grains(&problem);
        let mut points: Vec<Point<L>> = Vec::new();
        for method in methods.filter(|method| method.most_grains.is_none_or(|most| grains <= most)) {
            for (swept, value) in Sweep::overrides(method.sweep.as_ref()) {
                let set = [self.set, &method.set[..], &swept].concat();
                let row = Row {
                    grains,
                    truth: exact.by.clone(),
                    method: method.name.clone(),
                    value,
                    allowed: method.most_error,
                    command: command("field", self.scene, &set),
                    ..self.row()
                };
                points.push(match &method.program {
                    None => checked(laboratory, self.scene, &set, &exact, row),
                    Some(program) => peer(laboratory, program, &problem, &exact, row),
                });
            }
        }
        for _ in 0..self.study.passes {
            for point in &mut points {
                point.take_a_turn(laboratory, self.study.least_s);
            }
        }
        points.into_iter().map(Point::finish).collect()
    }

    fn row(&self) -> Row {
        Row {
            date: self.provenance.date.clone(),
            version: self.provenance.version.clone(),
            processor: self.provenance.processor.clone(),
            threads: self.provenance.threads,
            problem: self.name.to_owned(),
            ..Row::default()
        }
    }

    fn exact<L: Laboratory>(&self, laboratory: &mut L, problem: &L::Problem) -> Result<Exact, String> {
        match self.truth {
            Truth::Box => laboratory.exact(problem, self.study.direct_up_to),
            Truth::GroundedBoxes(boxes) => laboratory.exact_in_boxes(problem, boxes, self.study.direct_up_to),
            Truth::Finer(finer) => {
                let mut problem = laboratory.problem(self.scene, &[self.set, finer].concat())?;
                let mut method = laboratory.method(&mut problem)?;
                laboratory.evaluate(&problem, &mut method)?;
                let e = laboratory.e(&method).to_vec();
                Ok(Exact { scale: rms(&e), e, by: format!("p3m with {}", finer.join(", ")) })
            }
            &Truth::GroundedSphere { centre_m, radius_m } => {
                let (positions, charges, coulomb) = laboratory.charges(problem);
                let from_centre: Vec<_> =
                    positions.iter().map(|position| position - Vector3::from(centre_m)).collect();
                let e = grounded_cavity(coulomb, radius_m, &from_centre, &charges);
                Ok(Exact { scale: rms(&e), e, by: "Kelvin's images".to_owned() })
            }
        }
    }
}

/// The command that repeats a point by hand.
pub(super) fn command(verb: &str, scene: &Path, set: &[String]) -> String {
    let set: String = set.iter().map(|set| format!(" --set '{set}'")).collect();
    format!("amberfield {verb} {}{set}", scene.display())
}

/// A point whose error is known, or its failure.
fn checked<L: Laboratory>(
    laboratory: &mut L,
    scene: &Path,
    set: &[String],
    exact: &Exact,
    mut row: Row,
) -> Point<L> {
    let built = laboratory.problem(scene, set).and_then(|mut problem| {
        let mut method = laboratory.method(&mut problem)?;
        let evaluation = laboratory.evaluate(&problem, &mut method)?;
        Ok((problem, method, evaluation))
    });
    let running = match built {
        Ok((problem, method, evaluation)) => {
            let e = laboratory.e(&method);
            let norms = ErrorNorms::new(e, &exact.e, exact.scale);
            row.error = Some(norms.relative_rms);
            row.p99 = Some(norms.p99);
            row.worst = Some(norms.worst);
            row.bias = Some(bias(e, &exact.e));
            row.estimated = evaluation.estimated;
            row.promised = evaluation.promised;
            row.memory_bytes = Some(evaluation.memory_bytes);
            row.pairs_per_grain = Some(evaluation.pairs_per_grain);
            row.parameters = evaluation.parameters;
            Some((problem, method))
        }
        Err(reason) => {
            row.failure = reason;
            None
        }
    };
    Point { row, running, turns: Vec::new() }
}

/// The point of another program, which times itself.
fn peer<L: Laboratory>(
    laboratory: &mut L,
    program: &str,
    problem: &L::Problem,
    exact: &Exact,
    mut row: Row,
) -> Point<L> {
    let tolerance = row.value.parse::<f64>().map_err(|error| format!("tolerance {}: {error}", row.value));
    match tolerance.and_then(|tolerance| laboratory.peer(program, problem, exact, tolerance)) {
        Ok(Peer { error, seconds, parameters }) => {
            (row.error, row.seconds, row.parameters) = (Some(error), Some(seconds), parameters);
        }
        Err(reason) => row.failure = reason,
    }
    row.command.clear();
    Point { row, running: None, turns: Vec::new() }
}

/// Share by which E is too large on the whole.
fn bias(e: &[Vector3<f64>], exact: &[Vector3<f64>]) -> f64 {
    let excess: f64 = e.iter().zip(exact).map(|(e, exact)| (e - exact).dot(exact)).sum();
    excess / exact.iter().map(Vector3::norm_squared).sum::<f64>()
}

impl<L: Laboratory> Point<L> {
    /// Evaluates for a while.
    fn take_a_turn(&mut self, laboratory: &mut L, least_s: f64) {
        let Some((problem, method)) = &mut self.running else { return };
        let (begun, mut seconds) = (Instant::now(), Vec::new());
        while seconds.is_empty() || begun.elapsed().as_secs_f64() < least_s {
            match laboratory.evaluate(problem, method) {
                Ok(evaluation) => {
                    seconds.push(evaluation.seconds);
                    let stages: Vec<String> = evaluation
                        .stages
                        .iter()
                        .map(|(name, seconds)| format!("{name}={seconds:.3e}"))
                        .collect();
                    self.row.stages = stages.join(" ");
                }
                Err(reason) => {
                    self.row.failure = reason;
                    self.running = None;
                    return;
                }
            }
        }
        self.turns.push(median(&mut seconds));
    }

    fn finish(mut self) -> Row {
        if self.running.is_some() && !self.turns.is_empty() {
            self.row.seconds = Some(median(&mut self.turns));
            self.row.seconds_least = self.turns.first().copied();
            self.row.seconds_most = self.turns.last().copied();
        }
        self.row
    }
}

/// Sorts values, of which there is one at least; the one in the middle.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
