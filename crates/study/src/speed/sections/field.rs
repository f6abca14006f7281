//! One evaluation of the field in a periodic box, against LAMMPS `pppm` at equal error.

use crate::Context;
use crate::beds::{self, ChargedBed, RADIUS, relative_error};
use crate::page::{Table, figure};
use crate::timing::{median_seconds, on_threads};
use amberfield_core::{Boundary, FieldSettings, Method, Tuning, Vector3};
use amberfield_draw::Series;
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_study::Store;
use amberfield_study::peers::{SHARES, Script, fastest, pppm_sweep};
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};

const NAME: &str = "field";
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-6];
const PEER: &str = "LAMMPS pppm";
pub(crate) const OURS: &str = "amberfield";
/// Insulating and grounded boxes over the periodic one, at most.
const FACES_GOAL: f64 = 1.5;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) program: String,
    pub(crate) faces: String,
    pub(crate) fraction: f64,
    pub(crate) grains: usize,
    pub(crate) tolerance: f64,
    /// Measured, relative RMS of E.
    pub(crate) error: f64,
    pub(crate) ns_per_grain: f64,
    /// Time with the neighbour list built anew, where a program can do without [ns/grain].
    pub(crate) ns_with_list: Option<f64>,
    pub(crate) settings: String,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let clouds: &[(usize, f64)] = if context.quick {
        &[(1000, 0.4)]
    } else {
        &[(10_000, 0.4), (10_000, 0.1), (100_000, 0.4), (100_000, 0.1), (1_000_000, 0.4)]
    };
    let mut rows: Vec<Row> = match context.store.newest(NAME)? {
        Some((_, rows)) if context.resume => rows,
        _ => Vec::new(),
    };
    for &(grains, fraction) in clouds {
        let missing: Vec<f64> = TOLERANCES
            .into_iter()
            .filter(|&tolerance| {
                let cell = (grains, fraction, tolerance);
                !rows.iter().any(|row| (row.grains, row.fraction, row.tolerance) == cell)
            })
            .collect();
        if missing.is_empty() {
            continue;
        }
        let cloud = beds::cloud(grains, fraction);
        let exact = exact(&cloud)?;
        let boxes = if grains <= 100_000 && fraction > 0.3 { closed(&cloud)? } else { Vec::new() };
        for tolerance in missing {
            // The peer's turn comes between two of ours, so that a busy machine is busy for both.
            let row = |faces: &str, measured: Measured| Row {
                program: OURS.to_owned(),
                faces: faces.to_owned(),
                fraction,
                grains,
                tolerance,
                error: measured.error,
                ns_per_grain: measured.ns_per_grain,
                ns_with_list: Some(measured.ns_per_grain),
                settings: measured.settings,
            };
            let first = ours(&cloud, &exact, tolerance)?;
            let peer = peer(context, &cloud, &exact, tolerance, fraction, &rows)?;
            let second = ours(&cloud, &exact, tolerance)?;
            let ns_per_grain = 0.5 * (first.ns_per_grain + second.ns_per_grain);
            rows.push(row("periodic", Measured { ns_per_grain, ..second }));
            rows.extend(peer);
            for row in &rows[rows.len().saturating_sub(2)..] {
                println!("{row:?}");
            }
            for Closed { faces, cloud, exact } in &boxes {
                rows.push(row(faces, ours(cloud, exact, tolerance)?));
            }
            context.store.save(NAME, &rows)?;
        }
    }
    Ok(context.store.save(NAME, &rows)?)
}

/// The cloud in a closed box.
struct Closed {
    faces: &'static str,
    cloud: ChargedBed,
    exact: Vec<Vector3<f64>>,
}

/// The cloud in a grounded and in an insulating box.
fn closed(cloud: &ChargedBed) -> Result<Vec<Closed>> {
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let one = |(faces, boundary)| {
        let cloud = cloud.within(boundary);
        let exact = exact(&cloud)?;
        Ok(Closed { faces, cloud, exact })
    };
    [("grounded", Boundary::Grounded), ("insulating", insulating)].into_iter().map(one).collect()
}

/// E to compare with: `direct` for few grains, else a much tighter evaluation, which is itself compared with
/// `direct` in the tests of the field crate.
pub(crate) fn exact(cloud: &ChargedBed) -> Result<Vec<Vector3<f64>>> {
    let method = if cloud.position.len() <= 10_000 { Method::Direct } else { Method::P3m };
    let tolerance = if cloud.position.len() > 100_000 { 1e-7 } else { 1e-8 };
    let settings = FieldSettings { method, tolerance, tuning: Tuning::Model, ..FieldSettings::default() };
    let (mut field, mut values) = built(cloud, &settings)?;
    field.evaluate(&cloud.position, &cloud.charge, Wanted::default(), &mut values)?;
    Ok(values.e)
}

