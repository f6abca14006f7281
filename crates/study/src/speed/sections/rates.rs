//! Cost of a charged bed over the same bed without charge, and the accuracy that is lost where the field is
//! not evaluated at every step: trajectories, statistics of the bed, energy.

mod bed;
mod gas;
mod replicas;
mod trajectories;

use crate::Context;
use crate::page::Table;
use amberfield_draw::Series;
use amberfield_study::Store;
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::path::Path;

const NAME: &str = "rates";
/// Charged over uncharged, at most.
const COST_GOAL: f64 = 1.2;

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    study: String,
    case: String,
    quantity: String,
    value: f64,
}

/// Rows as they come.
#[derive(Debug, Default)]
struct Rows(Vec<Row>);

impl Rows {
    fn add(&mut self, study: &str, case: &str, quantity: &str, value: f64) {
        println!("{study} | {case} | {quantity} | {value:.4e}");
        self.0.push(Row {
            study: study.to_owned(),
            case: case.to_owned(),
            quantity: quantity.to_owned(),
            value,
        });
    }

    fn get(&self, study: &str, case: &str, quantity: &str) -> Option<f64> {
        let same = |row: &&Row| row.study == study && row.case == case && row.quantity == quantity;
        self.0.iter().find(same).map(|row| row.value)
    }

    /// Cases of a study in the order in which they were measured.
    fn cases(&self, study: &str) -> Vec<&str> {
        let mut cases: Vec<&str> = Vec::new();
        for row in self.0.iter().filter(|row| row.study == study) {
            if !cases.contains(&row.case.as_str()) {
                cases.push(&row.case);
            }
        }
        cases
    }
}

pub(crate) fn measure(context: &Context, root: &Path) -> Result<()> {
    let scene = root.join("cases/settling-charged-bed/scene.toml");
    let mut rows = Rows::default();
    bed::measure(&scene, context.quick, &mut rows)?;
    context.store.save(NAME, &rows.0)?;
    trajectories::measure(&scene, context.quick, &mut rows)?;
    context.store.save(NAME, &rows.0)?;
    gas::measure(context.quick, &mut rows)?;
    context.store.save(NAME, &rows.0)?;
    replicas::measure(&scene, context.quick, &mut rows)?;
    Ok(context.store.save(NAME, &rows.0)?)
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let rows = Rows(rows);
    let seconds = |case| rows.get(bed::STUDY, case, "seconds");
    let ratio = seconds("charged").zip(seconds("uncharged")).map(|(a, b)| a / b);
    let charged = |quantity| rows.get(bed::STUDY, "charged", quantity);
    let mut page = fill(
        include_str!("../../../templates/speed/rates.md"),
        context! {
            date,
            charged_s => seconds("charged"),
            uncharged_s => seconds("uncharged"),
            ratio,
            evaluations => charged("evaluations"),
            steps => charged("steps"),
            field_s => charged("field seconds"),
            forecast => charged("forecast error").unwrap_or(f64::NAN),
            goal => COST_GOAL,
            met => ratio.map(|ratio| ratio <= COST_GOAL),
        },
    );
    page += &trajectory_part(store, &rows)?;
    page += &gas_part(&rows);
    page += &replica_part(&rows);
    Ok(Some(page))
}

fn trajectory_part(store: &Store, rows: &Rows) -> Result<String> {
    let mut table = Table::new(&["run", "evaluations", "error of the forecasts", "error of the velocities"]);
    let get = |case: &str, quantity: &str| rows.get(trajectories::STUDY, case, quantity);
    let mut fixed = Vec::new();
    for case in rows.cases(trajectories::STUDY) {
        let (Some(evaluations), Some(forecast), Some(velocity)) =
            (get(case, "evaluations"), get(case, "forecast error"), get(case, "velocity error"))
        else {
            continue;
        };
        table.row(&[
            case.to_owned(),
            format!("{evaluations:.0}"),
            format!("{forecast:.1e}"),
            format!("{velocity:.1e}"),
        ]);
        if let Some(interval) = get(case, "interval") {
            fixed.push((interval, forecast, velocity));
        }
    }
    let series = |name: &str, value: &dyn Fn(&(f64, f64, f64)) -> f64| Series {
        name: name.to_owned(),
        points: fixed.iter().map(|point| (point.0, value(point))).collect(),
    };
    let all = [series("forecasts of E, measured by the run", &|p| p.1), series("velocities", &|p| p.2)];
    let axes = ["steps between evaluations", "relative RMS error"];
    crate::page::plot(store, "rates", "The bed while it lands", axes, &all)?;
    let growth = get("1e-12 perturbation", "growth").unwrap_or(f64::NAN);
    let values = context! {
        steps => get("1e-12 perturbation", "steps"),
        growth,
        tolerance => format!("{:e}", trajectories::REFERENCE_TOLERANCE),
        table => table.to_string(),
    };
    Ok(fill(include_str!("../../../templates/speed/trajectories.md"), values))
}

fn gas_part(rows: &Rows) -> String {
    let get = |case: &str, quantity: &str| rows.get(gas::STUDY, case, quantity).unwrap_or(f64::NAN);
    let mut table =
        Table::new(&["gas", "steps", "evaluations", "largest drift of the energy over the kinetic energy"]);
    for case in rows.cases(gas::STUDY) {
        table.row(&[
            case.to_owned(),
            format!("{:.0}", get(case, "steps")),
            format!("{:.0}", get(case, "evaluations")),
            format!("{:.1e}", get(case, "energy drift")),
        ]);
    }
    fill(
        include_str!("../../../templates/speed/elastic-gas.md"),
        context! { grains => gas::GRAINS, table => table.to_string() },
    )
}

fn replica_part(rows: &Rows) -> String {
    let mut table =
        Table::new(&["quantity at the end", "every step", "auto", "difference over its standard error"]);
    let mut worst = 0.0_f64;
    for quantity in replicas::QUANTITIES {
        let get = |case: &str| rows.get(replicas::STUDY, case, quantity);
        let (Some(every), Some(auto), Some(z)) = (get("every step"), get("auto"), get("difference")) else {
            continue;
        };
        worst = worst.max(z.abs());
        table.row(&[quantity.to_owned(), format!("{every:.4e}"), format!("{auto:.4e}"), format!("{z:.2}")]);
    }
    let values = context! {
        seeds => replicas::SEEDS,
        tolerance => format!("{:e}", replicas::REFERENCE_TOLERANCE),
        table => table.to_string(),
        met => (worst > 0.0).then_some(worst < 3.0),
    };
    fill(include_str!("../../../templates/speed/replicas.md"), values)
}
