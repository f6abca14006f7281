//! E at the grains between two evaluations: on the straight line through the last two,
//!
//! E(s) = E₀ + s (E₀ − E₋₁)/S,
//!
//! s steps after the last evaluation, which came S steps after the one before it. Why not impulses or a field
//! that is held: `docs/decisions/several-rates.md`.

use super::Members;
use super::interval::Check;
use crate::motion::grains::pick;
use amberfield_core::Vector3;
use serde::{Deserialize, Serialize};

/// Factor of the jump of E at a grain whose charge jumps: contacts overlap, and a jump that is taken for too
/// small leaves a rest that looks like drift.
const SPARE: f64 = 1.2;
/// Share of the charge of a grain that comes or leaves that counts as a jump since the last evaluation: its
/// images, and what has moved since, are not known before the next one.
const UNKNOWN: f64 = 0.1;

/// E, its change and the charge of every grain, in sorted order; zero for grains that are no members.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Forecast {
    /// E at the last evaluation [V/m].
    e: Vec<Vector3<f64>>,
    /// Change of E per step [V/m].
    slope: Vec<Vector3<f64>>,
    /// Charge [C].
    charge: Vec<f64>,
    /// Charge at the last evaluation [C].
    evaluated: Vec<f64>,
    /// Grains that have come since; empty where none has.
    new: Vec<bool>,
    /// Charges of the grains that have left since.
    left: Change,
    /// Scales of E at the last evaluation.
    scale: Scale,
    /// Jumps since the last evaluation; `None`: to be summed anew.
    jumps: Option<Jumps>,
    /// Memory of the next reordering.
    #[serde(skip)]
    spare: (Vec<Vector3<f64>>, Vec<f64>),
}

impl Forecast {
    /// E [V/m] of a grain, `age` steps after the last evaluation.
    #[inline(always)]
    pub(crate) fn at(&self, grain: usize, age: f64) -> Vector3<f64> {
        self.e[grain] + self.slope[grain] * age
    }

    /// Electric force on a grain [N], `age` steps after the last evaluation.
    #[inline(always)]
    pub(crate) fn force(&self, grain: usize, age: f64) -> Vector3<f64> {
        self.at(grain, age) * self.charge[grain]
    }

    /// Takes in a grain that has come, with E [V/m] and its charge [C].
    pub(super) fn admit(&mut self, e: Vector3<f64>, charge: f64) {
        self.new.resize(self.e.len(), false);
        self.new.push(true);
        self.e.push(e);
        self.slope.push(Vector3::zeros());
        self.charge.push(charge);
        self.evaluated.push((1.0 - UNKNOWN) * charge);
        self.jumps = None;
    }

    /// Adds a field [V/m] at a grain; nothing is known before the first evaluation.
    pub(super) fn add(&mut self, grain: usize, e: Vector3<f64>) {
        if let Some(known) = self.e.get_mut(grain) {
            *known += e;
        }
    }

    /// Adds what a field [V/m] that is the same everywhere has gained, at the grains that feel it.
    pub(super) fn gain(&mut self, gained: Vector3<f64>, feels: impl Fn(usize) -> bool) {
        let grains = self.e.iter_mut().enumerate().filter(|(grain, _)| feels(*grain));
        grains.for_each(|(_, e)| *e += gained);
    }

    /// Charge of a grain [C]; zero before the first evaluation.
    pub(crate) fn charge(&self, grain: usize) -> f64 {
        self.charge.get(grain).copied().unwrap_or(0.0)
    }

    /// Sum of the squared electric forces at the last evaluation, less those of the external field [N²].
    pub(crate) fn squared_forces(&self) -> f64 {
        self.scale.weights * self.scale.of_forces.powi(2)
    }

    /// Takes a grain's new charge [C]; nothing is known before the first evaluation.
    pub(crate) fn recharge(&mut self, grain: usize, charge: f64) {
        if let Some(known) = self.charge.get_mut(grain).filter(|known| **known != charge) {
            *known = charge;
            self.jumps = None;
        }
    }