fn built(cloud: &ChargedBed, settings: &FieldSettings) -> Result<(ElectricField, FieldValues)> {
    let field = ElectricField::new(&cloud.domain, settings, &cloud.position, &cloud.charge)?;
    Ok((field, FieldValues::default()))
}

/// Median seconds of an evaluation, repeated for `least_s` seconds at least; the field, and E.
pub(crate) fn timed(
    cloud: &ChargedBed,
    settings: &FieldSettings,
    least_s: f64,
) -> Result<(f64, ElectricField, Vec<Vector3<f64>>)> {
    let (mut field, mut values) = built(cloud, settings)?;
    let mut outcome = Ok(());
    let seconds = median_seconds(least_s, || {
        outcome = field.evaluate(&cloud.position, &cloud.charge, Wanted::default(), &mut values);
    });
    outcome?;
    Ok((seconds, field, values.e))
}

pub(crate) struct Measured {
    pub(crate) error: f64,
    pub(crate) ns_per_grain: f64,
    pub(crate) settings: String,
}

/// Time and error of an evaluation on one thread.
pub(crate) fn ours(cloud: &ChargedBed, exact: &[Vector3<f64>], tolerance: f64) -> Result<Measured> {
    let settings = FieldSettings { tolerance, ..FieldSettings::default() };
    let (seconds, field, e) = on_threads(1, || timed(cloud, &settings, 1.0))?;
    Ok(Measured {
        error: relative_error(&e, exact),
        ns_per_grain: 1e9 * seconds / cloud.position.len() as f64,
        settings: format!("{:?}", field.choice()).replace('"', ""),
    })
}

/// Grains from which on the peer runs with the settings that were best for a tenth of them: pppm takes
/// minutes to set up.
const VERY_MANY: usize = 1_000_000;

/// The peer's fastest settings whose error is at most the tolerance.
fn peer(
    context: &Context,
    cloud: &ChargedBed,
    exact: &[Vector3<f64>],
    tolerance: f64,
    fraction: f64,
    known: &[Row],
) -> Result<Option<Row>> {
    let Some(peers) = &context.peers else { return Ok(None) };
    let grains = cloud.position.len();
    let file = peers.file("cloud.bin", cloud.numbers(exact))?;
    // Many grains: only around what was best for fewer of them; very many: just that.
    let best = known.iter().rfind(|row| {
        row.program == PEER
            && row.tolerance == tolerance
            && row.fraction == fraction
            && row.grains * 10 == grains
    });
    let around: &[f64] = if grains < VERY_MANY { &[0.85, 1.0, 1.2] } else { &[1.0] };
    let (cutoffs, orders) = match best.and_then(|row| Setting::read(&row.settings)) {
        Some(best) => (
            around.iter().map(|factor| (factor * best.cutoff).to_string()).collect::<Vec<_>>().join(","),
            best.order.to_string(),
        ),
        None => {
            let (cutoffs, orders) = pppm_sweep(tolerance);
            (cutoffs.to_owned(), orders.to_owned())
        }
    };
    let tolerance_text = tolerance.to_string();
    let arguments = [file.as_str(), &tolerance_text, &cutoffs, &orders, SHARES];
    let points = peers.run(Script::LammpsField, 1, &arguments)?;
    Ok(fastest(Script::LammpsField, &points, tolerance).map(|point| Row {
        program: PEER.to_owned(),
        faces: "periodic".to_owned(),
        fraction,
        grains,
        tolerance,
        error: point[4],
        ns_per_grain: 1e9 * point[5] / grains as f64,
        ns_with_list: Some(1e9 * point[6] / grains as f64),
        settings: format!(
            "cut-off {:.2} diameters; order {}; {} differentiation",
            point[0] / (2.0 * RADIUS),
            point[1],
            if point[3] > 0.0 { "analytic" } else { "Fourier" },
        ),
    }))
}

struct Setting {
    cutoff: f64,
    order: f64,
}

