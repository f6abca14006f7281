//! A charged bed in LAMMPS on one and two ranks: `pppm` with `coul/long`, and our fix.

use crate::Context;
use crate::beds::{self, ChargedBed};
use crate::page::{Table, figure};
use amberfield_core::{FieldSettings, Tuning, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::rms;
use amberfield_study::Store;
use amberfield_study::peers::{Peers, SHARES, Script, fastest, pppm_sweep, read_numbers};
use amberfield_study::templates::fill;
use anyhow::{Context as _, Result};
use minijinja::context;
use serde::{Deserialize, Serialize};

const NAME: &str = "lammps";
/// Variable that names the plugin.
const PLUGIN: &str = "AMBERFIELD_PLUGIN";
const PLAIN: &str = "LAMMPS without charges";
const PPPM: &str = "LAMMPS pppm";
const OURS: &str = "fix amberfield/field";
/// Charged over uncharged bed, at most.
const CHARGED_GOAL: f64 = 1.2;
/// One rank's time of our part over two ranks', at least.
const RANKS_GOAL: f64 = 1.7;
/// Charge of a grain [C]: touching grains pull at each other with a fifth of their weight.
const CHARGE: f64 = 1e-13;
/// Tolerance of the field that errors are measured against.
const REFERENCE_TOLERANCE: f64 = 1e-7;
/// Tolerances of our fix over the error that is asked for, largest first: it keeps its tolerance in every
/// step, so that the RMS over steps is lower.
const LOOSER: [f64; 5] = [2.0, 1.7, 1.4, 1.2, 1.0];
/// Cut-offs around known ones.
const AROUND: [f64; 3] = [0.85, 1.0, 1.2];
/// Numbers of a grain in a state: place, charge, E.
const NUMBERS: usize = 7;

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    program: String,
    grains: usize,
    ranks: usize,
    /// Error that is asked for.
    tolerance: f64,
    /// Tolerance of our fix, with which it has that error.
    #[serde(default)]
    own_tolerance: f64,
    /// Measured in states of the moving bed, relative RMS of E; 0 without charges.
    error: f64,
    /// Error that the program states.
    stated: Option<f64>,
    /// Time of a step by the clock, and by the processor time of the busiest rank [ms].
    clock_ms: f64,
    processor_ms: f64,
    evaluations_per_step: f64,
    settings: String,
}

/// Settings of pppm: cut-off [m], order, force that is asked for [N], 1 for analytic differentiation.
struct Pppm {
    cutoff_m: f64,
    order: f64,
    force_n: f64,
    analytic: f64,
}

impl Pppm {
    /// Words of the script.
    fn words(&self) -> Vec<String> {
        let numbers =
            [self.cutoff_m, self.order, self.force_n, self.analytic].map(|number| number.to_string());
        [&["pppm".to_owned()][..], &numbers].concat()
    }
}

/// A bed with charges, as the script reads it.
struct Bed<'a> {
    peers: &'a Peers,
    cloud: ChargedBed,
    file: String,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let (Some(peers), Ok(plugin)) = (&context.peers, std::env::var(PLUGIN)) else {
        println!("left out: `cargo xtask bench --peers` installs LAMMPS and builds the plugin");
        return Ok(());
    };
    let counts: &[usize] = if context.quick { &[1000] } else { &[10_000, 100_000] };
    let mut rows = Vec::new();
    let mut settings: Vec<Option<Pppm>> = Vec::new();
    for &grains in counts {
        let steps = if context.quick { 40 } else { (20_000_000 / grains).min(800) };
        let bed = Bed::new(peers, grains)?;
        let tolerances: &[f64] = if context.quick { &[1e-2] } else { &[1e-2, 1e-3] };
        // Many grains: only around what was best for fewer of them.
        let fewer = std::mem::take(&mut settings);
        for (n, &tolerance) in tolerances.iter().enumerate() {
            settings.push(bed.pppm(tolerance, fewer.get(n).and_then(Option::as_ref))?);
        }
        for ranks in [1, 2] {
            for (&tolerance, pppm) in tolerances.iter().zip(&settings) {
                // Each program's turn comes between two of the bed without charges.
                let first = bed.run(ranks, steps, &["none"])?;
                if let Some(pppm) = pppm {
                    // A step costs as much as a hundred others: fewer of them.
                    let words = pppm.words();
                    let words: Vec<&str> = words.iter().map(String::as_str).collect();
                    let row = bed.run(ranks, steps.div_ceil(10), &words)?;
                    rows.push(Row { program: PPPM.to_owned(), tolerance, ..row });
                }
                let ours = bed.ours(ranks, steps, &plugin, tolerance)?;
                rows.push(Row { program: OURS.to_owned(), tolerance, ..ours });
                let last = bed.run(ranks, steps, &["none"])?;
                let mean = |a: f64, b: f64| 0.5 * (a + b);
                rows.push(Row {
                    program: PLAIN.to_owned(),
                    tolerance,
                    clock_ms: mean(first.clock_ms, last.clock_ms),
                    processor_ms: mean(first.processor_ms, last.processor_ms),
                    ..last
                });
                for row in rows.iter().rev().take(3) {
                    println!("{row:?}");
                }
                context.store.save(NAME, &rows)?;
            }
        }
    }
    Ok(())
}

