//! Lines of a list: a change each, and what is demanded after it.

#![expect(clippy::print_stdout, reason = "how much the fields differ, for whoever asks with --nocapture")]

use super::scene::{Field, Scene, fields};

/// RMS difference over the field's scale of sums in another order: near pairs are summed in single precision,
/// with places relative to a cell as large as the cut-off radius (1.3e-5 seen with few grains, else 3e-7 to
/// 3e-6). The linear solver stops elsewhere, at a residual of 1e-10.
pub(super) const SAME: f64 = 5e-5;
/// RMS difference over the field's scale where each rank has a grid of its own for the density of the clouds,
/// which is good to 1e-4 (8e-6 seen).
const OTHER_DENSITY: f64 = 5e-5;
/// Ratio of the true error to the stated one that is allowed.
const OF_STATED: f64 = 2.0;

/// Agreement that is demanded of the fields before and after a change.
#[derive(Clone, Copy, Debug)]
pub(super) enum Demand {
    /// Equal sums in another order.
    Same,
    /// Equal sums by other processes.
    ByOtherRanks,
    /// One field by other sums, as other cells or parameters make them: to the errors that both state.
    /// Those are RMS over all grains, and may be at the grains that both scenes have.
    WithinStated,
}

/// Change that physics does not see.
pub(super) struct Line<S> {
    pub(super) name: &'static str,
    pub(super) demand: Demand,
    pub(super) change: fn(&mut S),
}

/// Asserts that each change leaves the field of each set of grains as it is; names all that do not.
pub(super) fn assert_that_nothing_matters<S: Scene>(base: &S, lines: &[Line<S>]) {
    let seen = what_matters(base, lines);
    assert!(seen.is_empty(), "{}", seen.join("\n"));
}

/// Changes after which the field of a set of grains is not what is demanded, with how far it is off.
pub(super) fn what_matters<S: Scene>(base: &S, lines: &[Line<S>]) -> Vec<String> {
    let before = fields(base);
    let mut seen = Vec::new();
    for Line { name, demand, change } in lines {
        let mut scene = base.clone();
        change(&mut scene);
        for (set, (known, found)) in before.iter().zip(fields(&scene)).enumerate() {
            let Difference { rms: difference, worst, grain } = difference(known, &found);
            let bound = match demand {
                Demand::Same => SAME,
                Demand::ByOtherRanks => OTHER_DENSITY,
                Demand::WithinStated => {
                    let more = found.e.len() as f64 / known.e.len() as f64;
                    let theirs = found.stated * found.scale / known.scale * more.sqrt();
                    OF_STATED * known.stated.hypot(theirs)
                }
            };
            println!("{name}, set {set}: {difference:.1e} of {bound:.1e}");
            if difference.is_nan() || difference > bound {
                seen.push(format!(
                    "{name}, set {set}: {difference:.2e} is above {bound:.2e}, most at grain {grain}: \
                     {worst:.2e}"
                ));
            }
        }
    }
    seen
}

/// Difference of E at the grains that two scenes have, over the scale of the first.
struct Difference {
    rms: f64,
    /// Largest difference, and the name of its grain.
    worst: f64,
    grain: usize,
}

fn difference(known: &Field, found: &Field) -> Difference {
    let of = |name: usize| found.e.iter().find(|(other, _)| *other == name).expect("no grain is lost").1;
    let apart = known.e.iter().map(|(name, e)| ((of(*name) - e).norm() / known.scale, *name));
    let square: f64 = apart.clone().map(|(apart, _)| apart * apart).sum();
    let (worst, grain) = apart.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a set has grains");
    Difference { rms: (square / known.e.len() as f64).sqrt(), worst, grain }
}
