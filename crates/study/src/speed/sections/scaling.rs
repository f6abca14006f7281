//! Time and memory per grain from 10³ to 10⁷ grains, on one thread and two, and whether the results have
//! the same bits.

use crate::Context;
use crate::beds::{self, ChargedBed};
use crate::page::{Table, figure};
use crate::sections::field::timed;
use crate::timing::on_threads;
use amberfield_core::{FieldSettings, Particles, Tuning, Vector3};
use amberfield_dem::{Setup, Simulation};
use amberfield_draw::Series;
use amberfield_oracle::observed_order;
use amberfield_study::Store;
use amberfield_study::machine::peak_memory;
use amberfield_study::templates::fill;
use anyhow::{Context as _, Result};
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::time::Instant;

const NAME: &str = "scaling";
const TOLERANCE: f64 = 1e-2;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    grains: usize,
    threads: usize,
    field_ns_per_grain: f64,
    field_bytes_per_grain: f64,
    dem_ns_per_grain: f64,
    /// Memory of the whole process while it steps, with the scene that it started from [bytes/grain].
    dem_bytes_per_grain: Option<f64>,
    /// Whether E and the positions have the bits of one thread.
    same_bits: bool,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let largest = if context.quick { 3 } else { 7 };
    let mut rows = Vec::new();
    for power in 3..=largest {
        let grains = 10_usize.pow(power);
        let cloud = beds::sparse_cloud(grains);
        let (mut one_field, mut one_step) = (Vec::new(), Vec::new());
        for threads in [1, 2] {
            let (field_ns, field_bytes, e) = on_threads(threads, || field(&cloud))?;
            let scene = beds::sparse(grains);
            peak_memory();
            let (dem_ns, particles) = on_threads(threads, || dem(scene))?;
            let bytes = peak_memory();
            let position = particles.position;
            let same_bits = threads == 1 || (one_field == e && one_step == position);
            if threads == 1 {
                (one_field, one_step) = (e, position);
            }
            rows.push(Row {
                grains,
                threads,
                field_ns_per_grain: field_ns,
                field_bytes_per_grain: field_bytes,
                dem_ns_per_grain: dem_ns,
                dem_bytes_per_grain: bytes.map(|bytes| bytes / grains as f64),
                same_bits,
            });
            println!("{:?}", rows.last());
            context.store.save(NAME, &rows)?;
        }
    }
    Ok(())
}

/// Nanoseconds and bytes per grain, and E.
fn field(cloud: &ChargedBed) -> Result<(f64, f64, Vec<Vector3<f64>>)> {
    let settings = FieldSettings { tolerance: TOLERANCE, tuning: Tuning::Model, ..FieldSettings::default() };
    let count = cloud.position.len() as f64;
    let (seconds, field, e) = timed(cloud, &settings, 0.3)?;
    Ok((1e9 * seconds / count, field.memory_bytes() as f64 / count, e))
}

/// Nanoseconds per grain and step, and the grains after some steps.
fn dem(scene: Setup) -> Result<(f64, Particles)> {
    let count = scene.particles.len();
    let mut run = Simulation::new(scene)?;
    let steps = (5_000_000 / count).max(20);
    let start = Instant::now();
    for _ in 0..steps {
        run.step().context("a periodic box")?;
    }
    let seconds = start.elapsed().as_secs_f64();
    Ok((1e9 * seconds / (steps * count) as f64, run.particles()))
}

/// Slope of log y over log x by least squares; not a number for a single point.
fn slope(points: &[(f64, f64)]) -> f64 {
    if points.len() < 2 {
        return f64::NAN;
    }
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    observed_order(&x, &y)
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "grains",
        "threads",
        "field [ns/grain]",
        "field [bytes/grain]",
        "DEM step [ns/grain]",
        "process while stepping [bytes/grain]",
        "same bits as one thread",
    ]);
    for row in &rows {
        table.row(&[
            row.grains.to_string(),
            row.threads.to_string(),
            figure(Some(row.field_ns_per_grain), 0),
            figure(Some(row.field_bytes_per_grain), 0),
            figure(Some(row.dem_ns_per_grain), 1),
            figure(row.dem_bytes_per_grain, 0),
            if row.same_bits { "yes" } else { "NO" }.to_owned(),
        ]);
    }
    let points = |threads: usize, value: &dyn Fn(&Row) -> f64| -> Vec<(f64, f64)> {
        let of = rows.iter().filter(|row| row.threads == threads);
        of.map(|row| (row.grains as f64, value(row) * row.grains as f64)).collect()
    };
    let series = |name: &str, threads, value: &dyn Fn(&Row) -> f64| Series {
        name: name.to_owned(),
        points: points(threads, value).into_iter().map(|(x, y)| (x, y / x)).collect(),
    };
    let field = |row: &Row| row.field_ns_per_grain;
    let dem = |row: &Row| row.dem_ns_per_grain;
    let all = [
        series("field, 1 thread", 1, &field),
        series("field, 2 threads", 2, &field),
        series("DEM step, 1 thread", 1, &dem),
        series("DEM step, 2 threads", 2, &dem),
    ];
    crate::page::plot(store, "scaling", "Time per grain", ["grains", "time per grain [ns]"], &all)?;
    let values = context! {
        date,
        tolerance => format!("{TOLERANCE:e}"),
        table => table.to_string(),
        field => slope(&points(1, &field)),
        dem => slope(&points(1, &dem)),
        same => rows.iter().all(|row| row.same_bits),
    };
    Ok(Some(fill(include_str!("../../../templates/speed/scaling.md"), values)))
}