impl<'a> Bed<'a> {
    fn new(peers: &'a Peers, grains: usize) -> Result<Self> {
        let scene = beds::relaxed(grains, 0.4);
        let mut cloud = beds::charged(scene.clone());
        cloud.charge.iter_mut().for_each(|charge| *charge = CHARGE.copysign(*charge));
        let numbers = scene.particles.position.iter().zip(&scene.particles.velocity).zip(&cloud.charge);
        let numbers = numbers.flat_map(|((x, v), &q)| [x.x, x.y, x.z, v.x, v.y, v.z, q]);
        let head = beds::granular_head(&scene);
        let file = peers.file("charged-bed.bin", head.into_iter().chain(numbers))?;
        Ok(Self { peers, cloud, file })
    }

    /// Settings with which pppm is fastest at a tolerance, of a sweep or around known ones.
    fn pppm(&self, tolerance: f64, known: Option<&Pppm>) -> Result<Option<Pppm>> {
        let exact = reference(&self.cloud)?;
        let file = self.peers.file("charged-cloud.bin", self.cloud.numbers(&exact))?;
        let (cutoffs, orders) = match known {
            None => {
                let (cutoffs, orders) = pppm_sweep(tolerance);
                (cutoffs.to_owned(), orders.to_owned())
            }
            Some(known) => {
                let diameters = known.cutoff_m / (2.0 * beds::RADIUS);
                let around = AROUND.map(|factor| (factor * diameters).to_string());
                (around.join(","), known.order.to_string())
            }
        };
        let arguments = [file.as_str(), &tolerance.to_string(), &cutoffs, &orders, SHARES, "pppm"];
        let lines = self.peers.run(Script::LammpsField, 1, &arguments)?;
        let Some(best) = fastest(Script::LammpsField, &lines, tolerance) else { return Ok(None) };
        let forces: Vec<Vector3<f64>> = self.cloud.charge.iter().zip(&exact).map(|(&q, e)| e * q).collect();
        let force_n = best[2] * tolerance * rms(&forces);
        Ok(Some(Pppm { cutoff_m: best[0], order: best[1], force_n, analytic: best[3] }))
    }

    /// Runs the bed with our fix, at the largest tolerance whose error is the one asked for.
    fn ours(&self, ranks: usize, steps: usize, plugin: &str, error: f64) -> Result<Row> {
        let mut found = None;
        for factor in LOOSER {
            let own_tolerance = factor * error;
            let row = self.run(ranks, steps, &["fix", plugin, &own_tolerance.to_string()])?;
            let is_met = row.error <= error;
            found = Some(Row { own_tolerance, ..row });
            if is_met {
                break;
            }
        }
        found.context("no tolerances")
    }

    /// Runs the bed; the best of its skins.
    fn run(&self, ranks: usize, steps: usize, words: &[&str]) -> Result<Row> {
        let out = self.peers.file("charged-states.bin", [])?;
        let steps = steps.to_string();
        let arguments = [&[self.file.as_str(), &steps, "0.1,0.2", &out][..], words].concat();
        let lines = self.peers.run(Script::LammpsBed, ranks, &arguments)?;
        // The busiest rank of each skin.
        let busiest = |skin: f64| {
            let of_skin = lines.iter().filter(|line| line.len() == 6 && line[0] == skin);
            of_skin.max_by(|a, b| a[3].total_cmp(&b[3]))
        };
        let best = [0.1, 0.2].into_iter().filter_map(busiest).min_by(|a, b| a[3].total_cmp(&b[3]));
        let best = best.context("LAMMPS printed no times")?;
        let skin = format!("skin {} diameters", best[0]);
        Ok(Row {
            program: String::new(),
            grains: self.cloud.position.len(),
            ranks,
            tolerance: 0.0,
            own_tolerance: 0.0,
            error: self.error(&read_numbers(out.as_ref())?)?,
            stated: (best[5] >= 0.0).then_some(best[5]),
            clock_ms: 1e3 * best[2],
            processor_ms: 1e3 * best[3],
            evaluations_per_step: best[4],
            settings: match words {
                ["pppm", cutoff, order, ..] => format!("{skin}; cut-off {cutoff} m, order {order}"),
                _ => skin,
            },
        })
    }