    /// Jumps of E since the last evaluation, for grains with centres and radii [m] in a medium of 1/(4πε)
    /// [m/F].
    ///
    /// A jump of a grain's own charge by Δq goes with one of its partner's, or of its image, by −Δq, two
    /// radii away, so that its E jumps by about kΔq/(2r)². Jumps of the others' charges make that of charges
    /// at random, kΔq_rms n^{2/3}, and, where their sum changes, its share of E.
    pub(crate) fn jumps(&mut self, centre: &[[f64; 4]], coulomb: f64) -> Jumps {
        *self.jumps.get_or_insert_with(|| {
            let (mut change, mut sizes, mut weights, mut near) = (self.left, 0.0, 0.0, 0.0);
            for ((now, before), centre) in self.charge.iter().zip(&self.evaluated).zip(centre) {
                change.add(now - before);
                (sizes, weights) = (sizes + now.abs(), weights + now * now);
                near += (now * near_jump(now - before, centre, coulomb)).powi(2);
            }
            if change.squares == 0.0 {
                return Jumps::default();
            }
            let weights = weights.max(f64::MIN_POSITIVE);
            let share2 = (change.squares / weights).min(1.0);
            let of_sum2 = (change.sum / sizes.max(f64::MIN_POSITIVE)).powi(2).min(1.0);
            let jumps = Jumps { share2, of_sum2, e2: near / weights };
            Jumps { e2: jumps.e2 + jumps.far2(&self.scale), ..jumps }
        })
    }

    /// Whether E has jumped by more than a share of its scale, or charges by as large a share.
    pub(crate) fn has_jumped_by(&mut self, share: f64, centre: &[[f64; 4]], coulomb: f64) -> bool {
        let Jumps { share2, e2, .. } = self.jumps(centre, coulomb);
        share2 > share * share || e2 > (share * self.scale.of_forces).powi(2)
    }

    /// Whether it is one of `count` grains.
    pub(crate) fn fits(&self, count: usize) -> bool {
        [self.e.len(), self.slope.len(), self.charge.len(), self.evaluated.len()] == [count; 4]
    }

    /// Follows grains that are reordered to `order[new] = old`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        // Nothing is known before the first evaluation.
        if !self.e.is_empty() {
            let all = Change::of(&self.charge);
            pick(&mut self.e, order, &mut self.spare.0);
            pick(&mut self.slope, order, &mut self.spare.0);
            pick(&mut self.charge, order, &mut self.spare.1);
            pick(&mut self.evaluated, order, &mut self.spare.1);
            if !self.new.is_empty() {
                self.new = order.iter().map(|&old| self.new[old as usize]).collect();
            }
            if order.len() < self.spare.1.len() {
                let kept = Change::of(&self.charge);
                // The rest of what they did is off the others' E already.
                self.left.sum += UNKNOWN * (kept.sum - all.sum);
                self.left.squares += UNKNOWN * UNKNOWN * (all.squares - kept.squares).max(0.0);
                self.jumps = None;
            }
        }
    }

    /// Takes a fresh E of the members, `age` steps after the last evaluation. What it differs by from the
    /// forecast; `None` the first time and when no step was taken.
    ///
    /// As much of the difference as charges may have made ([`Self::jumps`]) counts as jump, the rest as
    /// drift; all of it where there were no charges before. The slope takes the drift alone: a jump does not
    /// go on. A grain that has just come has none yet.
    pub(crate) fn renew(
        &mut self,
        members: &Members,
        fresh: &[Vector3<f64>],
        age: u64,
        medium: &Medium<'_>,
    ) -> Option<Check> {
        let Members { index, charge, count, .. } = members;
        let known = !self.e.is_empty() && age > 0;
        self.e.resize(*count, Vector3::zeros());
        self.slope.resize(*count, Vector3::zeros());
        self.charge.resize(*count, 0.0);
        self.evaluated.resize(*count, 0.0);
        let &Medium { centre, coulomb, .. } = medium;
        let jumps = if known { self.jumps(centre, coulomb) } else { Jumps::default() };
        let scale = Scale::of(fresh, charge, medium);
        let far2 = jumps.far2(&scale);
        let age = age as f64;
        let mut sums = Sums::default();
        for ((&i, fresh), charge) in index.iter().zip(fresh).zip(charge) {
            let i = i as usize;
            let difference = fresh - self.at(i, age);
            let difference2 = difference.norm_squared();
            let near = near_jump(charge - self.evaluated[i], &centre[i], coulomb);
            let made2 = if jumps.share2 < 1.0 { near * near + far2 } else { f64::INFINITY };
            let jump2 = difference2.min(made2);
            let drift2 = difference2 - jump2;
            sums.add(charge * charge, drift2, jump2);
            let is_new = self.new.get(i).is_some_and(|new| *new);
            if known && !is_new && difference2 > 0.0 {
                self.slope[i] += difference * ((drift2 / difference2).sqrt() / age);
            } else if !known || is_new {
                self.slope[i] = Vector3::zeros();
            }
            self.e[i] = *fresh;
            self.charge[i] = *charge;
            self.evaluated[i] = *charge;
        }
        let check = known.then(|| sums.check(index.len(), &scale, jumps));
        self.new.clear();
        (self.left, self.scale, self.jumps) = (Change::default(), scale, Some(Jumps::default()));
        check
    }
}

