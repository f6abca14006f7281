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

/// E, its change and the charge of every grain, in sorted order; zero for grains that are no members.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Forecast {
    /// E at the last evaluation [V/m].
    e: Vec<Vector3<f64>>,
    /// Change of E per step [V/m].
    slope: Vec<Vector3<f64>>,
    /// Charge [C].
    charge: Vec<f64>,
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

    /// Takes a grain's new charge [C]; nothing is known before the first evaluation.
    pub(crate) fn recharge(&mut self, grain: usize, charge: f64) {
        if let Some(known) = self.charge.get_mut(grain) {
            *known = charge;
        }
    }

    /// Whether it is one of `count` grains.
    pub(crate) fn fits(&self, count: usize) -> bool {
        [self.e.len(), self.slope.len(), self.charge.len()] == [count; 3]
    }

    /// Follows grains that are reordered to `order[new] = old`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        // Nothing is known before the first evaluation.
        if !self.e.is_empty() {
            pick(&mut self.e, order, &mut self.spare.0);
            pick(&mut self.slope, order, &mut self.spare.0);
            pick(&mut self.charge, order, &mut self.spare.1);
        }
    }

    /// Takes a fresh E of the members, whose sorted indices among `count` grains are `index`, `age` steps
    /// after the last evaluation. The difference from what was forecast, over `scale` [V/m]; `None` the first
    /// time and when no step was taken.
    pub(crate) fn renew(
        &mut self,
        members: &Members,
        fresh: &[Vector3<f64>],
        age: u64,
        scale: f64,
    ) -> Option<Check> {
        let Members { index, charge, count, .. } = members;
        let known = !self.e.is_empty() && age > 0;
        self.e.resize(*count, Vector3::zeros());
        self.slope.resize(*count, Vector3::zeros());
        self.charge.resize(*count, 0.0);
        let age = age as f64;
        let (mut squares, mut largest2) = (0.0, 0.0_f64);
        for ((&i, fresh), charge) in index.iter().zip(fresh).zip(charge) {
            let i = i as usize;
            let error2 = (fresh - self.at(i, age)).norm_squared();
            squares += error2;
            largest2 = largest2.max(error2);
            self.slope[i] = if known { (fresh - self.e[i]) / age } else { Vector3::zeros() };
            self.e[i] = *fresh;
            self.charge[i] = *charge;
        }
        let over = |value: f64| if value == 0.0 { 0.0 } else { value / scale };
        let mean2 = squares / index.len().max(1) as f64;
        known.then(|| Check { rms: over(mean2.sqrt()), largest: over(largest2.sqrt()) })
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

    fn members(index: &[u32], count: usize) -> Members {
        let (position, charge) = (vec![Vector3::zeros(); index.len()], vec![2.0; index.len()]);
        Members { index: index.to_vec(), position, charge, count, time_s: 0.0 }
    }

    #[test]
    fn forecast_is_held_first_then_follows_the_line_and_is_checked() {
        let mut forecast = Forecast::default();
        // Grain 1 of 0…3 is no member.
        let inside = [0_u32, 2, 3];
        assert_eq!(forecast.renew(&members(&inside, 4), &fresh(&inside, 0.0), 0, 1.0), None);
        assert_eq!(forecast.at(2, 5.0), parabola(2, 0.0));
        assert_eq!(forecast.force(2, 5.0), 2.0 * parabola(2, 0.0));
        let check =
            forecast.renew(&members(&inside, 4), &fresh(&inside, 2.0), 2, 10.0).expect("steps were taken");
        let largest = (parabola(3, 2.0) - parabola(3, 0.0)).norm() / 10.0;
        assert!((check.largest - largest).abs() < 1e-15);
        // The line through times 0 and 2, three steps on, misses the parabola by g·3·5.
        assert!((forecast.at(3, 3.0) - parabola(3, 5.0) + Vector3::x() * 45.0).norm() < 1e-12);

        // The grains are sorted anew as 3, 2, 1, 0, and the last one leaves.
        forecast.reorder(&[3, 2, 1, 0]);
        forecast.reorder(&[0, 1, 2]);
        assert!(forecast.fits(3) && forecast.force(2, 3.0) == Vector3::zeros());
        let check =
            forecast.renew(&members(&[0, 1], 3), &fresh(&[3, 2], 5.0), 3, 1.0).expect("steps were taken");
        assert!((check.rms - f64::sqrt((45.0 * 45.0 + 30.0 * 30.0) / 2.0)).abs() < 1e-12);
        assert!((forecast.at(0, 0.0) - parabola(3, 5.0)).norm() < 1e-12);
    }

    #[test]
    fn second_evaluation_at_the_same_time_starts_afresh() {
        let mut forecast = Forecast::default();
        forecast.renew(&members(&[0], 1), &fresh(&[0], 0.0), 0, 1.0);
        assert_eq!(forecast.renew(&members(&[0], 1), &fresh(&[1], 0.0), 0, 1.0), None);
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