    /// Relative RMS error of E over states, whose numbers are place, charge and E of every grain.
    fn error(&self, states: &[f64]) -> Result<f64> {
        let (mut squares, mut scale) = (0.0, 0.0);
        for state in states.chunks_exact(NUMBERS * self.cloud.position.len()) {
            let vector =
                |from: usize| move |grain: &[f64]| Vector3::from_column_slice(&grain[from..from + 3]);
            let grains = || state.chunks_exact(NUMBERS);
            let cloud = ChargedBed {
                position: grains().map(vector(0)).collect(),
                charge: grains().map(|grain| grain[3]).collect(),
                ..self.cloud.clone()
            };
            let exact = reference(&cloud)?;
            let e: Vec<Vector3<f64>> = grains().map(vector(4)).collect();
            let scale_of_state = rms(&exact);
            squares += (beds::relative_error(&e, &exact) * scale_of_state).powi(2);
            scale += scale_of_state.powi(2);
        }
        Ok(if scale > 0.0 { (squares / scale).sqrt() } else { 0.0 })
    }
}

/// E by a far tighter evaluation, which the tests of the field crate compare with the direct sum.
fn reference(cloud: &ChargedBed) -> Result<Vec<Vector3<f64>>> {
    let settings =
        FieldSettings { tolerance: REFERENCE_TOLERANCE, tuning: Tuning::Model, ..FieldSettings::default() };
    let mut values = FieldValues::default();
    let mut field = ElectricField::new(&cloud.domain, &settings, &cloud.position, &cloud.charge)?;
    field.evaluate(&cloud.position, &cloud.charge, Wanted::default(), &mut values)?;
    Ok(values.e)
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "grains",
        "error asked for",
        "ranks",
        "uncharged [ms/step]",
        "pppm error",
        "pppm [ms/step]",
        "pppm / uncharged",
        "our tolerance",
        "our error",
        "stated",
        "evaluations per step",
        "ours [ms/step]",
        "ours / uncharged",
        "by the clock",
    ]);
    let find = |program: &str, like: &Row| {
        let same = |row: &&Row| {
            (row.grains, row.ranks, row.tolerance) == (like.grains, like.ranks, like.tolerance)
                && row.program == program
        };
        rows.iter().find(same)
    };
    let (mut worst, mut ranks) = (0.0_f64, Vec::new());
    for ours in rows.iter().filter(|row| row.program == OURS) {
        let Some(plain) = find(PLAIN, ours) else { continue };
        let pppm = find(PPPM, ours);
        let ratio = ours.processor_ms / plain.processor_ms;
        worst = worst.max(ratio);
        table.row(&[
            ours.grains.to_string(),
            format!("{:e}", ours.tolerance),
            ours.ranks.to_string(),
            figure(Some(plain.processor_ms), 3),
            pppm.map_or_else(|| "–".to_owned(), |row| format!("{:.1e}", row.error)),
            figure(pppm.map(|row| row.processor_ms), 2),
            figure(pppm.map(|row| row.processor_ms / plain.processor_ms), 1),
            format!("{:.1e}", ours.own_tolerance),
            format!("{:.1e}", ours.error),
            ours.stated.map_or_else(|| "–".to_owned(), |stated| format!("{stated:.1e}")),
            figure(Some(ours.evaluations_per_step), 3),
            figure(Some(ours.processor_ms), 3),
            figure(Some(ratio), 2),
            figure(Some(ours.clock_ms / plain.clock_ms), 2),
        ]);
        if ours.ranks == 1 {
            let two = rows.iter().find(|row| {
                (row.grains, row.tolerance, row.ranks) == (ours.grains, ours.tolerance, 2)
                    && row.program == OURS
            });
            if let Some((two, plain_of_two)) = two.and_then(|two| Some((two, find(PLAIN, two)?))) {
                let share = (ours.clock_ms - plain.clock_ms) / (two.clock_ms - plain_of_two.clock_ms);
                ranks.push(format!("{} grains at {:e}: {share:.2}", ours.grains, ours.tolerance));
            }
        }
    }
    let values = context! {
        date,
        table => table.to_string(),
        worst,
        met => worst <= CHARGED_GOAL,
        goal => CHARGED_GOAL,
        ranks => ranks.join(", "),
        ranks_goal => RANKS_GOAL,
    };
    Ok(Some(fill(include_str!("../../../templates/speed/lammps.md"), values)))
}