/// Sums over changes of charges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Change {
    /// Sum [C].
    sum: f64,
    /// Sum of the squares [C²].
    squares: f64,
}

impl Change {
    fn of(charges: &[f64]) -> Self {
        let mut sums = Self::default();
        charges.iter().for_each(|charge| sums.add(*charge));
        sums
    }

    fn add(&mut self, change: f64) {
        self.sum += change;
        self.squares += change * change;
    }
}

/// Jumps since the last evaluation, because charges have changed and grains have left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Jumps {
    /// Σ(q − q₀)² over Σq², at most 1.
    pub(crate) share2: f64,
    /// Squared change of the sum of the charges, over that of their sizes, at most 1.
    of_sum2: f64,
    /// Squared jump of E in the forces, in the mean [V²/m²].
    pub(crate) e2: f64,
}

impl Jumps {
    /// Squared jump of E that the charges of others make [V²/m²].
    fn far2(&self, scale: &Scale) -> f64 {
        self.share2 * scale.least.powi(2) + self.of_sum2 * scale.of_all.powi(2)
    }
}

/// Jump of E at a grain whose charge jumps [V/m].
fn near_jump(change: f64, centre: &[f64; 4], coulomb: f64) -> f64 {
    let diameter = 2.0 * centre[3];
    SPARE * coulomb * change / (diameter * diameter)
}

/// Quantities that a check needs beside E.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Medium<'a> {
    /// Centres and radii of all grains, sorted order [m].
    pub(crate) centre: &'a [[f64; 4]],
    /// External field at present, which forecasts know [V/m].
    pub(crate) external: Vector3<f64>,
    /// Scale of E where symmetry makes it vanish [V/m].
    pub(crate) least: f64,
    /// 1/(4πε) [m/F].
    pub(crate) coulomb: f64,
}

/// Scales to which errors of E are relative [V/m]: the RMS of E less the external field, but not less than
/// where symmetry makes it vanish.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Scale {
    /// Scale where symmetry makes E vanish.
    least: f64,
    of_all: f64,
    /// Scale with the charges squared as weights: the forces'.
    of_forces: f64,
    /// Sum of the squared charges [C²].
    weights: f64,
}

impl Scale {
    fn of(fresh: &[Vector3<f64>], charge: &[f64], medium: &Medium<'_>) -> Self {
        let (mut all, mut forces, mut weights, mut count) = (0.0, 0.0, 0.0, 0.0_f64);
        for (e, q) in fresh.iter().zip(charge) {
            let e2 = (e - medium.external).norm_squared();
            (all, forces) = (all + e2, forces + q * q * e2);
            (weights, count) = (weights + q * q, count + 1.0);
        }
        let root = |sum: f64, over: f64| if over > 0.0 { (sum / over).sqrt() } else { 0.0 };
        Self {
            least: medium.least,
            of_all: root(all, count).max(medium.least),
            of_forces: root(forces, weights).max(medium.least),
            weights,
        }
    }
}

