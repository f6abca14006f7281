//! Pairs per second of the near level and of the direct sum, beside the arithmetic that the machine can do.

use super::peak::peaks;
use crate::Context;
use crate::beds::{self, ChargedBed};
use crate::page::{Table, figure};
use crate::timing::{median, on_threads};
use amberfield_core::{Boundary, FieldSettings, Method};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_study::Store;
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};

const NAME: &str = "kernel";
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-6];
const FRACTION: f64 = 0.4;
const EVALUATIONS: usize = 15;
/// Arithmetic of a pair of the direct sum: three differences, their squares (5), a reciprocal root counted
/// as one, charge times it, two factors, the potential's sum, three fused sums of two.
const DIRECT_FLOPS: f64 = 19.0;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    what: String,
    grains: usize,
    tolerance: f64,
    /// 10⁹ pairs within the cut-off per second; of a peak, 10⁹ operations per second.
    rate: f64,
    ns_per_grain: f64,
    /// Nanoseconds per grain of all stages of the evaluation.
    stages: String,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let grains = if context.quick { 1000 } else { 20_000 };
    let cloud = beds::cloud(grains, FRACTION);
    let rows = on_threads(1, || -> Result<Vec<Row>> {
        let [double, single] = peaks();
        let peak = |what: &str, rate: f64| Row {
            what: what.to_owned(),
            grains: 0,
            tolerance: 0.0,
            rate: 1e-9 * rate,
            ns_per_grain: 0.0,
            stages: String::new(),
        };
        let mut rows = vec![peak("peak, double precision", double), peak("peak, single precision", single)];
        let direct = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
        rows.push(row("direct sum, open space", &cloud.within(Boundary::Open), &direct, "pairs")?);
        for tolerance in TOLERANCES {
            let settings = FieldSettings { tolerance, ..FieldSettings::default() };
            rows.push(row("near level", &cloud, &settings, "near")?);
        }
        Ok(rows)
    })?;
    rows.iter().for_each(|row| println!("{row:?}"));
    Ok(context.store.save(NAME, &rows)?)
}

/// Median times of the stages, and the pairs over the time of one of them (or of all, where it is not told
/// apart).
fn row(what: &str, cloud: &ChargedBed, settings: &FieldSettings, stage: &str) -> Result<Row> {
    let count = cloud.position.len() as f64;
    let mut field = ElectricField::new(&cloud.domain, settings, &cloud.position, &cloud.charge)?;
    let mut values = FieldValues::default();
    let mut runs = Vec::new();
    for _ in 0..EVALUATIONS {
        let start = std::time::Instant::now();
        field.evaluate(&cloud.position, &cloud.charge, Wanted::default(), &mut values)?;
        let all = start.elapsed().as_secs_f64();
        let mut stages = field.statistics().seconds;
        stages.push(("all", all));
        runs.push(stages);
    }
    let names: Vec<&str> = runs[0].iter().map(|(name, _)| *name).collect();
    let time = |index: usize| {
        1e9 * median(&mut runs.iter().map(|stages| stages[index].1).collect::<Vec<_>>()) / count
    };
    let all = time(names.len() - 1);
    let of_stage = names.iter().position(|name| *name == stage).map_or(all, time);
    let pairs = match settings.method {
        Method::Direct => count - 1.0,
        _ => field.statistics().pairs_per_particle,
    };
    let stages: Vec<String> =
        names.iter().enumerate().map(|(i, name)| format!("{name} {:.0}", time(i))).collect();
    Ok(Row {
        what: what.to_owned(),
        grains: cloud.position.len(),
        tolerance: settings.tolerance,
        rate: pairs / of_stage,
        ns_per_grain: of_stage,
        stages: stages.join("; "),
    })
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table =
        Table::new(&["sum", "tolerance", "10⁹ pairs/s", "ns per grain", "all stages [ns per grain]"]);
    let (peaks, sums): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.grains == 0);
    for row in &sums {
        let tolerance =
            if row.what == "near level" { format!("{:e}", row.tolerance) } else { "–".to_owned() };
        table.row(&[
            row.what.clone(),
            tolerance,
            figure(Some(row.rate), 2),
            figure(Some(row.ns_per_grain), 0),
            row.stages.clone(),
        ]);
    }
    let peak = |index: usize| peaks.get(index).map(|row| row.rate);
    let direct = sums.first().map(|row| row.rate * DIRECT_FLOPS);
    let values = context! {
        date,
        grains => sums.first().map_or(0, |row| row.grains),
        double_peak => peak(0),
        single_peak => peak(1),
        flops => DIRECT_FLOPS,
        direct,
        table => table.to_string(),
    };
    Ok(Some(fill(include_str!("../../../templates/speed/kernel.md"), values)))
}
