//! The plain DEM step, against LAMMPS `gran/hertz/history` from the same positions and velocities.

use crate::Context;
use crate::beds;
use crate::page::{Table, figure};
use crate::timing::{median, on_threads};
use amberfield_dem::{Setup, Simulation};
use amberfield_study::Store;
use amberfield_study::peers::{Script, fastest};
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::time::Instant;

const NAME: &str = "dem";
const OURS: &str = "amberfield";
const PEER: &str = "LAMMPS gran/hertz/history";
/// Steps before the clock runs.
const WARM_UP: usize = 100;
const ROUNDS: usize = 3;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    program: String,
    fraction: f64,
    grains: usize,
    threads: usize,
    /// Million grains moved by one step, per second and thread.
    m_grain_steps_per_s: f64,
    contacts_per_grain: Option<f64>,
    settings: String,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let counts: &[usize] = if context.quick { &[2000] } else { &[10_000, 100_000] };
    let fractions: &[f64] = if context.quick { &[0.4] } else { &[0.1, 0.4, 0.64] };
    let mut rows = Vec::new();
    for &grains in counts {
        let steps = (6_000_000 / grains).max(40);
        for &fraction in fractions {
            let scene = beds::relaxed(grains, fraction);
            for threads in [1, 2] {
                let first = ours(&scene, threads, steps)?;
                let peer = peer(context, &scene, fraction, threads, steps)?;
                let second = ours(&scene, threads, steps)?;
                let m_grain_steps_per_s = 0.5 * (first.m_grain_steps_per_s + second.m_grain_steps_per_s);
                rows.push(Row { fraction, m_grain_steps_per_s, ..second });
                rows.extend(peer);
                println!("{:?}", &rows[rows.len().saturating_sub(2)..]);
                context.store.save(NAME, &rows)?;
            }
        }
    }
    Ok(())
}

fn ours(scene: &Setup, threads: usize, steps: usize) -> Result<Row> {
    on_threads(threads, || {
        let grains = scene.particles.len();
        let mut run = Simulation::new(scene.clone())?;
        let mut go = |steps: usize| -> Result<f64> {
            let start = Instant::now();
            for _ in 0..steps {
                run.step()?;
            }
            Ok(start.elapsed().as_secs_f64())
        };
        go(WARM_UP)?;
        let mut times = (0..ROUNDS).map(|_| go(steps)).collect::<Result<Vec<_>>>()?;
        let seconds = median(&mut times);
        let per = 1e9 / ((WARM_UP + ROUNDS * steps) * grains) as f64;
        let stages = run.stage_seconds().into_iter().map(|(name, s)| format!("{name} {:.1} ns", s * per));
        Ok(Row {
            program: OURS.to_owned(),
            fraction: 0.0,
            grains,
            threads,
            m_grain_steps_per_s: (steps * grains) as f64 / seconds / 1e6 / threads as f64,
            contacts_per_grain: Some(run.contacts() as f64 / grains as f64),
            settings: stages.collect::<Vec<_>>().join("; "),
        })
    })
}

/// The peer at its best skin.
fn peer(
    context: &Context,
    scene: &Setup,
    fraction: f64,
    threads: usize,
    steps: usize,
) -> Result<Option<Row>> {
    let Some(peers) = &context.peers else { return Ok(None) };
    let grains = scene.particles.len();
    let bed = scene.particles.position.iter().zip(&scene.particles.velocity);
    let grain_numbers = bed.flat_map(|(x, v)| [x.x, x.y, x.z, v.x, v.y, v.z]);
    let file = peers.file("bed.bin", beds::granular_head(scene).into_iter().chain(grain_numbers))?;
    let steps_text = steps.to_string();
    let points = peers.run(Script::LammpsDem, threads, &[&file, &steps_text, "0.05,0.1,0.2,0.4"])?;
    Ok(fastest(Script::LammpsDem, &points, 0.0).map(|point| Row {
        program: PEER.to_owned(),
        fraction,
        grains,
        threads,
        m_grain_steps_per_s: grains as f64 / point[1] / 1e6 / threads as f64,
        contacts_per_grain: None,
        settings: format!("skin {} diameters", point[0]),
    }))
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "grains",
        "fraction",
        "threads",
        "contacts per grain",
        "ours [M grain-steps/s per core]",
        "LAMMPS",
        "ours / LAMMPS",
        "where our time goes",
    ]);
    let mut least = f64::INFINITY;
    for ours in rows.iter().filter(|row| row.program == OURS) {
        let same = |row: &&Row| {
            (row.grains, row.fraction, row.threads) == (ours.grains, ours.fraction, ours.threads)
        };
        let peer = rows.iter().filter(|row| row.program == PEER).find(same);
        let ratio = peer.map(|peer| ours.m_grain_steps_per_s / peer.m_grain_steps_per_s);
        least = least.min(ratio.unwrap_or(f64::INFINITY));
        table.row(&[
            ours.grains.to_string(),
            ours.fraction.to_string(),
            ours.threads.to_string(),
            figure(ours.contacts_per_grain, 2),
            figure(Some(ours.m_grain_steps_per_s), 1),
            figure(peer.map(|peer| peer.m_grain_steps_per_s), 1),
            figure(ratio, 2),
            ours.settings.clone(),
        ]);
    }
    let values = context! {
        date,
        table => table.to_string(),
        met => least.is_finite().then_some(least >= 1.0),
        least => least.is_finite().then_some(least),
    };
    Ok(Some(fill(include_str!("../../../templates/speed/dem.md"), values)))
}