/// Sums over the members.
#[derive(Default)]
struct Sums {
    weights: f64,
    drift: f64,
    jump: f64,
    drift_of_all: f64,
    largest: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, drift2: f64, jump2: f64) {
        self.weights += weight;
        self.drift += weight * drift2;
        self.jump += weight * jump2;
        self.drift_of_all += drift2;
        self.largest = self.largest.max(drift2);
    }

    fn check(&self, count: usize, scale: &Scale, jumps: Jumps) -> Check {
        let over = |sum: f64, weights: f64, scale: f64| {
            if sum == 0.0 { 0.0 } else { (sum / weights).sqrt() / scale }
        };
        Check {
            drift: over(self.drift, self.weights, scale.of_forces),
            jump: over(self.jump, self.weights, scale.of_forces),
            drift_of_all: over(self.drift_of_all, count as f64, scale.of_all),
            largest: over(self.largest, 1.0, scale.of_all),
            jumped: jumps.e2,
            missed: 0.0,
            forces2: self.weights * scale.of_forces.powi(2),
        }
    }
}

/// Electric energy, and the error that it may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FieldEnergy {
    /// Energy [J].
    pub(crate) energy: f64,
    /// Error that rounding and the field's tolerance may make [J].
    pub(crate) error: f64,
}

/// The electric energy between two evaluations, on the line through the last two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EnergyForecast {
    /// Energy at the last evaluation.
    last: FieldEnergy,
    /// Change of the energy per step [J].
    slope: f64,
    evaluated: bool,
}

impl EnergyForecast {
    /// Energy `age` steps after the last evaluation.
    pub(crate) fn at(&self, age: u64) -> FieldEnergy {
        FieldEnergy { energy: self.last.energy + self.slope * age as f64, ..self.last }
    }

    /// Adds what grains that come bring, or leave without [J].
    pub(crate) fn shift(&mut self, energy: f64) {
        self.last.energy += energy;
    }

    /// Takes a fresh energy, `age` steps after the last evaluation.
    pub(crate) fn renew(&mut self, fresh: FieldEnergy, age: u64) {
        let known = self.evaluated && age > 0;
        let slope = if known { (fresh.energy - self.last.energy) / age as f64 } else { 0.0 };
        *self = Self { last: fresh, slope, evaluated: true };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E of grain g at a time in steps: a parabola of its own.
    fn parabola(grain: u32, time: f64) -> Vector3<f64> {
        let g = f64::from(grain);
        Vector3::new(1.0 + g, -g, 0.5)
            + Vector3::new(0.1, 0.2 * g, -0.3) * time
            + Vector3::x() * (g * time * time)
    }

    fn fresh(grains: &[u32], time: f64) -> Vec<Vector3<f64>> {
        grains.iter().map(|&g| parabola(g, time)).collect()
    }

    /// Grains of unit radius at one place.
    const CENTRE: [[f64; 4]; 4] = [[0.0, 0.0, 0.0, 1.0]; 4];

    fn medium(least: f64) -> Medium<'static> {
        Medium { centre: &CENTRE, external: Vector3::zeros(), least, coulomb: 1.0 }
    }

    fn members(index: &[u32], count: usize) -> Members {
        let (position, charge) = (vec![Vector3::zeros(); index.len()], vec![2.0; index.len()]);
        Members { index: index.to_vec(), position, charge, count, time_s: 0.0 }
    }

