//! One evaluation of the field in open space, against FMM3D at equal error, and the direct sum.

use crate::Context;
use crate::beds;
use crate::page::{Table, figure};
use crate::sections::field::{self, OURS};
use crate::timing::on_threads;
use amberfield_core::{Boundary, FieldSettings, Method};
use amberfield_draw::Series;
use amberfield_study::Store;
use amberfield_study::peers::{Script, fastest};
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};

const NAME: &str = "open";
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-6];
/// Precisions that are asked of FMM3D; its error is measured.
const PRECISIONS: &str = "0.2,5e-2,1e-2,2e-3,5e-4,5e-5,5e-6,5e-7";
const FRACTION: f64 = 0.1;
const PEER: &str = "FMM3D";
const DIRECT: &str = "direct sum";
/// FMM3D's time over ours, at least.
const GOAL: f64 = 5.0;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    program: String,
    grains: usize,
    /// Asked of ours; what the peer met best.
    tolerance: f64,
    error: f64,
    ns_per_grain: f64,
    settings: String,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let counts: &[usize] = if context.quick { &[1000] } else { &[1000, 10_000, 30_000, 100_000, 1_000_000] };
    let mut rows = Vec::new();
    for &grains in counts {
        let cloud = beds::cloud(grains, FRACTION).within(Boundary::Open);
        let exact = if grains <= 100_000 {
            let settings = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
            let (seconds, _, exact) = on_threads(1, || field::timed(&cloud, &settings, 0.5))?;
            rows.push(Row {
                program: DIRECT.to_owned(),
                grains,
                tolerance: 0.0,
                error: 0.0,
                ns_per_grain: 1e9 * seconds / grains as f64,
                settings: format!("{:.3} ns per pair", 1e9 * seconds / (grains as f64).powi(2)),
            });
            exact
        } else {
            field::exact(&cloud)?
        };
        let points = match &context.peers {
            Some(peers) => {
                let file = peers.file("cloud.bin", cloud.numbers(&exact))?;
                peers.run(Script::Fmm3d, 1, &[&file, PRECISIONS])?
            }
            None => Vec::new(),
        };
        for tolerance in TOLERANCES {
            let field::Measured { error, ns_per_grain, settings } = field::ours(&cloud, &exact, tolerance)?;
            rows.push(Row { program: OURS.to_owned(), grains, tolerance, error, ns_per_grain, settings });
            rows.extend(fastest(Script::Fmm3d, &points, tolerance).map(|point| Row {
                program: PEER.to_owned(),
                grains,
                tolerance,
                error: point[1],
                ns_per_grain: 1e9 * point[2] / grains as f64,
                settings: format!("eps {}", point[0]),
            }));
        }
        rows.iter().filter(|row| row.grains == grains).for_each(|row| println!("{row:?}"));
        context.store.save(NAME, &rows)?;
    }
    Ok(())
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "grains",
        "tolerance",
        "our error",
        "ours [ns/grain]",
        "FMM3D error",
        "FMM3D [ns/grain]",
        "FMM3D / ours",
        "direct sum [ns/grain]",
    ]);
    let mut least = f64::INFINITY;
    let mut slower_than_direct = Vec::new();
    for ours in rows.iter().filter(|row| row.program == OURS) {
        let same = |row: &&Row| row.grains == ours.grains && row.tolerance == ours.tolerance;
        let peer = rows.iter().filter(|row| row.program == PEER).find(same);
        let direct = rows.iter().find(|row| row.program == DIRECT && row.grains == ours.grains);
        let ratio = peer.map(|peer| peer.ns_per_grain / ours.ns_per_grain);
        least = least.min(ratio.unwrap_or(f64::INFINITY));
        if direct.is_some_and(|direct| ours.ns_per_grain > 1.1 * direct.ns_per_grain) {
            slower_than_direct.push(format!("{} grains at {:e}", ours.grains, ours.tolerance));
        }
        table.row(&[
            ours.grains.to_string(),
            format!("{:e}", ours.tolerance),
            format!("{:.1e}", ours.error),
            format!("{:.0}", ours.ns_per_grain),
            peer.map_or_else(|| "–".to_owned(), |peer| format!("{:.1e}", peer.error)),
            figure(peer.map(|peer| peer.ns_per_grain), 0),
            figure(ratio, 1),
            figure(direct.map(|direct| direct.ns_per_grain), 0),
        ]);
    }
    let series = |program: &str| Series {
        name: program.to_owned(),
        points: rows
            .iter()
            .filter(|row| row.program == program && row.grains == 100_000)
            .map(|row| (row.error, row.ns_per_grain))
            .collect(),
    };
    let axes = ["relative RMS error of E", "time per grain [ns]"];
    crate::page::plot(store, "open", "Open space, 100 000 grains", axes, &[series(OURS), series(PEER)])?;
    let direct =
        if slower_than_direct.is_empty() { "none".to_owned() } else { slower_than_direct.join(", ") };
    let values = context! {
        date,
        fraction => FRACTION,
        table => table.to_string(),
        goal => GOAL,
        met => least.is_finite().then_some(least >= GOAL),
        least => least.is_finite().then_some(least),
        slower => direct,
    };
    Ok(Some(fill(include_str!("../../../templates/speed/open.md"), values)))
}