impl Setting {
    /// Reads what [`peer`] wrote.
    fn read(text: &str) -> Option<Self> {
        let mut numbers = text.split([' ', ';']).filter_map(|word| word.parse().ok());
        Some(Self { cutoff: numbers.next()?, order: numbers.next()? })
    }
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "grains",
        "fraction",
        "tolerance",
        "our error",
        "ours [ns/grain]",
        "pppm error",
        "pppm [ns/grain]",
        "pppm with list",
        "pppm / ours",
        "with list / ours",
    ]);
    let (mut least, mut least_with_list) = (f64::INFINITY, f64::INFINITY);
    let periodic = |program: &'static str| {
        rows.iter().filter(move |row| row.program == program && row.faces == "periodic")
    };
    for ours in periodic(OURS) {
        let same = |row: &&Row| {
            (row.grains, row.fraction, row.tolerance) == (ours.grains, ours.fraction, ours.tolerance)
        };
        let peer = periodic(PEER).find(same);
        let ratio = peer.map(|peer| peer.ns_per_grain / ours.ns_per_grain);
        let with_list = peer.and_then(|peer| peer.ns_with_list).map(|ns| ns / ours.ns_per_grain);
        least = least.min(ratio.unwrap_or(f64::INFINITY));
        least_with_list = least_with_list.min(with_list.unwrap_or(f64::INFINITY));
        table.row(&[
            ours.grains.to_string(),
            ours.fraction.to_string(),
            format!("{:e}", ours.tolerance),
            format!("{:.1e}", ours.error),
            format!("{:.0}", ours.ns_per_grain),
            peer.map_or_else(|| "–".to_owned(), |peer| format!("{:.1e}", peer.error)),
            figure(peer.map(|peer| peer.ns_per_grain), 0),
            figure(peer.and_then(|peer| peer.ns_with_list), 0),
            figure(ratio, 2),
            figure(with_list, 2),
        ]);
    }
    plots(store, &rows)?;
    let faces = dearest_faces(&rows);
    let goal = least.is_finite().then_some(least > 1.0);
    let twice = least.is_finite().then_some(least > 2.0);
    let values = context! {
        date,
        table => table.to_string(),
        kept_met => goal,
        kept => least.is_finite().then_some(least),
        anew_met => least_with_list.is_finite().then_some(least_with_list > 1.0),
        anew => least_with_list.is_finite().then_some(least_with_list),
        twice,
        goal => FACES_GOAL,
        worst => faces,
    };
    Ok(Some(fill(include_str!("../../../templates/speed/field.md"), values)))
}

/// Line of the page about the cost of closed boxes over periodic ones.
/// Closed box that costs most beside the periodic one, as the template wants it.
#[derive(Serialize)]
struct Dearest {
    met: bool,
    faces: String,
    grains: usize,
    tolerance: String,
    ratio: f64,
}

fn dearest_faces(rows: &[Row]) -> Option<Dearest> {
    let periodic = rows.iter().filter(|row| row.program == OURS && row.faces == "periodic");
    let (ratio, row) = rows
        .iter()
        .filter(|row| row.faces != "periodic")
        .filter_map(|row| {
            let same = |other: &&Row| {
                (other.grains, other.fraction, other.tolerance) == (row.grains, row.fraction, row.tolerance)
            };
            Some((row.ns_per_grain / periodic.clone().find(same)?.ns_per_grain, row))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Dearest {
        met: ratio <= FACES_GOAL,
        faces: row.faces.clone(),
        grains: row.grains,
        tolerance: format!("{:e}", row.tolerance),
        ratio,
    })
}

fn plots(store: &Store, rows: &[Row]) -> Result<()> {
    // The size with most points, the larger of two.
    let points =
        |grains: usize| rows.iter().filter(|row| row.grains == grains && row.fraction == 0.4).count();
    let grains =
        rows.iter().map(|row| row.grains).max_by_key(|&grains| (points(grains), grains)).unwrap_or(0);
    let series = |program: &str, name: &str, time: &dyn Fn(&Row) -> Option<f64>| Series {
        name: name.to_owned(),
        points: rows
            .iter()
            .filter(|row| {
                row.program == program
                    && row.grains == grains
                    && row.fraction == 0.4
                    && row.faces == "periodic"
            })
            .filter_map(|row| Some((row.error, time(row)?)))
            .collect(),
    };
    let kept = |row: &Row| Some(row.ns_per_grain);
    let all = [
        series(OURS, "amberfield", &kept),
        series(PEER, "pppm, list kept", &kept),
        series(PEER, "pppm, list built anew", &|row| row.ns_with_list),
    ];
    let title = format!("One evaluation, {grains} grains, volume fraction 0.4");
    crate::page::plot(store, "field", &title, ["relative RMS error of E", "time per grain [ns]"], &all)
}