    #[test]
    fn forecast_is_held_first_then_follows_the_line_and_is_checked() {
        let mut forecast = Forecast::default();
        // Grain 1 of 0…3 is no member.
        let inside = [0_u32, 2, 3];
        assert_eq!(forecast.renew(&members(&inside, 4), &fresh(&inside, 0.0), 0, &medium(1.0)), None);
        assert_eq!(forecast.at(2, 5.0), parabola(2, 0.0));
        assert_eq!(forecast.force(2, 5.0), 2.0 * parabola(2, 0.0));
        let check = forecast
            .renew(&members(&inside, 4), &fresh(&inside, 2.0), 2, &medium(1e3))
            .expect("steps were taken");
        let largest = (parabola(3, 2.0) - parabola(3, 0.0)).norm() / 1e3;
        assert!((check.largest - largest).abs() < 1e-15);
        // The line through times 0 and 2, three steps on, misses the parabola by g·3·5.
        assert!((forecast.at(3, 3.0) - parabola(3, 5.0) + Vector3::x() * 45.0).norm() < 1e-12);

        // The grains are sorted anew as 3, 2, 1, 0, and the last one leaves.
        forecast.reorder(&[3, 2, 1, 0]);
        forecast.reorder(&[0, 1, 2]);
        assert!(forecast.fits(3) && forecast.force(2, 3.0) == Vector3::zeros());
        assert_eq!(forecast.jumps(&CENTRE, 1.0).share2, 0.5 * UNKNOWN * UNKNOWN);
    }

    #[test]
    fn forecast_errs_by_what_the_parabola_bends() {
        let mut forecast = Forecast::default();
        for (time, age) in [(0.0, 0), (2.0, 2)] {
            forecast.renew(&members(&[0, 1], 2), &fresh(&[3, 2], time), age, &medium(1e3));
        }
        let check = forecast
            .renew(&members(&[0, 1], 2), &fresh(&[3, 2], 5.0), 3, &medium(1e3))
            .expect("steps were taken");
        let rms = f64::sqrt((45.0 * 45.0 + 30.0 * 30.0) / 2.0) / 1e3;
        assert!((check.drift - rms).abs() < 1e-15 && (check.drift_of_all - rms).abs() < 1e-15);
        assert_eq!((check.jump, check.jumped), (0.0, 0.0));
    }

    #[test]
    fn jump_of_charges_is_no_drift_and_does_not_go_on() {
        let mut forecast = Forecast::default();
        let e = |z: f64| [Vector3::new(0.0, 0.0, z), Vector3::new(0.0, 0.0, -z)];
        let with = |charge: f64| {
            let mut members = members(&[0, 1], 2);
            members.charge = vec![charge; 2];
            members
        };
        forecast.renew(&with(1.0), &e(1.0), 0, &medium(1e-3));
        forecast.renew(&with(1.0), &e(1.1), 1, &medium(1e-3));
        (0..2).for_each(|grain| forecast.recharge(grain, 1.2));
        assert!(forecast.has_jumped_by(0.16, &CENTRE, 0.0) && !forecast.has_jumped_by(0.17, &CENTRE, 0.0));
        // All charges grow by a sixth of what they are, and so does E, which was 1.1.
        assert!((forecast.jumps(&CENTRE, 0.0).e2.sqrt() - 1.1 / 6.0).abs() < 1e-6);
        // A step of 0.1 as before, and a jump by the share of the charges that is new.
        let check = forecast.renew(&with(1.2), &e(1.4), 1, &medium(1e-3)).expect("a step was taken");
        assert!(check.drift < 1e-9 && (check.jump - 0.2 / 1.4).abs() < 1e-9, "{check:?}");
        assert!((forecast.at(0, 1.0).z - 1.5).abs() < 1e-9);
        assert!(!forecast.has_jumped_by(0.0, &CENTRE, 1.0));
    }

    #[test]
    fn second_evaluation_at_the_same_time_starts_afresh() {
        let mut forecast = Forecast::default();
        forecast.renew(&members(&[0], 1), &fresh(&[0], 0.0), 0, &medium(1.0));
        assert_eq!(forecast.renew(&members(&[0], 1), &fresh(&[1], 0.0), 0, &medium(1.0)), None);
        assert_eq!(forecast.at(0, 9.0), parabola(1, 0.0));
    }

    #[test]
    fn energy_follows_its_line() {
        let mut energy = EnergyForecast::default();
        let of = |energy: f64| FieldEnergy { energy, error: 0.1 * energy };
        energy.renew(of(3.0), 0);
        assert_eq!(energy.at(5), of(3.0));
        energy.renew(of(5.0), 4);
        assert_eq!(energy.at(2), FieldEnergy { energy: 6.0, error: 0.5 });
    }
}
